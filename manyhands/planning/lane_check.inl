// How LaneCheck looks. Included by lane_check.h.
#pragma once

#include "manyhands/planning/lane_check.h"

namespace manyhands {

template <Number T>
LaneCheck<T>::LaneCheck(const PlanningScene& scene)
    : scene_(scene),
      margin_(static_cast<float>(scene.margin)),
      ws_(scene.tree_in_float),
      origin_(scene.parts.size()),
      centre_(scene.parts.size()) {
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
  const float touching = x.bound.radius + y.bound.radius - margin_, reach = touching + sway;
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
      const float inner = a[k].inner + b[l].inner - margin_, reach = a[k].radius + b[l].radius - margin_ + sway;
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
