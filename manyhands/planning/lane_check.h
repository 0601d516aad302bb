// Whether configurations are free of collision, one a lane, by balls.
#pragma once

#include <span>
#include <vector>

#include "manyhands/physics/dynamics/kinematics.h"
#include "manyhands/planning/planning_scene.h"

namespace manyhands {

/// Above it a look asks for the balls of groups alone what is near: the way is halved anyhow [m].
inline constexpr float kCoarseSway = 0.02f;

/// By how much a part may move about where it is placed [m]: of each part, and of each pair relative to each other.
struct Sways {
  std::vector<float> part, pair;
};

/// Two things that balls cannot tell apart in some lanes: a part and an obstacle, or both parts of a pair.
template <Number T>
struct Doubt {
  int part = -1, obstacle = -1;  ///< or
  int pair = -1;
  mask_t<T> lanes{};
};

/// Places the moving parts in every lane, and looks at them. Scratch of one thread; allocates nothing once it has
/// grown.
template <Number T>
class LaneCheck {
 public:
  explicit LaneCheck(const PlanningScene& scene);

  /// Of planned coordinate k in all lanes.
  [[nodiscard]] T& coordinate(std::size_t k) { return q_[scene_.coordinates[k]]; }

  /// Looks at the configurations set: `hit` are the lanes that collide for certain, by balls within the shapes;
  /// `doubtful` those in which balls, grown by the sways, may meet. In all others nothing meets. Looks no further once
  /// a lane of `wanted` is hit.
  void look(const Sways& sways, const mask_t<T>& wanted);

  [[nodiscard]] const mask_t<T>& hit() const { return hit_; }
  [[nodiscard]] const mask_t<T>& doubtful() const { return doubtful_; }
  /// What the doubts are about, where sways are below kCoarseSway.
  [[nodiscard]] std::span<const Doubt<T>> doubts() const { return doubts_; }

 private:
  void place_parts();
  void look_at_obstacles(std::size_t part, float sway);
  void look_at_node(std::size_t part, const BallNode& node, std::size_t first_piece, float sway);
  void look_at_balls(std::size_t part, const BallNode& leaf, std::size_t first_piece, float sway);
  void look_at_nodes(std::size_t pair, const BallNode& x, const BallNode& y, const Vec3<T>& p_x, const Vec3<T>& p_y,
                     float sway);
  void look_at_balls(std::size_t pair, const BallNode& x, const BallNode& y, float sway);
  void doubt(const Doubt<T>& found);

  [[nodiscard]] MANYHANDS_INLINE Vec3<T> placed(std::size_t part, const PartBall& ball) const {
    const std::size_t b = scene_.parts[part].body;
    return ws_.R_WB[b] * broadcast<T>(ball.centre) + origin_[part];
  }
  [[nodiscard]] static MANYHANDS_INLINE mask_t<T> meet(const Vec3<T>& a, const Vec3<T>& b, float reach) {
    return mask_t<T>(squared_norm(a - b) < T(reach * reach));
  }

