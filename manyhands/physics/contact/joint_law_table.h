// The set-valued force laws of all dofs and tendons, as numbers.
#pragma once

#include <limits>
#include <vector>

#include "manyhands/base/index.h"
#include "manyhands/math/control_flow.h"
#include "manyhands/physics/contact/settings.h"

namespace manyhands {

/// Where on its law a dof is: its constraint state, one entry of the active set. A number, so that it varies by lane.
struct JointConstraintState {
  static constexpr double kAtTarget = 0, kSaturatedUp = 1, kSaturatedDown = -1, kAtLower = 2, kAtUpper = -2;
  /// Of a drive with dry friction: at rest, or the drive's state with this added where friction pushes up, taken off
  /// where it pushes down.
  static constexpr double kStuck = 3, kRubs = 8;
};

/// The laws of all dofs (nv), and behind them those of all lengths, whose velocity is J v. Velocities are changes over
/// the step, forces are impulses.
template <Number T>
struct JointLaws {
  explicit JointLaws(int laws)
      : smooth(index(laws)),
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

  std::vector<T> smooth;        ///< h (tau - bias + passive forces): the impulse that acts without constraints; of
                                ///< lengths, how large what acts along them is
  std::vector<T> max_impulse;   ///< F = h max_force
  std::vector<T> slope;         ///< of a drive: impulse = slope (target - dv); 0 where the law is vertical. Of a length
                                ///< that gives way the same, about where it is held
  std::vector<T> friction;      ///< h times the dry friction beside a drive; without one it is max_impulse
  std::vector<T> stop;          ///< of a drive: dv that brings the dof to rest
  std::vector<T> target;        ///< dv that brings the dof to its motor's velocity, kept within the limits
  std::vector<T> lower, upper;  ///< dv that brings the dof just to a position limit by the step's end
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
  mask_t<T> sloped;     ///< a drive's or a compliance's slope through (held_dv, impulse)
  T impulse;
  T held_dv;  ///< at which a dof that is not saturated is held
};

template <Number T>
MANYHANDS_INLINE LawPiece<T> law_piece(bool is_drive, T state, std::size_t i, const JointLaws<T>& laws) {
  const T zero = constant<T>(0), one = constant<T>(1), F = laws.max_impulse[i];
  if (!is_drive) return {abs(state) == one, laws.slope[i] > zero, state * F, held_change(state, i, laws)};
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

/// Lets the dof or length want the change `target`, as far as its limits allow: the impulses that can hold it there.
template <Number T>
MANYHANDS_INLINE void aim_at(T target, std::size_t i, JointLaws<T>& laws) {
  const T infinity = constant<T>(std::numeric_limits<double>::infinity()), F = laws.max_impulse[i];
  laws.target[i] = clamp(target, laws.lower[i], laws.upper[i]);
  laws.max_held[i] = select(target < laws.lower[i], infinity, F);
  laws.min_held[i] = select(target > laws.upper[i], -infinity, -F);
}

/// Before the drives of a dof or length add up.
template <Number T>
MANYHANDS_INLINE void begin_drive(T friction, std::size_t i, JointLaws<T>& laws) {
  laws.friction[i] = min(friction, constant<T>(contact_settings::kMaxImpulse));
  laws.slope[i] = laws.target[i] = laws.max_impulse[i] = constant<T>(0);
}

/// After they have added up, `target` to slope times it: what they want of a dof or length whose velocity is v.
template <Number T>
MANYHANDS_INLINE void aim_drive(T v, std::size_t i, JointLaws<T>& laws) {
  const T zero = constant<T>(0), one = constant<T>(1);
  const auto drives = laws.slope[i] > zero;
  laws.target[i] = select(drives, laws.target[i] / select(drives, laws.slope[i], one), zero) - v;
  laws.stop[i] = -v;
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
  const mask_t<T> rests = rested | (offset == zero), at_limit = abs(place) > constant<T>(1);
  const T rubbing = select(at_limit, place, select(rests, stuck, place + offset));
  return select(laws.friction[i] > zero, rubbing, place);
}

/// What the curvature of a path counts for in a step [m/s].
template <Number T>
MANYHANDS_INLINE T bounded_arc(T velocity) {
  const T most = constant<T>(contact_settings::kMaxArc);
  return clamp(velocity, -most, most);
}

}  // namespace internal

}  // namespace manyhands
