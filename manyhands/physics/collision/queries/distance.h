// The distance of any two shapes.
#pragma once

#include "manyhands/physics/collision/general/collide_convex.h"
#include "manyhands/physics/collision/general/shape_view.h"

namespace manyhands {

/// The signed distance of two shapes of any types, with the nearest points, or the deepest where they overlap.
///
/// - Planes are half-spaces, and the ground of a height field is solid below its grid; a mesh is a surface, so that a
///   shape within a closed one is as far from it as from the nearest triangle.
/// - Overlapping a mesh, the depth is that in the triangle it is deepest in; below a height field, that of its deepest
///   contact (`collide_height_field`): a bound of how far it must move, exact in one triangle's reach.
/// - Two planes overlap without end (phi is minus infinity) unless they face each other.
template <Real R>
[[nodiscard]] ShapeDistance<R> signed_distance(const ShapeView& a, const Transform<R>& X_WA, const ShapeView& b,
                                               const Transform<R>& X_WB);

}  // namespace manyhands
