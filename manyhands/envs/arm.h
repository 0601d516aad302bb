// An arm with a gripper in a scene, where its episodes start, and what is observed of its hand.
#pragma once

#include "manyhands/envs/arm_spec.h"
#include "manyhands/kinematics/inverse_kinematics.h"
#include "manyhands/physics/step/step.h"

namespace manyhands {

/// A joint that mimics others.
struct Follower {
  std::size_t dof;  ///< the same in q and v
  double neutral;   ///< where it is in the neutral pose [rad or m]
};

/// The arm in a scene of which it is the first part. Uniform: one for all worlds of a batch.
struct Arm {
  /// Throws std::invalid_argument on a name that the scene lacks, on joints or numbers that do not fit the arm.
  Arm(const ArmSpec& spec, const Model& scene, ArmControl control, bool has_gripper, const Impedance& impedance = {});

  static constexpr std::size_t kMostActions = 16;

  ArmControl control;
  Impedance impedance;
  bool has_gripper;                          ///< else the fingers stay closed
  std::vector<std::size_t> joints, fingers;  ///< their dofs, the same in q and v
  std::vector<double> neutral, max_force;    ///< of `joints`, then of `fingers`
  std::vector<double> closed, opening;       ///< of `fingers`: the hand opens by opening (q - closed) of each [m]
  std::vector<double> per_width;             ///< of `fingers`: by how much each moves as the hand opens by 1 m
  std::vector<Follower> followers;
  FrameId hand;
  IkChain chain;  ///< of the hand
  IkSettings ik;  ///< of controls that move the hand

  /// The dof of the i-th joint, fingers last.
  [[nodiscard]] std::size_t dof(std::size_t i) const {
    return i < joints.size() ? joints[i] : fingers[i - joints.size()];
  }
};

/// panda-gym's inverse kinematics: 20 steps so heavily damped that they fall short, without regard to limits. It is
/// part of what an action of end-effector control means, so it is kept.
[[nodiscard]] IkSettings panda_gym_ik();

/// The hand in the world, as far as tasks observe it.
template <Number T>
struct HandState {
  Vec3<T> p;     ///< position of the grasp target [m]
  Vec3<T> v;     ///< its velocity [m/s]
  T open_width;  ///< of the fingers [m]
};

/// Puts one lane at rest, as new, its arm in the neutral pose.
template <Number T>
void reset_arm(const Arm& arm, State<T>& state, int lane) {
  using R = real_t<T>;
  for (T& number : state.numbers()) set_lane(number, lane, R(0));
  for (std::size_t i = 0; i < arm.neutral.size(); ++i) {
    set_lane(state.q()[arm.dof(i)], lane, static_cast<R>(arm.neutral[i]));
    set_lane(state.target_q()[arm.dof(i)], lane, static_cast<R>(arm.neutral[i]));
  }
  for (const Follower& joint : arm.followers) set_lane(state.q()[joint.dof], lane, static_cast<R>(joint.neutral));
}

/// The hand from its tree's origin, in world axes, where its body has been placed.
template <Number T>
MANYHANDS_INLINE Vec3<T> hand_in_tree(const Arm& arm, const Workspace<T>& ws) {
  const std::size_t b = arm.chain.body.index();
  return ws.R_WB[b] * broadcast<T>(broadcast<real_t<T>>(arm.chain.X_BF.p)) + ws.p_OB[b];
}

/// The hand at the state's present q and v.
template <Number T>
MANYHANDS_INLINE HandState<T> observe_hand(const Arm& arm, const Tree<real_t<T>>& tree, const State<T>& state,
                                           Workspace<T>& ws) {
  for (const std::size_t b : arm.chain.bodies) {
    place(tree, b, state.q(), ws);
    move(tree, b, state.v(), ws);
  }
  const std::size_t b = arm.chain.body.index();
  const Vec3<T> p_OF = hand_in_tree(arm, ws);
  T width(real_t<T>(0));
  for (std::size_t i = 0; i < arm.fingers.size(); ++i) {
    const T opened = state.q()[arm.fingers[i]] - T(static_cast<real_t<T>>(arm.closed[i]));
    width = fma(T(static_cast<real_t<T>>(arm.opening[i])), opened, width);
  }
  return {p_OF + ws.p_WO[b], at_point(ws.V[b], p_OF).v, width};
}

}  // namespace manyhands
