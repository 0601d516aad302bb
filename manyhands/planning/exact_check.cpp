#include "manyhands/planning/exact_check.h"

#include <algorithm>
#include <limits>

#include "manyhands/physics/dynamics/kinematics.h"

namespace manyhands::internal {

namespace {

/// No more than the distance of two shapes: of the ball that holds one from a plane or a box, or from the other's ball.
double least_distance(const SceneGeom& a, const Transform<double>& X_WA, const SceneGeom& b,
                      const Transform<double>& X_WB) {
  const Vec3<double> apart = X_WA.p - X_WB.p;
  if (b.shape.type == ShapeType::kPlane) return dot(X_WB.R.z, apart) - a.radius;
  if (b.shape.type != ShapeType::kBox) return norm(apart) - a.radius - b.radius;
  const Vec3<double> p = transpose_times(X_WB.R, apart), &half = b.shape.size;
  const Vec3<double> out{abs(p.x) - half.x, abs(p.y) - half.y, abs(p.z) - half.z};
  const double inside = min(0.0, max(out.x, max(out.y, out.z)));
  return norm(Vec3<double>{max(0.0, out.x), max(0.0, out.y), max(0.0, out.z)}) + inside - a.radius;
}

}  // namespace

ExactCheck::ExactCheck(const PlanningScene& scene)
    : scene_(scene), ws_(scene.tree), q_(place_scene(scene, scene.tree, ws_)) {}

void ExactCheck::place(std::span<const double> planned) {
  for (std::size_t k = 0; k < planned.size(); ++k) q_[scene_.coordinates[k]] = planned[k];
  for (const std::size_t b : scene_.bodies) manyhands::place(scene_.tree, b, q_.data(), ws_);
}

Transform<double> ExactCheck::pose(const MovingPart& part, const SceneGeom& geom) const {
  return body_pose(part.body, ws_) * geom.X_BG;
}

void ExactCheck::take_nearer(const SceneGeom& a, const Transform<double>& X_WA, const SceneGeom& b,
                             const Transform<double>& X_WB, double& least) const {
  if (!(least_distance(a, X_WA, b, X_WB) < least)) return;
  // Of convex bodies the search for the nearest points ends once they are known to be farther apart than asked.
  const bool are_convex = a.shape.is_convex_body() && b.shape.is_convex_body();
  const double d =
      are_convex ? core_distance(a.shape.convex(), b.shape.convex(), inverse(X_WA) * X_WB, std::max(0.0, least)).phi
                 : signed_distance(a.shape, X_WA, b.shape, X_WB).phi;
  least = std::min(least, d);
}

double ExactCheck::distance(int part_index, int obstacle, double far) const {
  const MovingPart& part = scene_.parts[static_cast<std::size_t>(part_index)];
  double least = far;
  const auto i = static_cast<std::size_t>(obstacle);
  if (i < scene_.obstacles.size()) {
    const SceneGeom& geom = scene_.obstacles[i].geom;
    for (const SceneGeom& own : part.geoms) take_nearer(own, pose(part, own), geom, geom.X_BG, least);
    return least;
  }
  return distance_from_cloud(part, obstacle, least);
}

double ExactCheck::distance_from_cloud(const MovingPart& part, int cloud, double far) const {
  double least = far;
  const PartBall& bound = part.nodes[0].bound;
  const Vec3<double> centre =
      ws_.R_WB[part.body] * broadcast<double>(bound.centre) + ws_.p_OB[part.body] + ws_.p_WO[part.body];
  const ObstacleTree& tree = scene_.tree_of_obstacles;
  tree.visit_leaves(centre, static_cast<double>(bound.radius) + far, [&](int leaf) {
    for (const ObstaclePiece& piece : tree.pieces_of(leaf)) {
      if (piece.owner != cloud) continue;
      const Transform<double> X_WP{Mat3<double>::identity(), broadcast<double>(piece.p_WG)};
      const SceneGeom ball{.shape = {.type = ShapeType::kSphere, .size = broadcast<double>(piece.size)},
                           .radius = static_cast<double>(piece.size.x)};
      for (const SceneGeom& own : part.geoms) take_nearer(own, pose(part, own), ball, X_WP, least);
    }
  });
  return least;
}

double ExactCheck::distance(const PartPair& pair, double far) const {
  double least = far;
  const MovingPart &a = scene_.parts[pair.a], &b = scene_.parts[pair.b];
  for (const SceneGeom& x : a.geoms) {
    for (const SceneGeom& y : b.geoms) take_nearer(x, pose(a, x), y, pose(b, y), least);
  }
  return least;
}

Encounter ExactCheck::nearest(double far) const {
  Encounter found{.distance = far};
  int owners = static_cast<int>(scene_.obstacles.size());
  for (const ObstaclePiece& piece : scene_.tree_of_obstacles.pieces()) owners = std::max(owners, piece.owner + 1);
  for (std::size_t k = 0; k < scene_.parts.size(); ++k) {
    const MovingPart& part = scene_.parts[k];
    for (int i = 0; i < owners; ++i) {
      if (std::ranges::binary_search(part.ignored, i)) continue;
      const double d = distance(static_cast<int>(k), i, found.distance);
      if (d < found.distance) found = {scene_.link_name(part.link), name_of(i), d};
    }
  }
  for (const std::vector<PartPair>* pairs : {&scene_.pairs, &scene_.pairs_apart}) {
    for (const PartPair& pair : *pairs) {
      const double d = distance(pair, found.distance);
      if (d < found.distance)
        found = {scene_.link_name(scene_.parts[pair.a].link), scene_.link_name(scene_.parts[pair.b].link), d};
    }
  }
  return found;
}

std::string ExactCheck::name_of(int obstacle) const {
  const auto i = static_cast<std::size_t>(obstacle);
  if (i < scene_.obstacles.size()) return scene_.link_name(scene_.obstacles[i].link);
  return "cloud " + std::to_string(i - scene_.obstacles.size());
}

}  // namespace manyhands::internal
