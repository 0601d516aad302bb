#include "manyhands/envs/arm6.h"

#include "manyhands/base/assets.h"

namespace manyhands {

ArmSpec arm6() {
  ArmSpec spec;
  spec.urdf = asset_path("arm6/arm6.urdf");
  spec.X_WA.p = {-0.6, 0, 0};
  for (int i = 1; i <= 6; ++i) spec.joints.push_back("arm6_joint" + std::to_string(i));
  spec.fingers = {"arm6_finger_joint1", "arm6_finger_joint2"};
  spec.hand = "arm6_grasptarget";
  spec.neutral = {-0.209817, -1.198085, 1.524398, -1.89711, -1.570796, -0.209817, 0, 0};
  spec.max_force = {150, 150, 150, 28, 28, 28, 235, 235};
  spec.meshes = false;
  return spec;
}

}  // namespace manyhands
