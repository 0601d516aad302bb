// Cubic B-splines between two configurations: a path as control points that can be moved freely.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "manyhands/planning/trajectory.h"

namespace manyhands {

/// What bends of a path q(s), s from 0 to 1, cost: half the integral of velocity |q'|^2 + acceleration |q''|^2 +
/// jerk |q'''|^2.
struct SmoothnessWeights {
  double velocity = 1, acceleration = 0.05, jerk = 1e-5;
};

/// Uniform cubic B-splines with natural ends: m control points between the start and the goal, m + 1 pieces. A path is
/// the straight line plus a displacement, q(s) = line(s) + sum_k b_k(s) x_k, x_k (n) being how far control point k is
/// from where it lies on the line: both ends are met and not bent, whatever x is, and each piece lies in the hull of
/// its control points. De Boor, A Practical Guide to Splines, 2001, chapter XI.
class PathSpline {
 public:
  /// points: m, 1 or more. looks: of each piece, evenly spread.
  PathSpline(std::size_t points, std::size_t looks, const SmoothnessWeights& weights);

  /// What control points `first`, `first` + 1, ... weigh at one s.
  struct Look {
    double s{};
    std::size_t first{}, count{};
    std::array<double, 4> weight{};
  };

  [[nodiscard]] std::size_t points() const { return points_; }
  [[nodiscard]] const SmoothnessWeights& weights() const { return weights_; }
  [[nodiscard]] std::span<const Look> looks() const { return looks_; }
  /// A (m, m): a displacement x costs 1/2 sum_j x_j^T A x_j, coordinates j, more than the line.
  [[nodiscard]] std::span<const double> smoothness() const { return smoothness_; }
  [[nodiscard]] std::span<const double> inverse_smoothness() const { return inverse_; }

  /// The path through all control points, (m + 2, n) with the start and the goal, as a trajectory of a given duration.
  [[nodiscard]] Trajectory path(std::span<const double> controls, double duration) const;

 private:
  /// Weights of the free control points for derivative `order` by s in piece i, u from 0 to 1 in it.
  [[nodiscard]] Look look(std::size_t piece, double u, std::size_t order) const;
  void add_smoothness();
  void invert();

  std::size_t points_;
  SmoothnessWeights weights_;
  std::vector<Look> looks_;
  std::vector<double> smoothness_, inverse_;  // (m, m)
};

}  // namespace manyhands
