// Clipping and choosing contact points.
#pragma once

#include <span>
#include <vector>

#include "manyhands/physics/collision/general/convex.h"
#include "manyhands/physics/collision/manifold.h"

namespace manyhands {

struct ManifoldPoint {
  Vec3<double> p;  ///< midway between the surfaces [m]
  double phi;      ///< [m]
};

/// Room for the corners that two features share.
struct ManifoldPoints {
  std::array<ManifoldPoint, 2 * kFeatureCorners + 4> point;  ///< the first `size` of them
  std::size_t size = 0;

  void add(const ManifoldPoint& c) {
    if (size < point.size()) point[size++] = c;
  }
  [[nodiscard]] std::span<const ManifoldPoint> all() const { return {point.data(), size}; }
};

/// The corners of what two features share, seen along the unit normal; all in one frame. Heights along the normal are
/// those of the features, raised by `radius_a` and lowered by `radius_b`. None if
/// nothing is shared, neither feature is a face and they do not run side by side, or a face is seen edge on.
[[nodiscard]] ManifoldPoints clip_features(const SupportingFeature& a, const SupportingFeature& b,
                                           const Vec3<double>& normal, double radius_a, double radius_b);

/// The four points that keep the deepest and span the largest area across the normal; all of them if four or fewer.
[[nodiscard]] Manifold<double> choose_points(std::span<const ManifoldPoint> points, const Vec3<double>& normal);

}  // namespace manyhands
