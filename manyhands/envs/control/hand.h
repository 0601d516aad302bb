// Controls that move the hand: where an action wants it, and the joints that bring it there.
#pragma once

#include "manyhands/envs/arm.h"

namespace manyhands::internal {

/// Three numbers of an action, clipped to [-1, 1].
template <Number T>
MANYHANDS_INLINE Vec3<T> clipped3(const T* action) {
  const T one(real_t<T>(1));
  return {clamp(action[0], -one, one), clamp(action[1], -one, one), clamp(action[2], -one, one)};
}

/// The hand's z axis down, its x axis ahead.
template <Number T>
MANYHANDS_INLINE Mat3<T> pointing_down() {
  const T zero(real_t<T>(0)), one(real_t<T>(1));
  return {{one, zero, zero}, {zero, -one, zero}, {zero, zero, -one}};
}

/// 5 cm per unit from p, never below the table.
template <Number T>
MANYHANDS_INLINE Vec3<T> displaced(const Vec3<T>& p, const T* action) {
  Vec3<T> goal = fma(T(real_t<T>(0.05)), clipped3(action), p);
  goal.z = max(goal.z, T(real_t<T>(0)));
  return goal;
}

/// How far one action turns the hand, or a joint, at most [rad].
inline constexpr double kMostTurn = 0.2;

/// Pointing down, turned by a rotation vector about the world's axes, 90 degrees per unit; or on the way there from R.
template <Number T>
MANYHANDS_INLINE Mat3<T> turned(const Mat3<T>& R_WF, const T* action) {
  using R = real_t<T>;
  const T quarter(static_cast<R>(std::numbers::pi / 2)), most(static_cast<R>(kMostTurn)), one(R(1));
  const Mat3<T> goal = to_matrix(quat_from_rotation_vector(quarter * clipped3(action))) * pointing_down<T>();
  const Vec3<T> turn = rotation_vector(to_quat(goal * transpose(R_WF)));
  const T share = min(most / max(norm(turn), most), one);
  return to_matrix(quat_from_rotation_vector(share * turn)) * R_WF;
}

/// Moves the joints of `target` towards the pose that the action asks of a hand at X_WF.
template <Number T, Number P>
void aim_hand(const Arm& arm, const Tree<real_t<T>>& tree, const Params<P>& params, const Transform<T>& X_WF,
              const T* action, T* target, Workspace<T>& ws) {
  const T most(static_cast<real_t<T>>(kMostTurn));
  std::array<T, Arm::kMostActions> start{};
  for (std::size_t k = 0; k < arm.joints.size(); ++k) start[k] = target[arm.joints[k]];
  improve_ik(tree, params, arm.chain, arm.ik, {turned(X_WF.R, action + 3), displaced(X_WF.p, action)}, target, ws);
  for (std::size_t k = 0; k < arm.joints.size(); ++k) {
    T& q = target[arm.joints[k]];
    q = clamp(q, start[k] - most, start[k] + most);
  }
}

/// Control by displacement: panda-gym's.
template <Number T, Number P>
void move_hand(const Arm& arm, const Tree<real_t<T>>& tree, const Params<P>& params, const HandState<T>& hand,
               const T* action, State<T>& state, Workspace<T>& ws) {
  const Transform<T> goal{pointing_down<T>(), displaced(hand.p, action)};
  T* target = state.target_q();
  for (const std::size_t i : arm.joints) target[i] = state.q()[i];
  improve_ik(tree, params, arm.chain, arm.ik, goal, target, ws);
}

/// Control by pose. What is observed holds no orientation, so an action tells the whole of it, not a change.
template <Number T, Number P>
void pose_hand(const Arm& arm, const Tree<real_t<T>>& tree, const Params<P>& params, const T* action, State<T>& state,
               Workspace<T>& ws) {
  T* target = state.target_q();
  for (const std::size_t i : arm.joints) target[i] = state.q()[i];
  const Transform<T> X_WF = place_chain(tree, arm.chain, broadcast<real_t<T>>(arm.chain.X_BF), target, ws);
  aim_hand(arm, tree, params, X_WF, action, target, ws);
}

}  // namespace manyhands::internal
