// Inertia matrices as Python gives them.
#pragma once

#include <array>
#include <string>
#include <utility>

#include "bindings/model/model_values.h"
#include "manyhands/math/spatial.h"

namespace manyhands::bindings {

using Matrix3 = std::array<Numbers3, 3>;

/// Throws ModelError unless it is symmetric.
[[nodiscard]] inline SymMat3<double> symmetric(const std::string& what, const Matrix3& m) {
  for (const auto& [i, j] : {std::pair{0, 1}, std::pair{0, 2}, std::pair{1, 2}}) {
    const auto r = static_cast<std::size_t>(i), c = static_cast<std::size_t>(j);
    if (m[r][c] != m[c][r]) throw ModelError(what + ": the inertia matrix must be symmetric");
  }
  return {m[0][0], m[1][1], m[2][2], m[0][1], m[0][2], m[1][2]};
}

}  // namespace manyhands::bindings
