#include "manyhands/envs/arm.h"

namespace manyhands {

namespace {

std::vector<std::size_t> dofs_of(const Model& scene, const std::vector<std::string>& names) {
  std::vector<std::size_t> dofs;
  for (const std::string& name : names) {
    const Body& body = scene.body(scene.link(scene.joint(scene.joint_id(name)).child).body);
    if (body.nq != 1 || body.iq != body.iv)
      throw ModelError("joint '" + name + "': an arm's joints must have one degree of freedom each, and come first");
    dofs.push_back(static_cast<std::size_t>(body.iv));
  }
  return dofs;
}

}  // namespace

Arm::Arm(const ArmSpec& spec, const Model& scene, ArmControl control_, bool has_gripper_)
    : control(control_),
      has_gripper(has_gripper_),
      joints(dofs_of(scene, spec.joints)),
      fingers(dofs_of(scene, spec.fingers)),
      neutral(spec.neutral),
      max_force(spec.max_force),
      tips(spec.tips),
      hand(scene.frame_id(spec.hand)),
      chain(scene, hand),
      ik(panda_gym_ik()) {
  const std::size_t count = joints.size() + fingers.size();
  if (neutral.size() != count || max_force.size() != count || joints.size() >= kMostActions)
    throw ModelError("an arm of " + std::to_string(count) + " joints has " + std::to_string(neutral.size()) +
                     " neutral positions and " + std::to_string(max_force.size()) + " largest forces");
}

IkSettings panda_gym_ik() {
  return {.max_iterations = 20,
          .damping = 0.5,
          .error_damping = 0,
          .position_tolerance = 1e-4,
          .rotation_tolerance = std::numeric_limits<double>::infinity(),
          .respect_limits = false};
}

int action_size(const Arm& arm) {
  const std::size_t moves = arm.control == ArmControl::kJoints ? arm.joints.size() : 3;
  return static_cast<int>(moves) + (arm.has_gripper ? 1 : 0);
}

}  // namespace manyhands
