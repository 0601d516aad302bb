// Convex shapes as the general collision engine sees them: a core and a radius about it.
#pragma once

#include <array>
#include <span>

#include "manyhands/model/convex_polyhedron.h"
#include "manyhands/model/description.h"

namespace manyhands {

/// All points within `radius` of a core. A sphere is a point with a radius and a capsule a segment with one, so that
/// their penetration shows as the distance of the cores. The engine computes in double for every number type: scalar
/// double costs what scalar float does, and slabs and needles need the digits.
struct ConvexShape {
  enum class Core { kPoint, kSegment, kTriangle, kBox, kCylinder, kHull };

  Core core = Core::kPoint;
  double radius = 0;                       ///< about the core [m]
  Vec3<double> size{};                     ///< box: half extents; cylinder: (r, half length); segment: (., half)
  std::array<Vec3<double>, 3> corners{};   ///< of a triangle
  const ConvexPolyhedron* hull = nullptr;  ///< outlives the shape

  [[nodiscard]] static ConvexShape sphere(double r) { return {.core = Core::kPoint, .radius = r}; }
  [[nodiscard]] static ConvexShape capsule(double r, double half) {
    return {.core = Core::kSegment, .radius = r, .size = {r, half, 0}};
  }
  [[nodiscard]] static ConvexShape cylinder(double r, double half) {
    return {.core = Core::kCylinder, .size = {r, half, 0}};
  }
  [[nodiscard]] static ConvexShape box(const Vec3<double>& half) { return {.core = Core::kBox, .size = half}; }
  [[nodiscard]] static ConvexShape polyhedron(const ConvexPolyhedron& hull) {
    return {.core = Core::kHull, .hull = &hull};
  }
  [[nodiscard]] static ConvexShape triangle(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c) {
    return {.core = Core::kTriangle, .corners = {a, b, c}};
  }
  /// A sphere, capsule, cylinder, box or, with its hull, convex mesh as described by type and size.
  [[nodiscard]] static ConvexShape of(ShapeType type, const Vec3<double>& size, const ConvexPolyhedron* hull = nullptr);

  /// A point of the core farthest along d, which need not be a unit vector; all in the shape's own frame.
  [[nodiscard]] Vec3<double> support(const Vec3<double>& d) const;
  /// A point deep in the core.
  [[nodiscard]] Vec3<double> centre() const;
  /// The radius of a ball about the frame's origin that holds the shape [m].
  [[nodiscard]] double bound() const;
};

/// The most corners that a supporting feature has; faces with more are thinned out.
inline constexpr std::size_t kFeatureCorners = 32;

/// The face, edge or vertex of a core that lies farthest along a direction.
struct SupportingFeature {
  std::array<Vec3<double>, kFeatureCorners> corner;  ///< the first `size` of them
  std::size_t size = 0;                              ///< corners: 1 a point, 2 a segment, more a convex polygon
  Vec3<double> normal{};                             ///< outward and unit, of a polygon

  void add(const Vec3<double>& p) { corner[size++] = p; }
};

/// The feature of the core that a contact with unit normal d rests on: the face that is turned to d the most, if it
/// holds the supporting point; a cylinder's cap as an octagon and the supporting point, its side as a segment.
[[nodiscard]] SupportingFeature supporting_feature(const ConvexShape& shape, const Vec3<double>& d);

}  // namespace manyhands
