#include "manyhands/planning/trajectory_check.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace manyhands {

namespace {

/// One trajectory, cut into pieces of which each is a polynomial of t in [0, 1].
class TrajectoryCheck {
 public:
  TrajectoryCheck(const PlanningScene& scene, ConfigurationCheck& check, const Trajectory& motion)
      : scene_(scene), check_(check), motion_(motion), order_(std::max<std::size_t>(motion.order(), 3)) {}

  /// Whether it is free and within limits from one time to another, both in piece `k`.
  [[nodiscard]] bool is_free(std::size_t k, double from, double to) {
    constexpr int kHalvings = 6;
    if (!is_within_limits(k, from, to, kHalvings)) return false;
    cut(k, from, to);
    std::vector<float> all(coefficients_.begin(), coefficients_.end());
    const std::span<const float> rows = all;
    const std::size_t n = scene_.size();
    return check_.is_free({rows.first(n), rows.subspan(n, n), rows.subspan(2 * n, n), rows.subspan(3 * n)});
  }

 private:
  /// Sets the coefficients (order, n) of the part of piece `k` between two times, as t goes from 0 to 1.
  void cut(std::size_t k, double from, double to) {
    const std::size_t n = scene_.size();
    const double length = to - from;
    coefficients_ = motion_.piece_from(k, from - motion_.breaks()[k]);
    coefficients_.resize(order_ * n, 0.0);
    double* c = coefficients_.data();
    double scale = 1;
    for (std::size_t j = 0; j < order_; ++j, scale *= length) {
      for (std::size_t x = 0; x < n; ++x) c[j * n + x] *= scale;
    }
  }

  /// By Bernstein's coefficients, between which a polynomial lies; of halves, where these say too little.
  [[nodiscard]] bool is_within_limits(std::size_t k, double from, double to, int halvings) {
    cut(k, from, to);
    if (are_bounded()) return true;
    if (halvings == 0) return false;
    const double middle = (from + to) / 2;
    return is_within_limits(k, from, middle, halvings - 1) && is_within_limits(k, middle, to, halvings - 1);
  }

  [[nodiscard]] bool are_bounded() const {
    constexpr double kHair = 1e-6;  // [rad or m], as of ends of plans
    const std::size_t n = scene_.size();
    bool all = true;
    for (std::size_t x = 0; x < n && all; ++x) {
      const double least = scene_.lower[x] - kHair, most = scene_.upper[x] + kHair;
      internal::visit_bernstein<double>(
          order_ - 1, [&](std::size_t j) { return coefficients_[j * n + x]; },
          [&](double b) { all = all && !(b < least || b > most); });
    }
    return all;
  }

  const PlanningScene& scene_;
  ConfigurationCheck& check_;
  const Trajectory& motion_;
  std::size_t order_;
  std::vector<double> coefficients_;
};

}  // namespace

double free_until(const PlanningScene& scene, ConfigurationCheck& check, const Trajectory& motion, double from) {
  constexpr double kResolution = 1e-3;  // [s]
  if (motion.width() != scene.size())
    throw std::invalid_argument("the trajectory has " + std::to_string(motion.width()) + " joints; " +
                                std::to_string(scene.size()) + " are planned");
  TrajectoryCheck all(scene, check, motion);
  double time = std::max(from, 0.0);
  if (time >= motion.duration()) return motion.duration();
  for (std::size_t k = motion.piece_at(time); k < motion.pieces(); ++k) {
    const double end = motion.breaks()[k + 1];
    if (end <= time) continue;
    if (all.is_free(k, time, end)) {
      time = end;
      continue;
    }
    for (double blocked = end; blocked - time > kResolution;) {
      const double middle = (time + blocked) / 2;
      (all.is_free(k, time, middle) ? time : blocked) = middle;
    }
    return time;
  }
  return motion.duration();
}

bool is_free_all_along(const PlanningScene& scene, ConfigurationCheck& check, const Trajectory& motion) {
  TrajectoryCheck all(scene, check, motion);
  for (std::size_t k = 0; k < motion.pieces(); ++k) {
    if (!all.is_free(k, motion.breaks()[k], motion.breaks()[k + 1])) return false;
  }
  return true;
}

}  // namespace manyhands
