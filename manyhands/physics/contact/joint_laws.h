// What motors, drives, dry friction and limits ask of each dof in a step: a set-valued force law at the velocity level.
//
// Below its target velocity a motor pushes with +F, above it with -F, at it with whatever is needed in between; at a
// position limit any impulse back inside is allowed. A drive (kp, kd) has a slope instead of the vertical part, and
// where its joint has dry friction, too, a vertical part at rest.
#pragma once

#include "manyhands/math/control_flow.h"
#include "manyhands/physics/contact/settings.h"
#include "manyhands/physics/dynamics/gravity_compensation.h"
#include "manyhands/physics/dynamics/ltdl.h"
#include "manyhands/physics/dynamics/springs.h"
#include "manyhands/physics/dynamics/state.h"
#include "manyhands/physics/dynamics/workspace.h"

namespace manyhands {

/// Where on its law a dof is: its constraint state, one entry of the active set. A number, so that it varies by lane.
struct JointConstraintState {
  static constexpr double kAtTarget = 0, kSaturatedUp = 1, kSaturatedDown = -1, kAtLower = 2, kAtUpper = -2;
  /// Of a drive with dry friction: at rest, or the drive's state with this added where friction pushes up, taken off
  /// where it pushes down.
  static constexpr double kStuck = 3, kRubs = 8;
};

/// The laws of all dofs (nv each). Velocities are changes over the step, forces are impulses.
template <Number T>
struct JointLaws {
  explicit JointLaws(int nv)
      : smooth(index(nv)),
        max_impulse(smooth),
        slope(smooth.size(), constant<T>(0)),
        friction(slope),
        stop(smooth),
        target(smooth),
        lower(smooth),
        upper(smooth),
        min_held(smooth),
        max_held(smooth),
        constrained(smooth),
        last_impulse(smooth),
        first_state(smooth) {}

