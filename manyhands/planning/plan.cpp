#include "manyhands/planning/plan.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "manyhands/kinematics/ik_search.h"
#include "manyhands/math/philox.h"
#include "manyhands/planning/checks.h"

namespace manyhands {

namespace {

using Rows = std::span<const double>;

/// The planned joint that is outside of its limits, in words; empty if none is.
std::string outside_limits(const PlanningScene& scene, Rows q) {
  constexpr double kHair = 1e-6;  // [rad or m]: what others round to
  for (std::size_t k = 0; k < q.size(); ++k) {
    if (q[k] >= scene.lower[k] - kHair && q[k] <= scene.upper[k] + kHair) continue;
    return "joint '" + scene.joint_names[k] + "' is at " + as_text(q[k]) + ", its limits are " +
           as_text(scene.lower[k]) + " and " + as_text(scene.upper[k]);
  }
  return {};
}

/// What is nearer than the margin at q, which is not free.
std::string collision_in_words(const PlanningScene& scene, ConfigurationCheck& check, Rows q) {
  const Encounter found = check.nearest(q);
  const std::string links = "'" + found.a + "' and '" + found.b + "' ";
  if (found.distance < 0) return links + "overlap by " + as_text(-found.distance) + " m";
  const std::string apart = links + "are " + as_text(found.distance) + " m apart";
  return scene.margin == 0 ? apart : apart + ", less than the margin of " + as_text(scene.margin) + " m";
}

/// The constraint that q breaks, in words; empty if it keeps all.
std::string broken_constraint(ConfigurationCheck& check, Rows q) {
  PathConstraints* constraints = check.constraints();
  return constraints == nullptr ? std::string() : constraints->broken_at(q);
}

/// An end of a plan, and what is said of one that is not good.
struct End {
  const char* name;
  PlanStatus outside_limits, breaks_constraint, collides;
};
constexpr End kStart{"the start", PlanStatus::kStartOutsideLimits, PlanStatus::kStartBreaksConstraint,
                     PlanStatus::kStartCollides};
constexpr End kGoal{"the goal", PlanStatus::kGoalOutsideLimits, PlanStatus::kGoalBreaksConstraint,
                    PlanStatus::kGoalCollides};

struct Fault {
  PlanStatus status;
  std::string message;
};

/// What is wrong with an end, if something is.
std::optional<Fault> fault_of(const PlanningScene& scene, ConfigurationCheck& check, Rows q, const End& end) {
  if (const std::string limits = outside_limits(scene, q); !limits.empty())
    return Fault{end.outside_limits, end.name + (" is outside of limits: " + limits)};
  if (const std::string broken = broken_constraint(check, q); !broken.empty())
    return Fault{end.breaks_constraint, end.name + (" breaks a constraint: " + broken)};
  if (check.are_free(q)[0] != 0) return {};
  return Fault{end.collides, end.name + (" collides: " + collision_in_words(scene, check, q))};
}

/// Moves joints without limits by whole turns to where they are nearest to the start.
void unwind(const PlanningScene& scene, Rows start, std::span<double> goal) {
  constexpr double kTurn = 2 * std::numbers::pi;
  for (std::size_t k = 0; k < goal.size(); ++k) {
    if (std::isfinite(scene.lower[k]) || std::isfinite(scene.upper[k])) continue;
    goal[k] -= kTurn * std::round((goal[k] - start[k]) / kTurn);
  }
}

std::vector<float> in_float(Rows rows) {
  std::vector<float> all;
  for (const double x : rows) all.push_back(static_cast<float>(x));
  return all;
}

/// Rows sorted by their distance from the start.
std::vector<double> nearest_first(Rows rows, Rows start) {
  const std::size_t n = start.size();
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < rows.size(); i += n) {
    double sum = 0;
    for (std::size_t k = 0; k < n; ++k) sum += square(rows[i + k] - start[k]);
    order.emplace_back(sum, i);
  }
  std::ranges::sort(order);
  std::vector<double> sorted;
  for (const auto& [distance, i] : order) {
    const Rows row = rows.subspan(i, n);
    sorted.insert(sorted.end(), row.begin(), row.end());
  }
  return sorted;
}

class Planning {
 public:
  Planning(const PlanningScene& scene, ConfigurationCheck& check, Rows start, const PlanSettings& settings)
      : scene_(scene),
        check_(check),
        start_(start),
        settings_(settings),
        deadline_(settings.time_limit, settings.look_up) {}

