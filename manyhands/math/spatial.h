// Spatial (6-D) algebra about one common point O with world axes, angular part first
// (Featherstone, Rigid Body Dynamics Algorithms, 2008, chapter 2). Because every quantity of a tree is expressed at the
// same point and in the same axes, quantities of different bodies add without transforms.
#pragma once

#include "manyhands/math/vec3.h"

namespace manyhands {

/// A spatial motion: velocity, acceleration or joint axis. `v` is the velocity of the body-fixed point at O.
template <Number T>
struct Motion {
  Vec3<T> w;  ///< angular [rad/s]
  Vec3<T> v;  ///< linear at O [m/s]

  friend MANYHANDS_INLINE Motion operator+(const Motion& a, const Motion& b) { return {a.w + b.w, a.v + b.v}; }
  friend MANYHANDS_INLINE Motion operator-(const Motion& a, const Motion& b) { return {a.w - b.w, a.v - b.v}; }
  friend MANYHANDS_INLINE Motion operator*(T s, const Motion& a) { return {s * a.w, s * a.v}; }
  static MANYHANDS_INLINE Motion zero() { return {Vec3<T>::zero(), Vec3<T>::zero()}; }
};

/// A spatial force: wrench, momentum or impulse. `n` is the moment about O.
template <Number T>
struct Force {
  Vec3<T> n;  ///< moment about O [N m]
  Vec3<T> f;  ///< force [N]

  friend MANYHANDS_INLINE Force operator+(const Force& a, const Force& b) { return {a.n + b.n, a.f + b.f}; }
  friend MANYHANDS_INLINE Force operator-(const Force& a, const Force& b) { return {a.n - b.n, a.f - b.f}; }
  friend MANYHANDS_INLINE Force operator*(T s, const Force& a) { return {s * a.n, s * a.f}; }
  static MANYHANDS_INLINE Force zero() { return {Vec3<T>::zero(), Vec3<T>::zero()}; }
};

/// s a + b.
template <Number T>
MANYHANDS_INLINE Motion<T> fma(T s, const Motion<T>& a, const Motion<T>& b) {
  return {fma(s, a.w, b.w), fma(s, a.v, b.v)};
}
template <Number T>
MANYHANDS_INLINE Force<T> fma(T s, const Force<T>& a, const Force<T>& b) {
  return {fma(s, a.n, b.n), fma(s, a.f, b.f)};
}

/// Power of a force on a motion.
template <Number T>
MANYHANDS_INLINE T dot(const Motion<T>& m, const Force<T>& f) {
  const T angular = fma(m.w.x, f.n.x, fma(m.w.y, f.n.y, m.w.z * f.n.z));
  return fma(m.v.x, f.f.x, fma(m.v.y, f.f.y, fma(m.v.z, f.f.z, angular)));
}

/// a x b: the rate at which b changes when carried along by a.
template <Number T>
MANYHANDS_INLINE Motion<T> cross(const Motion<T>& a, const Motion<T>& b) {
  return {cross(a.w, b.w), cross(a.w, b.v) + cross(a.v, b.w)};
}

/// a x* f: the same for forces.
template <Number T>
MANYHANDS_INLINE Force<T> cross(const Motion<T>& a, const Force<T>& f) {
  return {cross(a.w, f.n) + cross(a.v, f.f), cross(a.w, f.f)};
}

/// A symmetric 3 x 3 matrix.
template <Number T>
struct SymMat3 {
  T xx, yy, zz, xy, xz, yz;

  friend MANYHANDS_INLINE Vec3<T> operator*(const SymMat3& m, const Vec3<T>& a) {
    return {fma(m.xx, a.x, fma(m.xy, a.y, m.xz * a.z)), fma(m.xy, a.x, fma(m.yy, a.y, m.yz * a.z)),
            fma(m.xz, a.x, fma(m.yz, a.y, m.zz * a.z))};
  }
  friend MANYHANDS_INLINE SymMat3 operator+(const SymMat3& a, const SymMat3& b) {
    return {a.xx + b.xx, a.yy + b.yy, a.zz + b.zz, a.xy + b.xy, a.xz + b.xz, a.yz + b.yz};
  }
  static MANYHANDS_INLINE SymMat3 zero() {
    const T o(real_t<T>(0));
    return {o, o, o, o, o, o};
  }
};

template <Number T, Number P>
MANYHANDS_INLINE SymMat3<T> broadcast(const SymMat3<P>& m) {
  return {broadcast<T>(m.xx), broadcast<T>(m.yy), broadcast<T>(m.zz),
          broadcast<T>(m.xy), broadcast<T>(m.xz), broadcast<T>(m.yz)};
}

/// R m R^T.
template <Number T>
MANYHANDS_INLINE SymMat3<T> rotated(const Mat3<T>& R, const SymMat3<T>& m) {
  const Vec3<T> x{R.x.x, R.y.x, R.z.x}, y{R.x.y, R.y.y, R.z.y}, z{R.x.z, R.y.z, R.z.z};  // rows of R
  const Vec3<T> mx = m * x, my = m * y, mz = m * z;
  return {dot(x, mx), dot(y, my), dot(z, mz), dot(x, my), dot(x, mz), dot(y, mz)};
}

/// Rigid-body inertia about a point O: mass, first moment h = m c, and rotational inertia about O.
template <Number T>
struct RigidInertia {
  T m;           ///< [kg]
  Vec3<T> h;     ///< m times the centre of mass from O [kg m]
  SymMat3<T> I;  ///< about O [kg m^2]

  friend MANYHANDS_INLINE RigidInertia operator+(const RigidInertia& a, const RigidInertia& b) {
    return {a.m + b.m, a.h + b.h, a.I + b.I};
  }

  /// The momentum of a body of this inertia moving with V.
  friend MANYHANDS_INLINE Force<T> operator*(const RigidInertia& a, const Motion<T>& V) {
    return {a.I * V.w + cross(a.h, V.v), fma(a.m, V.v, cross(V.w, a.h))};
  }

  static MANYHANDS_INLINE RigidInertia zero() { return {T(real_t<T>(0)), Vec3<T>::zero(), SymMat3<T>::zero()}; }
};

template <Number T, Number P>
MANYHANDS_INLINE RigidInertia<T> broadcast(const RigidInertia<P>& a) {
  return {broadcast<T>(a.m), broadcast<T>(a.h), broadcast<T>(a.I)};
}

/// The inertia `a`, given about B's origin in B's axes, about O in O's axes, where X = X_OB.
template <Number T>
MANYHANDS_INLINE RigidInertia<T> transformed(const Transform<T>& X, const RigidInertia<T>& a) {
  const Vec3<T> h = X.R * a.h;
  const Vec3<T>& p = X.p;
  const SymMat3<T> I = rotated(X.R, a.I);
  // Parallel axes: I + 2 (h.p) 1 - h p^T - p h^T + m (p.p 1 - p p^T), written with g = h + m p / 2.
  const Vec3<T> g = fma(T(real_t<T>(0.5)) * a.m, p, h);
  const T gx = g.x * p.x, gy = g.y * p.y, gz = g.z * p.z;
  const T two(real_t<T>(2));
  return {a.m,
          fma(a.m, p, h),
          {fma(two, gy + gz, I.xx), fma(two, gx + gz, I.yy), fma(two, gx + gy, I.zz), I.xy - fma(g.x, p.y, g.y * p.x),
           I.xz - fma(g.x, p.z, g.z * p.x), I.yz - fma(g.y, p.z, g.z * p.y)}};
}

}  // namespace manyhands
