// Twists and rigid transforms: the exponential map of SE(3), its inverse, and how a transform acts on motions
// (Lynch and Park, Modern Robotics, 2017, chapter 3). Those of SO(3) are in quaternion.h; the Lie bracket of two
// motions is `cross` (spatial.h).
#pragma once

#include "manyhands/math/quaternion.h"
#include "manyhands/math/spatial.h"

namespace manyhands {

namespace internal {

inline constexpr double kTinyAngle2 = 1e-8;  ///< squared [rad^2]: below, the first terms of a series are exact

}  // namespace internal

/// The adjoint: a motion of B's axes, about B's origin, in A's axes about A's origin, where X = X_AB.
template <Number T>
MANYHANDS_INLINE Motion<T> transformed(const Transform<T>& X, const Motion<T>& m) {
  const Vec3<T> w = X.R * m.w;
  return {w, X.R * m.v + cross(X.p, w)};
}

/// The transform that a unit of time of the constant twist (w, v) makes: a turn by |w| about a screw axis, and a shift
/// along it.
template <Number T>
MANYHANDS_INLINE Transform<T> exp6(const Motion<T>& twist) {
  const T one = constant<T>(1), half = constant<T>(0.5);
  const T angle2 = squared_norm(twist.w);
  const auto tiny = angle2 < constant<T>(internal::kTinyAngle2);
  const T safe2 = select(tiny, one, angle2), angle = sqrt(safe2);
  const SinCos<T> whole = sincos(angle), halved = sincos(half * angle);
  // (1 - cos) / angle^2 and (angle - sin) / angle^3
  const T a = select(tiny, fma(angle2, constant<T>(-1.0 / 24), half),
                     (halved.sin * halved.sin + halved.sin * halved.sin) / safe2);
  const T b =
      select(tiny, fma(angle2, constant<T>(-1.0 / 120), constant<T>(1.0 / 6)), (angle - whole.sin) / (safe2 * angle));
  const Vec3<T> turned = cross(twist.w, twist.v);
  return {to_matrix(quat_from_rotation_vector(twist.w)), twist.v + fma(a, turned, b * cross(twist.w, turned))};
}

/// The twist of the shortest turn, at most pi, with exp6(twist) = X.
template <Number T>
MANYHANDS_INLINE Motion<T> log6(const Transform<T>& X) {
  const T one = constant<T>(1), half = constant<T>(0.5);
  const Vec3<T> w = rotation_vector(to_quat(X.R));
  const T angle2 = squared_norm(w);
  const auto tiny = angle2 < constant<T>(internal::kTinyAngle2);
  const T safe2 = select(tiny, one, angle2), half_angle = half * sqrt(safe2);
  const SinCos<T> halved = sincos(half_angle);
  // (1 - angle / 2 cot(angle / 2)) / angle^2
  const T c = select(tiny, fma(angle2, constant<T>(1.0 / 720), constant<T>(1.0 / 12)),
                     (one - half_angle * halved.cos / halved.sin) / safe2);
  const Vec3<T> turned = cross(w, X.p);
  return {w, fma(-half, turned, fma(c, cross(w, turned), X.p))};
}

}  // namespace manyhands