  Plan plan(Rows goals) {
    if (!is_good(start_, kStart) || !take_goals(goals)) return plan_;
    const Clock::time_point begin = Clock::now();
    const std::vector<float> start = in_float(start_);
    RrtPath path = rrt_connect(scene_, check_, start, in_float(goals_), settings_.rrt, deadline_);
    plan_.search_time = since(begin);
    plan_.nodes = path.nodes;
    plan_.iterations = path.iterations;
    if (path.rows.empty()) {
      plan_.message = "the time limit of " + as_text(settings_.time_limit) + " s passed after " +
                      std::to_string(path.iterations) + " samples; more time may help, or there is no way";
      return plan_;
    }
    finish(std::move(path.rows));
    return plan_;
  }

  Plan optimize(Rows goals) {
    if (!is_good(start_, kStart) || !take_goals(goals)) return plan_;
    if (std::ranges::equal(start_, Rows(goals_).first(start_.size()))) {
      succeed();
      plan_.waypoints.assign(start_.begin(), start_.end());
      return plan_;
    }
    const Clock::time_point begin = Clock::now();
    OptimizedPaths found = optimized_paths(scene_, check_, start_, goals_, settings_.optimization, deadline_);
    plan_.search_time = since(begin);
    if (found.best) {
      take(std::move(*found.best));
    } else if (deadline_.has_passed()) {
      plan_.message = "the time limit of " + as_text(settings_.time_limit) + " s passed before a path was free";
    } else {
      plan_.status = PlanStatus::kSeedsBlocked;
      plan_.message = "none of " + std::to_string(settings_.optimization.seeds) + " paths that were optimised is free" +
                      in_the_way(found.in_the_way) + "; more seeds may help, or a search";
    }
    return plan_;
  }

 private:
  using Clock = std::chrono::steady_clock;

  static double since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

  /// Says what is wrong with an end, if no other had something wrong.
  bool is_good(Rows q, const End& end) {
    const std::optional<Fault> fault = fault_of(scene_, check_, q, end);
    if (fault && plan_.message.empty()) {
      plan_.status = fault->status;
      plan_.message = fault->message;
    }
    return !fault;
  }

  /// Keeps the goals that are good; says what is wrong with the first if none is.
  bool take_goals(Rows goals) {
    const std::size_t n = scene_.size();
    for (std::size_t i = 0; i < goals.size(); i += n) {
      std::vector<double> goal(goals.begin() + static_cast<std::ptrdiff_t>(i),
                               goals.begin() + static_cast<std::ptrdiff_t>(i + n));
      unwind(scene_, start_, goal);
      if (is_good(goal, kGoal)) goals_.insert(goals_.end(), goal.begin(), goal.end());
    }
    if (goals_.empty()) return false;
    goals_ = nearest_first(goals_, start_);
    plan_.status = PlanStatus::kTimeLimit;
    plan_.message.clear();
    return true;
  }

  void finish(std::vector<float> rows) {
    const Clock::time_point begin = Clock::now();
    const std::size_t n = scene_.size();
    if (settings_.shorten) rows = shortened(check_, std::move(rows), n, settings_.shortening, deadline_);
    set_waypoints(rows);
    succeed();
    if (plan_.waypoints.size() > n && !smooth())
      plan_.curve = blended(check_, plan_.waypoints, n, settings_.blend, deadline_);
    plan_.shorten_time = since(begin);
  }

