// What it costs to be near something, with its gradient, of configurations one a lane: obstacles push links away.
#pragma once

#include <type_traits>
#include <vector>

#include "manyhands/physics/dynamics/kinematics.h"
#include "manyhands/planning/planning_scene.h"

namespace manyhands {

/// Every ball that stands for a part and is nearer than `clearance` to an obstacle costs, by the nearest piece, and so
/// does every pair of parts, by the nearest two balls. With e the distance that is missing, d clearance - e, a ball
/// costs
///
///   e^2 / (2 clearance) up to e = clearance,  e - clearance / 2 beyond       [m]
///
/// the obstacle cost of CHOMP (Zucker and others, CHOMP: Covariant Hamiltonian optimization for motion planning, Int.
/// J. Robotics Research 32(9-10), 2013, eq. 21). Its gradient by q is J^T f, f the force that pushes the ball away:
/// forces are summed up from the hand to the base as wrenches. Scratch of one thread; allocates nothing once it has
/// grown.
template <Number T>
class ClearanceCost {
 public:
  /// clearance: [m], from what balls stand for; these stick out by as much as the scene lets them.
  ClearanceCost(const PlanningScene& scene, double clearance);

  /// Of planned coordinate k in all lanes.
  [[nodiscard]] T& coordinate(std::size_t k) { return q_[scene_.coordinates[k]]; }
  /// The cost of the coordinates set [m].
  T evaluate();
  /// Of what was evaluated last, by planned coordinate k [m/rad or 1].
  [[nodiscard]] const T& gradient(std::size_t k) const { return gradient_[k]; }

 private:
  using R = real_t<T>;
  struct Hinge {
    T cost, slope;
  };
  /// Two balls of a pair: how far apart, and where.
  struct Nearest {
    T gap;
    Vec3<T> away, p_a, p_b;
  };

  [[nodiscard]] const Tree<R>& tree() const {
    if constexpr (std::is_same_v<R, double>)
      return scene_.tree;
    else
      return scene_.tree_in_float;
  }
  [[nodiscard]] static Hinge hinge(const T& gap, R band);
  [[nodiscard]] MANYHANDS_INLINE Vec3<T> placed(std::size_t part, const Vec3<float>& p) const {
    const std::size_t b = scene_.parts[part].body;
    return ws_.R_WB[b] * broadcast<T>(p) + ws_.p_OB[b] + ws_.p_WO[b];
  }
  void look_at_obstacles(std::size_t part);
  void look_at_node(std::size_t part, const BallNode& node, std::size_t first_piece);
  void look_at_balls(std::size_t part, const BallNode& leaf, std::size_t first_piece);
  void look_at_pair(const PartPair& pair);
  void find_nearest(const PartPair& pair, const BallNode& x, const BallNode& y, Nearest& nearest) const;
  void push(std::size_t part, const Vec3<T>& p, const Vec3<T>& force);
  void sum_up();

  const PlanningScene& scene_;
  R clearance_;
  Workspace<T> ws_;
  std::vector<T> q_;
  std::vector<std::size_t> dofs_, movers_;  // (n) of planned coordinates; the bodies that they move first
  std::vector<T> gradient_;                 // (n)
  T cost_{};
  std::vector<const ObstaclePiece*> pieces_;  // that are near a node, behind those near the nodes above it
};

}  // namespace manyhands

#include "manyhands/planning/clearance_cost.inl"
