// Where a box is as good as the half-space behind one of its faces.
#pragma once

#include "manyhands/physics/collision/closed_form/collide_sphere.h"

namespace manyhands {

/// A face of a box as a half-space.
template <Number T>
struct FaceOfBox {
  mask_t<T> is_all;  ///< whether nothing else of the box counts
  Transform<T> X_W;  ///< its frame: z is the outward normal, the origin lies on it
};

/// The face of the box (half, X_WB) over which the sphere (p, radius) stands with its centre: nothing else of the box
/// counts for what is inside the sphere if the sphere's whole shadow falls on that face.
template <Number T>
[[nodiscard]] MANYHANDS_INLINE FaceOfBox<T> face_below(const Vec3<T>& p, T radius, const Vec3<T>& half,
                                                       const Transform<T>& X_WB) {
  const T zero(real_t<T>(0));
  const Vec3<T> d = transpose_times(X_WB.R, p - X_WB.p);
  const Vec3<T> room{half.x - abs(d.x), half.y - abs(d.y), half.z - abs(d.z)};
  const Mat3<T>& m = X_WB.R;
  FaceOfBox<T> face{mask_t<T>(false), X_WB};
  const auto consider = [&](T over, T side, T half_axis, const Vec3<T>& axis, T beside_1, T beside_2,
                            const Vec3<T>& x) {
    const auto is_it = (over < zero) & (beside_1 >= radius) & (beside_2 >= radius);
    const Vec3<T> normal = select(side < zero, -axis, axis);
    face.is_all = face.is_all | is_it;
    face.X_W.R = {select(is_it, x, face.X_W.R.x), select(is_it, cross(normal, x), face.X_W.R.y),
                  select(is_it, normal, face.X_W.R.z)};
    face.X_W.p = select(is_it, fma(half_axis, normal, X_WB.p), face.X_W.p);
  };
  consider(room.x, d.x, half.x, m.x, room.y, room.z, m.y);
  consider(room.y, d.y, half.y, m.y, room.z, room.x, m.z);
  consider(room.z, d.z, half.z, m.z, room.x, room.y, m.x);
  return face;
}

}  // namespace manyhands
