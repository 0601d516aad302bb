// The project's own six-axis arm of the UR5e's class with a parallel gripper, in the tasks of the Panda.
#pragma once

#include "manyhands/envs/scene.h"

namespace manyhands {

/// On its base at (-0.6, 0, 0), elbow up, the grasp target of the neutral pose at (0.04, 0, 0.2), pointing down,
/// fingers closed. Motor forces are the ones in its URDF: those of the real arm, and 100 N in each finger.
[[nodiscard]] ArmSpec arm6();

}  // namespace manyhands
