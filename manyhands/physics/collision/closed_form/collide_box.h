// Contact of a box with a plane.
#pragma once

#include "manyhands/physics/collision/manifold.h"

namespace manyhands {

namespace internal {

/// An edge of a box that begins at its lowest corner, and how much it climbs.
template <Number T>
struct RisingEdge {
  Vec3<T> edge;
  T rise;
};

template <Number T>
MANYHANDS_INLINE void order(RisingEdge<T>& a, RisingEdge<T>& b) {
  const mask_t<T> swap = b.rise < a.rise;
  const RisingEdge<T> low{select(swap, b.edge, a.edge), select(swap, b.rise, a.rise)};
  b = {select(swap, a.edge, b.edge), select(swap, a.rise, b.rise)};
  a = low;
}

}  // namespace internal

/// size_A: half extents; B is the half-space z <= 0 of its frame. The four lowest corners.
template <Number T>
Manifold<T> collide_box_plane(const Vec3<T>& size_A, const Transform<T>& X_WA, const Vec3<T>& /*size_B*/,
                              const Transform<T>& X_WB, T /*margin*/) {
  using R = real_t<T>;
  const Vec3<T>& up = X_WB.R.z;
  Vec3<T> lowest = X_WA.p;
  T height = dot(up, X_WA.p - X_WB.p);
  const auto rising = [&](T half, const Vec3<T>& axis) -> internal::RisingEdge<T> {
    const T slope = dot(up, axis);
    const T to_top = copysign(half, slope);
    lowest = fma(-to_top, axis, lowest);
    height = fma(-to_top, slope, height);
    return {(T(R(2)) * to_top) * axis, T(R(2)) * to_top * slope};
  };
  auto a = rising(size_A.x, X_WA.R.x), b = rising(size_A.y, X_WA.R.y), c = rising(size_A.z, X_WA.R.z);
  internal::order(a, b);
  internal::order(b, c);
  internal::order(a, b);
  // After the corner and its two lowest neighbours comes the third neighbour, or the one across the lowest face.
  const mask_t<T> on_corner = c.rise < a.rise + b.rise;

  Manifold<T> m;
  m.normal = -up;
  m.set(0, lowest, height);
  m.set(1, lowest + a.edge, height + a.rise);
  m.set(2, lowest + b.edge, height + b.rise);
  m.set(3, lowest + select(on_corner, c.edge, a.edge + b.edge), height + select(on_corner, c.rise, a.rise + b.rise));
  return m;
}

}  // namespace manyhands
