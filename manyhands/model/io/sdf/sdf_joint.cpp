// <joint>: its type and axes.
#include <array>
#include <cmath>
#include <utility>

#include "manyhands/model/io/sdf/sdf_parts.h"
#include "manyhands/model/io/text_numbers.h"

namespace manyhands::io {

namespace {

/// How many axes a joint of that type has.
std::size_t num_axes(const SdfElement& joint, const std::string& type) {
  constexpr std::array<std::pair<std::string_view, std::size_t>, 9> kTypes{{{"fixed", 0},
                                                                            {"revolute", 1},
                                                                            {"continuous", 1},
                                                                            {"prismatic", 1},
                                                                            {"ball", 0},
                                                                            {"universal", 2},
                                                                            {"revolute2", 2},
                                                                            {"screw", 1},
                                                                            {"gearbox", 0}}};
  std::string known;
  for (const auto& [name, axes] : kTypes) {
    if (type == name) return axes;
    known += (known.empty() ? "" : ", ") + std::string(name);
  }
  joint.fail("there is no joint type " + in_quotes(type) + "; expected one of " + known);
}

double bound_or_none(const SdfElement& limit, const char* tag) {
  const double value = limit.limit_or(tag, JointLimits().effort);
  return value >= 0 ? value : JointLimits().effort;  // -1 says none
}

JointLimits read_limits(const SdfElement& axis) {
  JointLimits limits;
  const SdfElement limit = axis.child("limit");
  if (!limit) return limits;
  limit.expect({"lower", "upper", "effort", "velocity"});
  limits.lower = limit.limit_or("lower", limits.lower);
  limits.upper = limit.limit_or("upper", limits.upper);
  limits.effort = bound_or_none(limit, "effort");
  limits.velocity = bound_or_none(limit, "velocity");
  const JointLimits none;
  if (limits.lower > limits.upper) {
    limit.note(LoadAction::kRepaired, "lower " + format_number(limits.lower) + " is above upper " +
                                          format_number(limits.upper) + "; no range taken");
    limits.lower = none.lower;
    limits.upper = none.upper;
  }
  if (limits.lower == none.upper || limits.upper == none.lower) limit.fail("a limit is infinite on the wrong side");
  return limits;
}

void read_dynamics(const SdfElement& axis, Joint& joint) {
  const SdfElement dynamics = axis.child("dynamics");
  if (!dynamics) return;
  dynamics.expect({"damping", "friction", "spring_reference", "spring_stiffness"});
  joint.damping = dynamics.positive_or("damping", 0);
  joint.friction = dynamics.positive_or("friction", 0);
  joint.stiffness = dynamics.positive_or("spring_stiffness", 0);
  if (joint.stiffness > 0) joint.spring_reference = {dynamics.number_or("spring_reference", 0)};
}

std::optional<Mimic> read_mimic(const SdfElement& axis) {
  const SdfElement mimic = axis.child("mimic");
  if (!mimic) return std::nullopt;
  mimic.expect({"multiplier", "offset", "reference"});
  const double multiplier = mimic.number_or("multiplier", 1);
  return Mimic{mimic.attribute("joint"), multiplier,
               mimic.number_or("offset", 0) - multiplier * mimic.number_or("reference", 0)};
}

SdfAxis read_axis(const SdfElement& joint, const char* tag) {
  const SdfElement axis = joint.child(tag);
  if (!axis) {
    joint.note(LoadAction::kDefaulted, "no <" + std::string(tag) + ">; 0 0 1 taken");
    return {.source = joint};
  }
  axis.expect({"xyz", "limit", "dynamics", "use_parent_model_frame", "initial_position", "mimic"});
  SdfAxis result{.source = axis};
  result.xyz = axis.vec3_or("xyz", result.xyz);
  if (norm(result.xyz) < 1e-9) {
    axis.note(LoadAction::kRepaired, "the axis is 0; 0 0 1 taken");
    result.xyz = {0, 0, 1};
  }
  constexpr int kFirstInJointFrame = 105;  // before SDF 1.5 axes were in the model's frame
  const bool by_default = axis.file().version < kFirstInJointFrame;
  if (axis.flag_or("use_parent_model_frame", by_default)) result.expressed_in = "__model__";
  if (const SdfElement xyz = axis.child("xyz"); xyz && !xyz.attribute("expressed_in").empty()) {
    result.expressed_in = xyz.attribute("expressed_in");
  }
  result.joint.limits = read_limits(axis);
  read_dynamics(axis, result.joint);
  result.joint.mimic = read_mimic(axis);
  if (axis.has("initial_position")) result.joint.initial = {axis.number_or("initial_position", 0)};
  return result;
}

}  // namespace

SdfJoint read_joint(const SdfElement& joint) {
  SdfJoint result{.source = joint, .name = joint.name(), .scope = {}, .key = {}, .type = {}, .parent = {}, .child = {}};
  result.type = joint.attribute("type");
  const std::size_t axes = num_axes(joint, result.type);
  if (axes == 2) {
    joint.expect({"pose", "parent", "child", "axis", "axis2"});
  } else {
    joint.expect({"pose", "parent", "child", axes == 0 ? "" : "axis"});
  }
  result.parent = joint.text_or("parent", "");
  result.child = joint.text_or("child", "");
  if (result.parent.empty()) joint.fail("it has no <parent>; expected the name of a link");
  if (result.child.empty()) joint.fail("it has no <child>; expected the name of a link");
  if (axes > 0) result.axes.push_back(read_axis(joint, "axis"));
  if (axes > 1) result.axes.push_back(read_axis(joint, "axis2"));
  if (result.type == "continuous") {
    result.axes[0].joint.limits.lower = JointLimits().lower;
    result.axes[0].joint.limits.upper = JointLimits().upper;
  }
  return result;
}

}  // namespace manyhands::io
