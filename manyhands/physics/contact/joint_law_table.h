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
};

/// The laws of all dofs (nv), and behind them those of all lengths, whose velocity is J v. Velocities are changes over
/// the step, forces are impulses.
template <Number T>
struct JointLaws {
  explicit JointLaws(int laws)
      : smooth(index(laws)),
        max_impulse(smooth),
        slope(smooth.size(), constant<T>(0)),
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
  std::vector<T> slope;         ///< of a drive: impulse = slope (target - dv); 0 where the law is vertical
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

/// What the curvature of a path counts for in a step [m/s].
template <Number T>
MANYHANDS_INLINE T bounded_arc(T velocity) {
  const T most = constant<T>(contact_settings::kMaxArc);
  return clamp(velocity, -most, most);
}

}  // namespace internal

}  // namespace manyhands
