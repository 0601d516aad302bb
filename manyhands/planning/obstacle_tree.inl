// How lanes descend the tree, and how far they are from its pieces. Included by obstacle_tree.h.
#pragma once

#include "manyhands/planning/obstacle_tree.h"

namespace manyhands {

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
