#include "manyhands/physics/collision/general/convex.h"

#include <algorithm>

#include "manyhands/base/assert.h"
#include "manyhands/model/support_vertex.h"

namespace manyhands {
namespace {

using Vec = Vec3<double>;

// Sine of the angle between feature and contact plane beyond which points of the feature count no more.
constexpr double kLying = 0.2;

void segment_feature(double half, const Vec& d, SupportingFeature& f) {
  if (std::abs(d.z) > kLying) {
    f.add({0, 0, std::copysign(half, d.z)});
  } else {
    f.add({0, 0, -half});
    f.add({0, 0, half});
  }
}

void triangle_feature(const std::array<Vec, 3>& corners, const Vec& d, SupportingFeature& f) {
  const Vec across = cross(corners[1] - corners[0], corners[2] - corners[0]);
  const double length = norm(across);
  if (const double along = dot(across, d); length > 0 && std::abs(along) > kLying * length) {
    f.normal = std::copysign(1 / length, along) * across;
    for (const Vec& p : corners) f.add(p);
    return;
  }
  std::array<std::size_t, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t i, std::size_t j) { return dot(corners[i], d) > dot(corners[j], d); });
  f.add(corners[order[0]]);
  const Vec edge = corners[order[1]] - corners[order[0]];
  if (std::abs(dot(edge, d)) < kLying * norm(edge)) f.add(corners[order[1]]);
}

void box_feature(const Vec& half, const Vec& d, SupportingFeature& f) {
  const double x = std::abs(d.x), y = std::abs(d.y), z = std::abs(d.z);
  constexpr std::array<std::array<double, 2>, 4> kSigns{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
  if (x >= y && x >= z) {
    const double a = std::copysign(half.x, d.x);
    f.normal = {std::copysign(1.0, d.x), 0, 0};
    for (const auto& [s, t] : kSigns) f.add({a, s * half.y, t * half.z});
  } else if (y >= z) {
    const double a = std::copysign(half.y, d.y);
    f.normal = {0, std::copysign(1.0, d.y), 0};
    for (const auto& [s, t] : kSigns) f.add({t * half.x, a, s * half.z});
  } else {
    const double a = std::copysign(half.z, d.z);
    f.normal = {0, 0, std::copysign(1.0, d.z)};
    for (const auto& [s, t] : kSigns) f.add({s * half.x, t * half.y, a});
  }
}

/// The octagon's corners stay where they are on the cap, so that a standing cylinder keeps its contacts; the
/// supporting point stands among them in the order of angles.
void cap_feature(double r, double half, const Vec& d, SupportingFeature& f) {
  constexpr double s = 0.70710678118654752440;
  constexpr std::array<std::array<double, 2>, 8> kCircle{
      {{1, 0}, {s, s}, {0, 1}, {-s, s}, {-1, 0}, {-s, -s}, {0, -1}, {s, -s}}};
  const double z = std::copysign(half, d.z), across = norm(Vec{d.x, d.y, 0});
  f.normal = {0, 0, std::copysign(1.0, d.z)};
  const bool tilted = across > 1e-9;
  const double ux = tilted ? d.x / across : 0, uy = tilted ? d.y / across : 0;
  for (std::size_t k = 0; k < 8; ++k) {
    const auto &a = kCircle[k], &b = kCircle[(k + 1) % 8];
    f.add({r * a[0], r * a[1], z});
    const bool between = a[0] * uy - a[1] * ux > 1e-9 && ux * b[1] - uy * b[0] > 1e-9;
    if (tilted && between) f.add({r * ux, r * uy, z});
  }
}

void cylinder_feature(double r, double half, const Vec& d, SupportingFeature& f) {
  const double across = norm(Vec{d.x, d.y, 0});
  if (std::abs(d.z) > across) return cap_feature(r, half, d, f);
  const double x = r * d.x / across, y = r * d.y / across;
  if (std::abs(d.z) > kLying) {
    f.add({x, y, std::copysign(half, d.z)});
  } else {
    f.add({x, y, -half});
    f.add({x, y, half});
  }
}

void hull_feature(const ConvexPolyhedron& hull, const Vec& d, SupportingFeature& f) {
  const std::size_t top = support_vertex(hull, d);
  const Vec p = hull.vertices[top];
  int best = -1;
  double turned = kLying;
  for (const int face : hull.faces_of[top]) {
    if (const double t = dot(hull.planes[static_cast<std::size_t>(face)].normal, d); t > turned) {
      best = face;
      turned = t;
    }
  }
  if (best >= 0) {
    const auto face = hull.faces[static_cast<std::size_t>(best)];
    f.normal = hull.planes[static_cast<std::size_t>(best)].normal;
    const std::size_t n = std::min(face.size(), kFeatureCorners);
    const auto at = static_cast<std::size_t>(std::find(face.begin(), face.end(), static_cast<int>(top)) - face.begin());
    for (std::size_t i = 0; i < n; ++i) {
      f.add(hull.vertices[static_cast<std::size_t>(face[(at + i * face.size() / n) % face.size()])]);
    }
    return;
  }
  f.add(p);
  double flattest = kLying;
  std::size_t other = top;
  for (const int n : hull.neighbours[top]) {
    const Vec edge = hull.vertices[static_cast<std::size_t>(n)] - p;
    if (const double slope = std::abs(dot(edge, d)) / norm(edge); slope < flattest) {
      flattest = slope;
      other = static_cast<std::size_t>(n);
    }
  }
  if (other != top) f.add(hull.vertices[other]);
}

}  // namespace

