// Paths that slide to where they cost least, one a lane.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "manyhands/planning/clearance_cost.h"
#include "manyhands/planning/lane_minimizer.h"
#include "manyhands/planning/path_spline.h"
#include "manyhands/planning/rrt_connect.h"

namespace manyhands {

/// From where one lane begins, and then what it found.
struct PathSeed {
  std::vector<double> goal{};         ///< (n)
  std::vector<float> displacement{};  ///< (m, n) of control points from the line between the start and the goal
  float obstacle_weight = 0;          ///< [1/m]
  float cost = 0;
};

struct DescentSettings {
  double clearance = 0.02;  ///< that costs nothing, from balls that stick out of links already [m]
  int iterations = 100;
  MinimizerSettings minimizer{};
};

/// The cost of a path with control points displaced by x from the line between two configurations, and its descent:
///
///   velocity / 2 |goal - start|^2 + 1/2 sum_j x_j^T A x_j + obstacle_weight / looks sum_i c(q(s_i)) + 1e3 / m sum_k
///   |out_k|^2
///
/// c being `ClearanceCost`, and out_k how far control point k is outside of limits. A, the smoothness, is the first
/// guess of the Hessian, as in CHOMP: what pushes a path away at one place bends it smoothly. A lane finds what it
/// would find alone.
template <Number T>
class PathDescent {
 public:
  PathDescent(const PlanningScene& scene, const PathSpline& spline, std::span<const double> start,
              const DescentSettings& settings)
      : spline_(spline),
        settings_(settings),
        start_(in_R(start)),
        lower_(in_R(scene.lower)),
        upper_(in_R(scene.upper)),
        smoothness_(in_R(spline.smoothness())),
        inverse_(in_R(spline.inverse_smoothness())),
        clearance_(scene, settings.clearance),
        minimizer_(spline.points() * scene.size(), settings.minimizer),
        along_(scene.size()) {
    for (const PathSpline::Look& look : spline.looks()) looks_.push_back({look, static_cast<R>(look.s), {}});
    for (Look& look : looks_)
      std::ranges::transform(look.at.weight, look.weight.begin(), [](double w) { return static_cast<R>(w); });
  }

  /// Descends from up to as many seeds as there are lanes, until all have settled or time has passed.
  void descend(std::span<PathSeed> seeds, const Deadline& deadline) {
    set(seeds);
    const auto cost = [this](const std::vector<T>& x, std::vector<T>& gradient) { return evaluate(x, gradient); };
    const auto precondition = [this](const std::vector<T>& from, std::vector<T>& to) { multiply(inverse_, from, to); };
    minimizer_.start(cost, precondition);
    for (int i = 0; i < settings_.iterations && !deadline.has_passed(); ++i) {
      if (!minimizer_.iterate(cost, precondition)) break;
    }
    for (std::size_t lane_index = 0; lane_index < seeds.size(); ++lane_index) {
      const auto k = static_cast<int>(lane_index);
      seeds[lane_index].cost = static_cast<float>(lane(minimizer_.value(), k));
      for (std::size_t i = 0; i < minimizer_.x().size(); ++i)
        seeds[lane_index].displacement[i] = static_cast<float>(lane(minimizer_.x()[i], k));
    }
  }

  /// Lanes without a seed take the last.
  void set(std::span<const PathSeed> seeds) {
    for (int k = 0; k < width_v<T>; ++k) {
      const PathSeed& seed = seeds[std::min(static_cast<std::size_t>(k), seeds.size() - 1)];
      for (std::size_t j = 0; j < along_.size(); ++j) set_lane(along_[j], k, static_cast<R>(seed.goal[j]) - start_[j]);
      for (std::size_t i = 0; i < minimizer_.x().size(); ++i)
        set_lane(minimizer_.x()[i], k, static_cast<R>(seed.displacement[i]));
      set_lane(obstacle_weight_, k, static_cast<R>(seed.obstacle_weight));
    }
    of_line_ = constant<T>(0);
    for (const T& x : along_) of_line_ = fma(x, x, of_line_);
    of_line_ = constant<T>(0.5 * spline_.weights().velocity) * of_line_;
  }

