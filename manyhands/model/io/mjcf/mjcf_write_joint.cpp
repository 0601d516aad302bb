// <joint> and <freejoint>, and the places that joints have in a body with several.
#include <cmath>
#include <limits>

#include "manyhands/model/io/mjcf/mjcf_compliance.h"
#include "manyhands/model/io/mjcf/mjcf_scene.h"
#include "manyhands/model/io/mjcf/mjcf_writer.h"

namespace manyhands::io {

namespace {

using Pose = Transform<double>;

/// The step's own part in its frame: half of what the reader does.
Joint as_read(const MjcfStep& step) { return {.type = step.type, .axis = step.axis}; }

Mat3<double> turned_back(const MjcfStep& step) {
  return joint_frame(Pose::identity(), Vec3<double>::zero(), as_read(step), step.reference).R;
}

/// The motion of the step at its reference.
Pose at_reference(const MjcfStep& step) {
  if (step.type == JointType::kPrismatic) return {Mat3<double>::identity(), step.reference * step.axis};
  if (step.reference == 0) return Pose::identity();
  return {to_matrix(quat_from_rotation_vector(step.reference * step.axis)), Vec3<double>::zero()};
}

bool frames_are_parallel(const std::vector<MjcfStep>& steps) {
  for (std::size_t i = 1; i < steps.size(); ++i) {
    if (!same(steps[i].X_PF.R, turned_back(steps[i]))) return false;
  }
  return true;
}

/// From the last step to the first: each anchor is what puts the next frame where it is.
void place_parallel(MjcfChain& chain) {
  const std::size_t n = chain.steps.size();
  chain.anchors.assign(n, -chain.to_body);
  chain.axes.clear();
  for (const MjcfStep& step : chain.steps) chain.axes.push_back(step.axis);
  for (std::size_t i = n - 1; i > 0; --i) {
    const MjcfStep& step = chain.steps[i];
    const auto read = [&](const Vec3<double>& before) {
      return -joint_frame({Mat3<double>::identity(), -before}, chain.anchors[i], as_read(step), step.reference).p;
    };
    chain.anchors[i - 1] = point_for(chain.anchors[i] - step.X_PF.p, -step.X_PF.p, read);
  }
  const MjcfStep& first = chain.steps[0];
  chain.quat = quat_for(first.X_PF.R, turned_back(first));
  const Mat3<double> R = to_matrix(chain.quat);
  const auto read = [&](const Vec3<double>& p) {
    return joint_frame({R, p}, chain.anchors[0], as_read(first), first.reference).p;
  };
  chain.X_PB = {R, point_for(first.X_PF.p - R * chain.anchors[0], first.X_PF.p, read)};
}

/// Anchors and axes from the poses of the frames in the body, all joints at their references.
void place_turned(MjcfChain& chain) {
  const std::size_t n = chain.steps.size();
  chain.anchors.assign(n, Vec3<double>::zero());
  chain.axes.assign(n, Vec3<double>::zero());
  Pose X_FB{Mat3<double>::identity(), chain.to_body};  // the body in the step's moved frame
  for (std::size_t i = n; i-- > 0;) {
    const Pose X_BF = inverse(X_FB);
    chain.anchors[i] = X_BF.p;
    chain.axes[i] = X_BF.R * chain.steps[i].axis;
    X_FB = chain.steps[i].X_PF * at_reference(chain.steps[i]) * X_FB;
  }
  chain.quat = quat_for(X_FB.R);
  chain.X_PB = {to_matrix(chain.quat), X_FB.p};
}

void write_range(MjcfWriter& writer, pugi::xml_node node, const MjcfStep& step) {
  const JointLimits& limits = step.joint->limits;
  const std::string what = part("joint", step.joint->name);
  const bool is_limited = std::isfinite(limits.lower) || std::isfinite(limits.upper);
  const bool is_revolute = step.joint->type == JointType::kRevolute;
  if (velocity_size(step.joint->type) != 1 || (!is_limited && !is_revolute)) return;
  if (step.joint->type == JointType::kContinuous) {
    writer.notes.changed(what, "it is continuous and has limits; read as a revolute joint");
  }
  const double lower = std::isfinite(limits.lower) ? limits.lower : -kMjcfUnlimited;
  double upper = std::isfinite(limits.upper) ? limits.upper : kMjcfUnlimited;
  if (lower == upper) {
    upper = std::nextafter(upper, std::numeric_limits<double>::infinity());
    writer.notes.changed(what, "its limits are one number, which MJCF refuses; the upper one is the next number");
  }
  set(node, "range", std::array{lower, upper});
  if (is_limited) write_compliance(writer, node, what, limits.compliance, "solreflimit", "solimplimit");
}

void write_effort(MjcfWriter& writer, pugi::xml_node node, const MjcfStep& step) {
  const double effort = step.joint->limits.effort;
  if (!std::isfinite(effort) || velocity_size(step.joint->type) != 1) return;
  if (effort > 0) return set(node, "actuatorfrcrange", std::array{-effort, effort});
  writer.notes.left_out(part("joint", step.joint->name), "an effort of 0 is left out: MJCF has none");
}

}  // namespace

bool place_chain(MjcfChain& chain) {
  const bool is_parallel = frames_are_parallel(chain.steps);
  if (is_parallel) {
    place_parallel(chain);
  } else {
    place_turned(chain);
  }
  return is_parallel;
}

void write_joint(MjcfWriter& writer, pugi::xml_node body, const MjcfChain& chain, std::size_t i) {
  const MjcfStep& step = chain.steps[i];
  const Joint& joint = *step.joint;
  const bool is_free = step.type == JointType::kFloating;
  const bool is_bare = joint.damping == 0 && joint.friction == 0 && joint.armature == 0 && joint.stiffness == 0;
  pugi::xml_node node = body.append_child(is_free && is_bare ? "freejoint" : "joint");
  set(node, "name", writer.names.claim("joint", step.name, "joint", writer.notes));
  if (std::isfinite(joint.limits.velocity)) {
    writer.notes.changed_alike("velocity", part("joint", joint.name),
                               "its limit of velocity is left out: MJCF has none");
  }
  if (is_free && is_bare) return;
  const bool is_ball = step.type == JointType::kSpherical;
  const bool is_slide = step.type == JointType::kPrismatic;
  set(node, "type", is_free ? "free" : is_ball ? "ball" : is_slide ? "slide" : "hinge");
  if (!is_free && !same(chain.anchors[i], Vec3<double>::zero())) set(node, "pos", chain.anchors[i]);
  if (!is_free && !is_ball) {
    set(node, "axis", chain.axes[i]);
    set_unless(node, "ref", step.reference, 0);
    write_range(writer, node, step);
    write_effort(writer, node, step);
  }
  set_unless(node, "damping", joint.damping, 0);
  set_unless(node, "frictionloss", joint.friction, 0);
  set_unless(node, "armature", joint.armature, 0);
  set_unless(node, "stiffness", joint.stiffness, 0);
  if (joint.stiffness > 0 && !is_free && !is_ball) set_unless(node, "springref", step.spring_reference, 0);
}

}  // namespace manyhands::io
