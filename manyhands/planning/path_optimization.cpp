#include "manyhands/planning/path_optimization.h"

#include <cmath>
#include <numbers>
#include <numeric>

#include "manyhands/math/instantiate.h"
#include "manyhands/math/philox.h"
#include "manyhands/planning/trajectory_check.h"

namespace manyhands {

namespace {

using Rows = std::span<const double>;

class Optimization {
 public:
  Optimization(const PlanningScene& scene, ConfigurationCheck& check, Rows start, const OptimizationSettings& settings,
               const Deadline& deadline)
      : scene_(scene),
        check_(check),
        start_(start),
        settings_(settings),
        deadline_(deadline),
        spline_(settings.points, settings.looks, settings.smoothness) {}

  /// A seed that is straight.
  [[nodiscard]] PathSeed straight_to(Rows goal) const {
    PathSeed seed{.goal = {goal.begin(), goal.end()},
                  .displacement = std::vector<float>(settings_.points * start_.size()),
                  .obstacle_weight = static_cast<float>(settings_.obstacle_weight)};
    return seed;
  }

  /// One whose middle is at a random configuration.
  [[nodiscard]] PathSeed arc_to(Rows goal, RandomStream& random) const {
    PathSeed seed = straight_to(goal);
    for (std::size_t j = 0; j < start_.size(); ++j) {
      constexpr double kFar = std::numbers::pi;  // where there is no limit
      const double middle = (start_[j] + goal[j]) / 2;
      const double low = std::isfinite(scene_.lower[j]) ? scene_.lower[j] : middle - kFar;
      const double high = std::isfinite(scene_.upper[j]) ? scene_.upper[j] : middle + kFar;
      const double height = random.uniform(low, high) - middle;
      for (std::size_t k = 0; k < settings_.points; ++k) {
        const double s = share(k);
        seed.displacement[k * start_.size() + j] = static_cast<float>(height * std::sin(std::numbers::pi * s));
      }
    }
    return seed;
  }

  /// One along the path (rows of n), its control points evenly by length.
  [[nodiscard]] PathSeed along(Rows rows) const {
    const std::size_t n = start_.size(), edges = rows.size() / n - 1;
    PathSeed seed = straight_to(rows.last(n));
    std::vector<double> length(edges + 1);
    for (std::size_t i = 0; i < edges; ++i) length[i + 1] = length[i] + distance(&rows[i * n], &rows[(i + 1) * n]);
    for (std::size_t k = 0, i = 0; k < settings_.points; ++k) {
      const double at = share(k) * length.back();
      while (i + 1 < edges && length[i + 1] < at) ++i;
      const double part = (at - length[i]) / (length[i + 1] - length[i]);
      for (std::size_t j = 0; j < n; ++j) {
        const double q = std::lerp(rows[i * n + j], rows[(i + 1) * n + j], part);
        seed.displacement[k * n + j] = static_cast<float>(q - std::lerp(start_[j], seed.goal[j], share(k)));
      }
    }
    return seed;
  }

  void descend(std::span<PathSeed> seeds) const {
    PathDescent<NativeLanes> lanes(scene_, spline_, start_, settings_.descent);
    constexpr auto kLanes = static_cast<std::size_t>(width_v<NativeLanes>);
    for (std::size_t first = 0; first < seeds.size() && !deadline_.has_passed(); first += kLanes)
      lanes.descend(seeds.subspan(first, std::min(kLanes, seeds.size() - first)), deadline_);
  }

  /// The path of a seed, if it is proven free.
  [[nodiscard]] std::optional<OptimizedPath> proven(const PathSeed& seed) const {
    const Trajectory curve = path(seed);
    if (!is_free_all_along(scene_, check_, curve)) return {};
    std::optional<std::vector<double>> rows = waypoints(curve, seed.goal);
    if (!rows) return {};
    return OptimizedPath{std::move(*rows), curve, static_cast<double>(seed.cost)};
  }

  /// The first thing in the way of a path, of where it is looked at.
  [[nodiscard]] std::optional<Encounter> in_the_way(const PathSeed& seed) const {
    const Trajectory curve = path(seed);
    const std::size_t n = start_.size(), looks = 4 * curve.pieces();
    std::vector<double> q(n), v(n), a(n);
    for (std::size_t i = 0; i < looks && !deadline_.has_passed(); ++i) {
      const double t = curve.duration() * static_cast<double>(i) / static_cast<double>(looks);
      curve.sample({&t, 1}, q, v, a);
      if (std::optional<Encounter> found = check_.encounter(q)) return found;
    }
    return {};
  }

 private:
  /// Of the way to the goal, at which control point k lies on the line.
  [[nodiscard]] double share(std::size_t k) const {
    return static_cast<double>(k + 1) / static_cast<double>(settings_.points + 1);
  }

  [[nodiscard]] double distance(const double* a, const double* b) const {
    double sum = 0;
    for (std::size_t j = 0; j < start_.size(); ++j) sum += square(b[j] - a[j]);
    return std::sqrt(sum);
  }

