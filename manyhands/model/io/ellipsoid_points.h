// Ellipsoids as hulls.
#pragma once

#include "manyhands/model/description.h"

namespace manyhands::io {

/// 162 points on the ellipsoid with these half axes [m], as a mesh without triangles: an icosahedron, its triangles cut
/// into four twice.
[[nodiscard]] Mesh points_on_ellipsoid(const Vec3<double>& half_axes);

}  // namespace manyhands::io