  /// The cost of displacements x (m, n), and its gradient.
  T evaluate(const std::vector<T>& x, std::vector<T>& gradient) {
    multiply(smoothness_, x, gradient);
    T cost = constant<T>(0);
    for (std::size_t i = 0; i < x.size(); ++i) cost = fma(x[i], gradient[i], cost);
    cost = fma(constant<T>(0.5), cost, of_line_);
    cost += add_limits(x, gradient);  // one after the other: the order of a sum's operands is the compiler's
    cost += add_obstacles(x, gradient);
    return cost;
  }

 private:
  using R = real_t<T>;
  struct Look {
    PathSpline::Look at;
    R s;
    std::array<R, 4> weight;
  };

  [[nodiscard]] static std::vector<R> in_R(std::span<const double> numbers) {
    std::vector<R> found;
    for (const double x : numbers) found.push_back(static_cast<R>(x));
    return found;
  }

  /// Of each coordinate by itself.
  void multiply(const std::vector<R>& matrix, const std::vector<T>& from, std::vector<T>& to) const {
    const std::size_t m = spline_.points(), n = along_.size();
    for (std::size_t i = 0; i < m; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        T sum = constant<T>(0);
        for (std::size_t k = 0; k < m; ++k) sum = fma(T(matrix[i * m + k]), from[k * n + j], sum);
        to[i * n + j] = sum;
      }
    }
  }

  [[nodiscard]] T on_line(std::size_t j, R s) const { return fma(T(s), along_[j], T(start_[j])); }

  [[nodiscard]] T add_limits(const std::vector<T>& x, std::vector<T>& gradient) const {
    constexpr double kWeight = 1e3;  // [1/rad^2]
    const std::size_t m = spline_.points(), n = along_.size();
    const T weight = constant<T>(kWeight / static_cast<double>(m)), zero = constant<T>(0);
    T cost = zero;
    for (std::size_t k = 0; k < m; ++k) {
      const R s = static_cast<R>(k + 1) / static_cast<R>(m + 1);
      for (std::size_t j = 0; j < n; ++j) {
        const T q = on_line(j, s) + x[k * n + j];
        const T out = max(zero, q - T(upper_[j])) + min(zero, q - T(lower_[j]));
        cost = fma(out, out, cost);
        gradient[k * n + j] = fma(constant<T>(2) * weight, out, gradient[k * n + j]);
      }
    }
    return weight * cost;
  }

  [[nodiscard]] T add_obstacles(const std::vector<T>& x, std::vector<T>& gradient) {
    const std::size_t n = along_.size();
    const T weight = obstacle_weight_ * constant<T>(1 / static_cast<double>(spline_.looks().size()));
    T cost = constant<T>(0);
    for (const Look& look : looks_) {
      for (std::size_t j = 0; j < n; ++j) {
        T q = on_line(j, look.s);
        for (std::size_t i = 0; i < look.at.count; ++i) q = fma(T(look.weight[i]), x[(look.at.first + i) * n + j], q);
        clearance_.coordinate(j) = q;
      }
      cost += clearance_.evaluate();
      for (std::size_t j = 0; j < n; ++j) {
        const T slope = weight * clearance_.gradient(j);
        for (std::size_t i = 0; i < look.at.count; ++i) {
          T& to = gradient[(look.at.first + i) * n + j];
          to = fma(T(look.weight[i]), slope, to);
        }
      }
    }
    return weight * cost;
  }

  const PathSpline& spline_;
  DescentSettings settings_;
  std::vector<R> start_, lower_, upper_;  // (n)
  std::vector<R> smoothness_, inverse_;   // (m, m)
  std::vector<Look> looks_;
  ClearanceCost<T> clearance_;
  LaneMinimizer<T> minimizer_;
  std::vector<T> along_;  // (n) from the start to the goal
  T obstacle_weight_{}, of_line_{};
};

}  // namespace manyhands
