// The narrow phase of one pair: the function for its two shapes.
#pragma once

#include "manyhands/physics/collision/bounds_meet.h"
#include "manyhands/physics/collision/collide_box.h"
#include "manyhands/physics/collision/collide_box_box.h"
#include "manyhands/physics/collision/collide_capsule.h"
#include "manyhands/physics/collision/collide_cylinder.h"
#include "manyhands/physics/collision/collide_sphere.h"

namespace manyhands {

/// The pair's manifolds into `found`; how many there are. Lanes outside `near` may get anything.
template <Number T, Number P>
MANYHANDS_INLINE std::size_t collide_pair(const Colliders<real_t<T>>& colliders, const ColliderPair& pair,
                                          const Params<P>& params, mask_t<T> /*near*/, T margin,
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
      break;
    case kBox:
      if (b.type == kBox) MANYHANDS_COLLIDE(collide_box_box);
      if (b.type == kPlane) MANYHANDS_COLLIDE(collide_box_plane);
      break;
    default:
      break;
  }
#undef MANYHANDS_COLLIDE
  return 0;
}

}  // namespace manyhands
