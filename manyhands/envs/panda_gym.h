// panda-gym's laws for a world that people build themselves: the air's drag and the inverse kinematics of its actions.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "manyhands/kinematics/inverse_kinematics.h"
#include "manyhands/physics/world/world.h"

namespace manyhands {

/// Advances by n steps, in which the air slows the links as Bullet has it; see `apply_drag`. They must be free uniform
/// bodies whose frame is in their centre. Afterwards no force of `set_tau` acts on them.
/// Throws std::out_of_range on a link that is not there, std::invalid_argument on one that is not free.
void step_in_air(World& world, int n, std::span<const std::string> links);

/// The configuration (nq) to which panda-gym's inverse kinematics comes from `start` (nq) on the way to the frame's
/// pose X_WF: it falls short of it by design. Throws ModelError as IkChain does, except that a frame which no joint
/// moves leaves everything as it is.
[[nodiscard]] std::vector<double> approach(const Model& model, FrameId frame, const Transform<double>& X_WF,
                                           std::span<const double> start);

}  // namespace manyhands
