// How LaneCheck looks. Included by lane_check.h.
#pragma once

#include "manyhands/planning/lane_check.h"

namespace manyhands {

template <Number T>
LaneCheck<T>::LaneCheck(const PlanningScene& scene)
    : scene_(scene),
      margin_(static_cast<float>(scene.margin)),
      ws_(scene.tree_in_float),
      v_(static_cast<std::size_t>(scene.tree_in_float.nv), constant<T>(0)),
      origin_(scene.parts.size()),
      centre_(scene.parts.size()) {
  for (std::size_t k = 0; k < scene.size(); ++k) dofs_.push_back(scene.dof(k));
  q_ = place_scene(scene, scene.tree_in_float, ws_);
  consider_all();
}

template <Number T>
void LaneCheck<T>::consider_all() {
  consider_parts();
  pairs_.resize(scene_.pairs.size());
  std::iota(pairs_.begin(), pairs_.end(), std::size_t{0});
}

template <Number T>
void LaneCheck<T>::consider_parts() {
  parts_.resize(scene_.parts.size());
  // What collides is most often at the end of the arm.
  for (std::size_t i = 0; i < parts_.size(); ++i) parts_[i] = parts_.size() - 1 - i;
  pairs_.clear();
  near_parts_.clear();
  near_pairs_.clear();
}

template <Number T>
void LaneCheck<T>::consider_pairs(std::span<const std::size_t> pairs) {
  pairs_.assign(pairs.begin(), pairs.end());
  parts_.clear();
  near_parts_.clear();
  near_pairs_.clear();
}

template <Number T>
void LaneCheck<T>::consider_what_is_near() {
  const auto take = [](std::vector<std::size_t>& near, std::vector<std::size_t>& considered) {
    std::erase_if(considered, [&](std::size_t i) { return std::ranges::find(near, i) == near.end(); });
    near.clear();
  };
  take(near_parts_, parts_);
  take(near_pairs_, pairs_);
}

template <Number T>
void LaneCheck<T>::look(const Sways& sways, const mask_t<T>& wanted) {
  sways_ = &sways;
  place_parts();
  hit_ = undecided_ = doubtful_ = mask_t<T>(false);
  doubts_.clear();
  const auto look_at_each = [&](const std::vector<std::size_t>& considered, std::vector<std::size_t>& near,
                                void (LaneCheck::*look_at)(std::size_t)) {
    for (const std::size_t i : considered) {
      if (any(hit_ & wanted)) return;
      is_near_ = false;
      (this->*look_at)(i);
      if (is_near_) near.push_back(i);
    }
  };
  look_at_each(parts_, near_parts_, &LaneCheck::look_at_obstacles);
  look_at_each(pairs_, near_pairs_, &LaneCheck::look_at_pair);
}

template <Number T>
void LaneCheck<T>::place_parts() {
  for (const std::size_t b : scene_.bodies) {
    place(scene_.tree_in_float, b, q_.data(), ws_);
    move(scene_.tree_in_float, b, v_.data(), ws_);
  }
  for (std::size_t i = 0; i < scene_.parts.size(); ++i) {
    const MovingPart& part = scene_.parts[i];
    origin_[i] = ws_.p_OB[part.body] + ws_.p_WO[part.body];
    centre_[i] = placed(i, part.nodes[0].bound.centre);
  }
}

template <Number T>
T LaneCheck<T>::sway(float rate, float bend, const T& speed) const {
  const float dt = sways_->dt;
  return min(T(rate * dt), fma(speed, T(dt), T(bend * dt * dt)));
}

/// No point of the part is faster, seen from the body.
template <Number T>
T LaneCheck<T>::speed(std::size_t i, std::size_t relative_to) const {
  const MovingPart& part = scene_.parts[i];
  const auto at_centre = [&](std::size_t b) {
    const Motion<T>& V = ws_.V[b];
    return V.v + cross(V.w, centre_[i] - ws_.p_WO[b]);
  };
  const Vec3<T> w = ws_.V[part.body].w - ws_.V[relative_to].w;
  return fma(norm(w), T(part.nodes[0].bound.radius), norm(at_centre(part.body) - at_centre(relative_to)));
}

/// Things are near in some lanes; `fine` are sways below which smaller balls tell more. Whether they do in any lane
/// that is not undecided already.
template <Number T>
bool LaneCheck<T>::leaves_open(const mask_t<T>& near, float fine) {
  const mask_t<T> of_interest = near & asked_;
  undecided_ = undecided_ | (of_interest & mask_t<T>(sway_ > T(fine)));
  is_near_ = is_near_ || any(of_interest & undecided_);
  return any(of_interest & !undecided_);
}

template <Number T>
void LaneCheck<T>::look_at_obstacles(std::size_t i) {
  const MovingPart& part = scene_.parts[i];
  const ObstacleTree& tree = scene_.tree_of_obstacles;
  sway_ = sway(sways_->part_rate[i], sways_->part_bend[i], speed(i, 0));
  asked_ = mask_t<T>(true);
  const T reach = sway_ + T(part.nodes[0].bound.radius);
  pieces_.clear();
  const auto take_near = [&](std::span<const ObstaclePiece> pieces) {
    for (const ObstaclePiece& piece : pieces) {
      if (std::ranges::binary_search(part.ignored, piece.owner)) continue;
      if (any(mask_t<T>(tree.distance(piece, centre_[i]).low < reach))) pieces_.push_back(&piece);
    }
  };
  tree.visit_leaves(centre_[i], reach, [&](int leaf) { take_near(tree.pieces_of(leaf)); });
  take_near(tree.endless());
  if (!pieces_.empty()) look_at_node(i, part.nodes[0], 0);
}

/// The pieces from `first_piece` on are near the node above.
template <Number T>
void LaneCheck<T>::look_at_node(std::size_t i, const BallNode& node, std::size_t first_piece) {
  const Vec3<T> centre = placed(i, node.bound.centre);
  const T reach = sway_ + T(node.bound.radius), certain(node.bound.radius);
  const bool is_leaf = node.second == 0;
  const float fine = is_leaf ? kCoarseSway : max(kCoarseSway, node.bound.radius);
  const std::size_t own_first = pieces_.size();
  for (std::size_t k = first_piece; k < own_first; ++k) {
    const T low = scene_.tree_of_obstacles.distance(*pieces_[k], centre).low;
    const mask_t<T> near(low < reach);
    if (none(near)) continue;
    if (leaves_open(near, fine) || any(mask_t<T>(low < certain))) pieces_.push_back(pieces_[k]);
  }
  if (pieces_.size() > own_first) {
    if (is_leaf) {
      look_at_balls(i, node, own_first);
    } else {
      const std::vector<BallNode>& nodes = scene_.parts[i].nodes;
      look_at_node(i, *(&node + 1), own_first);
      look_at_node(i, nodes[node.second], own_first);
    }
  }
  pieces_.resize(own_first);
}

template <Number T>
void LaneCheck<T>::look_at_balls(std::size_t i, const BallNode& leaf, std::size_t first_piece) {
  for (std::size_t k = leaf.first; k < leaf.last; ++k) {
    const PartBall& ball = scene_.parts[i].balls[k];
    const Vec3<T> p = placed(i, ball.centre);
    const T reach = sway_ + T(ball.radius);
    for (std::size_t j = first_piece; j < pieces_.size(); ++j) {
      const DistanceBounds<T> distance = scene_.tree_of_obstacles.distance(*pieces_[j], p);
      hit_ = hit_ | mask_t<T>(distance.high < T(ball.inner));
      const mask_t<T> near(distance.low < reach);
      if (any(near) && leaves_open(near, kWorthExact))
        doubt({.part = static_cast<int>(i), .obstacle = pieces_[j]->owner, .lanes = near, .sway = sway_});
    }
  }
}

/// Of the segments of both capsules. Between segments that are nearly parallel the nearest points are found to within
/// kCapsuleRounding of their distance.
template <Number T>
T LaneCheck<T>::squared_distance_of_axes(std::size_t i, std::size_t j) const {
  const PartCapsule &x = scene_.parts[i].capsule, &y = scene_.parts[j].capsule;
  constexpr float kParallel = 1e-6f, kShort = 1e-12f;  // of the square of the sine, and of a length [m^2]
  const float xx = max(kShort, squared_norm(x.b - x.a)), yy = max(kShort, squared_norm(y.b - y.a));
  const Vec3<T> x_a = placed(i, x.a), y_a = placed(j, y.a);
  const Vec3<T> u = placed(i, x.b) - x_a, v = placed(j, y.b) - y_a, w = x_a - y_a;
  const T zero = constant<T>(0), one = constant<T>(1), uv = dot(u, v), uw = dot(u, w), vw = dot(v, w);
  const T lines = fma(uv, vw, -(uw * T(yy))) / max(T(kParallel * xx * yy), T(xx * yy) - uv * uv);
  const T t = clamp(fma(uv, clamp(lines, zero, one), vw) * T(1 / yy), zero, one);
  const T s = clamp(fma(uv, t, -uw) * T(1 / xx), zero, one);
  return squared_norm(w + s * u - t * v);
}

template <Number T>
void LaneCheck<T>::look_at_pair(std::size_t i) {
  constexpr float kCapsuleRounding = 0.5e-3f;  // [m]
  const PartPair& pair = scene_.pairs[i];
  const MovingPart &a = scene_.parts[pair.a], &b = scene_.parts[pair.b];
  const float touching = a.nodes[0].bound.radius + b.nodes[0].bound.radius - margin_;
  const float most = touching + sways_->pair_rate[i] * sways_->dt;
  if (none(mask_t<T>(squared_norm(centre_[pair.a] - centre_[pair.b]) < T(most * most)))) return;
  sway_ = sway(sways_->pair_rate[i], sways_->pair_bend[i], speed(pair.b, a.body));
  const T reach = sway_ + T(a.capsule.radius + b.capsule.radius - margin_ + kCapsuleRounding);
  asked_ = mask_t<T>(squared_distance_of_axes(pair.a, pair.b) < reach * reach);
  if (any(asked_)) look_at_nodes(i, a.nodes[0], b.nodes[0], centre_[pair.a], centre_[pair.b]);
}

/// Descends both trees, the larger ball first.
template <Number T>
void LaneCheck<T>::look_at_nodes(std::size_t i, const BallNode& x, const BallNode& y, const Vec3<T>& p_x,
                                 const Vec3<T>& p_y) {
  const float touching = x.bound.radius + y.bound.radius - margin_;
  const T apart = squared_norm(p_x - p_y), reach = sway_ + T(touching);
  const mask_t<T> near(apart < reach * reach);
  if (none(near)) return;
  const bool are_leaves = x.second == 0 && y.second == 0;
  const float fine = are_leaves ? kCoarseSway : max(kCoarseSway, touching / 2);
  if (!leaves_open(near, fine)) return;
  if (are_leaves) {
    look_at_balls(i, x, y);
    return;
  }
  const PartPair& pair = scene_.pairs[i];
  if (y.second == 0 || (x.second != 0 && x.bound.radius > y.bound.radius)) {
    for (const BallNode* child : {&x + 1, &scene_.parts[pair.a].nodes[x.second]})
      look_at_nodes(i, *child, y, placed(pair.a, child->bound.centre), p_y);
  } else {
    for (const BallNode* child : {&y + 1, &scene_.parts[pair.b].nodes[y.second]})
      look_at_nodes(i, x, *child, p_x, placed(pair.b, child->bound.centre));
  }
}

template <Number T>
void LaneCheck<T>::look_at_balls(std::size_t i, const BallNode& x, const BallNode& y) {
  const PartPair& pair = scene_.pairs[i];
  const std::vector<PartBall>&a = scene_.parts[pair.a].balls, &b = scene_.parts[pair.b].balls;
  for (std::size_t k = x.first; k < x.last; ++k) {
    const Vec3<T> p = placed(pair.a, a[k].centre);
    for (std::size_t l = y.first; l < y.last; ++l) {
      const T apart = squared_norm(p - placed(pair.b, b[l].centre));
      const float inner = a[k].inner + b[l].inner - margin_;
      if (inner > 0) hit_ = hit_ | mask_t<T>(apart < T(inner * inner));
      const T reach = sway_ + T(a[k].radius + b[l].radius - margin_);
      const mask_t<T> near(apart < reach * reach);
      if (any(near) && leaves_open(near, kWorthExact))
        doubt({.pair = static_cast<int>(i), .lanes = mask_t<T>(near & asked_), .sway = sway_});
    }
  }
}

/// Adds lanes to the doubt of the same two things, which is among the last.
template <Number T>
void LaneCheck<T>::doubt(const Doubt<T>& found) {
  doubtful_ = doubtful_ | found.lanes;
  is_near_ = true;
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