  std::vector<T> smooth;              ///< h (tau - bias + passive forces): the impulse that acts without constraints
  std::vector<T> max_impulse;         ///< F = h max_force
  std::vector<T> slope;               ///< of a drive: impulse = slope (target - dv); 0 where the law is vertical
  std::vector<T> friction;            ///< h times the dry friction beside a drive; without one it is max_impulse
  std::vector<T> stop;                ///< of a drive: dv that brings the dof to rest
  std::vector<T> target;              ///< dv that brings the dof to its motor's velocity, kept within the limits
  std::vector<T> lower, upper;        ///< dv that brings the dof just to a position limit by the step's end
  std::vector<T> min_held, max_held;  ///< the impulses that can hold the dof at `target`
  std::vector<T> constrained;         ///< 1 where contacts or equality constraints act on the dof's tree, else 0
  std::vector<T> last_impulse;        ///< of the last step: the multiplier about which a held dof yields
  std::vector<T> first_state;         ///< where the search for the states begins
};

/// The dv at which a dof in the given state, neither saturated, is held.
template <Number T>
MANYHANDS_INLINE T held_change(T state, std::size_t i, const JointLaws<T>& laws) {
  const T zero = constant<T>(0);
  return select(state == zero, laws.target[i], select(state > zero, laws.lower[i], laws.upper[i]));
}

/// Where a drive is on its own law, and which way the joint's dry friction pushes: 1 up, -1 down, else 0.
template <Number T>
struct DriveState {
  T place, push;
};

template <Number T>
MANYHANDS_INLINE DriveState<T> drive_state(T state) {
  const T zero = constant<T>(0), one = constant<T>(1), rubs = constant<T>(JointConstraintState::kRubs);
  const T push = select(state > T(0.5) * rubs, one, select(state < T(-0.5) * rubs, -one, zero));
  return {fma(-push, rubs, state), push};
}

/// The piece of a dof's law that its state names.
template <Number T>
struct LawPiece {
  mask_t<T> saturated;  ///< the impulse is prescribed
  mask_t<T> sloped;     ///< a drive's slope through (held_dv, impulse)
  T impulse;
  T held_dv;  ///< at which a dof that is not saturated is held
};

template <Number T>
MANYHANDS_INLINE LawPiece<T> law_piece(bool is_drive, T state, std::size_t i, const JointLaws<T>& laws) {
  const T zero = constant<T>(0), one = constant<T>(1), F = laws.max_impulse[i];
  if (!is_drive) return {abs(state) == one, mask_t<T>(false), state * F, held_change(state, i, laws)};
  const DriveState<T> s = drive_state(state);
  const auto stuck = s.place == constant<T>(JointConstraintState::kStuck);
  return {abs(s.place) == one, s.place == zero, fma(s.place, F, s.push * laws.friction[i]),
          select(stuck, laws.stop[i], held_change(s.place, i, laws))};
}

/// How fast dof i, whose velocity is v, shall return from beyond its limits; not above 0 where it is within them.
template <Number T>
MANYHANDS_INLINE T return_speed(T v, std::size_t i, const JointLaws<T>& laws) {
  return max(v + laws.lower[i], -(v + laws.upper[i]));
}

namespace internal {

/// dv that brings the dof from `gap` outside (> 0) or inside (< 0) its limit to the limit, or part of the way.
template <Number T>
MANYHANDS_INLINE T limit_velocity(T gap, T inverse_h) {
  const T fastest = constant<T>(contact_settings::kMaxClosing);
  const T back = min(constant<T>(contact_settings::kLimitRecovery) * (gap * inverse_h), fastest);
  return select(gap > constant<T>(0), back, gap * inverse_h);
}

/// The actuators: a force joins the smooth impulse; a drive, implicit in the velocity v+ at the step's end, gives
/// h gear (kp (ctrl - gear (q + h v+)) - kd gear v+) = slope (target - v+), limited by its force. Drives of one dof add
/// up. `target` becomes slope times it.
template <Number T, Number P>
MANYHANDS_INLINE void assemble_actuators(const Tree<real_t<T>>& tree, const Params<P>& params, real_t<T> h,
                                         const State<T>& state, JointLaws<T>& laws) {
  const T step(h), zero = constant<T>(0), most = constant<T>(contact_settings::kMaxImpulse);
  for (std::size_t k = 0; k < tree.actuators.size(); ++k) {
    const TreeActuator& actuator = tree.actuators[k];
    const std::size_t i = actuator.dof;
    const T gear = broadcast<T>(params.gear[k]), kp = broadcast<T>(params.drive_kp[k]);
    const T kd = broadcast<T>(params.drive_kd[k]), force = broadcast<T>(params.drive_max_force[k]);
    const T ctrl = state.ctrl()[k];
    if (actuator.type == ActuatorType::kForce) {
      laws.smooth[i] = fma(step, clamp(gear * ctrl, -force, force), laws.smooth[i]);
      continue;
    }
    const bool position = actuator.type == ActuatorType::kPosition;
    const T pull = position ? kp * (ctrl - gear * state.q()[actuator.q]) : kd * ctrl;
    const T slope = step * (gear * gear) * fma(step, kp, kd);
    const auto drives = slope > zero;
    laws.slope[i] += slope;
    laws.target[i] += select(drives, step * gear * pull, zero);
    laws.max_impulse[i] += select(drives, min(step * force, most), zero);
  }
}

/// The springs, with the force in the middle of the change of velocity: h k (reference - q - h dv / 4). Then q+ = q + h
/// v+ is the trapezoidal rule's: it gains and loses nothing, and is stable however stiff the spring is.
template <Number T, Number P>
MANYHANDS_INLINE void assemble_springs(const Tree<real_t<T>>& tree, const Params<P>& params, real_t<T> h,
                                       const State<T>& state, Workspace<T>& dynamics, JointLaws<T>& laws) {
  const T step(h), quarter(real_t<T>(0.25) * h * h);
  visit_springs<T>(tree, params, state.q(), [&](std::size_t i, T stiffness, T stretch) {
    const auto acts = stiffness > constant<T>(0);
    laws.smooth[i] = select(acts, fma(-step * stiffness, stretch, laws.smooth[i]), laws.smooth[i]);
    T& inertia = tree_row(tree, dynamics.M.data(), i)[i];
    inertia = fma(quarter, stiffness, inertia);
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
    if (tree.dof_limited[i]) {
      laws.lower[i] = limit_velocity(lower - q, inverse_h) - v;
      laws.upper[i] = -limit_velocity(q - upper, inverse_h) - v;
    }
  }
  if (tree.dof_drive[i] >= 0) {
    const auto drives = laws.slope[i] > zero;
    laws.target[i] = select(drives, laws.target[i] / select(drives, laws.slope[i], one), zero) - v;
    laws.stop[i] = -v;
    return;
  }
  const T target = select(F > zero, select(motor, wanted, zero) - v, infinity);
  laws.target[i] = clamp(target, laws.lower[i], laws.upper[i]);
  laws.max_held[i] = select(target < laws.lower[i], infinity, F);
  laws.min_held[i] = select(target > laws.upper[i], -infinity, -F);
}

/// The state of the last step, but: a saturated motor arrives when a change like the last one would pass its target.
/// Without a motor the target is the upper limit, and may be infinite: the search must not begin where that holds or
/// comes next.
template <Number T>
MANYHANDS_INLINE T first_state(T last, T last_dv, std::size_t i, const JointLaws<T>& laws) {
  const T zero = constant<T>(0), one = constant<T>(1);
  const auto holds = laws.max_impulse[i] > zero;  // a motor, a drive, or dry friction
  const auto at_limit = (last == zero) & (laws.target[i] < constant<T>(std::numeric_limits<double>::infinity()));
  const auto arrives = (abs(last) == one) & (last * (last_dv - laws.target[i]) > zero);
  const T saturated = select((abs(last) <= one) & !at_limit, constant<T>(JointConstraintState::kSaturatedUp), last);
  return select(holds, select(arrives, constant<T>(JointConstraintState::kAtTarget), last), saturated);
}

/// The same of a drive. Where friction has just begun to act, it pushes against the motion.
template <Number T>
MANYHANDS_INLINE T first_drive_state(T last, T last_dv, std::size_t i, const JointLaws<T>& laws) {
  const T zero = constant<T>(0), rubs = constant<T>(JointConstraintState::kRubs);
  const T stuck = constant<T>(JointConstraintState::kStuck), target = constant<T>(JointConstraintState::kAtTarget);
  const DriveState<T> old = drive_state(last);
  const auto rested = old.place == stuck;
  const T place = first_state(select(rested, target, old.place), last_dv, i, laws);
  const T against = select(laws.stop[i] > zero, rubs, select(laws.stop[i] < zero, -rubs, zero));
  const T offset = select(old.push == zero, against, old.push * rubs);
  const auto rests = rested | (offset == zero), at_limit = abs(place) > constant<T>(1);
  const T rubbing = select(at_limit, place, select(rests, stuck, place + offset));
  return select(laws.friction[i] > zero, rubbing, place);
}

}  // namespace internal

/// Fills the laws from the state, after bias_and_mass_matrix, and adds h damping + h^2 stiffness / 4 to M's diagonal:
/// damping and springs are implicit.
/// A motor wants v* = kp (target_q - q) / h + v' + kd (target_v - v'), where v' is the velocity that the step would
/// reach without constraints, and pushes with at most max_force (PyBullet's position and velocity control).
/// `free_change(dv)` writes M^-1 smooth (nv), and is called only where some kd is not 1.
template <Number T, Number P, class FreeChange>
MANYHANDS_INLINE void assemble_joint_laws(const Tree<real_t<T>>& tree, const Params<P>& params, real_t<T> h,
                                          const State<T>& state, Workspace<T>& dynamics, std::vector<T>& free_dv,
                                          FreeChange&& free_change, JointLaws<T>& laws) {
  const T step(h), inverse_h(real_t<T>(1) / h), zero = constant<T>(0), one = constant<T>(1);
  mask_t<T> needs_free_velocity(false);
  for (std::size_t i = 0; i < index(tree.nv); ++i) {
    const T damping = broadcast<T>(params.damping[i]), max_force = broadcast<T>(params.motor_max_force[i]);
    laws.smooth[i] = step * (state.tau()[i] - dynamics.bias[i] - damping * state.v()[i]);
    T& inertia = tree_row(tree, dynamics.M.data(), i)[i];
    inertia = fma(step, damping, inertia);
    const T friction = broadcast<T>(params.friction[i]);
    laws.max_impulse[i] = step * select(max_force > zero, max_force, friction);
    if (tree.dof_drive[i] >= 0) {
      laws.friction[i] = min(step * friction, constant<T>(contact_settings::kMaxImpulse));
      laws.slope[i] = laws.target[i] = laws.max_impulse[i] = zero;
    }
    needs_free_velocity = needs_free_velocity | ((broadcast<T>(params.motor_kd[i]) != one) & (max_force > zero));
    laws.constrained[i] = zero;
    laws.last_impulse[i] = state.joint_impulse()[i];
    free_dv[i] = zero;
  }
  visit_gravity_compensation(tree, params, dynamics,
                             [&](std::size_t i, T force) { laws.smooth[i] = fma(step, force, laws.smooth[i]); });
  internal::assemble_springs(tree, params, h, state, dynamics, laws);
  internal::assemble_actuators(tree, params, h, state, laws);
  when(needs_free_velocity, [&] { free_change(free_dv); });
  for (std::size_t i = 0; i < index(tree.nv); ++i) {
    internal::assemble_targets(tree, params, inverse_h, state, i, free_dv[i], laws);
    const T last = state.active_set()[i], last_dv = state.dv()[i];
    laws.first_state[i] = tree.dof_drive[i] >= 0 ? internal::first_drive_state(last, last_dv, i, laws)
                                                 : internal::first_state(last, last_dv, i, laws);
  }
}

}  // namespace manyhands
