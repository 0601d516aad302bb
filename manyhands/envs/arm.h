// An arm with a gripper as tasks drive it: actions to motor targets, and what is observed of the hand.
#pragma once

#include <string>
#include <vector>

#include "manyhands/kinematics/inverse_kinematics.h"
#include "manyhands/physics/step/step.h"

namespace manyhands {

enum class ArmControl {
  kEndEffector,  ///< action: displacement of the hand, 5 cm per unit
  kJoints,       ///< action: displacement of the arm's joints, 0.05 rad per unit
};

/// What tasks must know of an arm besides its URDF. Its joints are named in the order of actions, fingers last.
struct ArmSpec {
  std::string asset;  ///< the URDF, in the assets
  Transform<double> X_WA = Transform<double>::identity();
  std::vector<std::string> joints, fingers;
  std::string hand;               ///< the frame between the finger tips, z away from the hand
  double tips = 0;                ///< how far the finger tips reach beyond it [m]
  std::vector<double> neutral;    ///< where every episode starts [rad or m]
  std::vector<double> max_force;  ///< of the motors [N m or N]
};

/// The arm in a scene of which it is the first part. Uniform: one for all worlds of a batch.
struct Arm {
  /// Throws std::out_of_range on a name that the scene lacks, ModelError on joints of several degrees of freedom.
  Arm(const ArmSpec& spec, const Model& scene, ArmControl control, bool has_gripper);

  static constexpr std::size_t kMostActions = 16;

  ArmControl control;
  bool has_gripper;                          ///< else the fingers stay closed
  std::vector<std::size_t> joints, fingers;  ///< their dofs, the same in q and v
  std::vector<double> neutral, max_force;    ///< of `joints`, then of `fingers`
  double tips;                               ///< how far they reach beyond the hand's frame [m]
  FrameId hand;
  IkChain chain;  ///< of the hand
  IkSettings ik;

  /// The dof of the i-th joint, fingers last.
  [[nodiscard]] std::size_t dof(std::size_t i) const {
    return i < joints.size() ? joints[i] : fingers[i - joints.size()];
  }
};

[[nodiscard]] int action_size(const Arm& arm);

/// panda-gym's inverse kinematics: 20 steps so heavily damped that they fall short, without regard to limits. It is
/// part of what an action means, so it is kept.
[[nodiscard]] IkSettings panda_gym_ik();

/// The hand in the world, as far as tasks observe it.
template <Number T>
struct HandState {
  Vec3<T> p;     ///< position of the grasp target [m]
  Vec3<T> v;     ///< its velocity [m/s]
  T open_width;  ///< of the fingers [m]
};

/// Gives every world's motors panda-gym's gains: a tenth of the error removed in each physics step, no overshoot.
template <Number T>
void set_arm_motors(const Arm& arm, Params<T>& params) {
  using R = real_t<T>;
  for (std::size_t i = 0; i < arm.max_force.size(); ++i) {
    params.motor_kp[arm.dof(i)] = T(R(0.1));
    params.motor_kd[arm.dof(i)] = T(R(1));
    params.motor_max_force[arm.dof(i)] = T(static_cast<R>(arm.max_force[i]));
  }
}

/// Puts one lane at rest, as new, its arm in the neutral pose.
template <Number T>
void reset_arm(const Arm& arm, State<T>& state, int lane) {
  using R = real_t<T>;
  for (T& number : state.numbers()) set_lane(number, lane, R(0));
  for (std::size_t i = 0; i < arm.neutral.size(); ++i) {
    set_lane(state.q()[arm.dof(i)], lane, static_cast<R>(arm.neutral[i]));
    set_lane(state.target_q()[arm.dof(i)], lane, static_cast<R>(arm.neutral[i]));
  }
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
  const Vec3<T> p_OF = ws.R_WB[b] * broadcast<T>(broadcast<real_t<T>>(arm.chain.X_BF.p)) + ws.p_OB[b];
  T width(real_t<T>(0));
  for (const std::size_t finger : arm.fingers) width += state.q()[finger];
  return {p_OF + ws.p_WO[b], at_point(ws.V[b], p_OF).v, width};
}

/// Sets the motor targets from an action (action_size), clipped to [-1, 1]. The hand keeps pointing straight down and
/// never aims below the table; the gripper opens by 20 cm per unit. `hand` is observe_hand of the same state.
template <Number T, Number P>
MANYHANDS_INLINE void apply_action(const Arm& arm, const Tree<real_t<T>>& tree, const Params<P>& params,
                                   const HandState<T>& hand, const T* action, State<T>& state, Workspace<T>& ws) {
  using R = real_t<T>;
  const T zero(R(0)), one(R(1)), scale(R(0.05)), opening(R(0.2));
  const auto clipped = [&](std::size_t i) { return clamp(action[i], -one, one); };
  T* target = state.target_q();
  std::size_t used = 3;
  if (arm.control == ArmControl::kJoints) {
    used = arm.joints.size();
    for (std::size_t i = 0; i < used; ++i) target[arm.joints[i]] = fma(scale, clipped(i), state.q()[arm.joints[i]]);
  } else {
    Transform<T> goal;
    goal.R = {{one, zero, zero}, {zero, -one, zero}, {zero, zero, -one}};
    goal.p = fma(scale, Vec3<T>{clipped(0), clipped(1), clipped(2)}, hand.p);
    goal.p.z = max(goal.p.z, zero);
    for (const std::size_t i : arm.joints) target[i] = state.q()[i];
    improve_ik(tree, params, arm.chain, arm.ik, goal, target, ws);
  }
  const T share(R(1) / static_cast<R>(arm.fingers.size()));
  const T finger = arm.has_gripper ? share * fma(opening, clipped(used), hand.open_width) : zero;
  for (const std::size_t i : arm.fingers) target[i] = finger;
}

}  // namespace manyhands
