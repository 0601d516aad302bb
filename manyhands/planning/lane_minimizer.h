// Minima of a function that all lanes evaluate together: a lane is a problem of its own.
#pragma once

#include <vector>

#include "manyhands/math/number.h"

namespace manyhands {

struct MinimizerSettings {
  std::size_t history = 6;    ///< steps that the next direction is made of
  double longest_step = 0.3;  ///< of any number
  double tolerance = 2e-3;    ///< a lane stops once a step gains less than this share of its value, three times running
};

/// L-BFGS (Liu and Nocedal, On the limited memory BFGS method for large scale optimization, Mathematical Programming
/// 45, 1989), the first guess of the inverse Hessian being the caller's. Each lane halves its own step until it gains
/// enough (Armijo), and goes on from there while others still halve theirs; no lane depends on another. Allocates
/// nothing but when it is made.
template <Number T>
class LaneMinimizer {
 public:
  LaneMinimizer(std::size_t size, const MinimizerSettings& settings)
      : settings_(settings),
        x_(size),
        gradient_(size),
        direction_(size),
        trial_(size),
        trial_gradient_(size),
        work_(size),
        steps_(settings.history, std::vector<T>(size)),
        changes_(settings.history, std::vector<T>(size)),
        curvature_(settings.history),
        share_(settings.history) {}

  [[nodiscard]] std::vector<T>& x() { return x_; }  ///< set it, then call `start`
  [[nodiscard]] const T& value() const { return value_; }

  /// cost(x, gradient) returns the value and sets the gradient; precondition(from, to) multiplies by the first guess of
  /// the inverse Hessian.
  template <class Cost, class Precondition>
  void start(const Cost& cost, const Precondition& precondition) {
    for (T& curvature : curvature_) curvature = constant<T>(0);
    running_ = mask_t<T>(true);
    small_ = constant<T>(0);
    value_ = cost(x_, gradient_);
    set_direction(running_, precondition);
  }

  /// One look of all lanes; whether any goes on.
  template <class Cost, class Precondition>
  bool iterate(const Cost& cost, const Precondition& precondition) {
    constexpr double kEnough = 1e-4, kShorter = 0.4, kShortest = 1e-3;
    for (std::size_t i = 0; i < x_.size(); ++i) trial_[i] = fma(step_, direction_[i], x_[i]);
    const T value = cost(trial_, trial_gradient_);
    const mask_t<T> taken(running_ & (value <= fma(constant<T>(kEnough) * step_, slope_, value_)));
    const mask_t<T> is_small(value_ - value <= constant<T>(settings_.tolerance) * abs(value_));
    small_ = select(taken, select(is_small, small_ + constant<T>(1), constant<T>(0)), small_);
    remember(taken);
    for (std::size_t i = 0; i < x_.size(); ++i) {
      x_[i] = select(taken, trial_[i], x_[i]);
      gradient_[i] = select(taken, trial_gradient_[i], gradient_[i]);
    }
    value_ = select(taken, value, value_);
    step_ = constant<T>(kShorter) * step_;
    running_ = mask_t<T>(running_ & (taken | (step_ > constant<T>(kShortest))) & (small_ < constant<T>(3)));
    set_direction(taken, precondition);
    return any(running_);
  }

 private:
  [[nodiscard]] static T dot(const std::vector<T>& a, const std::vector<T>& b) {
    T sum = constant<T>(0);
    for (std::size_t i = 0; i < a.size(); ++i) sum = fma(a[i], b[i], sum);
    return sum;
  }

  /// The step to the trial and how the gradient changed, in these lanes; a step along which it did not grow is left
  /// out.
  void remember(const mask_t<T>& taken) {
    for (std::size_t i = 0; i < x_.size(); ++i) {
      trial_[i] = select(taken, trial_[i], x_[i]);
      work_[i] = trial_[i] - x_[i];
      direction_[i] = select(taken, trial_gradient_[i] - gradient_[i], direction_[i]);
    }
    const T grown = dot(work_, direction_);
    const mask_t<T> keep(taken & (grown > constant<T>(1e-6) * dot(work_, work_)));
    for (std::size_t k = steps_.size() - 1; k > 0; --k) {
      for (std::size_t i = 0; i < x_.size(); ++i) {
        steps_[k][i] = select(keep, steps_[k - 1][i], steps_[k][i]);
        changes_[k][i] = select(keep, changes_[k - 1][i], changes_[k][i]);
      }
      curvature_[k] = select(keep, curvature_[k - 1], curvature_[k]);
    }
    for (std::size_t i = 0; i < x_.size(); ++i) {
      steps_[0][i] = select(keep, work_[i], steps_[0][i]);
      changes_[0][i] = select(keep, direction_[i], changes_[0][i]);
    }
    curvature_[0] = select(keep, constant<T>(1) / select(keep, grown, constant<T>(1)), curvature_[0]);
  }

  /// Minus the inverse Hessian times the gradient, in these lanes: by two loops over what is remembered, of which lanes
  /// that remember less have zeros.
  template <class Precondition>
  void set_direction(const mask_t<T>& lanes, const Precondition& precondition) {
    work_ = gradient_;
    for (std::size_t k = 0; k < steps_.size(); ++k) {
      share_[k] = curvature_[k] * dot(steps_[k], work_);
      for (std::size_t i = 0; i < work_.size(); ++i) work_[i] = fma(-share_[k], changes_[k][i], work_[i]);
    }
    precondition(work_, trial_);
    for (std::size_t k = steps_.size(); k-- > 0;) {
      const T more = share_[k] - curvature_[k] * dot(changes_[k], trial_);
      for (std::size_t i = 0; i < work_.size(); ++i) trial_[i] = fma(more, steps_[k][i], trial_[i]);
    }
    T largest = constant<T>(settings_.longest_step);
    for (const T& x : trial_) largest = max(largest, abs(x));
    const T scale = constant<T>(-settings_.longest_step) / largest;
    for (std::size_t i = 0; i < work_.size(); ++i) direction_[i] = select(lanes, scale * trial_[i], direction_[i]);
    slope_ = select(lanes, dot(direction_, gradient_), slope_);
    step_ = select(lanes, constant<T>(1), step_);
    running_ = mask_t<T>(running_ & (slope_ < constant<T>(0)));
  }

  MinimizerSettings settings_;
  std::vector<T> x_, gradient_, direction_, trial_, trial_gradient_, work_;
  std::vector<std::vector<T>> steps_, changes_;  // the last first
  std::vector<T> curvature_, share_;             // 1 / (step . change), 0 where none is remembered
  T value_{}, slope_{}, step_{}, small_{};
  mask_t<T> running_{};
};

}  // namespace manyhands
