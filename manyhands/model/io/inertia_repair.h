// The nearest inertia that a rigid body can have.
#pragma once

#include <optional>
#include <string>

#include "manyhands/model/description.h"

namespace manyhands::io {

/// Checks that `inertial` can belong to a rigid body: mass not negative, inertia positive semi-definite, and each
/// principal moment at most the sum of the other two (within 1e-6 of the largest). If not, makes the smallest change
/// (in the Frobenius norm) that repairs it and returns what was wrong and what was done; else returns nothing.
[[nodiscard]] std::optional<std::string> repair_inertial(Inertial& inertial);

/// Raises principal moments below `least` to it.
void bound_principal_moments(SymMat3<double>& inertia, double least);

/// The point nearest to `moments` with 0 <= each <= the sum of the other two.
[[nodiscard]] Vec3<double> nearest_principal_moments(const Vec3<double>& moments);

}  // namespace manyhands::io
