// The inertia that joints meet where the file places the bodies, which MuJoCo's compiler turns ratios of damping with.
#pragma once

#include "manyhands/model/io/mjcf/mjcf_scene.h"

namespace manyhands::io {

/// For each joint of the scene: the inertia that its dofs meet at qpos0 while all other joints yield, their number by
/// the trace of their block of M^-1 [kg m^2 or kg]. MuJoCo's 1 / dof_invweight0.
[[nodiscard]] std::vector<double> yielding_inertias(const MjcfScene& scene);

}  // namespace manyhands::io
