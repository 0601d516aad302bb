// Whether configurations are free of collision, one a lane, by balls.
#pragma once

#include <algorithm>
#include <numeric>
#include <span>
#include <vector>

#include "manyhands/physics/dynamics/kinematics.h"
#include "manyhands/planning/planning_scene.h"

namespace manyhands {

/// Above it a look asks for the balls of groups alone what is near: the way is halved anyhow [m].
inline constexpr float kCoarseSway = 0.02f;
/// Below it what balls leave in doubt is worth exact distances; above it the way is halved [m].
inline constexpr float kWorthExact = 0.01f;

/// How far parts may move about where they are placed, while `t` changes by `dt` to either side: `rate` dt, wherever
/// they are; or their speed there times dt, and `bend` dt^2 for how the speed changes. The smaller of both holds. Of
/// each part [m per unit of t], and of each pair, of one relative to the other.
struct Sways {
  float dt = 0;
  std::vector<float> part_rate{}, pair_rate{}, part_bend{}, pair_bend{};
};

/// Two things that balls cannot tell apart in some lanes: a part and an obstacle, or both parts of a pair.
template <Number T>
struct Doubt {
  int part = -1, obstacle = -1;  ///< or
  int pair = -1;
  mask_t<T> lanes{};
  T sway{};  ///< of the part, or of the pair [m]
};

/// Places the moving parts in every lane, and looks at them. Scratch of one thread; allocates nothing once it has
/// grown.
template <Number T>
class LaneCheck {
 public:
  explicit LaneCheck(const PlanningScene& scene);

  /// Of planned coordinate k in all lanes.
  [[nodiscard]] T& coordinate(std::size_t k) { return q_[scene_.coordinates[k]]; }
  /// How fast it changes per unit of t.
  [[nodiscard]] T& slope(std::size_t k) { return v_[dofs_[k]]; }

  /// Which things are looked at: at first all parts, beside obstacles, and all pairs; or either; or of those that were
  /// looked at so far the ones that were not clear in some look since the last call of any.
  void consider_all();
  void consider_parts();
  void consider_pairs(std::span<const std::size_t> pairs);
  void consider_what_is_near();

  /// Looks at the configurations set: `hit` are the lanes that collide for certain, by balls within the shapes. In
  /// lanes that are neither that nor `undecided`, nor in a doubt, nothing meets within the sways. Looks no further once
  /// a lane of `wanted` is hit.
  void look(const Sways& sways, const mask_t<T>& wanted);

  [[nodiscard]] const mask_t<T>& hit() const { return hit_; }
  /// Lanes in which things may meet whose sways are too large to ask exactly.
  [[nodiscard]] const mask_t<T>& undecided() const { return undecided_; }
  /// What balls leave in doubt in the other lanes, and the lanes of all these doubts.
  [[nodiscard]] std::span<const Doubt<T>> doubts() const { return doubts_; }
  [[nodiscard]] const mask_t<T>& doubtful() const { return doubtful_; }

 private:
  void place_parts();
  [[nodiscard]] T sway(float rate, float bend, const T& speed) const;
  [[nodiscard]] T speed(std::size_t part, std::size_t relative_to) const;
  [[nodiscard]] T squared_distance_of_axes(std::size_t part, std::size_t other) const;
  void look_at_obstacles(std::size_t part);
  void look_at_node(std::size_t part, const BallNode& node, std::size_t first_piece);
  void look_at_balls(std::size_t part, const BallNode& leaf, std::size_t first_piece);
  void look_at_pair(std::size_t pair);
  void look_at_nodes(std::size_t pair, const BallNode& x, const BallNode& y, const Vec3<T>& p_x, const Vec3<T>& p_y);
  void look_at_balls(std::size_t pair, const BallNode& x, const BallNode& y);
  [[nodiscard]] bool leaves_open(const mask_t<T>& near, float fine);
  void doubt(const Doubt<T>& found);

  [[nodiscard]] MANYHANDS_INLINE Vec3<T> placed(std::size_t part, const Vec3<float>& p) const {
    const std::size_t b = scene_.parts[part].body;
    return ws_.R_WB[b] * broadcast<T>(p) + origin_[part];
  }

  const PlanningScene& scene_;
  float margin_;  // each ball has it: two together have it once too often
  Workspace<T> ws_;
  std::vector<T> q_, v_;
  std::vector<std::size_t> dofs_;         // (n) of planned coordinates, in v
  std::vector<Vec3<T>> origin_, centre_;  // (parts) of the body, and of the ball that holds the part, in the world
  std::vector<std::size_t> parts_, pairs_, near_parts_, near_pairs_;
  const Sways* sways_ = nullptr;
  T sway_{};                                  // of the part or pair that is looked at
  bool is_near_ = false;                      // whether it is not clear in some lane
  std::vector<const ObstaclePiece*> pieces_;  // that are near a node, behind those near the nodes above it
  mask_t<T> asked_{};                         // lanes in which it is not known to be clear
  mask_t<T> hit_{}, undecided_{}, doubtful_{};
  std::vector<Doubt<T>> doubts_;
};

}  // namespace manyhands

#include "manyhands/planning/lane_check.inl"
