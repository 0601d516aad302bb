// Attempts of inverse kinematics in lanes: one a lane, the next begins where one ends.
#pragma once

#include <array>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "manyhands/kinematics/ik_goals.h"
#include "manyhands/kinematics/ik_refinement.h"
#include "manyhands/kinematics/ik_schedule.h"
#include "manyhands/kinematics/ik_search.h"
#include "manyhands/kinematics/ik_seeds.h"
#include "manyhands/math/control_flow.h"
#include "manyhands/math/philox.h"

namespace manyhands::internal {

/// What is asked, and the best that each target has so far.
struct IkQuestion {
  const Tree<float>& tree;
  const Params<float>& params;
  const IkChain& chain;
  const IkGoal& goal;
  IkSettings ik;  ///< of attempts
  std::span<const IkTarget<double>> targets;
  std::span<const double> start;  ///< (nq)
  std::uint64_t seed;
  bool from_start;
  const IkFilter& accepts;

  std::optional<IkSeeds>& seeds;  ///< made when they are needed first
  IkSolutions& found;
  std::span<double> nearest;  ///< (n) squared error of the best attempt
};

/// Makes the attempts of a schedule. What one finds depends on its target and round only: not on T, nor on its lane.
template <Number T>
class IkAttempts {
 public:
  /// ws: scratch.
  IkAttempts(const IkQuestion& question, IkSchedule schedule, Workspace<T>& ws)
      : asked_(question),
        schedule_(std::move(schedule)),
        solve_(asked_.tree, asked_.params, asked_.chain, asked_.ik, asked_.goal, target_, q_.data(), ws) {}

  IkAttempts(const IkAttempts&) = delete;
  IkAttempts& operator=(const IkAttempts&) = delete;

  void run() {
    for (std::size_t j = 0; j < q_.size(); ++j) q_[j] = constant<T>(asked_.start[j]);
    for (fill_lanes(); any(running());) {
      if (iterate() || has_idle_) fill_lanes();
    }
  }

 private:
  static constexpr int W = width_v<T>;
  static constexpr float kHeadStart = 8;  // iterations of an attempt before free lanes run the next of the same target

  [[nodiscard]] bool runs(int k) const { return lane(runs_, k) > 0; }
  [[nodiscard]] mask_t<T> running() const { return mask_t<T>(runs_ > constant<T>(0)); }

  /// One iteration of all attempts; those that end are judged. Whether any did.
  bool iterate() {
    solve_.look();
    const mask_t<T> reached = solve_.reached(), goes_further(iterations_ < constant<T>(asked_.ik.max_iterations));
    mask_t<T> active(running() & goes_further);
    if (asked_.goal.posture.empty()) active = mask_t<T>(active & !reached);  // what is left is the refinement's
    const T error2 = solve_.error2();
    const mask_t<T> ended(running() & !solve_.step(active));
    iterations_ = iterations_ + constant<T>(1);
    if (!any(ended)) return false;
    for_lanes<T>(ended, [&](int k) { end(k, static_cast<double>(lane(error2, k)), lane(reached, k)); });
    return true;
  }

  void end(int k, double error2, bool reached) {
    const IkAttempt attempt = attempts_[at(k)];
    const bool success = (solve_.take_kept(k) || reached) && is_accepted(k);
    const std::size_t i = attempt.target;
    set_lane(runs_, k, 0.0f);
    schedule_.end(attempt, success);
    IkSolutions& found = asked_.found;
    if (success ? schedule_.winner(i) != attempt.round : found.success[i] != 0 || !(error2 < asked_.nearest[i])) return;
    asked_.nearest[i] = error2;
    found.success[i] = success;
    if (success) found.attempts[i] = attempt.round + 1;
    write(k, std::span(found.q).subspan(i * q_.size(), q_.size()));
  }

  [[nodiscard]] bool is_accepted(int k) const {
    if (!asked_.accepts) return true;
    std::vector<double> q(asked_.start.begin(), asked_.start.end());
    write(k, q);
    return asked_.accepts(q);
  }

