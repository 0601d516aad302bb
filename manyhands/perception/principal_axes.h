// The directions in which points are spread.
#pragma once

#include "manyhands/perception/point_grid.h"

namespace manyhands {

struct PrincipalAxes {
  Point mean;
  Mat3<double> axes;  ///< unit columns, right-handed, of falling variance
  Point variance;     ///< along them [m^2]
};

/// Of the finite points, by Jacobi's rotations of their covariance. At least one must be finite.
[[nodiscard]] PrincipalAxes principal_axes(std::span<const Point> points);

}  // namespace manyhands
