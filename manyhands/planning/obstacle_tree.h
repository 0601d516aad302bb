// Obstacles as a tree of boxes that all lanes descend together: a lane is a configuration.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "manyhands/math/vec3.h"
#include "manyhands/model/convex_polyhedron.h"
#include "manyhands/model/description.h"

namespace manyhands {

/// A piece of an obstacle, in its own frame G. A mesh or height field is many pieces of type kMesh, one for each
/// triangle: in the plane z = 0, corners (0, 0), (size.x, 0) and (size.y, size.z). A point of a cloud is a sphere.
struct ObstaclePiece {
  ShapeType type{};
  int owner{};    ///< the obstacle it belongs to
  bool turned{};  ///< whether its axes differ from the world's
  Mat3<float> R_GW = Mat3<float>::identity();
  Vec3<float> p_WG{};           ///< [m]
  Vec3<float> size{};           ///< as Shape::size
  int first_face{}, faces = 0;  ///< of a convex hull, in ObstacleTree::faces
};

/// How far a point is from a piece: between the two [m]. Within a solid both are 0 or less.
template <Number T>
struct DistanceBounds {
  T low, high;
};

class ObstacleTree {
 public:
  /// Adds a shape of obstacle `owner` at X_WG; not a mesh or height field, whose triangles are added one by one.
  void add(int owner, const Shape& shape, const ConvexPolyhedron* hull, const Transform<double>& X_WG);
  void add_triangle(int owner, const std::array<Vec3<double>, 3>& corners);
  void add_point(int owner, const Vec3<double>& p, double radius);
  /// After the last piece.
  void build();

  [[nodiscard]] std::span<const ObstaclePiece> pieces() const { return pieces_; }
  /// What has no bounds: planes. Their pieces.
  [[nodiscard]] std::span<const ObstaclePiece> endless() const { return endless_; }

  /// Calls visit(leaf) for each leaf whose box is within `reach` of p in some lane.
  template <Number T, class Visit>
  void visit_leaves(const Vec3<T>& p, T reach, Visit&& visit) const;
  [[nodiscard]] std::span<const ObstaclePiece> pieces_of(int leaf) const {
    const Node& node = nodes_[static_cast<std::size_t>(leaf)];
    return std::span(pieces_).subspan(static_cast<std::size_t>(node.first), static_cast<std::size_t>(node.count));
  }
  template <Number T>
  [[nodiscard]] DistanceBounds<T> distance(const ObstaclePiece& piece, const Vec3<T>& p) const;

 private:
  struct Node {
    Vec3<float> low{}, high{};
    int first = 0;  // piece of a leaf; second child of an inner node, whose first child follows it
    int count = 0;  // pieces of a leaf, else 0

    template <Number T>
    [[nodiscard]] MANYHANDS_INLINE mask_t<T> is_near(const Vec3<T>& p, T reach) const {
      const T zero = constant<T>(0);
      const Vec3<T> gap{max(zero, max(T(low.x) - p.x, p.x - T(high.x))),
                        max(zero, max(T(low.y) - p.y, p.y - T(high.y))),
                        max(zero, max(T(low.z) - p.z, p.z - T(high.z)))};
      return squared_norm(gap) <= reach * reach;
    }
  };
  struct Extent {
    Vec3<float> low, high;
  };
  struct Face {
    Vec3<float> normal;
    float offset;
  };

  void add_bounded(const ObstaclePiece& piece, const Vec3<double>& low, const Vec3<double>& high);
  void divide(std::span<int> order, int first);

