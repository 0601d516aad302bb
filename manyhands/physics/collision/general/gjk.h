// The Minkowski difference of two convex cores and the point of it that is nearest to the origin.
#pragma once

#include "manyhands/physics/collision/general/convex.h"

namespace manyhands {

/// The cores of two shapes, seen in A's frame.
struct CorePair {
  const ConvexShape& a;
  const ConvexShape& b;
  Transform<double> X_AB;

  /// The size of the problem [m]: what rounding errors and tolerances are relative to.
  [[nodiscard]] double scale() const { return a.bound() + b.bound(); }
};

/// A vertex of the Minkowski difference A - B.
struct MinkowskiVertex {
  Vec3<double> w;  ///< a - b
  Vec3<double> a;  ///< on A's core
};

/// The vertex of A - B farthest along d, in A's frame.
[[nodiscard]] MinkowskiVertex minkowski_support(const CorePair& pair, const Vec3<double>& d);

/// What GJK found. With `overlap`, the simplex holds the origin, or comes so near that its side is not known, to
/// rounding.
struct GjkResult {
  bool overlap = false;
  double distance{};      ///< between the cores [m]
  double lower_bound{};   ///< the cores are at least this far apart [m]
  Vec3<double> normal{};  ///< unit, from A to B, unless `overlap`
  Vec3<double> a{}, b{};  ///< the nearest points of the cores
  std::array<MinkowskiVertex, 4> simplex{};
  int size = 0;  ///< of the simplex
};

/// Nearest points of two cores (Gilbert, Johnson and Keerthi, A Fast Procedure for Computing the Distance Between
/// Complex Objects in Three-Dimensional Space, IEEE J. Robotics and Automation 1988). Stops early once the cores are
/// known to be more than `far` apart.
[[nodiscard]] GjkResult gjk(const CorePair& pair, double far);

}  // namespace manyhands
