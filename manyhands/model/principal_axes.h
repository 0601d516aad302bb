// Principal axes of inertias, in the order and with the signs that MuJoCo gives them.
#pragma once

#include "manyhands/math/quaternion.h"
#include "manyhands/math/spatial.h"

namespace manyhands {

struct PrincipalAxes {
  Mat3<double> R = Mat3<double>::identity();  ///< the axes as columns
  Vec3<double> moments{};                     ///< falling
};

/// By Jacobi's method from the axes it is given in: what is diagonal already is only put in order, by quarter turns.
/// Where moments are equal, axes are a convention; this is MuJoCo's (mju_eig3).
[[nodiscard]] PrincipalAxes principal_axes(const SymMat3<double>& inertia);

}  // namespace manyhands
