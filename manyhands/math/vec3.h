// Vectors, rotations and rigid transforms over any number type.
#pragma once

#include "manyhands/math/functions.h"

namespace manyhands {

template <Number T>
struct Vec3 {
  T x, y, z;

  friend MANYHANDS_INLINE Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend MANYHANDS_INLINE Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend MANYHANDS_INLINE Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
  friend MANYHANDS_INLINE Vec3 operator*(T s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
  friend MANYHANDS_INLINE Vec3 operator*(const Vec3& a, T s) { return s * a; }
  MANYHANDS_INLINE Vec3& operator+=(const Vec3& b) { return *this = *this + b; }
  MANYHANDS_INLINE Vec3& operator-=(const Vec3& b) { return *this = *this - b; }

  static MANYHANDS_INLINE Vec3 zero() { return {T(real_t<T>(0)), T(real_t<T>(0)), T(real_t<T>(0))}; }
};

template <Number T>
MANYHANDS_INLINE T dot(const Vec3<T>& a, const Vec3<T>& b) {
  return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z));
}

template <Number T>
MANYHANDS_INLINE Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {fma(a.y, b.z, -(a.z * b.y)), fma(a.z, b.x, -(a.x * b.z)), fma(a.x, b.y, -(a.y * b.x))};
}

/// s a + b.
template <Number T>
MANYHANDS_INLINE Vec3<T> fma(T s, const Vec3<T>& a, const Vec3<T>& b) {
  return {fma(s, a.x, b.x), fma(s, a.y, b.y), fma(s, a.z, b.z)};
}

template <Number T>
MANYHANDS_INLINE T squared_norm(const Vec3<T>& a) {
  return dot(a, a);
}

template <Number T>
MANYHANDS_INLINE T norm(const Vec3<T>& a) {
  return sqrt(dot(a, a));
}

template <Number T>
MANYHANDS_INLINE Vec3<T> select(mask_t<T> m, const Vec3<T>& a, const Vec3<T>& b) {
  return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
}

/// The same number in every lane of T; what varies by lane already stays as it is.
template <Number T, Number P>
MANYHANDS_INLINE T broadcast(P a) {
  if constexpr (std::same_as<T, P>) {
    return a;
  } else {
    real_t<T> rounded = static_cast<real_t<T>>(a);  // NOLINT(misc-const-correctness): made opaque if P is double
    // GCC 12 drops the rounding where vectors of numbers go to float and back to double.
    if constexpr (std::same_as<P, double>) MANYHANDS_OPAQUE(rounded);
    return T(rounded);
  }
}
template <Number T, Number P>
MANYHANDS_INLINE Vec3<T> broadcast(const Vec3<P>& a) {
  return {broadcast<T>(a.x), broadcast<T>(a.y), broadcast<T>(a.z)};
}

/// The vector in lane k.
template <Number T>
MANYHANDS_INLINE Vec3<real_t<T>> lane(const Vec3<T>& a, int k) {
  return {lane(a.x, k), lane(a.y, k), lane(a.z, k)};
}

/// Copies lane k of one vector into another.
template <Number T>
MANYHANDS_INLINE void copy_lane(const Vec3<T>& from, Vec3<T>& to, int k) {
  set_lane(to.x, k, lane(from.x, k));
  set_lane(to.y, k, lane(from.y, k));
  set_lane(to.z, k, lane(from.z, k));
}

/// A 3 x 3 matrix by its columns; as a rotation R_AB, the columns are B's axes expressed in A.
template <Number T>
struct Mat3 {
  Vec3<T> x, y, z;

  friend MANYHANDS_INLINE Vec3<T> operator*(const Mat3& m, const Vec3<T>& a) {
    return fma(a.x, m.x, fma(a.y, m.y, a.z * m.z));
  }
  friend MANYHANDS_INLINE Mat3 operator*(const Mat3& a, const Mat3& b) { return {a * b.x, a * b.y, a * b.z}; }

  static MANYHANDS_INLINE Mat3 identity() {
    const T zero(real_t<T>(0)), one(real_t<T>(1));
    return {{one, zero, zero}, {zero, one, zero}, {zero, zero, one}};
  }
};

/// m^T a: with a rotation, the way back.
template <Number T>
MANYHANDS_INLINE Vec3<T> transpose_times(const Mat3<T>& m, const Vec3<T>& a) {
  return {dot(m.x, a), dot(m.y, a), dot(m.z, a)};
}

template <Number T>
MANYHANDS_INLINE Mat3<T> transpose(const Mat3<T>& m) {
  return {{m.x.x, m.y.x, m.z.x}, {m.x.y, m.y.y, m.z.y}, {m.x.z, m.y.z, m.z.z}};
}

template <Number T, Number P>
MANYHANDS_INLINE Mat3<T> broadcast(const Mat3<P>& m) {
  return {broadcast<T>(m.x), broadcast<T>(m.y), broadcast<T>(m.z)};
}

/// A rigid transform X_AB: the pose of frame B in frame A; X_AC = X_AB * X_BC.
template <Number T>
struct Transform {
  Mat3<T> R;  ///< R_AB
  Vec3<T> p;  ///< p_AB [m]

  friend MANYHANDS_INLINE Transform operator*(const Transform& a, const Transform& b) {
    return {a.R * b.R, a.R * b.p + a.p};
  }
  friend MANYHANDS_INLINE Vec3<T> operator*(const Transform& a, const Vec3<T>& b) { return a.R * b + a.p; }

  static MANYHANDS_INLINE Transform identity() { return {Mat3<T>::identity(), Vec3<T>::zero()}; }
};

/// X_BA from X_AB.
template <Number T>
MANYHANDS_INLINE Transform<T> inverse(const Transform<T>& a) {
  return {transpose(a.R), -transpose_times(a.R, a.p)};
}

/// The transform in lane k.
template <Number T>
MANYHANDS_INLINE Transform<real_t<T>> lane(const Transform<T>& a, int k) {
  return {{lane(a.R.x, k), lane(a.R.y, k), lane(a.R.z, k)}, lane(a.p, k)};
}

template <Number T, Number P>
MANYHANDS_INLINE Transform<T> broadcast(const Transform<P>& a) {
  return {broadcast<T>(a.R), broadcast<T>(a.p)};
}

}  // namespace manyhands
