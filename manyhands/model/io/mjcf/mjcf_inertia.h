// The inertia that joints meet where the file places the bodies, of which MuJoCo's compiler takes ratios of damping.
#pragma once

#include "manyhands/model/io/mjcf/mjcf_scene.h"

namespace manyhands::io {

/// For each joint of the scene: the inertia that its dofs meet at qpos0 while all other joints yield, the number of
/// dofs over the trace of their block of M^-1 [kg m^2 or kg]; MuJoCo's 1 / dof_invweight0. By articulated inertias
/// inwards and compliances outwards (Rodriguez, Jain and Kreutz-Delgado 1992, operator factorisation of M^-1).
[[nodiscard]] std::vector<double> yielding_inertias(const MjcfScene& scene);

}  // namespace manyhands::io