  /// What lane k has found, into q (nq). Coordinates outside the chain are left as they are: float would round them.
  void write(int k, std::span<double> q) const {
    for (const std::size_t dof : asked_.chain.dofs) {
      const auto j = static_cast<std::size_t>(asked_.tree.dof_q[dof]);
      q[j] = static_cast<double>(lane(q_[j], k));
    }
  }

  /// Gives every free lane an attempt, as far as there are any.
  void fill_lanes() {
    candidates_.clear();
    for (int k = 0; k < W; ++k) {
      if (!runs(k)) continue;
      if (const IkAttempt& attempt = attempts_[at(k)]; schedule_.is_late(attempt)) {
        schedule_.end(attempt, false);
        set_lane(runs_, k, 0.0f);
      } else if (lane(iterations_, k) >= kHeadStart) {
        candidates_.push_back(attempt);
      }
    }
    has_idle_ = false;
    for (int k = 0; k < W; ++k) {
      if (runs(k)) continue;
      if (const std::optional<IkAttempt> next = schedule_.next(candidates_)) {
        begin(k, *next);
      } else {
        has_idle_ = true;
      }
    }
  }

  void begin(int k, const IkAttempt& attempt) {
    attempts_[at(k)] = attempt;
    set_lane(runs_, k, 1.0f);
    set_lane(iterations_, k, 0.0f);
    set_target(target_, k, asked_.targets[attempt.target]);
    set_start(k, attempt);
    solve_.restart(k);
  }

  /// Attempts begin where the search does, if asked to, then at seeds near the goal, if it has a position, then at
  /// random.
  void set_start(int k, const IkAttempt& attempt) {
    const int rank = attempt.round - (asked_.from_start ? 1 : 0);
    if (rank >= 0 && rank < IkSeeds::kRanks && asked_.goal.position_weight > 0) {
      if (!asked_.seeds) asked_.seeds.emplace(asked_.tree, asked_.params, asked_.chain);
      const IkSeeds& seeds = *asked_.seeds;
      const std::span<const float> seed = seeds.near(asked_.goal, asked_.targets[attempt.target], rank);
      set_start(k, [&](std::size_t i, float here) { return seeds.coordinate(seed, i, here); });
    } else if (rank >= 0) {
      RandomStream random(asked_.seed, static_cast<std::uint32_t>(attempt.target),
                          static_cast<std::uint64_t>(attempt.round));
      set_start(k, [&](std::size_t i, float here) { return random_coordinate(asked_.chain.dofs[i], here, random); });
    } else {
      set_start(k, [](std::size_t, float here) { return here; });
    }
  }

  /// `coordinate(i, here)` of the chain's dof i, which is `here` where the search begins.
  template <class Coordinate>
  void set_start(int k, const Coordinate& coordinate) {
    for (std::size_t i = 0; i < asked_.chain.dofs.size(); ++i) {
      const auto j = static_cast<std::size_t>(asked_.tree.dof_q[asked_.chain.dofs[i]]);
      set_lane(q_[j], k, coordinate(i, static_cast<float>(asked_.start[j])));
    }
  }

  [[nodiscard]] float random_coordinate(std::size_t dof, float here, RandomStream& random) const {
    constexpr float kFar = std::numbers::pi_v<float>;  // where there is no limit [rad or m]
    const float lower = asked_.params.lower[dof], upper = asked_.params.upper[dof];
    const float low = is_finite(lower) ? lower : here - kFar, high = is_finite(upper) ? upper : here + kFar;
    return random.uniform(low, high);
  }

  static std::size_t at(int k) { return static_cast<std::size_t>(k); }

  const IkQuestion& asked_;
  IkSchedule schedule_;
  std::vector<T> q_ = std::vector<T>(asked_.start.size());
  IkTarget<T> target_{Transform<T>::identity(), Vec3<T>::zero()};
  GoalSolve<T, float> solve_;
  std::array<IkAttempt, static_cast<std::size_t>(W)> attempts_{};  // of each lane
  T runs_ = constant<T>(0), iterations_ = constant<T>(0);          // 1 where it runs; how many it has taken
  bool has_idle_ = false;                                          // whether a lane has nothing to do
  std::vector<IkAttempt> candidates_;
};

}  // namespace manyhands::internal
