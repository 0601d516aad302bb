// What motors, drives, dry friction and limits ask of each dof in a step: a set-valued force law at the velocity level.
//
// Below its target velocity a motor pushes with +F, above it with -F, at it with whatever is needed in between; at a
// position limit any impulse back inside is allowed. A drive (kp, kd) has a slope instead of the vertical part, and
// where its joint has dry friction, too, a vertical part at rest.
#pragma once

#include "manyhands/physics/contact/tendon_laws.h"
#include "manyhands/physics/dynamics/actuation.h"
#include "manyhands/physics/dynamics/drag.h"
#include "manyhands/physics/dynamics/gravity_compensation.h"
#include "manyhands/physics/dynamics/springs.h"

namespace manyhands {

namespace internal {

/// The actuators: a force joins the smooth impulse; a drive, implicit in the velocity v+ at the step's end, gives
/// h gear (pull - stiffness gear h v+ - damping gear v+) = slope (target - v+), limited by its force. Drives of one dof
/// add up; one that shares it is a force where the step begins beyond its own bounds. `target` becomes slope times it.
template <Number T, Number P>
MANYHANDS_INLINE void assemble_actuators(const Tree<real_t<T>>& tree, const Params<P>& params, real_t<T> h,
                                         const State<T>& state, const Workspace<T>& dynamics, JointLaws<T>& laws) {
  const T step(h), zero = constant<T>(0), most = constant<T>(contact_settings::kMaxImpulse);
  const std::size_t nv = index(tree.nv);
  for (std::size_t k = 0; k < tree.actuators.size(); ++k) {
    const TreeActuator<real_t<T>>& actuator = tree.actuators[k];
    const std::size_t i = actuator.law;
    const T bound = broadcast<T>(params.drive_max_force[k]), middle(actuator.middle_force);
    const T ctrl = command(tree, h, state, k);
    const auto push = [&](T force) {
      if (i < nv) {
        laws.smooth[i] = fma(step, force, laws.smooth[i]);
      } else {
        add_along_length(tree, dynamics, i - nv, step * force, laws.smooth.data());
      }
    };
    if (!is_drive(actuator.type)) {
      push(clamp(broadcast<T>(params.gear[k]) * ctrl, middle - bound, middle + bound));
      continue;
    }
    const T q = i < nv ? state.q()[actuator.q] : dynamics.length[actuator.q];
    const T v = i < nv ? state.v()[i] : dynamics.length_rate[actuator.q];
    const DriveLaw<T> law = drive_law(actuator, params, k, ctrl, q, v);
    const T slope = step * (law.gear * law.gear) * fma(step, law.stiffness, law.damping);
    auto drives = slope > zero;
    if (actuator.type == ActuatorType::kAffine || actuator.is_shared || actuator.middle_force != 0) {
      const T now = law.gear * fma(-law.damping, law.gear * v, law.pull);
      if (actuator.is_shared) drives = drives & (abs(now - middle) < bound);
      push(select(drives, middle, clamp(now, middle - bound, middle + bound)));
    }
    laws.slope[i] += select(drives, slope, zero);
    laws.target[i] += select(drives, step * law.gear * law.pull - step * middle, zero);
    laws.max_impulse[i] += select(drives, min(step * bound, most), zero);
  }
}

/// The springs, with the force in the middle of the change of velocity: h k (reference - q - h dv / 4). Then q+ = q + h
/// v+ is the trapezoidal rule's: it gains and loses nothing, and is stable however stiff the spring is. One so stiff
/// that a step would turn its oscillator by more than a right angle, h^2 k > 4 M, is met by h^2 k / 2: half a turn a
/// step, without end, would take q ever farther.
template <Number T, Number P>
MANYHANDS_INLINE void assemble_springs(const Tree<real_t<T>>& tree, const Params<P>& params, real_t<T> h,
                                       const State<T>& state, Workspace<T>& dynamics, JointLaws<T>& laws) {
  const T step(h), quarter(real_t<T>(0.25) * h * h), half(real_t<T>(0.5) * h * h);
  visit_springs<T>(tree, params, state.q(), [&](std::size_t i, T stiffness, T stretch) {
    const auto acts = stiffness > constant<T>(0);
    laws.smooth[i] = select(acts, fma(-step * stiffness, stretch, laws.smooth[i]), laws.smooth[i]);
    T& inertia = tree_row(tree, dynamics.M.data(), i)[i];
    inertia = max(fma(quarter, stiffness, inertia), half * stiffness);
  });
}

/// Limits, and where the motor, the drive or dry friction would have the dof. `free_dv`: what it gains without them.
template <Number T, Number P>
MANYHANDS_INLINE void assemble_targets(const Tree<real_t<T>>& tree, const Params<P>& params, T inverse_h,
                                       const State<T>& state, std::size_t i, T free_dv, JointLaws<T>& laws) {
  const T zero = constant<T>(0), one = constant<T>(1), infinity = constant<T>(std::numeric_limits<double>::infinity());
  const T v = state.v()[i], kd = broadcast<T>(params.motor_kd[i]), F = laws.max_impulse[i];
  const auto motor = broadcast<T>(params.motor_max_force[i]) > zero;
  T wanted = fma(kd, state.target_v()[i], select(kd == one, zero, (one - kd) * (v + free_dv)));
  laws.lower[i] = -infinity;
  laws.upper[i] = infinity;
  if (tree.dof_q[i] >= 0) {
    const T q = state.q()[index(tree.dof_q[i])];
    const T lower = broadcast<T>(params.lower[i]), upper = broadcast<T>(params.upper[i]);
    const T goal = tree.dof_limited[i] ? clamp(state.target_q()[i], lower, upper) : state.target_q()[i];
    wanted = fma(broadcast<T>(params.motor_kp[i]) * inverse_h, goal - q, wanted);
    if (tree.dof_stops[i]) {
      laws.lower[i] = limit_velocity(lower - q, inverse_h) - v;
      laws.upper[i] = -limit_velocity(q - upper, inverse_h) - v;
    }
  }
  if (tree.dof_drive[i] >= 0) {
    aim_drive(v, i, laws);
    return;
  }
  const T target = select(F > zero, select(motor, wanted, zero) - v, infinity);
  aim_at(target, i, laws);
}

}  // namespace internal

/// Fills the laws from the state, after bias_and_mass_matrix, and adds h damping + h^2 stiffness / 4 to M's diagonal:
/// damping and springs are implicit. So is what `yield()` adds to M and to the smooth impulse.
/// A motor wants v* = kp (target_q - q) / h + v' + kd (target_v - v'), where v' is the velocity that the step would
/// reach without constraints, and pushes with at most max_force (PyBullet's position and velocity control).
/// `free_change(dv)` writes M^-1 smooth (nv), and is called only where some kd is not 1.
template <Number T, Number P, class Yield, class FreeChange>
MANYHANDS_INLINE void assemble_joint_laws(const Tree<real_t<T>>& tree, const Params<P>& params, real_t<T> h,
                                          const State<T>& state, Workspace<T>& dynamics, std::vector<T>& free_dv,
                                          Yield&& yield, FreeChange&& free_change, JointLaws<T>& laws) {
  const T step(h), inverse_h(real_t<T>(1) / h), zero = constant<T>(0), one = constant<T>(1);
  mask_t<T> needs_free_velocity(false);
  for (std::size_t i = 0; i < index(tree.nv); ++i) {
    const T damping = broadcast<T>(params.damping[i]), max_force = broadcast<T>(params.motor_max_force[i]);
    laws.smooth[i] = step * (state.tau()[i] - dynamics.bias[i] - damping * state.v()[i]);
    T& inertia = tree_row(tree, dynamics.M.data(), i)[i];
    inertia = fma(step, damping, inertia);
    const T friction = broadcast<T>(params.friction[i]);
    laws.max_impulse[i] = step * select(max_force > zero, max_force, friction);
    if (tree.dof_drive[i] >= 0) internal::begin_drive(step * friction, i, laws);
    needs_free_velocity = needs_free_velocity | ((broadcast<T>(params.motor_kd[i]) != one) & (max_force > zero));
    laws.constrained[i] = zero;
    laws.last_impulse[i] = state.joint_impulse()[i];
    free_dv[i] = zero;
  }
  visit_gravity_compensation(tree, params, dynamics,
                             [&](std::size_t i, T force) { laws.smooth[i] = fma(step, force, laws.smooth[i]); });
  add_drag(tree, h, laws.smooth.data(), dynamics);
  internal::assemble_springs(tree, params, h, state, dynamics, laws);
  yield();
  if (!tree.lengths.empty()) {
    place_lengths(tree, state.q(), state.v(), dynamics);
    internal::assemble_tendon_forces(tree, params, h, dynamics, laws);
    internal::find_length_inertia(tree, dynamics);
    internal::begin_length_drives(tree, params, h, laws);
  }
  internal::assemble_actuators(tree, params, h, state, dynamics, laws);
  when(needs_free_velocity, [&] { free_change(free_dv); });
  for (std::size_t i = 0; i < index(tree.nv); ++i) {
    internal::assemble_targets(tree, params, inverse_h, state, i, free_dv[i], laws);
    const T last = state.active_set()[i], last_dv = state.dv()[i];
    laws.first_state[i] = tree.dof_drive[i] >= 0 ? internal::first_drive_state(last, last_dv, i, laws)
                                                 : internal::first_state(last, last_dv, i, laws);
  }
  internal::assemble_length_laws(tree, params, h, dynamics, laws);
}

}  // namespace manyhands
