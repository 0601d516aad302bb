// The inertia that a subtree shows at its root: a full symmetric 6 x 6 matrix (Featherstone 2008, chapter 7).
#pragma once

#include "manyhands/math/spatial.h"

namespace manyhands {

/// [ I  H ; H^T  M ]: n = I w + H v, f = H^T w + M v.
template <Number T>
struct ArticulatedInertia {
  SymMat3<T> I;
  Mat3<T> H;
  SymMat3<T> M;

  friend MANYHANDS_INLINE Force<T> operator*(const ArticulatedInertia& a, const Motion<T>& m) {
    return {a.I * m.w + a.H * m.v, transpose_times(a.H, m.w) + a.M * m.v};
  }

  MANYHANDS_INLINE ArticulatedInertia& operator+=(const ArticulatedInertia& b) {
    I = I + b.I;
    H = {H.x + b.H.x, H.y + b.H.y, H.z + b.H.z};
    M = M + b.M;
    return *this;
  }
};

template <Number T>
MANYHANDS_INLINE ArticulatedInertia<T> articulated(const RigidInertia<T>& a) {
  const T o(real_t<T>(0));
  // H is the cross-product matrix of h, by columns.
  return {a.I, {{o, a.h.z, -a.h.y}, {-a.h.z, o, a.h.x}, {a.h.y, -a.h.x, o}}, {a.m, a.m, a.m, o, o, o}};
}

namespace internal {

/// m + s a b^T, of which only the symmetric part is kept: a and b are parallel.
template <Number T>
MANYHANDS_INLINE SymMat3<T> rank_one(const SymMat3<T>& m, const Vec3<T>& a, const Vec3<T>& b) {
  return {fma(a.x, b.x, m.xx), fma(a.y, b.y, m.yy), fma(a.z, b.z, m.zz),
          fma(a.x, b.y, m.xy), fma(a.x, b.z, m.xz), fma(a.y, b.z, m.yz)};
}

}  // namespace internal

/// a - U U^T d: what remains of the inertia when the joint of U = a S, 1 / d = S . U, moves freely.
template <Number T>
MANYHANDS_INLINE ArticulatedInertia<T> project(const ArticulatedInertia<T>& a, const Force<T>& U, T d) {
  const Force<T> W = (-d) * U;
  return {internal::rank_one(a.I, W.n, U.n),
          {fma(U.f.x, W.n, a.H.x), fma(U.f.y, W.n, a.H.y), fma(U.f.z, W.n, a.H.z)},
          internal::rank_one(a.M, W.f, U.f)};
}

}  // namespace manyhands