  const PlanningScene& scene_;
  Workspace<T> ws_;
  std::vector<T> q_;
  std::vector<Vec3<T>> origin_, centre_;      // (parts) of the body, and of the ball that holds the part, in the world
  std::vector<const ObstaclePiece*> pieces_;  // that are near a node, behind those near the nodes above it
  mask_t<T> hit_{}, doubtful_{};
  std::vector<Doubt<T>> doubts_;
};

template <Number T>
LaneCheck<T>::LaneCheck(const PlanningScene& scene)
    : scene_(scene), ws_(scene.tree_in_float), origin_(scene.parts.size()), centre_(scene.parts.size()) {
  for (const double x : scene.q) q_.push_back(constant<T>(x));
  std::vector<T> mocap;
  for (const double x : scene.mocap) mocap.push_back(constant<T>(x));
  place_mocap(scene.tree_in_float, mocap.data(), ws_);
  forward_kinematics(scene.tree_in_float, q_.data(), ws_);
}

template <Number T>
void LaneCheck<T>::look(const Sways& sways, const mask_t<T>& wanted) {
  place_parts();
  hit_ = doubtful_ = mask_t<T>(false);
  doubts_.clear();
  // What collides is most often at the end of the arm.
  for (std::size_t i = scene_.parts.size(); i > 0 && none(hit_ & wanted); --i)
    look_at_obstacles(i - 1, sways.part[i - 1]);
  for (std::size_t i = 0; i < scene_.pairs.size() && none(hit_ & wanted); ++i) {
    const PartPair& pair = scene_.pairs[i];
    look_at_nodes(i, scene_.parts[pair.a].nodes[0], scene_.parts[pair.b].nodes[0], centre_[pair.a], centre_[pair.b],
                  sways.pair[i]);
  }
}

template <Number T>
void LaneCheck<T>::place_parts() {
  for (const std::size_t b : scene_.bodies) place(scene_.tree_in_float, b, q_.data(), ws_);
  for (std::size_t i = 0; i < scene_.parts.size(); ++i) {
    const MovingPart& part = scene_.parts[i];
    origin_[i] = ws_.p_OB[part.body] + ws_.p_WO[part.body];
    centre_[i] = placed(i, part.nodes[0].bound);
  }
}

template <Number T>
void LaneCheck<T>::look_at_obstacles(std::size_t i, float sway) {
  const MovingPart& part = scene_.parts[i];
  const ObstacleTree& tree = scene_.tree_of_obstacles;
  const T reach(part.nodes[0].bound.radius + sway);
  pieces_.clear();
  const auto take_near = [&](std::span<const ObstaclePiece> pieces) {
    for (const ObstaclePiece& piece : pieces) {
      if (std::ranges::binary_search(part.ignored, piece.owner)) continue;
      if (any(mask_t<T>(tree.distance(piece, centre_[i]).low < reach))) pieces_.push_back(&piece);
    }
  };
  tree.visit_leaves(centre_[i], reach, [&](int leaf) { take_near(tree.pieces_of(leaf)); });
  take_near(tree.endless());
  if (!pieces_.empty()) look_at_node(i, part.nodes[0], 0, sway);
}

/// The pieces from `first_piece` on are near the node above.
template <Number T>
void LaneCheck<T>::look_at_node(std::size_t i, const BallNode& node, std::size_t first_piece, float sway) {
  const Vec3<T> centre = placed(i, node.bound);
  const T reach(node.bound.radius + sway), certain(node.bound.radius);
  const bool is_coarse = sway > kCoarseSway, is_leaf = node.second == 0;
  const std::size_t own_first = pieces_.size();
  for (std::size_t k = first_piece; k < own_first; ++k) {
    const T low = scene_.tree_of_obstacles.distance(*pieces_[k], centre).low;
    const mask_t<T> near(low < reach);
    if (none(near)) continue;
    if (is_coarse) {
      // Small balls tell no more beside a large sway; no more is to be learnt of lanes that are in doubt already.
      if (is_leaf || node.bound.radius < sway) doubtful_ = doubtful_ | near;
      if (none(near & !doubtful_) && none(mask_t<T>(low < certain))) continue;
    }
    pieces_.push_back(pieces_[k]);
  }
  if (pieces_.size() > own_first) {
    if (is_leaf) {
      look_at_balls(i, node, own_first, sway);
    } else {
      const std::vector<BallNode>& nodes = scene_.parts[i].nodes;
      look_at_node(i, *(&node + 1), own_first, sway);
      look_at_node(i, nodes[node.second], own_first, sway);
    }
  }
  pieces_.resize(own_first);
}

template <Number T>
void LaneCheck<T>::look_at_balls(std::size_t i, const BallNode& leaf, std::size_t first_piece, float sway) {
  for (std::size_t k = leaf.first; k < leaf.last; ++k) {
    const PartBall& ball = scene_.parts[i].balls[k];
    const Vec3<T> p = placed(i, ball);
    for (std::size_t j = first_piece; j < pieces_.size(); ++j) {
      const DistanceBounds<T> distance = scene_.tree_of_obstacles.distance(*pieces_[j], p);
      hit_ = hit_ | mask_t<T>(distance.high < T(ball.inner));
      if (sway > kCoarseSway) continue;
      const mask_t<T> near(distance.low < T(ball.radius + sway));
      if (any(near)) doubt({.part = static_cast<int>(i), .obstacle = pieces_[j]->owner, .lanes = near});
    }
  }
}

/// Descends both trees, the larger ball first.
template <Number T>
void LaneCheck<T>::look_at_nodes(std::size_t i, const BallNode& x, const BallNode& y, const Vec3<T>& p_x,
                                 const Vec3<T>& p_y, float sway) {
  const float touching = x.bound.radius + y.bound.radius, reach = touching + sway;
  const T apart = squared_norm(p_x - p_y);
  const mask_t<T> near(apart < T(reach * reach));
  if (none(near)) return;
  const bool are_leaves = x.second == 0 && y.second == 0;
  if (sway > kCoarseSway) {
    if (are_leaves || touching < 2 * sway) doubtful_ = doubtful_ | near;
    if (none(near & !doubtful_) && none(mask_t<T>(apart < T(touching * touching)))) return;
  }
  if (are_leaves) {
    look_at_balls(i, x, y, sway);
    return;
  }
  const PartPair& pair = scene_.pairs[i];
  if (y.second == 0 || (x.second != 0 && x.bound.radius > y.bound.radius)) {
    for (const BallNode* child : {&x + 1, &scene_.parts[pair.a].nodes[x.second]})
      look_at_nodes(i, *child, y, placed(pair.a, child->bound), p_y, sway);
  } else {
    for (const BallNode* child : {&y + 1, &scene_.parts[pair.b].nodes[y.second]})
      look_at_nodes(i, x, *child, p_x, placed(pair.b, child->bound), sway);
  }
}

template <Number T>
void LaneCheck<T>::look_at_balls(std::size_t i, const BallNode& x, const BallNode& y, float sway) {
  const PartPair& pair = scene_.pairs[i];
  const std::vector<PartBall>&a = scene_.parts[pair.a].balls, &b = scene_.parts[pair.b].balls;
  for (std::size_t k = x.first; k < x.last; ++k) {
    const Vec3<T> p = placed(pair.a, a[k]);
    for (std::size_t l = y.first; l < y.last; ++l) {
      const T apart = squared_norm(p - placed(pair.b, b[l]));
      const float inner = a[k].inner + b[l].inner, reach = a[k].radius + b[l].radius + sway;
      if (inner > 0) hit_ = hit_ | mask_t<T>(apart < T(inner * inner));
      if (sway > kCoarseSway) continue;
      const mask_t<T> near(apart < T(reach * reach));
      if (any(near)) doubt({.pair = static_cast<int>(i), .lanes = near});
    }
  }
}

/// Adds lanes to the doubt of the same two things, which is among the last.
template <Number T>
void LaneCheck<T>::doubt(const Doubt<T>& found) {
  doubtful_ = doubtful_ | found.lanes;
  for (std::size_t k = doubts_.size(); k > 0; --k) {
    Doubt<T>& known = doubts_[k - 1];
    if (known.part != found.part || known.pair != found.pair) break;
    if (known.obstacle != found.obstacle) continue;
    known.lanes = known.lanes | found.lanes;
    return;
  }
  doubts_.push_back(found);
}

}  // namespace manyhands
