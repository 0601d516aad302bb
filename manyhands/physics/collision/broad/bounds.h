// Boxes and spheres around shapes.
#pragma once

#include "manyhands/math/vec3.h"
#include "manyhands/model/description.h"

namespace manyhands {

/// The box between two corners, along the axes of the frame in which they are given; a plane's is without end.
template <Number T>
struct Aabb {
  Vec3<T> low, high;  ///< [m]
};

template <Number T>
MANYHANDS_INLINE mask_t<T> overlap(const Aabb<T>& a, const Aabb<T>& b) {
  return mask_t<T>((a.low.x <= b.high.x) & (b.low.x <= a.high.x) & (a.low.y <= b.high.y) & (b.low.y <= a.high.y) &
                   (a.low.z <= b.high.z) & (b.low.z <= a.high.z));
}

/// Larger by `margin` on every side.
template <Number T>
MANYHANDS_INLINE Aabb<T> grown(const Aabb<T>& a, T margin) {
  const Vec3<T> m{margin, margin, margin};
  return {a.low - m, a.high + m};
}

/// The half extents of a shape's box about the origin, in the shape's own frame; infinite for planes. `size` as in
/// Shape. Of meshes, hulls and height fields `size` holds the half extents, which their owner knows.
template <Number T>
MANYHANDS_INLINE Vec3<T> half_extents(ShapeType type, const Vec3<T>& size) {
  const T endless(std::numeric_limits<real_t<T>>::infinity());
  switch (type) {
    case ShapeType::kSphere:
      return {size.x, size.x, size.x};
    case ShapeType::kCapsule:
      return {size.x, size.x, size.x + size.y};
    case ShapeType::kCylinder:
      return {size.x, size.x, size.y};
    case ShapeType::kPlane:
      return {endless, endless, endless};
    default:
      return size;
  }
}

/// The radius of the sphere about the origin that holds the shape [m]; infinite for planes.
template <Number T>
MANYHANDS_INLINE T bounding_radius(ShapeType type, const Vec3<T>& size) {
  switch (type) {
    case ShapeType::kSphere:
      return size.x;
    case ShapeType::kCapsule:
      return size.x + size.y;
    case ShapeType::kCylinder:
      return sqrt(fma(size.x, size.x, size.y * size.y));
    case ShapeType::kPlane:
      return T(std::numeric_limits<real_t<T>>::infinity());
    default:
      return norm(size);
  }
}

/// The smallest box along the world's axes around the shape at X_WG; without end around planes.
template <Number T>
MANYHANDS_INLINE Aabb<T> world_bounds(ShapeType type, const Vec3<T>& size, const Transform<T>& X_WG) {
  const Vec3<T>&x = X_WG.R.x, &y = X_WG.R.y, &z = X_WG.R.z;
  Vec3<T> reach;
  switch (type) {
    case ShapeType::kSphere:
    case ShapeType::kPlane:
      reach = half_extents(type, size);
      break;
    case ShapeType::kCapsule: {
      const T r = size.x;
      reach = {fma(size.y, abs(z.x), r), fma(size.y, abs(z.y), r), fma(size.y, abs(z.z), r)};
      break;
    }
    case ShapeType::kCylinder: {
      // A disc of radius r across the unit vector z reaches r sqrt(1 - z_i^2) along axis i.
      const auto along = [&](T x_i, T y_i, T z_i) {
        return fma(size.y, abs(z_i), size.x * sqrt(fma(x_i, x_i, y_i * y_i)));
      };
      reach = {along(x.x, y.x, z.x), along(x.y, y.y, z.y), along(x.z, y.z, z.z)};
      break;
    }
    default: {
      const auto along = [&](T x_i, T y_i, T z_i) {
        return fma(size.x, abs(x_i), fma(size.y, abs(y_i), size.z * abs(z_i)));
      };
      reach = {along(x.x, y.x, z.x), along(x.y, y.y, z.y), along(x.z, y.z, z.z)};
      break;
    }
  }
  return {X_WG.p - reach, X_WG.p + reach};
}

}  // namespace manyhands
