// Contact of convex shapes with planes, triangle meshes and height fields.
#pragma once

#include <span>

#include "manyhands/physics/collision/general/collide_convex.h"
#include "manyhands/physics/collision/surface/triangle_mesh.h"

namespace manyhands {

/// The contact with the half-space z <= 0 of frame P; the normal is P's -z.
template <Real R>
[[nodiscard]] Manifold<R> collide_plane(const ConvexShape& a, const Transform<R>& X_WA, const Transform<R>& X_WP,
                                        R margin);

/// The contacts with a mesh B: as many manifolds as differ in their normals, the deepest of them if `out` holds fewer.
/// Returns how many. Triangles push to their front only. A contact at an edge or a vertex counts if its normal lies
/// between those of the triangles there, so that what slides over flat ground feels none of its seams; otherwise the
/// triangle's own normal is taken where the shape is above the triangle (compare Jolt Physics, ActiveEdges).
template <Real R>
[[nodiscard]] int collide_mesh(const ConvexShape& a, const Transform<R>& X_WA, const TriangleMesh& mesh,
                               const Transform<R>& X_WB, R margin, std::span<Manifold<R>> out);

/// The same with a height field, the ground below which is solid: what is under the surface is pushed up.
template <Real R>
[[nodiscard]] int collide_height_field(const ConvexShape& a, const Transform<R>& X_WA, const HeightField& field,
                                       const Transform<R>& X_WB, R margin, std::span<Manifold<R>> out);

/// The box of a shape posed at X_BA, in B's axes.
[[nodiscard]] Bounds shape_bounds(const ConvexShape& a, const Transform<double>& X_BA);

}  // namespace manyhands
