// A quick look at whether two geoms can be near each other.
#pragma once

#include <span>

#include "manyhands/physics/collision/broad/bounds.h"
#include "manyhands/physics/collision/colliders.h"
#include "manyhands/physics/dynamics/workspace.h"

namespace manyhands {

/// The radius of a sphere about the geom's origin that holds its shape [m]; infinite for a plane.
template <Number T>
MANYHANDS_INLINE T bounding_radius(const Collider<real_t<T>>& geom, const Vec3<T>& size) {
  switch (geom.type) {
    case ShapeType::kConvex:
    case ShapeType::kMesh:
    case ShapeType::kHeightField:
      return T(geom.radius);
    default:
      return bounding_radius(geom.type, size);
  }
}

namespace internal {

/// Whether the sphere (p, r) comes nearer than r to the box (half, X).
template <Number T>
MANYHANDS_INLINE mask_t<T> sphere_meets_box(const Vec3<T>& p, T r, const Vec3<T>& half, const Transform<T>& X) {
  const T zero(real_t<T>(0));
  const Vec3<T> d = transpose_times(X.R, p - X.p);
  const Vec3<T> out{max(abs(d.x) - half.x, zero), max(abs(d.y) - half.y, zero), max(abs(d.z) - half.z, zero)};
  return squared_norm(out) < r * r;
}

/// Whether the sphere (p, r) comes nearer than r to the box around the shape, in whose axes it lies. True of spheres
/// and surfaces, which have none.
template <Number T>
MANYHANDS_INLINE mask_t<T> sphere_meets_box_of(const Vec3<T>& p, T r, const Collider<real_t<T>>& geom,
                                               const Vec3<T>& size, const Transform<T>& X) {
  switch (geom.type) {
    case ShapeType::kBox:
    case ShapeType::kCapsule:
    case ShapeType::kCylinder:
      return sphere_meets_box(p, r, half_extents(geom.type, size), X);
    case ShapeType::kConvex:
      return sphere_meets_box(p, r, broadcast<T>(geom.half), {X.R, X * broadcast<T>(geom.centre)});
    default:
      return true;
  }
}

/// Whether the boxes (half_A, X_A) and (half_B, X_B) come nearer than `margin` to each other along each of their axes.
/// Of two that are farther apart only some whose edges are nearest to each other pass (Gottschalk, Lin, Manocha,
/// OBBTree, SIGGRAPH 1996, has the axes across edges, too, which cost more than they save here).
template <Number T>
MANYHANDS_INLINE mask_t<T> box_meets_box(const Vec3<T>& half_A, const Transform<T>& X_A, const Vec3<T>& half_B,
                                         const Transform<T>& X_B, T margin) {
  const Vec3<T> d = X_B.p - X_A.p, p_A = transpose_times(X_A.R, d), p_B = transpose_times(X_B.R, d);
  const auto turned = [&](const Vec3<T>& axis) {
    const Vec3<T> in_A = transpose_times(X_A.R, axis);
    return Vec3<T>{abs(in_A.x), abs(in_A.y), abs(in_A.z)};
  };
  const Mat3<T> R_AB{turned(X_B.R.x), turned(X_B.R.y), turned(X_B.R.z)};
  const Vec3<T> reach_A = half_A + R_AB * half_B, reach_B = half_B + transpose_times(R_AB, half_A);
  return (abs(p_A.x) < reach_A.x + margin) & (abs(p_A.y) < reach_A.y + margin) & (abs(p_A.z) < reach_A.z + margin) &
         (abs(p_B.x) < reach_B.x + margin) & (abs(p_B.y) < reach_B.y + margin) & (abs(p_B.z) < reach_B.z + margin);
}

/// The same of a shape's box and a hull's. Not inlined: it would crowd the loop over pairs that have no hull.
template <Number T>
[[gnu::noinline]] mask_t<T> box_meets_hull(const Collider<real_t<T>>& a, const Vec3<T>& size_A, const Transform<T>& X_A,
                                           const Collider<real_t<T>>& hull, const Transform<T>& X_B, T margin) {
  const Transform<T> X_BC{X_B.R, X_B * broadcast<T>(hull.centre)};
  const Vec3<T> half = broadcast<T>(hull.half);
  if (a.type != ShapeType::kConvex) return box_meets_box(half_extents(a.type, size_A), X_A, half, X_BC, margin);
  return box_meets_box(broadcast<T>(a.half), {X_A.R, X_A * broadcast<T>(a.centre)}, half, X_BC, margin);
}

}  // namespace internal

/// A box of the world, which may be a table: its sphere says little.
template <Real R>
[[nodiscard]] inline bool is_wide(const Collider<R>& geom) {
  return geom.body == 0 && geom.type == ShapeType::kBox;
}

/// Whether the pair's shapes may be nearer to each other than `margin`, by spheres about them. Of what moves it asks no
/// more than where it is, so that most pairs are done with before it is known how their geoms are turned.
template <Number T, Number P>
MANYHANDS_INLINE mask_t<T> spheres_meet(const Colliders<real_t<T>>& colliders, const ColliderPair& pair,
                                        const Params<P>& params, T margin, const std::vector<Transform<T>>& X_WG,
                                        const std::vector<T>& radius) {
  const Collider<real_t<T>>&a = colliders.geoms[pair.a], &b = colliders.geoms[pair.b];
  const Transform<T>&X_A = X_WG[pair.a], &X_B = X_WG[pair.b];
  const T reach_A = radius[pair.a] + margin;
  if (b.type == ShapeType::kPlane) return dot(X_B.R.z, X_A.p - X_B.p) < reach_A;
  const auto size = [&](const Collider<real_t<T>>& geom) { return broadcast<T>(params.geom_size[geom.geom]); };
  if (is_wide(b)) return internal::sphere_meets_box_of(X_A.p, reach_A, b, size(b), X_B);
  if (is_wide(a)) return internal::sphere_meets_box_of(X_B.p, radius[pair.b] + margin, a, size(a), X_A);
  const T reach = reach_A + radius[pair.b];
  return squared_norm(X_B.p - X_A.p) < reach * reach;
}

/// The same by a box about one and a sphere about the other: worth asking where spheres meet. By two boxes if one holds
/// a hull, whose origin may lie far off, and whose narrow phase is dear.
template <Number T, Number P>
MANYHANDS_INLINE mask_t<T> boxes_meet(const Colliders<real_t<T>>& colliders, const ColliderPair& pair,
                                      const Params<P>& params, T margin, const std::vector<Transform<T>>& X_WG,
                                      const std::vector<T>& radius) {
  const Collider<real_t<T>>&a = colliders.geoms[pair.a], &b = colliders.geoms[pair.b];
  if (b.type == ShapeType::kPlane) return true;
  const Transform<T>&X_A = X_WG[pair.a], &X_B = X_WG[pair.b];
  const auto size = [&](const Collider<real_t<T>>& geom) { return broadcast<T>(params.geom_size[geom.geom]); };
  if (b.type == ShapeType::kConvex && a.type != ShapeType::kSphere) {
    return internal::box_meets_hull(a, size(a), X_A, b, X_B, margin);
  }
  mask_t<T> meets(true);
  if (!is_wide(a)) meets = internal::sphere_meets_box_of(X_B.p, radius[pair.b] + margin, a, size(a), X_A);
  if (!is_wide(b)) meets = meets & internal::sphere_meets_box_of(X_A.p, radius[pair.a] + margin, b, size(b), X_B);
  return meets;
}

}  // namespace manyhands