  std::vector<ObstaclePiece> pieces_, endless_;
  std::vector<Extent> extents_;  // of pieces, until the tree is built
  std::vector<Face> faces_;
  std::vector<Node> nodes_;
};

template <Number T, class Visit>
void ObstacleTree::visit_leaves(const Vec3<T>& p, T reach, Visit&& visit) const {
  if (nodes_.empty()) return;
  std::array<int, 64> stack{};  // the tree is balanced: 64 levels would need 2^64 pieces
  int top = 1;
  while (top > 0) {
    const int n = stack[static_cast<std::size_t>(--top)];
    const Node& node = nodes_[static_cast<std::size_t>(n)];
    if (!any(node.is_near(p, reach))) continue;
    if (node.count > 0) {
      visit(n);
    } else {
      stack[static_cast<std::size_t>(top++)] = node.first;
      stack[static_cast<std::size_t>(top++)] = n + 1;
    }
  }
}

namespace internal {

/// Square of the distance of (x, y) from the segment from (ax, ay) along (dx, dy).
template <Number T>
MANYHANDS_INLINE T squared_distance_2d(T x, T y, float ax, float ay, float dx, float dy) {
  const T rx = x - T(ax), ry = y - T(ay);
  const T s = clamp(fma(rx, T(dx), ry * T(dy)) * T(1 / (dx * dx + dy * dy)), constant<T>(0), constant<T>(1));
  const T ex = rx - s * T(dx), ey = ry - s * T(dy);
  return fma(ex, ex, ey * ey);
}

/// Distance from a triangle in the plane z = 0, see ObstaclePiece.
template <Number T>
MANYHANDS_INLINE T distance_from_triangle(const Vec3<float>& size, const Vec3<T>& p) {
  const float bx = size.x, cx = size.y, cy = size.z;  // counter-clockwise: cy > 0
  const T zero = constant<T>(0);
  const T left_of_bc = fma(T(cx - bx), p.y, -(T(cy) * (p.x - T(bx))));
  const T left_of_ca = fma(T(cy), p.x, -(T(cx) * p.y));
  const mask_t<T> inside((p.y >= zero) & (left_of_bc >= zero) & (left_of_ca >= zero));
  const T edges =
      min(squared_distance_2d(p.x, p.y, 0.0f, 0.0f, bx, 0.0f),
          min(squared_distance_2d(p.x, p.y, bx, 0.0f, cx - bx, cy), squared_distance_2d(p.x, p.y, 0.0f, 0.0f, cx, cy)));
  return sqrt(fma(p.z, p.z, select(inside, zero, edges)));
}

}  // namespace internal

template <Number T>
DistanceBounds<T> ObstacleTree::distance(const ObstaclePiece& piece, const Vec3<T>& p) const {
  const T zero = constant<T>(0);
  const Vec3<T> shifted = p - broadcast<T>(piece.p_WG);
  const Vec3<T> g = piece.turned ? broadcast<T>(piece.R_GW) * shifted : shifted;
  const T x(piece.size.x), y(piece.size.y);
  const auto exact = [](T d) { return DistanceBounds<T>{d, d}; };
  switch (piece.type) {
    case ShapeType::kSphere:
      return exact(norm(g) - x);
    case ShapeType::kCapsule:
      return exact(norm(Vec3<T>{g.x, g.y, g.z - clamp(g.z, -y, y)}) - x);
    case ShapeType::kCylinder: {
      const T around = max(zero, sqrt(fma(g.x, g.x, g.y * g.y)) - x), along = max(zero, abs(g.z) - y);
      return exact(sqrt(fma(around, around, along * along)));
    }
    case ShapeType::kBox:
      return exact(
          norm(Vec3<T>{max(zero, abs(g.x) - x), max(zero, abs(g.y) - y), max(zero, abs(g.z) - T(piece.size.z))}));
    case ShapeType::kPlane:
      return exact(g.z);
    case ShapeType::kConvex: {
      T low = constant<T>(-1e9);
      for (int i = piece.first_face; i < piece.first_face + piece.faces; ++i) {
        const Face& face = faces_[static_cast<std::size_t>(i)];
        low = max(low, dot(broadcast<T>(face.normal), g) - T(face.offset));
      }
      return {low, select(low <= zero, low, constant<T>(1e9))};
    }
    default:
      return exact(internal::distance_from_triangle(piece.size, g));
  }
}

}  // namespace manyhands
