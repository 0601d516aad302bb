// Unit quaternions (x, y, z, w) and their maps to rotations and rotation vectors.
#pragma once

#include "manyhands/math/vec3.h"

namespace manyhands {

/// A unit quaternion, scalar part last; q and -q are the same rotation.
template <Number T>
struct Quat {
  T x, y, z, w;

  /// The rotation that applies b first, then a.
  friend MANYHANDS_INLINE Quat operator*(const Quat& a, const Quat& b) {
    return {fma(a.w, b.x, fma(a.x, b.w, fma(a.y, b.z, -(a.z * b.y)))),
            fma(a.w, b.y, fma(a.y, b.w, fma(a.z, b.x, -(a.x * b.z)))),
            fma(a.w, b.z, fma(a.z, b.w, fma(a.x, b.y, -(a.y * b.x)))),
            fma(a.w, b.w, -fma(a.x, b.x, fma(a.y, b.y, a.z * b.z)))};
  }

  static MANYHANDS_INLINE Quat identity() {
    const T zero(real_t<T>(0));
    return {zero, zero, zero, T(real_t<T>(1))};
  }
};

/// q at unit length; NaN for the zero quaternion.
template <Number T>
MANYHANDS_INLINE Quat<T> normalized(const Quat<T>& q) {
  const T n2 = fma(q.x, q.x, fma(q.y, q.y, fma(q.z, q.z, q.w * q.w)));
  const T s = T(real_t<T>(1)) / sqrt(n2);
  return {q.x * s, q.y * s, q.z * s, q.w * s};
}

template <Number T>
MANYHANDS_INLINE Mat3<T> to_matrix(const Quat<T>& q) {  ///< the rotation R with R v = q v q^-1
  const T one(real_t<T>(1));
  const T x2 = q.x + q.x, y2 = q.y + q.y, z2 = q.z + q.z;
  const T xx = q.x * x2, yy = q.y * y2, zz = q.z * z2;
  const T xy = q.x * y2, xz = q.x * z2, yz = q.y * z2;
  const T wx = q.w * x2, wy = q.w * y2, wz = q.w * z2;
  return {
      {one - (yy + zz), xy + wz, xz - wy}, {xy - wz, one - (xx + zz), yz + wx}, {xz + wy, yz - wx, one - (xx + yy)}};
}

/// The quaternion of a rotation matrix, w >= 0 where it can be; every branch is taken by selection (Shepperd, 1978).
template <Number T>
MANYHANDS_INLINE Quat<T> to_quat(const Mat3<T>& m) {
  using R = real_t<T>;
  const T one(R(1));
  const T tw = one + m.x.x + m.y.y + m.z.z, tx = one + m.x.x - m.y.y - m.z.z;
  const T ty = one - m.x.x + m.y.y - m.z.z, tz = one - m.x.x - m.y.y + m.z.z;
  const T dx = m.y.z - m.z.y, dy = m.z.x - m.x.z, dz = m.x.y - m.y.x;  // 4 w (x, y, z)
  const T sxy = m.x.y + m.y.x, sxz = m.z.x + m.x.z, syz = m.y.z + m.z.y;
  Quat<T> q{dx, dy, dz, tw};
  T best = tw;
  const auto take = [&](T t, const Quat<T>& c) {
    const auto better = t > best;
    best = select(better, t, best);
    q = {select(better, c.x, q.x), select(better, c.y, q.y), select(better, c.z, q.z), select(better, c.w, q.w)};
  };
  take(tx, {tx, sxy, sxz, dx});
  take(ty, {sxy, ty, syz, dy});
  take(tz, {sxz, syz, tz, dz});
  const T s = copysign(T(R(0.5)) / sqrt(best), q.w);
  return {q.x * s, q.y * s, q.z * s, q.w * s};
}

/// The rotation by |r| radians about r: the exponential map.
template <Number T>
MANYHANDS_INLINE Quat<T> quat_from_rotation_vector(const Vec3<T>& r) {
  using R = real_t<T>;
  const T angle2 = squared_norm(r);
  const auto tiny = angle2 < T(R(1e-8));
  const T angle = sqrt(select(tiny, T(R(1)), angle2));
  const SinCos<T> half = sincos(T(R(0.5)) * angle);
  const T k = select(tiny, fma(angle2, T(R(-1.0 / 48)), T(R(0.5))), half.sin / angle);
  const T w = select(tiny, fma(angle2, T(R(-0.125)), T(R(1))), half.cos);
  return {k * r.x, k * r.y, k * r.z, w};
}

/// The rotation vector of q, of length at most pi: the logarithm.
template <Number T>
MANYHANDS_INLINE Vec3<T> rotation_vector(const Quat<T>& q) {
  using R = real_t<T>;
  const T sign = copysign(T(R(1)), q.w);
  const T w = q.w * sign;
  const Vec3<T> u{q.x * sign, q.y * sign, q.z * sign};
  const T s2 = squared_norm(u);
  const auto tiny = s2 < T(R(1e-12));
  const T s = sqrt(select(tiny, T(R(1)), s2));
  const T k = select(tiny, fma(s2, T(R(1.0 / 3)), T(R(2))), T(R(2)) * atan2(s, w) / s);
  return k * u;
}

/// q after the angular velocity omega, expressed in the frame in which q is given, has acted for `time` [s].
template <Number T>
MANYHANDS_INLINE Quat<T> integrate(const Quat<T>& q, const Vec3<T>& omega, T time) {
  return normalized(quat_from_rotation_vector(time * omega) * q);
}

/// R = Rz(yaw) Ry(pitch) Rx(roll): the rpy of URDF, rotations about fixed axes.
template <Number T>
MANYHANDS_INLINE Mat3<T> rotation_from_rpy(const Vec3<T>& rpy) {
  const SinCos<T> r = sincos(rpy.x), p = sincos(rpy.y), y = sincos(rpy.z);
  return {{y.cos * p.cos, y.sin * p.cos, -p.sin},
          {y.cos * p.sin * r.sin - y.sin * r.cos, y.sin * p.sin * r.sin + y.cos * r.cos, p.cos * r.sin},
          {y.cos * p.sin * r.cos + y.sin * r.sin, y.sin * p.sin * r.cos - y.cos * r.sin, p.cos * r.cos}};
}

}  // namespace manyhands
