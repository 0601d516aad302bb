#include "manyhands/envs/panda.h"

#include "manyhands/base/assets.h"

namespace manyhands {

ArmSpec panda_arm() {
  ArmSpec spec;
  spec.urdf = asset_path("panda/panda.urdf");
  spec.X_WA.p = {-0.6, 0, 0};
  for (int i = 1; i <= 7; ++i) spec.joints.push_back("panda_joint" + std::to_string(i));
  spec.fingers = {"panda_finger_joint1", "panda_finger_joint2"};
  spec.hand = "panda_grasptarget";
  spec.neutral = {0, 0.41, 0, -1.85, 0, 2.26, 0.79, 0, 0};
  spec.max_force = {87, 87, 87, 87, 12, 120, 120, 170, 170};
  spec.meshes = false;
  return spec;
}

}  // namespace manyhands
