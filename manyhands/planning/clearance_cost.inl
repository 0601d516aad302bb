// How ClearanceCost looks. Included by clearance_cost.h.
#pragma once

#include "manyhands/planning/clearance_cost.h"

namespace manyhands {

namespace internal {

// Links of one arm are always near their neighbours: they cost only where they all but touch [m].
inline constexpr double kClearanceOfLinks = 0.005;
// What is left out is farther away by this than what costs: so every lane sums up what it would alone [m].
inline constexpr float kBeyondClearance = 1e-4f;

}  // namespace internal

template <Number T>
ClearanceCost<T>::ClearanceCost(const PlanningScene& scene, double clearance)
    : scene_(scene), clearance_(static_cast<R>(clearance)), ws_(tree()), gradient_(scene.size()) {
  for (std::size_t k = 0; k < scene.size(); ++k) {
    const std::size_t dof = scene.dof(k);
    dofs_.push_back(dof);
    movers_.push_back(*std::ranges::find(scene.bodies, static_cast<int>(dof),
                                         [&](std::size_t b) { return scene.tree.bodies[b].iv; }));
  }
  q_ = place_scene(scene, tree(), ws_);
}

template <Number T>
T ClearanceCost<T>::evaluate() {
  for (const std::size_t b : scene_.bodies) {
    place(tree(), b, q_.data(), ws_);
    ws_.F[b] = Force<T>::zero();
  }
  cost_ = constant<T>(0);
  for (std::size_t i = 0; i < scene_.parts.size(); ++i) look_at_obstacles(i);
  for (const PartPair& pair : scene_.pairs) look_at_pair(pair);
  sum_up();
  return cost_;
}

/// Gradients are those of the cost: minus the force along each axis.
template <Number T>
void ClearanceCost<T>::sum_up() {
  for (std::size_t i = scene_.bodies.size(); i-- > 0;) {
    const std::size_t b = scene_.bodies[i], parent = static_cast<std::size_t>(tree().bodies[b].parent);
    ws_.F[parent] = ws_.F[parent] + ws_.F[b];
  }
  for (std::size_t k = 0; k < dofs_.size(); ++k) gradient_[k] = -dot(ws_.S[dofs_[k]], ws_.F[movers_[k]]);
}

template <Number T>
typename ClearanceCost<T>::Hinge ClearanceCost<T>::hinge(const T& gap, R band) {
  const T zero = constant<T>(0), missing = T(band) - gap, bent = clamp(missing, zero, T(band));
  return {fma(T(1 / (2 * band)), bent * bent, max(zero, missing - T(band))), bent * T(1 / band)};
}

template <Number T>
void ClearanceCost<T>::push(std::size_t i, const Vec3<T>& p, const Vec3<T>& force) {
  const std::size_t b = scene_.parts[i].body;
  ws_.F[b] = ws_.F[b] + Force<T>{cross(p - ws_.p_WO[b], force), force};
}

template <Number T>
void ClearanceCost<T>::look_at_obstacles(std::size_t i) {
  const MovingPart& part = scene_.parts[i];
  const ObstacleTree& tree = scene_.tree_of_obstacles;
  const PartBall& bound = part.nodes[0].bound;
  const Vec3<T> centre = placed(i, bound.centre);
  const T reach(static_cast<R>(bound.radius + internal::kBeyondClearance) + clearance_);
  pieces_.clear();
  const auto take = [&](std::span<const ObstaclePiece> pieces) {
    for (const ObstaclePiece& piece : pieces) {
      if (!std::ranges::binary_search(part.ignored, piece.owner)) pieces_.push_back(&piece);
    }
  };
  tree.visit_leaves(centre, reach, [&](int leaf) { take(tree.pieces_of(leaf)); });
  take(tree.endless());
  if (!pieces_.empty()) look_at_node(i, part.nodes[0], 0);
}

/// The pieces from `first_piece` on are near the node above.
template <Number T>
void ClearanceCost<T>::look_at_node(std::size_t i, const BallNode& node, std::size_t first_piece) {
  const Vec3<T> centre = placed(i, node.bound.centre);
  const T reach(static_cast<R>(node.bound.radius + internal::kBeyondClearance) + clearance_);
  const std::size_t own_first = pieces_.size();
  for (std::size_t k = first_piece; k < own_first; ++k) {
    if (any(mask_t<T>(scene_.tree_of_obstacles.distance(*pieces_[k], centre).low < reach)))
      pieces_.push_back(pieces_[k]);
  }
  if (pieces_.size() > own_first) {
    if (node.second == 0) {
      look_at_balls(i, node, own_first);
    } else {
      look_at_node(i, *(&node + 1), own_first);
      look_at_node(i, scene_.parts[i].nodes[node.second], own_first);
    }
  }
  pieces_.resize(own_first);
}

template <Number T>
void ClearanceCost<T>::look_at_balls(std::size_t i, const BallNode& leaf, std::size_t first_piece) {
  for (std::size_t k = leaf.first; k < leaf.last; ++k) {
    const PartBall& ball = scene_.parts[i].balls[k];
    const Vec3<T> p = placed(i, ball.centre);
    Approach<T> nearest{constant<T>(1e9), Vec3<T>::zero()};
    for (std::size_t j = first_piece; j < pieces_.size(); ++j) {
      const Approach<T> found = scene_.tree_of_obstacles.approach(*pieces_[j], p);
      const mask_t<T> nearer(found.distance < nearest.distance);
      nearest = {select(nearer, found.distance, nearest.distance), select(nearer, found.away, nearest.away)};
    }
    const Hinge found = hinge(nearest.distance - T(ball.radius), clearance_);
    cost_ += found.cost;
    push(i, p, found.slope * nearest.away);
  }
}

template <Number T>
void ClearanceCost<T>::look_at_pair(const PartPair& pair) {
  constexpr R band = static_cast<R>(internal::kClearanceOfLinks);
  Nearest nearest{constant<T>(1e9), Vec3<T>::zero(), Vec3<T>::zero(), Vec3<T>::zero()};
  find_nearest(pair, scene_.parts[pair.a].nodes[0], scene_.parts[pair.b].nodes[0], nearest);
  // Both balls stick out; so that neighbours do not push each other all the time, as if neither did.
  const Hinge found = hinge(nearest.gap + T(static_cast<R>(2 * scene_.overshoot)), band);
  if (none(mask_t<T>(found.slope > constant<T>(0)))) return;
  cost_ += found.cost;
  push(pair.a, nearest.p_a, found.slope * nearest.away);
  push(pair.b, nearest.p_b, -found.slope * nearest.away);
}

/// Descends both trees, the larger ball first; `away` points from b to a.
template <Number T>
void ClearanceCost<T>::find_nearest(const PartPair& pair, const BallNode& x, const BallNode& y,
                                    Nearest& nearest) const {
  const auto margin = static_cast<float>(scene_.margin);  // each ball has it: two together have it once too often
  const auto touching = [&](const PartBall& a, const PartBall& b) {
    return T(static_cast<R>(a.radius + b.radius - margin));
  };
  const Vec3<T> apart = placed(pair.a, x.bound.centre) - placed(pair.b, y.bound.centre);
  const T reach = touching(x.bound, y.bound) + T(static_cast<R>(internal::kClearanceOfLinks - 2 * scene_.overshoot +
                                                                static_cast<double>(internal::kBeyondClearance)));
  if (none(mask_t<T>((reach > constant<T>(0)) & (squared_norm(apart) < reach * reach)))) return;
  const std::vector<BallNode>&nodes_a = scene_.parts[pair.a].nodes, &nodes_b = scene_.parts[pair.b].nodes;
  if (y.second != 0 && (x.second == 0 || x.bound.radius <= y.bound.radius)) {
    for (const BallNode* child : {&y + 1, &nodes_b[y.second]}) find_nearest(pair, x, *child, nearest);
  } else if (x.second != 0) {
    for (const BallNode* child : {&x + 1, &nodes_a[x.second]}) find_nearest(pair, *child, y, nearest);
  } else {
    for (std::size_t k = x.first; k < x.last; ++k) {
      const PartBall& a = scene_.parts[pair.a].balls[k];
      const Vec3<T> p_a = placed(pair.a, a.centre);
      for (std::size_t l = y.first; l < y.last; ++l) {
        const PartBall& b = scene_.parts[pair.b].balls[l];
        const Vec3<T> p_b = placed(pair.b, b.centre);
        const Approach<T> found = internal::approach_to_core(p_a - p_b, touching(a, b));
        const mask_t<T> nearer(found.distance < nearest.gap);
        nearest = {select(nearer, found.distance, nearest.gap), select(nearer, found.away, nearest.away),
                   select(nearer, p_a, nearest.p_a), select(nearer, p_b, nearest.p_b)};
      }
    }
  }
}

}  // namespace manyhands
