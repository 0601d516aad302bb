// Boxes around points.
#pragma once

#include "manyhands/perception/point_grid.h"

namespace manyhands {

struct OrientedBox {
  Transform<double> X_WB;  ///< of its centre, along its edges
  Point half_extents;      ///< [m]
};

/// A box that holds all finite points (n). Upright, it stands on its xy plane, which is level, and its outline is the
/// rectangle of least area (Freeman, Shapira, 1975), x the longer side; else its axes are the principal ones, x the
/// longest. Throws std::invalid_argument if there is no finite point.
[[nodiscard]] OrientedBox oriented_box(std::span<const Point> points, bool upright);

}  // namespace manyhands