  /// Whether the waypoints became a smooth curve.
  bool smooth() {
    if (!settings_.smooth) return false;
    std::optional<OptimizedPath> found = smoothed(scene_, check_, plan_.waypoints, settings_.optimization, deadline_);
    if (found) take(std::move(*found));
    return found.has_value();
  }

  void take(OptimizedPath path) {
    succeed();
    plan_.waypoints = std::move(path.waypoints);
    plan_.curve = std::move(path.curve);
    plan_.cost = path.cost;
  }

  void succeed() {
    plan_.status = PlanStatus::kSolved;
    plan_.message = "solved";
  }

  [[nodiscard]] static std::string in_the_way(const std::optional<Encounter>& found) {
    return found ? ": on the best of them '" + found->a + "' and '" + found->b + "' are in each other's way" : "";
  }

  /// The rows without repetitions, with the ends as they were given in double.
  void set_waypoints(const std::vector<float>& rows) {
    const std::size_t n = scene_.size();
    std::vector<double>& to = plan_.waypoints;
    for (std::size_t i = 0; i < rows.size(); i += n) {
      if (i > 0 &&
          std::equal(rows.begin() + static_cast<std::ptrdiff_t>(i - n), rows.begin() + static_cast<std::ptrdiff_t>(i),
                     rows.begin() + static_cast<std::ptrdiff_t>(i)))
        continue;
      to.insert(to.end(), rows.begin() + static_cast<std::ptrdiff_t>(i),
                rows.begin() + static_cast<std::ptrdiff_t>(i + n));
    }
    std::ranges::copy(start_, to.begin());
    if (to.size() == n) return;
    for (std::size_t i = 0; i < goals_.size(); i += n) {
      const Rows goal = Rows(goals_).subspan(i, n);
      if (std::ranges::equal(in_float(goal), in_float(Rows(to).last(n))))
        std::ranges::copy(goal, to.end() - static_cast<std::ptrdiff_t>(n));
    }
  }

  const PlanningScene& scene_;
  ConfigurationCheck& check_;
  Rows start_;
  const PlanSettings& settings_;
  Deadline deadline_;
  std::vector<double> goals_;
  Plan plan_;
};

void require(bool holds, const std::string& otherwise) {
  if (!holds) throw std::invalid_argument(otherwise);
}

void check_arguments(const PlanningScene& scene, std::span<const double> start, std::span<const double> goals,
                     const PlanSettings& settings) {
  const std::size_t n = scene.size();
  require_rows("start", start, 1, n);
  require(!goals.empty() && goals.size() % n == 0,
          "the goal has " + std::to_string(goals.size()) + " numbers; expected rows of " + std::to_string(n));
  require_finite("goal", goals, n);
  require(settings.time_limit >= 0, "time_limit is " + as_text(settings.time_limit) + " s; expected 0 or more");
  require(settings.rrt.range > 0 && std::isfinite(settings.rrt.range),
          "range is " + as_text(settings.rrt.range) + "; expected more than 0");
  require(settings.blend >= 0 && std::isfinite(settings.blend),
          "blend is " + as_text(settings.blend) + "; expected 0 or more");
  require(settings.optimization.seeds > 0, "seeds is 0; expected 1 or more");
}

}  // namespace

Plan find_plan(const PlanningScene& scene, ConfigurationCheck& check, std::span<const double> start,
               std::span<const double> goals, const PlanSettings& settings) {
  check_arguments(scene, start, goals, settings);
  return Planning(scene, check, start, settings).plan(goals);
}

Plan optimize_plan(const PlanningScene& scene, ConfigurationCheck& check, std::span<const double> start,
                   std::span<const double> goals, const PlanSettings& settings) {
  check_arguments(scene, start, goals, settings);
  return Planning(scene, check, start, settings).optimize(goals);
}

