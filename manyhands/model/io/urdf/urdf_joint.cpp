// <joint>: its type, axis, limits, dynamics and mimic.
#include <array>
#include <cmath>
#include <utility>

#include "manyhands/model/io/text_numbers.h"
#include "manyhands/model/io/urdf/urdf_parts.h"
#include "manyhands/model/unit.h"

namespace manyhands::io {

namespace {

constexpr std::array<std::pair<std::string_view, JointType>, 7> kTypes{{
    {"fixed", JointType::kFixed},
    {"revolute", JointType::kRevolute},
    {"continuous", JointType::kContinuous},
    {"prismatic", JointType::kPrismatic},
    {"spherical", JointType::kSpherical},
    {"planar", JointType::kPlanar},
    {"floating", JointType::kFloating},
}};

JointType read_type(const UrdfElement& joint) {
  const std::string type = joint.text("type");
  std::string known;
  for (const auto& [name, value] : kTypes) {
    if (type == name) return value;
    known += (known.empty() ? "" : ", ") + std::string(name);
  }
  joint.fail("there is no joint type " + in_quotes(type) + "; expected one of " + known);
}

bool has_axis(JointType type) {
  return type == JointType::kRevolute || type == JointType::kContinuous || type == JointType::kPrismatic ||
         type == JointType::kPlanar;
}

bool has_range(JointType type) { return type == JointType::kRevolute || type == JointType::kPrismatic; }

Vec3<double> read_axis(const UrdfElement& joint) {
  constexpr Vec3<double> kDefault{1, 0, 0};  // URDF's own
  const UrdfElement axis = joint.child("axis");
  if (!axis) {
    joint.note(LoadAction::kDefaulted, "no <axis>; 1 0 0 taken");
    return kDefault;
  }
  axis.expect({"xyz"});
  if (!axis.has("xyz")) {
    axis.note(LoadAction::kDefaulted, "<axis> has no xyz; 1 0 0 taken");
    return kDefault;
  }
  const Vec3<double> v = axis.vec3("xyz", "0 0 1");
  const double length = norm(v);
  if (length < 1e-9) {
    axis.note(LoadAction::kRepaired, "the axis is 0; 1 0 0 taken");
    return kDefault;
  }
  if (std::abs(length - 1) > 1e-3) {
    axis.note(LoadAction::kRepaired, "the axis has length " + format_number(length) + "; brought to 1");
  }
  return at_unit_length(v);
}

double positive_or_unlimited(const UrdfElement& limit, const char* attribute) {
  const std::optional<double> value = limit.optional_number(attribute, Magnitude::kAny);
  const std::string name(attribute);
  if (!value) {
    limit.note(LoadAction::kDefaulted, "<limit> has no " + name + "; unlimited");
  } else if (*value < 0) {
    limit.note(LoadAction::kRepaired, "the " + name + " limit " + format_number(*value) + " is negative; unlimited");
  }
  return value && *value >= 0 ? *value : JointLimits().effort;
}

void read_range(const UrdfElement& limit, JointLimits& limits) {
  const std::optional<double> lower = limit.optional_number("lower", Magnitude::kAny);
  const std::optional<double> upper = limit.optional_number("upper", Magnitude::kAny);
  if (!lower && !upper) {
    limit.note(LoadAction::kDefaulted, "<limit> has neither lower nor upper; no range taken");
    return;
  }
  if (!lower || !upper) {
    limit.note(LoadAction::kDefaulted, std::string("<limit> has no ") + (lower ? "upper" : "lower") + "; 0 taken");
  }
  if (lower.value_or(0) > upper.value_or(0)) {
    limit.note(LoadAction::kRepaired, "lower " + format_number(lower.value_or(0)) + " is above upper " +
                                          format_number(upper.value_or(0)) + "; no range taken, as PyBullet does");
    return;
  }
  limits.lower = lower.value_or(0);
  limits.upper = upper.value_or(0);
}

JointLimits read_limits(const UrdfElement& joint, JointType type) {
  JointLimits limits;
  const UrdfElement limit = joint.child("limit");
  if (!limit) {
    if (has_range(type)) joint.note(LoadAction::kDefaulted, "no <limit>; unlimited");
    return limits;
  }
  const bool is_told = joint.is_bullet();  // of joints that have none, Bullet tells them all the same
  if (type == JointType::kFixed && !is_told) return limits;
  if (has_range(type) || (is_told && (limit.has("lower") || limit.has("upper")))) {
    limit.expect({"lower", "upper", "effort", "velocity"});
    read_range(limit, limits);
  } else {
    limit.expect({"effort", "velocity"});
  }
  limits.effort = positive_or_unlimited(limit, "effort");
  limits.velocity = positive_or_unlimited(limit, "velocity");
  return limits;
}

void read_dynamics(const UrdfElement& element, Joint& joint) {
  const UrdfElement dynamics = element.child("dynamics");
  if (!dynamics) return;
  dynamics.expect({"damping", "friction"});
  const auto read = [&](const char* attribute) {
    const double value = dynamics.optional_number(attribute).value_or(0.0);
    if (value >= 0) return value;
    dynamics.note_serious(LoadAction::kRepaired,
                          std::string(attribute) + " " + format_number(value) + " is negative; 0 taken");
    return 0.0;
  };
  joint.damping = read("damping");
  joint.friction = read("friction");
}

std::optional<Mimic> read_mimic(const UrdfElement& joint, JointType type) {
  const UrdfElement mimic = joint.child("mimic");
  if (!mimic) return std::nullopt;
  mimic.expect({"joint", "multiplier", "offset"});
  if (joint.is_bullet()) {
    mimic.note(LoadAction::kIgnored, "Bullet does not know mimics; the joint moves freely");
    return std::nullopt;
  }
  Mimic result{mimic.text("joint"), mimic.optional_number("multiplier").value_or(1.0),
               mimic.optional_number("offset").value_or(0.0)};
  if (velocity_size(type) == 1) return result;
  mimic.note_serious(LoadAction::kIgnored, "a " + std::string(to_string(type)) + " joint cannot mimic another");
  return std::nullopt;
}

}  // namespace

UrdfJoint read_joint(const UrdfElement& element) {
  element.expect({"name", "type"}, {"origin", "parent", "child", "axis", "limit", "dynamics", "mimic"});
  UrdfJoint result{.source = element, .joint = {}, .parent = {}, .child = {}};
  const auto link_of = [&](const char* tag) {
    const UrdfElement end = element.required_child(tag, "<" + std::string(tag) + " link=\"...\"/>");
    end.expect({"link"});
    return end.text("link");
  };
  result.parent = link_of("parent");
  result.child = link_of("child");
  Joint& joint = result.joint;
  joint.name = element.text("name");
  joint.type = read_type(element);
  if (joint.type == JointType::kFloating && element.is_bullet()) {
    element.note(LoadAction::kRepaired, "a floating joint is a fixed one in Bullet");
    joint.type = JointType::kFixed;
  }
  joint.X_PF = element.origin();
  if (has_axis(joint.type)) joint.axis = read_axis(element);
  joint.limits = read_limits(element, joint.type);
  read_dynamics(element, joint);
  joint.mimic = read_mimic(element, joint.type);
  return result;
}

}  // namespace manyhands::io
