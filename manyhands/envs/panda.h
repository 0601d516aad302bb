// The Franka Panda as panda-gym sets it up.
#pragma once

#include "manyhands/envs/scene.h"

namespace manyhands {

/// On its base at (-0.6, 0, 0), fingers closed in the neutral pose. Motor forces are panda-gym's: 120 N m in the wrist
/// is more than the real arm's 12, and 170 N in a finger more than its 20.
[[nodiscard]] ArmSpec panda_arm();

/// The arm alone, without a table, its fingers closed.
struct LonePanda {
  Model model = load_arm(panda_arm());
  Arm arm{panda_arm(), model, ArmControl::kEndEffector, false};
};

}  // namespace manyhands
