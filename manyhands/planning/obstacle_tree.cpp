#include "manyhands/planning/obstacle_tree.h"

#include <algorithm>
#include <numeric>

#include "manyhands/physics/collision/broad/bounds.h"

namespace manyhands {

namespace {

using Vec = Vec3<double>;

constexpr std::size_t kPiecesOfLeaf = 4;  // pieces of a leaf, at most
constexpr double kBoxRounding = 1e-5;     // that boxes are larger by, for numbers in float [m]

bool is_turned(const Mat3<double>& R) { return R.x.x < 1 || R.y.y < 1 || R.z.z < 1; }

Vec low_of(const Vec& a, const Vec& b) { return {min(a.x, b.x), min(a.y, b.y), min(a.z, b.z)}; }
Vec high_of(const Vec& a, const Vec& b) { return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)}; }

ObstaclePiece piece_at(int owner, ShapeType type, const Vec& size, const Transform<double>& X_WG) {
  return {.type = type,
          .owner = owner,
          .turned = type != ShapeType::kSphere && is_turned(X_WG.R),
          .R_GW = broadcast<float>(transpose(X_WG.R)),
          .p_WG = broadcast<float>(X_WG.p),
          .size = broadcast<float>(size)};
}

}  // namespace

void ObstacleTree::add(int owner, const Shape& shape, const ConvexPolyhedron* hull, const Transform<double>& X_WG) {
  ObstaclePiece piece = piece_at(owner, shape.type, shape.size, X_WG);
  if (shape.type == ShapeType::kPlane) {
    endless_.push_back(piece);
    return;
  }
  if (shape.type != ShapeType::kConvex) {
    const Aabb<double> box = world_bounds(shape.type, shape.size, X_WG);
    add_bounded(piece, box.low, box.high);
    return;
  }
  piece.first_face = static_cast<int>(faces_.size());
  piece.faces = static_cast<int>(hull->planes.size());
  for (const FacePlane& plane : hull->planes)
    faces_.push_back({broadcast<float>(plane.normal), static_cast<float>(plane.offset)});
  Vec low = X_WG * hull->vertices[0], high = low;
  for (const Vec& vertex : hull->vertices) {
    const Vec p = X_WG * vertex;
    low = low_of(low, p);
    high = high_of(high, p);
  }
  add_bounded(piece, low, high);
}

void ObstacleTree::add_triangle(int owner, const std::array<Vec, 3>& corners) {
  const auto& [a, b, c] = corners;
  const Vec ab = b - a, ac = c - a;
  const double length = norm(ab);
  const Vec x = (1 / length) * ab, across = cross(ab, ac);
  const Vec z = (1 / norm(across)) * across;
  const Mat3<double> R_WG{x, cross(z, x), z};
  const Vec size{length, dot(x, ac), dot(R_WG.y, ac)};
  add_bounded(piece_at(owner, ShapeType::kMesh, size, {R_WG, a}), low_of(a, low_of(b, c)), high_of(a, high_of(b, c)));
}

void ObstacleTree::add_point(int owner, const Vec& p, double radius) {
  const Vec r{radius, radius, radius};
  add_bounded(piece_at(owner, ShapeType::kSphere, r, {Mat3<double>::identity(), p}), p - r, p + r);
}

void ObstacleTree::add_bounded(const ObstaclePiece& piece, const Vec& low, const Vec& high) {
  const Vec more{kBoxRounding, kBoxRounding, kBoxRounding};
  pieces_.push_back(piece);
  extents_.push_back({broadcast<float>(low - more), broadcast<float>(high + more)});
}

void ObstacleTree::build() {
  std::vector<int> order(pieces_.size());
  std::iota(order.begin(), order.end(), 0);
  nodes_.clear();
  if (!order.empty()) divide(order, 0);
  std::vector<ObstaclePiece> pieces;
  std::vector<Extent> extents;
  for (const int i : order) {
    pieces.push_back(pieces_[static_cast<std::size_t>(i)]);
    extents.push_back(extents_[static_cast<std::size_t>(i)]);
  }
  pieces_ = std::move(pieces);
  extents_ = std::move(extents);
}

/// Halves of `order`, the part of the whole that begins at `first`, by the middles of boxes along the longest side.
void ObstacleTree::divide(std::span<int> order, int first) {
  const std::size_t n = nodes_.size();
  const auto extent = [&](int i) -> const Extent& { return extents_[static_cast<std::size_t>(i)]; };
  Node node{.low = extent(order[0]).low, .high = extent(order[0]).high};
  for (const int i : order) {
    const auto& [low, high] = extent(i);
    node.low = {min(node.low.x, low.x), min(node.low.y, low.y), min(node.low.z, low.z)};
    node.high = {max(node.high.x, high.x), max(node.high.y, high.y), max(node.high.z, high.z)};
  }
  if (order.size() <= kPiecesOfLeaf) {
    node.first = first;
    node.count = static_cast<int>(order.size());
    nodes_.push_back(node);
    return;
  }
  nodes_.push_back(node);
  const Vec3<float> side = node.high - node.low;
  float Vec3<float>::* const axis = side.x >= side.y && side.x >= side.z ? &Vec3<float>::x
                                    : side.y >= side.z                   ? &Vec3<float>::y
                                                                         : &Vec3<float>::z;
  const auto middle = [&](int i) { return std::pair(extent(i).low.*axis + extent(i).high.*axis, i); };
  const auto half = static_cast<std::ptrdiff_t>(order.size() / 2);
  std::ranges::nth_element(order, order.begin() + half, {}, middle);
  divide(order.first(static_cast<std::size_t>(half)), first);
  nodes_[n].first = static_cast<int>(nodes_.size());
  divide(order.subspan(static_cast<std::size_t>(half)), first + static_cast<int>(half));
}

}  // namespace manyhands
