// Where a line passes through shapes.
#pragma once

#include <span>
#include <vector>

#include "manyhands/physics/collision/general/shape_view.h"

namespace manyhands {

/// A shape at a pose; what it points to outlives it.
struct PlacedShape {
  ShapeView shape{};
  Transform<double> X = Transform<double>::identity();
};

/// A stretch of a line within shapes: it enters at t = from and leaves at t = to.
struct Crossing {
  double from{}, to{};                  ///< [m]
  Vec3<double> normal_from, normal_to;  ///< unit, outwards
};

/// Where o + t d, d a unit vector, |t| <= reach [m], lies within any of the shapes, in rising order. Stretches that
/// meet are one. Solids are convex shapes and closed meshes, whose inside is what an odd number of triangles lies
/// before; the line begins and ends outside of them.
[[nodiscard]] std::vector<Crossing> crossings(std::span<const PlacedShape> shapes, const Vec3<double>& o,
                                              const Vec3<double>& d, double reach);

}  // namespace manyhands
