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

/// From the nearest point of the segment from (ax, ay) along (dx, dy) to (x, y), in the plane z = 0.
template <Number T>
MANYHANDS_INLINE Vec3<T> offset_2d(T x, T y, float ax, float ay, float dx, float dy) {
  const T rx = x - T(ax), ry = y - T(ay);
  const T s = clamp(fma(rx, T(dx), ry * T(dy)) * T(1 / (dx * dx + dy * dy)), constant<T>(0), constant<T>(1));
  return {rx - s * T(dx), ry - s * T(dy), constant<T>(0)};
}

/// As `distance_from_triangle`, from the nearest point to p.
template <Number T>
MANYHANDS_INLINE Vec3<T> offset_from_triangle(const Vec3<float>& size, const Vec3<T>& p) {
  const float bx = size.x, cx = size.y, cy = size.z;
  const T zero = constant<T>(0);
  const T left_of_bc = fma(T(cx - bx), p.y, -(T(cy) * (p.x - T(bx))));
  const T left_of_ca = fma(T(cy), p.x, -(T(cx) * p.y));
  const mask_t<T> inside((p.y >= zero) & (left_of_bc >= zero) & (left_of_ca >= zero));
  Vec3<T> off = offset_2d(p.x, p.y, 0.0f, 0.0f, bx, 0.0f);
  for (const Vec3<T>& other : {offset_2d(p.x, p.y, bx, 0.0f, cx - bx, cy), offset_2d(p.x, p.y, 0.0f, 0.0f, cx, cy)}) {
    off = select(mask_t<T>(squared_norm(other) < squared_norm(off)), other, off);
  }
  return {select(inside, zero, off.x), select(inside, zero, off.y), p.z};
}

/// Of what lies within `radius` of a core, at `off` from the core's nearest point.
template <Number T>
MANYHANDS_INLINE Approach<T> approach_to_core(const Vec3<T>& off, T radius) {
  const T far = norm(off);
  return {far - radius, (constant<T>(1) / max(far, constant<T>(1e-9))) * off};
}

}  // namespace internal

template <Number T>
DistanceBounds<T> ObstacleTree::distance(const ObstaclePiece& piece, const Vec3<T>& p) const {
  const T zero = constant<T>(0);
  const Vec3<T> g = in_piece(piece, p);
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

template <Number T>
Approach<T> ObstacleTree::approach(const ObstaclePiece& piece, const Vec3<T>& p) const {
  Approach<T> found = approach_in_piece(piece, in_piece(piece, p));
  if (piece.turned) found.away = transpose_times(broadcast<T>(piece.R_GW), found.away);
  return found;
}

template <Number T>
Approach<T> ObstacleTree::approach_in_piece(const ObstaclePiece& piece, const Vec3<T>& g) const {
  const T zero = constant<T>(0), one = constant<T>(1), x(piece.size.x), y(piece.size.y);
  switch (piece.type) {
    case ShapeType::kSphere:
      return internal::approach_to_core(g, x);
    case ShapeType::kCapsule:
      return internal::approach_to_core(Vec3<T>{g.x, g.y, g.z - clamp(g.z, -y, y)}, x);
    case ShapeType::kCylinder: {
      const T across = sqrt(fma(g.x, g.x, g.y * g.y)), around = across - x, along = abs(g.z) - y;
      const Approach<T> outside = internal::approach_to_core(Vec3<T>{max(zero, around), zero, max(zero, along)}, zero);
      const mask_t<T> is_outside(outside.distance > zero), by_side(around >= along);
      const T out = select(is_outside, outside.away.x, select(by_side, one, zero)) / max(across, constant<T>(1e-9));
      const T up = select(is_outside, outside.away.z, select(by_side, zero, one));
      return {select(is_outside, outside.distance, max(around, along)), {out * g.x, out * g.y, copysign(up, g.z)}};
    }
    case ShapeType::kBox: {
      const Vec3<T> out{abs(g.x) - x, abs(g.y) - y, abs(g.z) - T(piece.size.z)};
      const T least = max(out.x, max(out.y, out.z));
      const Approach<T> outside =
          internal::approach_to_core(Vec3<T>{max(zero, out.x), max(zero, out.y), max(zero, out.z)}, zero);
      const mask_t<T> is_outside(outside.distance > zero), by_x(out.x == least), by_y((out.y == least) & !by_x);
      const Vec3<T> face{select(by_x, one, zero), select(by_y, one, zero), select(by_x | by_y, zero, one)};
      const Vec3<T> away = select(is_outside, outside.away, face);
      return {select(is_outside, outside.distance, least),
              {copysign(away.x, g.x), copysign(away.y, g.y), copysign(away.z, g.z)}};
    }
    case ShapeType::kPlane:
      return {g.z, {zero, zero, one}};
    case ShapeType::kConvex: {
      Approach<T> found{constant<T>(-1e9), Vec3<T>::zero()};
      for (int i = piece.first_face; i < piece.first_face + piece.faces; ++i) {
        const Face& face = faces_[static_cast<std::size_t>(i)];
        const Vec3<T> normal = broadcast<T>(face.normal);
        const T above = dot(normal, g) - T(face.offset);
        const mask_t<T> farther(above > found.distance);
        found = {select(farther, above, found.distance), select(farther, normal, found.away)};
      }
      return found;
    }
    default:
      return internal::approach_to_core(internal::offset_from_triangle(piece.size, g), zero);
  }
}

}  // namespace manyhands
