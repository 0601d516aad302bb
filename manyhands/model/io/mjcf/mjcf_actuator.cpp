// <actuator>: motors, servos and other affine laws on joints, tendons and sites, however they are written.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "manyhands/model/io/mjcf/mjcf_scene.h"
#include "manyhands/model/io/text_numbers.h"

namespace manyhands::io {

bool is_limited(const MjcfScene& scene, const MjcfElement& e, const char* range, const char* limited) {
  const std::string word = e.word_or(limited, {"true", "false", "auto"}, "auto");
  if (word == "auto" && e.has(range) && !scene.settings_of(e).autolimits) {
    e.fail(std::string("it has '") + range + "' but not '" + limited + "', and autolimits is false");
  }
  if (word == "true" && !e.has(range)) e.fail(std::string("it is limited but has no '") + range + "'");
  return word == "true" || (word == "auto" && e.has(range));
}

namespace {

/// MuJoCo's form: force = gain . (1, length, velocity) ctrl + bias . (1, length, velocity), in the actuator's space.
struct Law {
  std::array<double, 3> gain{1, 0, 0};
  std::array<double, 3> bias{0, 0, 0};
};

double first_number(const MjcfElement& e, const char* attribute, double fallback) {
  return e.has(attribute) ? e.numbers(attribute, 1, 10)[0] : fallback;
}

/// The first three parameters of an affine function; what is not given is 0.
std::array<double, 3> affine(const MjcfElement& e, const char* attribute) {
  std::array<double, 3> result{};
  if (!e.has(attribute)) return result;
  const std::vector<double> given = e.numbers(attribute, 1, 10);
  std::copy_n(given.begin(), std::min<std::size_t>(given.size(), 3), result.begin());
  return result;
}

/// kd of a position servo: kv, or the damping of a ratio to critical (MuJoCo's mj_setConst).
double damping_of(const MjcfElement& e, double inertia, double kp) {
  if (!e.has("dampratio")) return e.positive_or("kv", 0);
  if (e.has_own("kv")) e.fail("both 'kv' and 'dampratio' are given; expected one");
  return e.positive_or("dampratio", 1) * 2 * std::sqrt(kp * inertia);
}

/// Whether a word of a <general> is one of those; else it is left out, with a note.
bool is_known(const MjcfElement& e, const char* attribute, std::initializer_list<std::string_view> known) {
  const std::string value = e.text_or(attribute, std::string(*known.begin()));
  if (std::ranges::find(known, value) != known.end()) return true;
  e.note_serious(LoadAction::kIgnored,
                 std::string(attribute) + " " + in_quotes(value) + " is not read; it is left out");
  return false;
}

/// The law of a <general>; nothing, with a note, if it is of another kind.
std::optional<Law> general_law(const MjcfElement& e) {
  if (!is_known(e, "gaintype", {"fixed", "affine"}) || !is_known(e, "biastype", {"none", "affine"}))
    return std::nullopt;
  Law law;
  if (e.has("gainprm")) law.gain = affine(e, "gainprm");
  if (e.text_or("gaintype", "fixed") == "fixed") law.gain[1] = law.gain[2] = 0;
  if (e.text_or("biastype", "none") == "affine") law.bias = affine(e, "biasprm");
  return law;
}

/// The area of a cylinder's piston.
double area_of(const MjcfElement& e) {
  if (!e.has("diameter")) return e.number_or("area", 1);
  const double radius = 0.5 * e.number_or("diameter", 1);
  return std::numbers::pi * radius * radius;
}

/// `inertia`: that which the actuator moves, at its own length.
std::optional<Law> law_of(const MjcfElement& e, double inertia) {
  const std::string_view tag = e.tag();
  if (tag == "motor") return Law{};
  if (tag == "general") return general_law(e);
  if (tag == "cylinder") return Law{{area_of(e), 0, 0}, affine(e, "bias")};
  if (tag == "velocity" || tag == "damper") {
    const double kv = e.positive_or("kv", 1);
    return tag == "velocity" ? Law{{kv, 0, 0}, {0, 0, -kv}} : Law{{0, 0, -kv}, {0, 0, 0}};
  }
  const double kp = e.has("kp") ? e.positive_or("kp", 1) : std::abs(first_number(e, "gainprm", 1));
  return Law{{kp, 0, 0}, {0, -kp, -damping_of(e, inertia, kp)}};
}

/// How many activations MuJoCo has for it.
std::size_t num_activations(const MjcfElement& e) {
  const std::string_view tag = e.tag();
  if (tag == "muscle" || tag == "intvelocity" || tag == "cylinder") return 1;
  if (tag == "position") return e.number_or("timeconst", 0) != 0 ? 1 : 0;
  if (tag != "general" || e.text_or("dyntype", "none") == "none") return 0;
  return static_cast<std::size_t>(std::clamp(e.integer_or("actdim", 1), 1, 1000));
}

/// Its kind, its time constant and the range of actrange; nothing, with a note, if it is of another kind.
std::optional<Activation> activation_of(const MjcfScene& scene, const MjcfElement& e) {
  const std::string_view tag = e.tag();
  Activation activation;
  if (tag == "general") {
    if (!is_known(e, "dyntype", {"none", "integrator", "filter", "filterexact"})) return std::nullopt;
    if (num_activations(e) > 1) {
      e.note_serious(LoadAction::kIgnored, "an actdim above 1 is not read; it is left out");
      return std::nullopt;
    }
    const std::string type = e.text_or("dyntype", "none");
    activation.type = type == "integrator"    ? ActivationType::kIntegrator
                      : type == "filter"      ? ActivationType::kFilter
                      : type == "filterexact" ? ActivationType::kFilterExact
                                              : ActivationType::kNone;
    activation.time_constant = first_number(e, "dynprm", 1);
    activation.early = e.boolean_or("actearly", false);
  } else if (tag == "intvelocity") {
    activation.type = ActivationType::kIntegrator;
  } else if (tag == "cylinder") {
    activation.type = ActivationType::kFilter;
    activation.time_constant = e.number_or("timeconst", 1);
  } else if (tag == "position" && e.number_or("timeconst", 0) != 0) {
    activation.type = ActivationType::kFilterExact;
    activation.time_constant = e.number_or("timeconst", 0);
  }
  if (activation.time_constant < 0) e.fail("its time constant is below 0; expected 0 or more");
  if (activation.type == ActivationType::kNone || !is_limited(scene, e, "actrange", "actlimited")) return activation;
  const std::vector<double> range = e.numbers("actrange", 2, 2);
  if (range[0] > -kMjcfUnlimited) activation.lower = range[0];
  if (range[1] < kMjcfUnlimited) activation.upper = range[1];
  return activation;
}

/// Writes the law into the actuator, as a motor or servo if it is one's.
void apply(const Law& law, Actuator& actuator) {
  const auto& [b0, b1, b2] = law.bias;
  const auto& [g0, g1, g2] = law.gain;
  const bool is_servo = b1 != 0 || b2 != 0;
  if (g1 != 0 || g2 != 0 || b1 > 0 || b2 > 0 || (!is_servo && g0 == 0)) {
    actuator.type = ActuatorType::kAffine;
    actuator.gain = law.gain;
    actuator.bias = law.bias;
    return;
  }
  if (b0 == 0 && !is_servo) {
    actuator.type = ActuatorType::kForce;
    actuator.ctrl_scale = g0;
    return;
  }
  const double k = b1 != 0 ? -b1 : b2 != 0 ? -b2 : 1;
  actuator.type = b1 != 0 ? ActuatorType::kPosition : b2 != 0 ? ActuatorType::kVelocity : ActuatorType::kForce;
  actuator.kp = -b1;
  actuator.kd = -b2;
  actuator.ctrl_scale = g0 / k;
  actuator.ctrl_offset = b0 / k;
}

std::pair<double, double> limits_of(const MjcfScene& scene, const Actuator& actuator) {
  if (actuator.tendon.is_valid()) {
    const Tendon& tendon = scene.builder.tendons()[actuator.tendon.index()];
    return {tendon.lower, tendon.upper};
  }
  const JointLimits& limits = scene.builder.joints()[actuator.joint.index()].limits;
  return {limits.lower, limits.upper};
}

/// The bounds of its force, within those of all actuators of its joint.
void read_force_range(const MjcfScene& scene, const MjcfElement& e, double gear, Actuator& actuator) {
  double low = -std::numeric_limits<double>::infinity(), high = -low;
  if (is_limited(scene, e, "forcerange", "forcelimited")) {
    const std::vector<double> range = e.numbers("forcerange", 2, 2);
    if (range[0] > range[1]) e.fail("its 'forcerange' is not in order; expected the lower bound first");
    low = gear * (gear > 0 ? range[0] : range[1]);
    high = gear * (gear > 0 ? range[1] : range[0]);
  }
  if (low != -high && std::max(high, -low) >= std::abs(gear) * kMjcfUnlimited) {
    e.note_serious(LoadAction::kIgnored, "a 'forcerange' with one bound is not used");
    return;
  }
  actuator.max_force = high;
  if (low != -high) actuator.min_force = low;
}

void read_ranges(const MjcfScene& scene, const MjcfElement& e, double gear, Actuator& actuator) {
  if (is_limited(scene, e, "ctrlrange", "ctrllimited")) {
    const std::vector<double> range = e.numbers("ctrlrange", 2, 2);
    if (range[0] > -kMjcfUnlimited) actuator.min_ctrl = range[0];
    if (range[1] < kMjcfUnlimited) actuator.max_ctrl = range[1];
  } else if (e.tag() == "position" && e.number_or("inheritrange", 0) > 0) {
    const auto [lower, upper] = limits_of(scene, actuator);
    if (!is_finite(lower)) e.fail("'inheritrange' needs a joint or tendon with a range");
    const double middle = 0.5 * (lower + upper);
    const double half = 0.5 * (upper - lower) * e.number_or("inheritrange", 0);
    actuator.min_ctrl = middle - half;
    actuator.max_ctrl = middle + half;
  }
  read_force_range(scene, e, gear, actuator);
}

/// What MuJoCo takes for the inertia that a tendon's actuator moves, by which 'dampratio' counts [at its length].
double inertia_of(const MjcfScene& scene, const MjcfElement& e, const Tendon& tendon) {
  if (e.has("dampratio") && tendon.joints.empty())
    e.note_serious(LoadAction::kIgnored, "'dampratio' of a spatial tendon's actuator is not used");
  double sum = 0;
  for (const TendonJoint& part : tendon.joints) {
    const auto joint = std::ranges::find(scene.joints, part.joint, &MjcfJoint::id);
    sum += joint->inertia / (part.coefficient * part.coefficient);
  }
  return sum;
}

/// A wrench at a site, against another one where there is a reference.
double read_site(const MjcfScene& scene, const MjcfElement& e, Actuator& actuator) {
  const MjcfSite& site = scene.site(e, "site");
  ActuatorSite& at = actuator.site.emplace(ActuatorSite{.link = site.link, .X_LS = site.X_LS});
  if (e.has("refsite")) {
    const MjcfSite& reference = scene.site(e, "refsite");
    at.reference = reference.link;
    at.X_LR = reference.X_LS;
  }
  std::vector<double> gear = e.has("gear") ? e.numbers("gear", 1, 6) : std::vector<double>{1};
  gear.resize(6, 0.0);
  at.force = {gear[0], gear[1], gear[2]};
  at.torque = {gear[3], gear[4], gear[5]};
  if (e.has("dampratio")) e.note_serious(LoadAction::kIgnored, "'dampratio' of an actuator at a site is not used");
  return 0;
}

/// A torque about axes of a ball joint: those of its child, or in its parent those that it has unturned. As between two
/// sites at the joint, whose rotation against each other is q.
double read_ball(const MjcfElement& e, const Joint& joint, bool in_parent, Actuator& actuator) {
  std::vector<double> gear = e.has("gear") ? e.numbers("gear", 1, 6) : std::vector<double>{1};
  gear.resize(6, 0.0);
  const Vec3<double> torque{gear[0], gear[1], gear[2]};
  const ActuatorSite in_child{.link = joint.parent, .X_LS = joint.X_PF, .reference = joint.child, .torque = -torque};
  const ActuatorSite in_frame{.link = joint.child, .reference = joint.parent, .X_LR = joint.X_PF, .torque = torque};
  actuator.site = in_parent ? in_frame : in_child;
  if (e.has("dampratio")) e.note_serious(LoadAction::kIgnored, "'dampratio' of a ball joint's actuator is not used");
  return 0;
}

/// What the actuator drives, and the inertia that it moves; nothing, with a note, if that is not read.
std::optional<double> read_transmission(const MjcfScene& scene, const MjcfElement& e, Actuator& actuator) {
  if (e.has("site")) return read_site(scene, e, actuator);
  actuator.gear = first_number(e, "gear", 1);
  const double squared = actuator.gear * actuator.gear;
  if (e.has("tendon")) {
    const MjcfTendon& tendon = scene.tendon(e, "tendon");
    if (!tendon.id) {
      e.note_serious(LoadAction::kIgnored, "tendon " + in_quotes(tendon.name) + " was left out, and so is it");
      return std::nullopt;
    }
    actuator.tendon = *tendon.id;
    return inertia_of(scene, e, scene.builder.tendons()[tendon.id->index()]) / squared;
  }
  const bool in_parent = !e.has("joint");
  const char* const on = in_parent ? "jointinparent" : "joint";
  if (!e.has(on)) {
    e.note_serious(LoadAction::kIgnored, "it does not act on a joint, tendon or site; it is left out");
    return std::nullopt;
  }
  const MjcfJoint& read = scene.joint(e, on);
  const Joint& joint = scene.builder.joints()[read.id.index()];
  if (joint.type == JointType::kFloating) {
    e.note_serious(LoadAction::kIgnored, "joint " + in_quotes(read.name) + " is free; the actuator is left out");
    return std::nullopt;
  }
  if (joint.type == JointType::kSpherical) {
    actuator.gear = 1;
    return read_ball(e, joint, in_parent, actuator);
  }
  actuator.joint = read.id;
  return read.inertia / squared;
}

constexpr std::string_view kRead[] = {"motor", "position", "velocity", "general", "intvelocity", "damper", "cylinder"};

/// Adds the actuator and returns its index; -1, with a note, if it is left out.
int add_actuator(MjcfScene& scene, const MjcfElement& e, const std::string& name) {
  const std::string tag(e.tag());
  if (std::ranges::find(kRead, tag) == std::ranges::end(kRead)) {
    e.note_serious(LoadAction::kIgnored, "an actuator of kind <" + tag + "> is not read; it is left out");
    return -1;
  }
  Actuator actuator{.name = name};
  const std::optional<double> inertia = read_transmission(scene, e, actuator);
  if (!inertia) return -1;
  const double gear = actuator.gear;
  if (gear == 0) e.fail("its gear is 0; expected another number");
  e.expect({"name",      "class",       "joint",      "jointinparent", "tendon",   "site",       "refsite",  "gear",
            "ctrlrange", "ctrllimited", "forcerange", "forcelimited",  "actrange", "actlimited", "actearly", "kp",
            "kv",        "dampratio",   "timeconst",  "inheritrange",  "area",     "diameter",   "bias",     "gaintype",
            "gainprm",   "biastype",    "biasprm",    "dyntype",       "dynprm",   "actdim",     "group"});
  const std::optional<Law> law = law_of(e, *inertia);
  const std::optional<Activation> activation = law ? activation_of(scene, e) : std::nullopt;
  if (!activation) return -1;
  actuator.activation = *activation;
  apply(*law, actuator);
  read_ranges(scene, e, gear, actuator);
  return checked(e, [&] { return scene.builder.add_actuator(actuator).value(); });
}

/// Joints bound what all their actuators do together: as the bound of the one that there is.
void bound_by_efforts(MjcfScene& scene) {
  for (const MjcfJoint& read : scene.joints) {
    const double effort = scene.builder.joints()[read.id.index()].limits.effort;
    if (!is_finite(effort)) continue;
    std::vector<ActuatorId> on_joint;
    for (std::size_t i = 0; i < scene.builder.actuators().size(); ++i) {
      if (scene.builder.actuators()[i].joint == read.id) on_joint.emplace_back(i);
    }
    if (on_joint.size() > 1) {
      scene.root.note_serious(LoadAction::kIgnored, "joint " + in_quotes(read.name) +
                                                        " has several actuators, whose bound by 'actuatorfrcrange' "
                                                        "together is not used");
    }
    if (on_joint.size() != 1) continue;
    Actuator& actuator = scene.builder.actuator(on_joint.front());
    const double low = std::clamp(actuator.least_force(), -effort, effort);
    const double high = std::clamp(actuator.max_force, -effort, effort);
    actuator.max_force = high;
    actuator.min_force = low != -high ? std::optional(low) : std::nullopt;
  }
}

}  // namespace

void read_actuators(MjcfScene& scene) {
  MjcfNames names;
  for (const MjcfElement& section : scene.sections("actuator")) {
    for (const MjcfElement& element : scene.elements(section)) {
      const std::string name = claim_name(names, element.named("actuator"), "actuator", names.size(), scene.reserved);
      const MjcfElement e = element.named("actuator '" + name + "'").with_defaults(scene.classes, "actuator");
      scene.activations.push_back(num_activations(e));
      scene.actuators.push_back(add_actuator(scene, e, name));
    }
  }
  bound_by_efforts(scene);
}

}  // namespace manyhands::io
