// Cartesian impedance (control/impedance.h): where the goal is to which spring and damper pull the hand.
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

}  // namespace manyhands::internal
