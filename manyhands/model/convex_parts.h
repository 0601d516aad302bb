// Concave meshes that move, as several convex ones.
#pragma once

#include <map>
#include <vector>

#include "manyhands/model/model.h"

namespace manyhands {

/// The model with the parts of some meshes in their place: each geom that collides by such a mesh, on a body that
/// moves, becomes one convex geom for every part.
[[nodiscard]] Model with_convex_parts(const Model& model, const std::map<MeshId, std::vector<Mesh>>& parts);

}  // namespace manyhands
