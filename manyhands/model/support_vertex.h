// The vertex of a convex polyhedron that lies farthest along a direction.
#pragma once

#include "manyhands/model/convex_polyhedron.h"

namespace manyhands {

/// A vertex farthest along d, which need not be a unit vector: in small hulls by a look at each, in others by a climb
/// along edges from the vertex that `hull.support` knows for directions like d. Depends on the hull and d alone. Any
/// vertex where d is zero or not finite.
[[nodiscard]] std::size_t support_vertex(const ConvexPolyhedron& hull, const Vec3<double>& d);

/// ConvexPolyhedron::support of a hull whose vertices and neighbours are known.
[[nodiscard]] SupportTable support_table(const ConvexPolyhedron& hull);

}  // namespace manyhands
