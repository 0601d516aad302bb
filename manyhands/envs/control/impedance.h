// Cartesian impedance: a spring and a damper pull the hand to a goal, tau = J^T F + C v + g (Hogan, Impedance control,
// 1985; without shaping of the inertia). At rest the hand yields by F / stiffness to a force F.
#pragma once

#include "manyhands/envs/control/hand.h"

namespace manyhands::internal {

/// The goal is where the motors' targets would have the hand: it moves with actions only, not with the hand, so that a
/// hand that is pushed comes back; and it stays in reach.
template <Number T>
MANYHANDS_INLINE Transform<T> impedance_goal(const Arm& arm, const Tree<real_t<T>>& tree, const State<T>& state,
                                             Workspace<T>& ws) {
  return place_chain(tree, arm.chain, broadcast<real_t<T>>(arm.chain.X_BF), state.target_q(), ws);
}

/// Moves the goal as an action of control by pose moves the hand.
template <Number T, Number P>
void move_goal(const Arm& arm, const Tree<real_t<T>>& tree, const Params<P>& params, const T* action, State<T>& state,
               Workspace<T>& ws) {
  aim_hand(arm, tree, params, impedance_goal(arm, tree, state, ws), action, state.target_q(), ws);
}

/// What spring and damper do to the hand, at its origin in world axes; after `rnea` of the present state.
template <Number T>
MANYHANDS_INLINE Force<T> spring_force(const Arm& arm, const Transform<T>& goal, const Workspace<T>& ws) {
  using R = real_t<T>;
  const auto number = [](double x) { return T(static_cast<R>(x)); };
  const Transform<T> X_WF = frame_pose(arm.chain.body, broadcast<R>(arm.chain.X_BF), ws);
  const std::size_t b = arm.chain.body.index();
  const Motion<T> e = pose_error(goal, X_WF), V = at_point(ws.V[b], X_WF.p - ws.p_WO[b]);
  return {number(arm.impedance.rotational_stiffness) * e.w - number(arm.impedance.rotational_damping) * V.w,
          number(arm.impedance.stiffness) * e.v - number(arm.impedance.damping) * V.v};
}

/// tau += J^T F of the joints that move the hand.
template <Number T>
MANYHANDS_INLINE void add_hand_force(const Arm& arm, const Force<T>& F, const Workspace<T>& ws, T* tau) {
  const Vec3<T> p_OF = hand_in_tree(arm, ws);
  for (const std::size_t i : arm.chain.dofs) tau[i] += dot(at_point(ws.S[i], p_OF), F);
}

}  // namespace manyhands::internal
