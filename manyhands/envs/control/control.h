// How actions drive the arm: what they ask for, once in an environment step, and the forces of every physics step.
//
// Under ArmControl::kEndEffector, kJoints and kEndEffectorPose motors bring the joints to targets, panda-gym's: a tenth
// of the error is removed in each physics step, with no overshoot. Under kJointVelocity they hold velocities. Under
// kJointTorque and kImpedance the arm's motors are off: the joints get forces that hold the arm against gravity and
// Coriolis forces (not what the hand carries), and what the action asks for beyond, at most the motors' largest in all;
// their velocity is damped by 1 N m s/rad. Fingers are moved by motors always.
#pragma once

#include "manyhands/control/pid.h"
#include "manyhands/envs/control/impedance.h"
#include "manyhands/physics/dynamics/rnea.h"

namespace manyhands {

namespace internal {

/// Whether joints are driven by forces that follow the state.
[[nodiscard]] inline bool drives_by_force(const Arm& arm) {
  return arm.control == ArmControl::kJointTorque || arm.control == ArmControl::kImpedance;
}

}  // namespace internal

/// The numbers of an action: those of the control, and one for the gripper.
[[nodiscard]] int action_size(const Arm& arm);

/// Gives every world's motors the gains of the control.
template <Number T>
void set_arm_motors(const Arm& arm, Params<T>& params) {
  using R = real_t<T>;
  for (std::size_t i = 0; i < arm.max_force.size(); ++i) {
    const std::size_t dof = arm.dof(i);
    const bool is_finger = i >= arm.joints.size(), to_position = is_finger || arm.control != ArmControl::kJointVelocity;
    const bool off = !is_finger && internal::drives_by_force(arm);
    params.motor_kp[dof] = T(R(to_position ? 0.1 : 0));
    params.motor_kd[dof] = T(R(1));
    params.motor_max_force[dof] = T(static_cast<R>(off ? 0 : arm.max_force[i]));
    if (off) params.damping[dof] += T(R(1));
  }
}

/// Takes an action (action_size), clipped to [-1, 1]: sets motor targets. `hand` is observe_hand of the same state.
template <Number T, Number P>
void apply_action(const Arm& arm, const Tree<real_t<T>>& tree, const Params<P>& params, const HandState<T>& hand,
                  const T* action, State<T>& state, Workspace<T>& ws) {
  using R = real_t<T>;
  const T zero(R(0)), one(R(1)), opening(R(0.2));
  const auto clipped = [&](std::size_t i) { return clamp(action[i], -one, one); };
  switch (arm.control) {
    case ArmControl::kEndEffector:
      internal::move_hand(arm, tree, params, hand, action, state, ws);
      break;
    case ArmControl::kEndEffectorPose:
      internal::pose_hand(arm, tree, params, action, state, ws);
      break;
    case ArmControl::kImpedance:
      internal::move_goal(arm, tree, params, action, state, ws);
      break;
    case ArmControl::kJoints:
      for (std::size_t i = 0; i < arm.joints.size(); ++i)
        state.target_q()[arm.joints[i]] = fma(T(R(0.05)), clipped(i), state.q()[arm.joints[i]]);
      break;
    case ArmControl::kJointVelocity:
      for (std::size_t i = 0; i < arm.joints.size(); ++i) state.target_v()[arm.joints[i]] = clipped(i);
      break;
    case ArmControl::kJointTorque:
      break;
  }
  const auto grip = static_cast<std::size_t>(action_size(arm)) - 1;
  const T width = arm.has_gripper ? fma(opening, clipped(grip), hand.open_width) : zero;
  for (std::size_t i = 0; i < arm.fingers.size(); ++i) {
    const T per_width(static_cast<R>(arm.per_width[i])), closed(static_cast<R>(arm.closed[i]));
    state.target_q()[arm.fingers[i]] = fma(per_width, width, closed);
  }
}

/// Before a physics step: sets the forces of controls that drive by force, from the action and the present state.
template <Number T, Number P>
void drive_arm(const Arm& arm, const Tree<real_t<T>>& tree, const Params<P>& params, const T* action, State<T>& state,
               Workspace<T>& ws) {
  using R = real_t<T>;
  if (!internal::drives_by_force(arm)) return;
  const T zero(R(0)), one(R(1));
  Transform<T> goal = Transform<T>::identity();
  if (arm.control == ArmControl::kImpedance) goal = internal::impedance_goal(arm, tree, state, ws);
  for (T& a : ws.u) a = zero;
  rnea(tree, params, state.q(), state.v(), ws.u.data(), ws.bias.data(), ws);
  T* tau = state.tau();
  for (const std::size_t i : arm.joints) tau[i] = ws.bias[i];
  if (arm.control == ArmControl::kImpedance) {
    const Transform<T> X_WF = frame_pose(arm.chain.body, broadcast<R>(arm.chain.X_BF), ws);
    const std::size_t b = arm.chain.body.index();
    const Motion<T> V = at_point(ws.V[b], X_WF.p - ws.p_WO[b]);
    add_frame_force(arm.chain.dofs, hand_in_tree(arm, ws), impedance_force(arm.impedance, goal, X_WF, V), ws, tau);
  }
  for (std::size_t k = 0; k < arm.joints.size(); ++k) {
    const T most(static_cast<R>(arm.max_force[k])), unit(static_cast<R>(0.1 * arm.max_force[k]));
    T& force = tau[arm.joints[k]];
    if (arm.control == ArmControl::kJointTorque) force = fma(unit, clamp(action[k], -one, one), force);
    force = limited(force, most);
  }
}

// Compiled once for each number type, with parameters of its own for every world or the same for all.
#define MANYHANDS_CONTROL(prefix, T, P)                                                                              \
  prefix template void apply_action<T, P>(const Arm&, const Tree<real_t<T>>&, const Params<P>&, const HandState<T>&, \
                                          const T*, State<T>&, Workspace<T>&);                                       \
  prefix template void drive_arm<T, P>(const Arm&, const Tree<real_t<T>>&, const Params<P>&, const T*, State<T>&,    \
                                       Workspace<T>&);
MANYHANDS_CONTROL(extern, float, float)
MANYHANDS_FOR_ALL_LANES(MANYHANDS_CONTROL, extern)

}  // namespace manyhands