  /// As long as the lines between the ends of its pieces.
  [[nodiscard]] Trajectory path(const PathSeed& seed) const {
    const std::size_t n = start_.size();
    std::vector<double> controls(start_.begin(), start_.end());
    for (std::size_t k = 0; k < settings_.points; ++k) {
      for (std::size_t j = 0; j < n; ++j) {
        const double q =
            std::lerp(start_[j], seed.goal[j], share(k)) + static_cast<double>(seed.displacement[k * n + j]);
        controls.push_back(std::clamp(q, scene_.lower[j], scene_.upper[j]));
      }
    }
    controls.insert(controls.end(), seed.goal.begin(), seed.goal.end());
    const Trajectory even = spline_.path(controls, 1);
    double length = 0;
    for (std::size_t i = 0; i < even.pieces(); ++i)
      length += i + 1 < even.pieces() ? distance(even.piece(i).data(), even.piece(i + 1).data())
                                      : distance(even.piece(i).data(), seed.goal.data());
    return spline_.path(controls, length);
  }

  /// Points of the curve, so many that the lines between them are free as well.
  [[nodiscard]] std::optional<std::vector<double>> waypoints(const Trajectory& curve, Rows goal) const {
    constexpr int kHalvings = 4;
    std::vector<double> rows(start_.begin(), start_.end());
    for (std::size_t i = 0; i < curve.pieces(); ++i) {
      const bool is_last = i + 1 == curve.pieces();
      const std::vector<double> end =
          is_last ? std::vector<double>(goal.begin(), goal.end()) : at(curve, curve.breaks()[i + 1]);
      if (!add_way(curve, curve.breaks()[i], curve.breaks()[i + 1], end, kHalvings, rows)) return {};
    }
    return rows;
  }

  [[nodiscard]] static std::vector<double> at(const Trajectory& curve, double t) {
    std::vector<double> q(curve.width()), v(q), a(q);
    curve.sample({&t, 1}, q, v, a);
    return q;
  }

  /// Goes on from the last row to `end`, by way of the curve where the line between is not free.
  [[nodiscard]] bool add_way(const Trajectory& curve, double from, double to, const std::vector<double>& end,
                             int halvings, std::vector<double>& rows) const {
    const std::size_t n = start_.size();
    const std::vector<float> a(rows.end() - static_cast<std::ptrdiff_t>(n), rows.end()), b(end.begin(), end.end());
    if (check_.is_free(a, b)) {
      rows.insert(rows.end(), end.begin(), end.end());
      return true;
    }
    const double middle = (from + to) / 2;
    return halvings > 0 && add_way(curve, from, middle, at(curve, middle), halvings - 1, rows) &&
           add_way(curve, middle, to, end, halvings - 1, rows);
  }

  const PlanningScene& scene_;
  ConfigurationCheck& check_;
  Rows start_;
  const OptimizationSettings& settings_;
  const Deadline& deadline_;
  PathSpline spline_;
};

}  // namespace

OptimizedPaths optimized_paths(const PlanningScene& scene, ConfigurationCheck& check, std::span<const double> start,
                               std::span<const double> goals, const OptimizationSettings& settings,
                               const Deadline& deadline) {
  const std::size_t n = scene.size(), count = goals.size() / n;
  const Optimization all(scene, check, start, settings, deadline);
  std::vector<PathSeed> seeds;
  for (std::size_t i = 0; i < settings.seeds; ++i) {
    const Rows goal = goals.subspan(i % count * n, n);
    RandomStream random(settings.seed, 4, i);
    seeds.push_back(i < count ? all.straight_to(goal) : all.arc_to(goal, random));
  }
  all.descend(seeds);
  std::ranges::stable_sort(seeds, {}, &PathSeed::cost);
  OptimizedPaths found;
  for (const PathSeed& seed : seeds) {
    if (deadline.has_passed()) return found;
    found.best = all.proven(seed);
    if (found.best) return found;
  }
  found.in_the_way = all.in_the_way(seeds[0]);
  return found;
}

std::optional<OptimizedPath> smoothed(const PlanningScene& scene, ConfigurationCheck& check,
                                      std::span<const double> rows, const OptimizationSettings& settings,
                                      const Deadline& deadline) {
  const Optimization all(scene, check, rows.first(scene.size()), settings, deadline);
  constexpr int kWeights = 8;
  std::vector<PathSeed> seeds(kWeights, all.along(rows));
  // From paths that all but ignore obstacles to such that keep far from them.
  for (int i = 0; i < kWeights; ++i)
    seeds[static_cast<std::size_t>(i)].obstacle_weight *= std::exp2(static_cast<float>(2 * (i - 3)));
  all.descend(seeds);
  for (const PathSeed& seed : seeds) {
    if (deadline.has_passed()) return {};
    if (std::optional<OptimizedPath> found = all.proven(seed)) return found;
  }
  return {};
}

}  // namespace manyhands
