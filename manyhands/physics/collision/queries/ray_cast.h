// Where a ray meets a shape.
#pragma once

#include <optional>

#include "manyhands/physics/collision/general/shape_view.h"

namespace manyhands {

template <Real R>
struct RayHit {
  R distance{};      ///< along the ray [m]
  Vec3<R> normal{};  ///< unit, of the surface, against the ray
};

/// The first point of a shape at X_WG on the ray from `origin` along the unit vector `direction`, no farther than
/// `far` [m]; none if it is missed. A ray that starts inside a solid meets it at 0, head on. Triangles of a mesh are
/// met from both sides. All in the axes of W.
template <Real R>
[[nodiscard]] std::optional<RayHit<R>> ray_cast(const ShapeView& shape, const Transform<R>& X_WG, const Vec3<R>& origin,
                                                const Vec3<R>& direction, R far);

}  // namespace manyhands
