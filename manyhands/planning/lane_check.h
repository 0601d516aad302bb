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
  float margin_;  // each ball has it: two together have it once too often
  Workspace<T> ws_;
  std::vector<T> q_;
  std::vector<Vec3<T>> origin_, centre_;      // (parts) of the body, and of the ball that holds the part, in the world
  std::vector<const ObstaclePiece*> pieces_;  // that are near a node, behind those near the nodes above it
  mask_t<T> hit_{}, doubtful_{};
  std::vector<Doubt<T>> doubts_;
};

}  // namespace manyhands

#include "manyhands/planning/lane_check.inl"
