// Motions of a frame through poses: along screws, or straight while it turns.
#pragma once

#include "manyhands/math/rigid_motion.h"
#include "manyhands/planning/trajectory.h"

namespace manyhands {

/// From X_WA to X_WB: `kScrew` is X_WA exp6(s log6(X_AB)), one turn about and shift along a screw axis; `kStraight`
/// moves the origin along a line, while the frame turns about one axis at an even rate (slerp). Both take the shorter
/// turn (Lynch and Park, Modern Robotics, 2017, section 9.2.1).
enum class CartesianPath { kScrew, kStraight };

struct CartesianSample {
  Transform<double> X;  ///< of the frame in the world
  Motion<double> V, A;  ///< angular velocity and that of the origin, world axes; their derivatives
};

/// A frame's motion through poses 0 to m - 1. Where it is on its way a scalar trajectory says, `law`: k at pose k.
class CartesianTrajectory {
 public:
  /// Throws std::invalid_argument on fewer than two poses, and unless `law` has the width 1, begins at 0 and ends at
  /// m - 1.
  CartesianTrajectory(const std::vector<Transform<double>>& poses, Trajectory law, CartesianPath path);

  [[nodiscard]] const Trajectory& law() const { return law_; }
  [[nodiscard]] CartesianSample sample(double t) const;

 private:
  /// From one pose to the next: displacements in a unit of the law.
  struct Segment {
    Transform<double> start;
    Motion<double> step;  ///< the turn in the axes of the start; of a screw its shift, too, else the line in the world
  };

  CartesianPath path_;
  Trajectory law_;
  std::vector<Segment> segments_;
};

}  // namespace manyhands
