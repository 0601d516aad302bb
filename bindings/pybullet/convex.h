// Convex parts of concave meshes, which the Python package makes.
#pragma once

#include <vector>

#include "manyhands/model/description.h"

namespace manyhands::pybullet {

/// The parts by manyhands.decomposition; none, with a warning, where what it needs is not installed, and none where
/// the hull will do. Raises PythonError.
[[nodiscard]] std::vector<Mesh> convex_parts(const Mesh& mesh);

}  // namespace manyhands::pybullet
