// PD and PID control of one degree of freedom, and the limits of what a motor can do.
#pragma once

#include "manyhands/math/lanes.h"

namespace manyhands {

/// kp e + kd de/dt.
template <Number T>
[[nodiscard]] MANYHANDS_INLINE T pd(const T& kp, const T& kd, const T& error, const T& rate) {
  return fma(kp, error, kd * rate);
}

/// The force within [-most, most].
template <Number T>
[[nodiscard]] MANYHANDS_INLINE T limited(const T& force, const T& most) {
  return clamp(force, -most, most);
}

/// The force, but no farther from the last one than `most_change`: the rate limit of a drive, times the step.
template <Number T>
[[nodiscard]] MANYHANDS_INLINE T rate_limited(const T& force, const T& last, const T& most_change) {
  return clamp(force, last - most_change, last + most_change);
}

/// Of one degree of freedom; an infinite limit is none.
template <Number T>
struct PidGains {
  T kp, ki, kd;
  T max_integral;  ///< of the integral of the error [rad s or m s]
  T max_force;     ///< [N m or N]
};

/// kp e + ki (integral of e) + kd de/dt, within max_force; `integral` goes on by h e. Against windup it stands still
/// while the force is at its limit and the error would drive it farther (conditional integration: Astrom, Hagglund,
/// Advanced PID Control, 2006, section 3.5), and it never leaves max_integral.
template <Number T>
[[nodiscard]] MANYHANDS_INLINE T pid(const PidGains<T>& gains, const T& h, const T& error, const T& rate, T& integral) {
  const T zero = constant<T>(0), rest = pd(gains.kp, gains.kd, error, rate);
  const T next = clamp(fma(h, error, integral), -gains.max_integral, gains.max_integral);
  const T force = fma(gains.ki, next, rest), drive = gains.ki * error;
  const auto winds_up = ((force > gains.max_force) & (drive > zero)) | ((force < -gains.max_force) & (drive < zero));
  integral = select(winds_up, integral, next);
  return limited(fma(gains.ki, integral, rest), gains.max_force);
}

}  // namespace manyhands
