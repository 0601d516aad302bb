// Convex hulls as meshes.
#pragma once

#include "manyhands/model/description.h"

namespace manyhands {

/// The surface of the convex hull of a mesh's vertices. Throws ModelError if they have no extent.
[[nodiscard]] Mesh hull_of(const Mesh& mesh);

}  // namespace manyhands
