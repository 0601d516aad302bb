#include "manyhands/envs/panda.h"

#include "manyhands/base/assets.h"
#include "manyhands/model/io/urdf.h"

namespace manyhands {

namespace {

Model load_panda() {
  UrdfOptions options;
  options.base_pose.p = {-0.6, 0, 0};
  options.load_meshes = false;
  return load_urdf(asset_path("panda/panda.urdf"), options).model;
}

/// panda-gym's inverse kinematics: 20 steps so heavily damped that they fall short, without regard to limits. It is
/// part of what an action means, so it is kept.
IkSettings panda_gym_ik() {
  return {.max_iterations = 20,
          .damping = 0.5,
          .error_damping = 0,
          .position_tolerance = 1e-4,
          .rotation_tolerance = std::numeric_limits<double>::infinity(),
          .respect_limits = false};
}

}  // namespace

PandaRobot::PandaRobot(PandaControl control_)
    : model(load_panda()),
      control(control_),
      hand(model.frame_id("panda_grasptarget")),
      chain(model, hand),
      ik(panda_gym_ik()) {}

int action_size(PandaControl control) { return control == PandaControl::kJoints ? PandaRobot::kArmJoints : 3; }

}  // namespace manyhands
