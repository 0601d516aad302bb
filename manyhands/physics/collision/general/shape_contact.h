// The contact of two shapes outside of any model, by the code that a world's step runs.
#pragma once

#include <array>

#include "manyhands/physics/collision/general/collision_shape.h"
#include "manyhands/physics/collision/manifold.h"

namespace manyhands {

/// Manifolds of one pair of shapes, the normals from A to B; points that are none have an infinite phi.
template <Real R>
struct ShapeContact {
  std::array<Manifold<R>, 4> manifolds{};
  std::size_t size = 0;  ///< how many of them there are: more than one against meshes and height fields only
};

/// Where two shapes are at most `margin` [m] apart: what the narrow phase of a step with number type R finds, and with
/// float what each of its lanes finds. Throws std::invalid_argument for two of plane, mesh and height field, which no
/// step looks at, and unless margin is finite and 0 or more.
template <Real R>
[[nodiscard]] ShapeContact<R> shape_contact(const CollisionShape& a, const Transform<R>& X_WA, const CollisionShape& b,
                                            const Transform<R>& X_WB, R margin);

}  // namespace manyhands
