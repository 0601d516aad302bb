// Balls that together hold shapes: what a planner checks in place of a link.
#pragma once

#include <span>
#include <vector>

#include "manyhands/physics/collision/general/convex.h"

namespace manyhands {

/// A ball of a cover, in the axes of the shapes' common frame.
struct Ball {
  Vec3<double> centre{};  ///< [m]
  double radius{};        ///< within which it covers [m]
  double inner{};         ///< a ball of this radius about the centre lies within one of the shapes; negative: none [m]
};

/// A convex shape at a pose.
struct PlacedConvex {
  ConvexShape shape;
  Transform<double> X;
};

/// Balls whose union holds every point of every shape, and sticks out of their union by `overshoot` [m] or less, as far
/// as cells of a hundredth of a shape's extent can tell.
///
/// Shapes are cut into cells, small ones at the surface. Candidates are centred in cells and reach `overshoot` beyond
/// the shape that they are deepest in; the one that holds most cells that no other holds yet is taken until all are
/// held (the greedy set cover: Chvatal, A greedy heuristic for the set-covering problem, 1979).
[[nodiscard]] std::vector<Ball> cover_with_balls(std::span<const PlacedConvex> shapes, double overshoot);

/// How deep p lies in the shape, exact within; negative outside, where it bounds the distance from below [m].
[[nodiscard]] double depth_within(const ConvexShape& shape, const Vec3<double>& p);

}  // namespace manyhands
