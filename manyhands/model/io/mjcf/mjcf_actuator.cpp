// <actuator>: motors, position and velocity servos on joints and tendons, however they are written.
#include <algorithm>
#include <cmath>
#include <limits>

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

/// MuJoCo's form: force = gain ctrl + bias0 + bias1 length + bias2 velocity, in the actuator's space.
struct Law {
  double gain = 1;
  std::array<double, 3> bias{0, 0, 0};
};

double first_number(const MjcfElement& e, const char* attribute, double fallback) {
  return e.has(attribute) ? e.numbers(attribute, 1, 10)[0] : fallback;
}

/// kd of a position servo: kv, or the damping of a ratio to critical (MuJoCo's mj_setConst).
double damping_of(const MjcfElement& e, double inertia, double kp) {
  if (!e.has("dampratio")) return e.positive_or("kv", 0);
  if (e.has_own("kv")) e.fail("both 'kv' and 'dampratio' are given; expected one");
  return e.positive_or("dampratio", 1) * 2 * std::sqrt(kp * inertia);
}

/// The law of a <general>; nothing, with a note, if it is of another kind.
std::optional<Law> general_law(const MjcfElement& e) {
  const auto has_other = [&](const char* attribute, std::initializer_list<std::string_view> known) {
    const std::string value = e.text_or(attribute, std::string(*known.begin()));
    if (std::ranges::find(known, value) != known.end()) return false;
    e.note_serious(LoadAction::kIgnored,
                   std::string(attribute) + " " + in_quotes(value) + " is not read; it is left out");
    return true;
  };
  if (has_other("dyntype", {"none"}) || has_other("gaintype", {"fixed"}) || has_other("biastype", {"none", "affine"})) {
    return std::nullopt;
  }
  Law law{.gain = first_number(e, "gainprm", 1)};
  if (e.text_or("biastype", "none") == "affine" && e.has("biasprm")) {
    const std::vector<double> bias = e.numbers("biasprm", 1, 10);
    std::copy_n(bias.begin(), std::min<std::size_t>(bias.size(), 3), law.bias.begin());
  }
  return law;
}

/// `inertia`: that which the actuator moves, at its own length.
std::optional<Law> law_of(const MjcfElement& e, double inertia) {
  const std::string_view tag = e.tag();
  if (tag == "motor") return Law{};
  if (tag == "general") return general_law(e);
  if (tag == "velocity") {
    const double kv = e.positive_or("kv", 1);
    return Law{kv, {0, 0, -kv}};
  }
  if (e.number_or("timeconst", 0) != 0) {
    e.note_serious(LoadAction::kIgnored, "the filter of 'timeconst' is not used");
  }
  const double kp = e.has("kp") ? e.positive_or("kp", 1) : std::abs(first_number(e, "gainprm", 1));
  return Law{kp, {0, -kp, -damping_of(e, inertia, kp)}};
}

/// Writes the law into the actuator; false if none of its types can hold it.
bool apply(const Law& law, Actuator& actuator) {
  const auto& [b0, b1, b2] = law.bias;
  if ((law.gain == 0 && b0 == 0) || b1 > 0 || b2 > 0) return false;
  if (b0 == 0 && b1 == 0 && b2 == 0) {
    actuator.type = ActuatorType::kForce;
    actuator.gear *= law.gain;
    return true;
  }
  const double k = b1 != 0 ? -b1 : b2 != 0 ? -b2 : 1;
  actuator.type = b1 != 0 ? ActuatorType::kPosition : b2 != 0 ? ActuatorType::kVelocity : ActuatorType::kForce;
  actuator.kp = -b1;
  actuator.kd = -b2;
  actuator.ctrl_scale = law.gain / k;
  actuator.ctrl_offset = b0 / k;
  return true;
}

