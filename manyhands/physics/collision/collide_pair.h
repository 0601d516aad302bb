// The narrow phase of one pair: the function for its two shapes.
#pragma once

#include "manyhands/physics/collision/broad/bounds_meet.h"
#include "manyhands/physics/collision/closed_form/collide_box.h"
#include "manyhands/physics/collision/closed_form/collide_box_box.h"
#include "manyhands/physics/collision/closed_form/collide_capsule.h"
#include "manyhands/physics/collision/closed_form/collide_cylinder.h"
#include "manyhands/physics/collision/closed_form/collide_sphere.h"
#include "manyhands/physics/collision/closed_form/face_of_box.h"
#include "manyhands/physics/collision/general/collide_general.h"

namespace manyhands {

namespace internal {

/// The general narrow phase in those lanes that need it; the others get no points.
template <Number T>
std::size_t collide_lane_by_lane(const Colliders<real_t<T>>& colliders, const ColliderPair& pair, mask_t<T> near,
                                 T margin, const Vec3<T>& size_A, const Transform<T>& X_WA, const Vec3<T>& size_B,
                                 const Transform<T>& X_WB, std::array<Manifold<T>, 4>& found) {
  using R = real_t<T>;
  std::size_t most = 0;
  for (Manifold<T>& m : found) m = {.normal = {T(R(0)), T(R(0)), T(R(1))}};
  for_lanes<T>(near, [&](int k) {
    std::array<Manifold<R>, 4> own;
    const auto count = static_cast<std::size_t>(collide_general<R>(
        colliders, pair, lane(size_A, k), lane(X_WA, k), lane(size_B, k), lane(X_WB, k), lane(margin, k), own));
    for (std::size_t i = 0; i < count; ++i) copy_to_lane(own[i], found[i], k);
    most = std::max(most, count);
  });
  return most;
}

/// A cylinder over the inside of a box's face meets a half-space; elsewhere it is a general pair.
template <Number T>
std::size_t collide_cylinder_box(const Colliders<real_t<T>>& colliders, const ColliderPair& pair, mask_t<T> near,
                                 T margin, const Vec3<T>& size_A, const Transform<T>& X_WA, const Vec3<T>& size_B,
                                 const Transform<T>& X_WB, std::array<Manifold<T>, 4>& found) {
  const T radius = sqrt(fma(size_A.x, size_A.x, size_A.y * size_A.y));
  const FaceOfBox<T> face = face_below(X_WA.p, radius, size_B, X_WB);
  const Manifold<T> flat = collide_cylinder_plane(size_A, X_WA, size_B, face.X_W, margin);
  const auto general = near & !face.is_all;
  if (any(general)) collide_lane_by_lane(colliders, pair, general, margin, size_A, X_WA, size_B, X_WB, found);
  found[0] = select(face.is_all, flat, found[0]);
  return 1;
}

}  // namespace internal

/// The pair's manifolds into `found`; how many there are. Lanes outside `near` may get anything.
template <Number T, Number P>
MANYHANDS_INLINE std::size_t collide_pair(const Colliders<real_t<T>>& colliders, const ColliderPair& pair,
                                          const Params<P>& params, mask_t<T> near, T margin,
                                          const std::vector<Transform<T>>& X_WG, std::array<Manifold<T>, 4>& found) {
  const Collider<real_t<T>>&a = colliders.geoms[pair.a], &b = colliders.geoms[pair.b];
  const Vec3<T> size_A = broadcast<T>(params.geom_size[a.geom]), size_B = broadcast<T>(params.geom_size[b.geom]);
  const auto call = [&](auto&& collide_shapes) {
    found[0] = collide_shapes(size_A, X_WG[pair.a], size_B, X_WG[pair.b], margin);
    return std::size_t{1};
  };
  using enum ShapeType;
#define MANYHANDS_COLLIDE(function) return call([](const auto&... arguments) { return function<T>(arguments...); })
  switch (a.type) {
    case kSphere:
      if (b.type == kSphere) MANYHANDS_COLLIDE(collide_sphere_sphere);
      if (b.type == kCapsule) MANYHANDS_COLLIDE(collide_sphere_capsule);
      if (b.type == kCylinder) MANYHANDS_COLLIDE(collide_sphere_cylinder);
      if (b.type == kBox) MANYHANDS_COLLIDE(collide_sphere_box);
      if (b.type == kPlane) MANYHANDS_COLLIDE(collide_sphere_plane);
      break;
    case kCapsule:
      if (b.type == kCapsule) MANYHANDS_COLLIDE(collide_capsule_capsule);
      if (b.type == kBox) MANYHANDS_COLLIDE(collide_capsule_box);
      if (b.type == kPlane) MANYHANDS_COLLIDE(collide_capsule_plane);
      break;
    case kCylinder:
      if (b.type == kPlane) MANYHANDS_COLLIDE(collide_cylinder_plane);
      if (b.type == kBox) {
        return internal::collide_cylinder_box(colliders, pair, near, margin, size_A, X_WG[pair.a], size_B, X_WG[pair.b],
                                              found);
      }
      break;
    case kBox:
      if (b.type == kBox) MANYHANDS_COLLIDE(collide_box_box);
      if (b.type == kPlane) MANYHANDS_COLLIDE(collide_box_plane);
      break;
    default:
      break;
  }
#undef MANYHANDS_COLLIDE
  return internal::collide_lane_by_lane(colliders, pair, near, margin, size_A, X_WG[pair.a], size_B, X_WG[pair.b],
                                        found);
}

}  // namespace manyhands
