// Plans: from a configuration to a goal among obstacles, or why there is none.
#pragma once

#include "manyhands/planning/path_optimization.h"
#include "manyhands/planning/path_shortening.h"

namespace manyhands {

enum class PlanStatus {
  kSolved,
  kStartOutsideLimits,
  kStartCollides,
  kGoalOutsideLimits,  ///< of all goals, the first says why
  kGoalCollides,
  kStartBreaksConstraint,
  kGoalBreaksConstraint,
  kNoGoal,        ///< no configuration reaches the pose, not even one that collides
  kSeedsBlocked,  ///< no path that was optimised is free
  kTimeLimit,     ///< that is not to say that there is no plan
};

struct PlanSettings {
  double time_limit = 1.0;  ///< [s]
  bool shorten = true;
  bool smooth = false;  ///< whether the curve is optimised; where nothing proven comes of it, corners are blended
  double blend = 0.5;   ///< how far from a corner the path may leave it [rad or m]
  RrtSettings rrt{};
  ShorteningSettings shortening{};
  OptimizationSettings optimization{};
  std::function<void()> look_up{};  ///< called every 50 ms; what it throws ends the search
};

/// What was found.
struct Plan {
  PlanStatus status = PlanStatus::kTimeLimit;
  std::string message{};              ///< what was found, in a sentence: which joint, which links
  std::vector<double> waypoints{};    ///< rows of n; empty unless solved
  std::optional<Trajectory> curve{};  ///< through them, corners blended, by its length; unless there is no way to go
  std::size_t nodes = 0, iterations = 0;     ///< of the search
  double search_time = 0, shorten_time = 0;  ///< [s], both, and with them blending and smoothing
  std::optional<double> cost{};              ///< of a curve that was optimised, see PathDescent
};

/// From `start` (n) to the first of `goals` (rows of n) that is reached; goals outside of limits, in collision or off
/// the check's constraints are left out. Throws std::invalid_argument on other lengths, numbers that are not finite,
/// and settings without sense.
[[nodiscard]] Plan find_plan(const PlanningScene& scene, ConfigurationCheck& check, std::span<const double> start,
                             std::span<const double> goals, const PlanSettings& settings = {});

/// The same without a search: of `settings.optimization.seeds` paths that are optimised the one that costs least and is
/// proven free. Quick and smooth where little is in the way; an obstacle course is not for it.
[[nodiscard]] Plan optimize_plan(const PlanningScene& scene, ConfigurationCheck& check, std::span<const double> start,
                                 std::span<const double> goals, const PlanSettings& settings = {});

/// Configurations that reach a pose.
struct GoalConfigurations {
  std::vector<double> rows{};               ///< of n
  PlanStatus status = PlanStatus::kSolved;  ///< if there are none: why
  std::string message{};                    ///< the same in a sentence
};

/// Those that bring a frame, which only planned joints move, to X_WF, within limits and free: of those found from
/// `start` (n) and from random configurations the `count` nearest to the start. None if the start itself is not good.
/// Ends when time runs out.
[[nodiscard]] GoalConfigurations goal_configurations(const Model& model, const PlanningScene& scene,
                                                     ConfigurationCheck& check, FrameId frame,
                                                     const Transform<double>& X_WF, std::span<const double> start,
                                                     std::size_t count, std::uint64_t seed, const Deadline& deadline);

/// The least distance on the way along waypoints (rows of n), looked at so often that no point moves by more than
/// `step` [m] from one look to the next: the judge of plans, by exact distances of shapes alone.
[[nodiscard]] Encounter least_distance(const PlanningScene& scene, ConfigurationCheck& check,
                                       std::span<const double> rows, double step);

}  // namespace manyhands