ConvexShape ConvexShape::of(ShapeType type, const Vec& size, const ConvexPolyhedron* hull) {
  switch (type) {
    case ShapeType::kSphere:
      return sphere(size.x);
    case ShapeType::kCapsule:
      return capsule(size.x, size.y);
    case ShapeType::kCylinder:
      return cylinder(size.x, size.y);
    case ShapeType::kBox:
      return box(size);
    default:
      MANYHANDS_ASSERT(type == ShapeType::kConvex && hull);
      return polyhedron(*hull);
  }
}

Vec ConvexShape::support(const Vec& d) const {
  switch (core) {
    case Core::kPoint:
      return Vec::zero();
    case Core::kSegment:
      return {0, 0, std::copysign(size.y, d.z)};
    case Core::kTriangle: {
      const double a = dot(corners[0], d), b = dot(corners[1], d), c = dot(corners[2], d);
      return corners[a >= b && a >= c ? 0 : b >= c ? 1 : 2];
    }
    case Core::kBox:
      return {std::copysign(size.x, d.x), std::copysign(size.y, d.y), std::copysign(size.z, d.z)};
    case Core::kCylinder: {
      const double across = std::sqrt(d.x * d.x + d.y * d.y), z = std::copysign(size.y, d.z);
      return across > 0 ? Vec{size.x / across * d.x, size.x / across * d.y, z} : Vec{size.x, 0, z};
    }
    case Core::kHull:
      break;
  }
  return hull->vertices[support_vertex(*hull, d)];
}

Vec ConvexShape::centre() const {
  if (core == Core::kTriangle) return (1.0 / 3) * (corners[0] + corners[1] + corners[2]);
  return core == Core::kHull ? hull->centre : Vec::zero();
}

double ConvexShape::bound() const {
  switch (core) {
    case Core::kPoint:
      return radius;
    case Core::kSegment:
      return radius + size.y;
    case Core::kTriangle:
      return std::max({norm(corners[0]), norm(corners[1]), norm(corners[2])});
    case Core::kBox:
      return norm(size);
    case Core::kCylinder:
      return norm(Vec{size.x, size.y, 0});
    case Core::kHull:
      break;
  }
  return hull->bound;
}

SupportingFeature supporting_feature(const ConvexShape& shape, const Vec& d) {
  SupportingFeature f;
  switch (shape.core) {
    case ConvexShape::Core::kPoint:
      f.add(Vec::zero());
      break;
    case ConvexShape::Core::kSegment:
      segment_feature(shape.size.y, d, f);
      break;
    case ConvexShape::Core::kTriangle:
      triangle_feature(shape.corners, d, f);
      break;
    case ConvexShape::Core::kBox:
      box_feature(shape.size, d, f);
      break;
    case ConvexShape::Core::kCylinder:
      cylinder_feature(shape.size.x, shape.size.y, d, f);
      break;
    case ConvexShape::Core::kHull:
      hull_feature(*shape.hull, d, f);
      break;
  }
  return f;
}

}  // namespace manyhands
