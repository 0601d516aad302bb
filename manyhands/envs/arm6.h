// The project's own six-axis arm of the UR5e's class with a parallel gripper, in the tasks of the Panda.
#pragma once

#include "manyhands/envs/scene.h"

namespace manyhands {

/// On its base at (-0.6, 0, 0), elbow up, the grasp target of the neutral pose at (0.04, 0, 0.2), pointing down,
/// fingers closed. Motor forces are those in its URDF: the real arm's, and 235 N in each finger. With them the Panda's
/// experts reach, pick and stack as well as the Panda; for pressing on a cube, as those of Push and Flip do, 28 N m in
/// the wrists are few: of 200 episodes they solve 149 and 158, and that of Slide 166.
[[nodiscard]] ArmSpec arm6();

}  // namespace manyhands
