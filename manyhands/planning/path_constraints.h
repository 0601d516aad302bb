// What is kept along a way: how an axis of a frame points, and where a point of it is.
#pragma once

#include <string>

#include "manyhands/math/instantiate.h"
#include "manyhands/planning/motion_piece.h"
#include "manyhands/planning/planning_scene.h"

namespace manyhands {

/// Bounds on a number that follows from a frame's pose: on `along` . (R_WF `of`) for an axis, and on
/// `along` . (X_WF `of`) for a point. Half-spaces, of which cones and boxes are made.
struct PathConstraint {
  FrameId frame{};
  bool is_axis{};
  Vec3<double> of{};             ///< in the frame: a unit vector, or a point [m]
  Vec3<double> along{};          ///< unit vector, in the world
  double lower = -1, upper = 1;  ///< [1 or m]; infinite numbers do not bound
};

/// The axis (frame) is within an angle [rad] of the direction (world); neither need be of length 1. Throws
/// std::invalid_argument on an angle below 0.01 or above pi, and vectors without direction.
[[nodiscard]] PathConstraint keep_axis(FrameId frame, const Vec3<double>& axis, const Vec3<double>& direction,
                                       double within);
/// The frame's origin is within bounds [m] along the axes of a pose R, from R's origin. Throws std::invalid_argument on
/// bounds less than a millimetre apart.
[[nodiscard]] std::vector<PathConstraint> keep_position(FrameId frame, const Transform<double>& X_WR,
                                                        const Vec3<double>& lower, const Vec3<double>& upper);

/// Constraints of a scene: which configurations and whole motions keep them, and how others are brought back. Scratch
/// of one thread.
class PathConstraints {
 public:
  /// Frames of things that are attached move with what carries them. Throws std::invalid_argument for a frame that no
  /// planned joint moves.
  PathConstraints(const Model& model, const PlanningScene& scene, std::span<const PathConstraint> constraints);

  /// What is not kept at planned coordinates (n), in words; empty if all is.
  [[nodiscard]] std::string broken_at(std::span<const double> q);

  /// Whether all is kept everywhere on the way. A number f(t) with |f''| <= B is nowhere beyond the line between its
  /// values at both ends of a stretch of length h by more than B h^2 / 8. Lanes are spread over the way; stretches that
  /// this leaves in doubt are cut again.
  [[nodiscard]] bool hold(const MotionPiece& motion);
  [[nodiscard]] bool hold(std::span<const float> a, std::span<const float> b);

  /// Moves q (n) to where all is kept, with some room to spare, by Newton steps of least length within joint limits.
  /// Whether it got there. What keeps all stays as it is.
  [[nodiscard]] bool project(std::span<float> q);

 private:
  struct Row {
    std::size_t body{};
    bool is_axis{};
    Vec3<double> of{}, along{};  // on the body, in the world
    double lower{}, upper{};
    std::vector<float> reach{}, turn{};  // (n) of a point as PlanningScene has it; 1 for the joints that turn the body
    std::string frame{};
  };
  template <Number T>
  struct Placed {
    Placed(const PlanningScene& scene, const Tree<real_t<T>>& tree) : ws(tree), q(place_scene(scene, tree, ws)) {}
    Workspace<T> ws;
    std::vector<T> q;
  };
  static constexpr std::size_t kNotPlanned = std::size_t(-1);

  void add(const Frame& frame, const PathConstraint& given);
  template <class R>
  void place(std::span<R> q);
  template <Number T>
  [[nodiscard]] T value(const Row& row, const Workspace<T>& ws) const;
  [[nodiscard]] float greatest_bend(const Row& row, const MotionPiece& motion) const;
  [[nodiscard]] bool look(const MotionPiece& motion, float first, float last);
  [[nodiscard]] double correction(const Row& row, std::span<double> gradient) const;

  const PlanningScene& scene_;
  std::vector<Row> rows_;
  std::vector<bool> used_;               // (bodies) on the way to a row's
  std::vector<std::size_t> bodies_;      // these, parents first
  std::vector<std::size_t> planned_of_;  // (nv) the planned coordinate of a dof
  Placed<double> exact_;
  Placed<NativeLanes> lanes_;
  std::vector<float> bends_;                     // of rows
  std::vector<std::pair<float, float>> open_;    // stretches of a way
  std::vector<float> linear_, none_;             // (n)
  std::vector<double> gradient_, step_;          // (n)
  std::vector<std::vector<double>> orthogonal_;  // (n) of the rows that a Newton step corrects
};

}  // namespace manyhands
