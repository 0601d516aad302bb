// Contact of a sphere with every simple shape: its centre's signed distance from the other shape, less its radius.
#pragma once

#include "manyhands/physics/collision/manifold.h"

namespace manyhands {

namespace internal {

template <Number T>
struct Direction {
  Vec3<T> unit;
  T length;
};

/// v's direction and length; the direction is `otherwise` where v is too short to have one.
template <Number T>
MANYHANDS_INLINE Direction<T> direction_or(const Vec3<T>& v, const Vec3<T>& otherwise) {
  using R = real_t<T>;
  const T squared = squared_norm(v);
  const mask_t<T> clear = squared > T(R(1e-30));
  const T length = sqrt(squared);
  return {select(clear, (T(R(1)) / select(clear, length, T(R(1)))) * v, otherwise), length};
}

/// How far a point lies from a solid shape (negative inside), and the unit direction of the fastest way out.
template <Number T>
struct SignedDistance {
  T distance;
  Vec3<T> outward;
};

/// From a solid cylinder about z, in its own frame.
template <Number T>
MANYHANDS_INLINE SignedDistance<T> distance_from_cylinder(const Vec3<T>& p, T radius, T half_length) {
  using R = real_t<T>;
  const T zero(R(0)), one(R(1));
  const auto radial = direction_or(Vec3<T>{p.x, p.y, zero}, {one, zero, zero});
  const T side = radial.length - radius, cap = abs(p.z) - half_length;
  const auto gap = direction_or(Vec3<T>{max(side, zero), zero, max(cap, zero)}, Vec3<T>::zero());
  const mask_t<T> outside = gap.unit.x + gap.unit.z > zero;
  const mask_t<T> through_side = side >= cap;
  const T out_r = select(outside, gap.unit.x, select(through_side, one, zero));
  const T out_z = select(outside, gap.unit.z, select(through_side, zero, one));
  return {select(outside, gap.length, max(side, cap)),
          {out_r * radial.unit.x, out_r * radial.unit.y, copysign(one, p.z) * out_z}};
}

/// From a solid box, in its own frame.
template <Number T>
MANYHANDS_INLINE SignedDistance<T> distance_from_box(const Vec3<T>& p, const Vec3<T>& half) {
  using R = real_t<T>;
  const T zero(R(0)), one(R(1));
  const T x = abs(p.x) - half.x, y = abs(p.y) - half.y, z = abs(p.z) - half.z;
  const T deepest = max(x, max(y, z));
  const mask_t<T> is_x = x >= deepest;
  const mask_t<T> is_y = (y >= deepest) & (!is_x);
  const Vec3<T> face{select(is_x, one, zero), select(is_y, one, zero), select(is_x | is_y, zero, one)};
  const auto gap = direction_or(Vec3<T>{max(x, zero), max(y, zero), max(z, zero)}, face);
  const Vec3<T> out = gap.unit;
  return {select(gap.length > T(R(1e-15)), gap.length, deepest),
          {copysign(one, p.x) * out.x, copysign(one, p.y) * out.y, copysign(one, p.z) * out.z}};
}

/// The contact of a sphere whose centre is that far from the other shape.
template <Number T>
MANYHANDS_INLINE Manifold<T> sphere_contact(T radius, const Vec3<T>& centre, const SignedDistance<T>& from_B) {
  Manifold<T> m;
  m.normal = -from_B.outward;
  m.set(0, fma(radius, m.normal, centre), from_B.distance - radius);
  return m;
}

/// The contact of two spheres; the normal is `otherwise` where the centres coincide.
template <Number T>
MANYHANDS_INLINE Manifold<T> contact_of_spheres(T r_A, const Vec3<T>& p_A, T r_B, const Vec3<T>& p_B,
                                                const Vec3<T>& otherwise) {
  const auto way = direction_or(p_B - p_A, otherwise);
  Manifold<T> m;
  m.normal = way.unit;
  m.set(0, fma(r_A, m.normal, p_A), way.length - (r_A + r_B));
  return m;
}

}  // namespace internal

/// size: (radius, -, -). Concentric spheres part along A's z.
template <Number T>
Manifold<T> collide_sphere_sphere(const Vec3<T>& size_A, const Transform<T>& X_WA, const Vec3<T>& size_B,
                                  const Transform<T>& X_WB, T /*margin*/) {
  return internal::contact_of_spheres(size_A.x, X_WA.p, size_B.x, X_WB.p, X_WA.R.z);
}

/// size_B: (radius, half length, -). A centre on the capsule's axis parts along B's x.
template <Number T>
Manifold<T> collide_sphere_capsule(const Vec3<T>& size_A, const Transform<T>& X_WA, const Vec3<T>& size_B,
                                   const Transform<T>& X_WB, T /*margin*/) {
  const T along = clamp(dot(X_WB.R.z, X_WA.p - X_WB.p), -size_B.y, size_B.y);
  return internal::contact_of_spheres(size_A.x, X_WA.p, size_B.x, fma(along, X_WB.R.z, X_WB.p), X_WB.R.x);
}

/// size_B: (radius, half length, -). A centre inside leaves by the nearest face.
template <Number T>
Manifold<T> collide_sphere_cylinder(const Vec3<T>& size_A, const Transform<T>& X_WA, const Vec3<T>& size_B,
                                    const Transform<T>& X_WB, T /*margin*/) {
  auto from_B = internal::distance_from_cylinder(transpose_times(X_WB.R, X_WA.p - X_WB.p), size_B.x, size_B.y);
  from_B.outward = X_WB.R * from_B.outward;
  return internal::sphere_contact(size_A.x, X_WA.p, from_B);
}

/// size_B: half extents. A centre inside leaves by the nearest face.
template <Number T>
Manifold<T> collide_sphere_box(const Vec3<T>& size_A, const Transform<T>& X_WA, const Vec3<T>& size_B,
                               const Transform<T>& X_WB, T /*margin*/) {
  auto from_B = internal::distance_from_box(transpose_times(X_WB.R, X_WA.p - X_WB.p), size_B);
  from_B.outward = X_WB.R * from_B.outward;
  return internal::sphere_contact(size_A.x, X_WA.p, from_B);
}

/// B is the half-space z <= 0 of its frame.
template <Number T>
Manifold<T> collide_sphere_plane(const Vec3<T>& size_A, const Transform<T>& X_WA, const Vec3<T>& /*size_B*/,
                                 const Transform<T>& X_WB, T /*margin*/) {
  return internal::sphere_contact(size_A.x, X_WA.p, {dot(X_WB.R.z, X_WA.p - X_WB.p), X_WB.R.z});
}

}  // namespace manyhands