std::pair<double, double> limits_of(const MjcfScene& scene, const Actuator& actuator) {
  if (actuator.tendon.is_valid()) {
    const Tendon& tendon = scene.builder.tendons()[actuator.tendon.index()];
    return {tendon.lower, tendon.upper};
  }
  const JointLimits& limits = scene.builder.joints()[actuator.joint.index()].limits;
  return {limits.lower, limits.upper};
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
  if (!is_limited(scene, e, "forcerange", "forcelimited")) return;
  const std::vector<double> range = e.numbers("forcerange", 2, 2);
  const double most = std::max(std::abs(range[0]), std::abs(range[1]));
  actuator.max_force = std::abs(gear) * most;
  if (range[0] != -range[1]) {
    e.note(LoadAction::kRepaired, "'forcerange' is not symmetric; " + format_number(most) + " both ways taken");
  }
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

/// What the actuator drives, and the inertia that it moves; nothing, with a note, if that is not read.
std::optional<double> read_transmission(const MjcfScene& scene, const MjcfElement& e, Actuator& actuator) {
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
  const char* const on = e.has("joint") ? "joint" : "jointinparent";
  if (!e.has(on)) {
    e.note_serious(LoadAction::kIgnored, "it does not act on a joint or tendon; it is left out");
    return std::nullopt;
  }
  const MjcfJoint& joint = scene.joint(e, on);
  if (velocity_size(scene.builder.joints()[joint.id.index()].type) != 1) {
    e.note_serious(LoadAction::kIgnored,
                   "joint " + in_quotes(joint.name) + " is no hinge or slide; the actuator is left out");
    return std::nullopt;
  }
  actuator.joint = joint.id;
  return joint.inertia / squared;
}

/// Servos of one joint or tendon act as one, whose force is bounded by the sum of their bounds.
void note_shared_servo(const MjcfScene& scene, const MjcfElement& e, const Actuator& servo) {
  const auto is_servo = [](const Actuator& a) { return a.type != ActuatorType::kForce; };
  if (!is_servo(servo)) return;
  for (const Actuator& other : scene.builder.actuators()) {
    if (!is_servo(other) || other.joint != servo.joint || other.tendon != servo.tendon) continue;
    if (!is_finite(servo.max_force) && !is_finite(other.max_force)) continue;
    return e.note_serious(LoadAction::kRepaired, "another servo drives its " +
                                                     std::string(servo.tendon.is_valid() ? "tendon" : "joint") +
                                                     ", too; their forces are bounded together");
  }
}

/// Adds the actuator and returns its index; -1, with a note, if it is left out.
int add_actuator(MjcfScene& scene, const MjcfElement& e, const std::string& name) {
  const std::string tag(e.tag());
  if (tag != "motor" && tag != "position" && tag != "velocity" && tag != "general") {
    e.note_serious(LoadAction::kIgnored, "an actuator of kind <" + tag + "> is not read; it is left out");
    return -1;
  }
  const double gear = first_number(e, "gear", 1);
  Actuator actuator{.name = name, .gear = gear};
  const std::optional<double> inertia = read_transmission(scene, e, actuator);
  if (!inertia) return -1;
  if (gear == 0) e.fail("its gear is 0; expected another number");
  e.expect({"name",      "class",       "joint",        "jointinparent", "tendon",  "gear",
            "ctrlrange", "ctrllimited", "forcerange",   "forcelimited",  "kp",      "kv",
            "dampratio", "timeconst",   "inheritrange", "gaintype",      "gainprm", "biastype",
            "biasprm",   "dyntype",     "dynprm",       "group"});
  const std::optional<Law> law = law_of(e, *inertia);
  if (!law) return -1;
  if (!apply(*law, actuator)) {
    e.note_serious(LoadAction::kIgnored, "its gain and bias are neither a motor's nor a servo's; it is left out");
    return -1;
  }
  read_ranges(scene, e, gear, actuator);
  note_shared_servo(scene, e, actuator);
  return checked(e, [&] { return scene.builder.add_actuator(actuator).value(); });
}

}  // namespace

void read_actuators(MjcfScene& scene) {
  MjcfNames names;
  for (const MjcfElement& section : scene.sections("actuator")) {
    for (const MjcfElement& element : scene.elements(section)) {
      const std::string name = claim_name(names, element.named("actuator"), "actuator", names.size(), scene.reserved);
      const MjcfElement e = element.named("actuator '" + name + "'").with_defaults(scene.classes, "actuator");
      scene.actuators.push_back(add_actuator(scene, e, name));
    }
  }
}

}  // namespace manyhands::io
