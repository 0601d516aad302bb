// The Panda as panda-gym drives it: actions to motor targets, and what is observed of the hand.
#pragma once

#include "manyhands/kinematics/inverse_kinematics.h"
#include "manyhands/physics/step/step.h"

namespace manyhands {

enum class PandaControl {
  kEndEffector,  ///< action: displacement of the hand, 5 cm per unit
  kJoints,       ///< action: displacement of the arm's joints, 0.05 rad per unit
};

/// The arm on its base at (-0.6, 0, 0), the table's top at z = 0. Uniform: one for all worlds of a batch.
struct PandaRobot {
  explicit PandaRobot(PandaControl control);

  static constexpr int kArmJoints = 7;
  static constexpr int kJoints = 9;  ///< the arm's, then the two fingers'

  Model model;
  PandaControl control;
  FrameId hand;   ///< the grasp target between the finger tips
  IkChain chain;  ///< of the hand
  IkSettings ik;
};

[[nodiscard]] int action_size(PandaControl control);

/// The pose at which every episode starts: [rad] and [m].
inline constexpr std::array<double, PandaRobot::kJoints> kPandaNeutral{0, 0.41, 0, -1.85, 0, 2.26, 0.79, 0, 0};

/// The largest motor forces, as panda-gym has them: 120 N m in the wrist is more than the real arm's 12.
inline constexpr std::array<double, PandaRobot::kJoints> kPandaMaxForce{87, 87, 87, 87, 12, 120, 120, 170, 170};

/// The hand in the world, as far as tasks observe it.
template <Number T>
struct HandState {
  Vec3<T> p;  ///< position of the grasp target [m]
  Vec3<T> v;  ///< its velocity [m/s]
};

/// Gives every world's motors panda-gym's gains: a tenth of the error removed in each physics step, no overshoot.
template <Number T>
void set_panda_motors(Params<T>& params) {
  using R = real_t<T>;
  for (std::size_t i = 0; i < PandaRobot::kJoints; ++i) {
    params.motor_kp[i] = T(R(0.1));
    params.motor_kd[i] = T(R(1));
    params.motor_max_force[i] = T(static_cast<R>(kPandaMaxForce[i]));
  }
}

/// Puts one lane's arm at rest in the neutral pose, fingers closed.
template <Number T>
void reset_panda(State<T>& state, int lane) {
  using R = real_t<T>;
  for (T& number : state.numbers()) set_lane(number, lane, R(0));
  for (std::size_t i = 0; i < PandaRobot::kJoints; ++i) {
    set_lane(state.q()[i], lane, static_cast<R>(kPandaNeutral[i]));
    set_lane(state.target_q()[i], lane, static_cast<R>(kPandaNeutral[i]));
  }
}

/// The hand at the state's present q and v.
template <Number T>
MANYHANDS_INLINE HandState<T> observe_hand(const PandaRobot& robot, const Tree<real_t<T>>& tree, const State<T>& state,
                                           Workspace<T>& ws) {
  for (const std::size_t b : robot.chain.bodies) {
    place(tree, b, state.q(), ws);
    move(tree, b, state.v(), ws);
  }
  const std::size_t b = robot.chain.body.index();
  const Vec3<T> p_OF = ws.R_WB[b] * broadcast<T>(broadcast<real_t<T>>(robot.chain.X_BF.p)) + ws.p_OB[b];
  return {p_OF + ws.p_WO[b], at_point(ws.V[b], p_OF).v};
}

/// Sets the motor targets from an action (action_size), clipped to [-1, 1]; the gripper stays closed.
/// The hand keeps pointing straight down and never aims below the table. `hand` is observe_hand of the same state.
template <Number T, Number P>
MANYHANDS_INLINE void apply_panda_action(const PandaRobot& robot, const Tree<real_t<T>>& tree, const Params<P>& params,
                                         const HandState<T>& hand, const T* action, State<T>& state, Workspace<T>& ws) {
  using R = real_t<T>;
  const T zero(R(0)), one(R(1)), scale(R(0.05));
  const auto clipped = [&](std::size_t i) { return clamp(action[i], -one, one); };
  T* target = state.target_q();
  if (robot.control == PandaControl::kJoints) {
    for (std::size_t i = 0; i < PandaRobot::kArmJoints; ++i) target[i] = fma(scale, clipped(i), state.q()[i]);
  } else {
    Transform<T> goal;
    goal.R = {{one, zero, zero}, {zero, -one, zero}, {zero, zero, -one}};
    goal.p = fma(scale, Vec3<T>{clipped(0), clipped(1), clipped(2)}, hand.p);
    goal.p.z = max(goal.p.z, zero);
    for (std::size_t i = 0; i < PandaRobot::kJoints; ++i) target[i] = state.q()[i];
    improve_ik(tree, params, robot.chain, robot.ik, goal, target, ws);
  }
  for (std::size_t i = PandaRobot::kArmJoints; i < PandaRobot::kJoints; ++i) target[i] = zero;
}

}  // namespace manyhands