GoalConfigurations goal_configurations(const Model& model, const PlanningScene& scene, ConfigurationCheck& check,
                                       FrameId frame, const Transform<double>& X_WF, std::span<const double> start,
                                       std::size_t count, std::uint64_t seed, const Deadline& deadline) {
  constexpr std::size_t kStarts = 40;
  constexpr double kSame = 1e-3;  // [rad or m]
  const std::size_t n = scene.size();
  if (const std::optional<Fault> fault = fault_of(scene, check, start, kStart))
    return {.status = fault->status, .message = fault->message};
  const std::string name = "'" + model.frame(frame).name + "'";
  IkSearch search(model, frame);
  const IkTarget<double> target{X_WF, Vec3<double>::zero()};
  RandomStream random(seed, 2, 0);
  std::vector<double> from(start.begin(), start.end()), found, colliding;
  const auto is_new = [&](const std::vector<double>& q) {
    for (std::size_t i = 0; i < found.size(); i += n) {
      double most = 0;
      for (std::size_t k = 0; k < n; ++k) most = std::max(most, std::abs(found[i + k] - q[k]));
      if (most < kSame) return false;
    }
    return true;
  };
  for (std::size_t i = 0; i < kStarts && !deadline.has_passed(); ++i) {
    const IkSearchSettings settings{.restarts = i == 0 ? 100 : 0, .seed = seed};
    const IkSolutions solved = search.find(IkGoal{}, {&target, 1}, scene.configuration(from), settings);
    if (solved.success[0] != 0) {
      std::vector<double> q;
      for (const std::size_t k : scene.coordinates) q.push_back(solved.q[k]);
      if (check.are_free(q)[0] == 0)
        colliding = q;
      else if (is_new(q))
        found.insert(found.end(), q.begin(), q.end());
    } else if (i == 0) {
      break;  // a hundred restarts did not reach it
    }
    for (std::size_t k = 0; k < n; ++k) {
      constexpr double kFar = std::numbers::pi;  // where there is no limit
      from[k] = random.uniform(std::max(scene.lower[k], -kFar), std::min(scene.upper[k], kFar));
    }
  }
  if (found.empty() && deadline.has_passed())
    return {.status = PlanStatus::kTimeLimit,
            .message = "no time was left to find a configuration that brings " + name + " there without a collision"};
  if (found.empty() && colliding.empty())
    return {.status = PlanStatus::kNoGoal,
            .message = "out of reach: inverse kinematics found no configuration that brings " + name + " there"};
  if (found.empty())
    return {.status = PlanStatus::kGoalCollides,
            .message = "every configuration found that brings " + name + " there collides; in the last, " +
                       collision_in_words(scene, check, colliding)};
  std::vector<double> sorted = nearest_first(found, start);
  sorted.resize(std::min(sorted.size(), count * n));
  return {.rows = sorted};
}

Encounter least_distance(const PlanningScene& scene, ConfigurationCheck& check, std::span<const double> rows,
                         double step) {
  const std::size_t n = scene.size();
  require_rows("rows", rows, rows.size() / n, n);
  require(step > 0, "step is " + as_text(step) + " m; expected more than 0");
  Encounter least = check.nearest(rows.first(n));
  std::vector<double> q(n);
  for (std::size_t i = n; i < rows.size(); i += n) {
    double farthest = 0;
    for (const MovingPart& part : scene.parts) {
      double way = 0;
      for (std::size_t k = 0; k < n; ++k)
        way += static_cast<double>(part.reach[k]) * std::abs(rows[i + k] - rows[i - n + k]);
      farthest = std::max(farthest, way);
    }
    const double looks = std::max(1.0, std::ceil(farthest / step));
    for (double look = 1; look <= looks; ++look) {
      for (std::size_t k = 0; k < n; ++k) q[k] = rows[i - n + k] + look / looks * (rows[i + k] - rows[i - n + k]);
      if (const Encounter here = check.nearest(q); here.distance < least.distance) least = here;
    }
  }
  return least;
}

}  // namespace manyhands
