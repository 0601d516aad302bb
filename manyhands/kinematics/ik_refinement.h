// What attempts in float have found, finished and judged in double.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "manyhands/kinematics/ik_goals.h"
#include "manyhands/kinematics/ik_search.h"
#include "manyhands/math/double_lanes.h"

namespace manyhands::internal {

/// Lane k of a target.
template <Number T>
void set_target(IkTarget<T>& to, int k, const IkTarget<double>& target) {
  const auto set = [k](Vec3<T>& v, const Vec3<double>& wide) {
    const Vec3<real_t<T>> numbers = broadcast<real_t<T>>(wide);
    set_lane(v.x, k, numbers.x);
    set_lane(v.y, k, numbers.y);
    set_lane(v.z, k, numbers.z);
  };
  set(to.X_WF.R.x, target.X_WF.R.x);
  set(to.X_WF.R.y, target.X_WF.R.y);
  set(to.X_WF.R.z, target.X_WF.R.z);
  set(to.X_WF.p, target.X_WF.p);
  set(to.toward, target.toward);
}

/// The best that attempts have found is refined and judged in double where one has reached its target, else measured.
class IkRefinement {
 public:
  IkRefinement(const Tree<double>& tree, const Params<double>& params, Workspace<double>& ws,
               Workspace<DoubleLanes>& lanes, const IkChain& chain, const IkGoal& goal, const IkSettings& settings)
      : tree_(tree), params_(params), ws_(ws), lanes_(lanes), chain_(chain), goal_(goal), settings_(settings) {
    settings_.patience = 0;
    without_posture_.posture.clear();
  }

  void finish(std::span<const IkTarget<double>> targets, IkSolutions& found) {
    std::vector<std::size_t> rough;  // all but those that the posture's own solve has settled
    for (std::size_t i = 0; i < targets.size(); ++i)
      if (!keep_posture(targets[i], i, found)) rough.push_back(i);
    std::span<const std::size_t> left = rough;
    for (; left.size() > 1; left = left.subspan(std::min(left.size(), kWidth)))
      polish(targets, left.first(std::min(left.size(), kWidth)), found, lanes_);
    if (!left.empty()) polish(targets, left, found, ws_);
    for (const std::size_t i : rough)
      if (found.success[i] == 0) try_further(targets[i], i, found);
  }

 private:
  static constexpr std::size_t kWidth = static_cast<std::size_t>(width_v<DoubleLanes>);
  static constexpr int kRefinements = 5;
  static constexpr double kLeastDamping = 1e-12;

  [[nodiscard]] std::span<double> row(std::size_t i, IkSolutions& found) const {
    const auto nq = static_cast<std::size_t>(tree_.nq);
    return std::span(found.q).subspan(i * nq, nq);
  }

  void take(const IkResult<double>& result, std::size_t i, IkSolutions& found) const {
    found.success[i] = result.success;
    found.position_error[i] = result.position_error;
    found.rotation_error[i] = result.rotation_error;
  }

  /// Whether the target is reached with the posture, if one is wanted.
  bool keep_posture(const IkTarget<double>& target, std::size_t i, IkSolutions& found) {
    const std::span<double> q = row(i, found);
    if (settings_.respect_limits) keep_within_limits(q);
    if (found.success[i] == 0 || goal_.posture.empty()) return false;
    const IkResult<double> result = solve_goal(tree_, params_, chain_, settings_, goal_, target, q.data(), ws_);
    if (result.success) take(result, i, found);
    return result.success;
  }

  /// Of those that attempts have reached, one step or more: from a tolerance of float a single one leads far below it.
  template <Number T>
  void polish(std::span<const IkTarget<double>> targets, std::span<const std::size_t> rows, IkSolutions& found,
              Workspace<T>& ws) {
    std::vector<T> q(static_cast<std::size_t>(tree_.nq));
    IkTarget<T> target{Transform<T>::identity(), Vec3<T>::zero()};
    T reached = constant<T>(0);
    for (int k = 0; k < width_v<T>; ++k) {  // lanes that are left over repeat the last
      const std::size_t i = rows[std::min(static_cast<std::size_t>(k), rows.size() - 1)];
      set_target(target, k, targets[i]);
      set_lane(reached, k, found.success[i] != 0 ? 1.0 : 0.0);
      for (std::size_t j = 0; j < q.size(); ++j) set_lane(q[j], k, row(i, found)[j]);
    }
    GoalSolve<T, double> solve(tree_, params_, chain_, settings_, without_posture_, target, q.data(), ws);
    solve.look();
    mask_t<T> active(reached > constant<T>(0));
    for (int n = 0; n < kRefinements && any(active); ++n) {
      (void)solve.step(active);
      solve.look();
      active = mask_t<T>(active & !solve.result().success);
    }
    const IkResult<T> result = solve.result();
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const int lane_k = static_cast<int>(k);
      for (const std::size_t dof : chain_.dofs) {
        const std::size_t j = index(tree_.dof_q[dof]);
        row(rows[k], found)[j] = lane(q[j], lane_k);
      }
      take({lane(result.success, lane_k), lane(result.position_error, lane_k), lane(result.rotation_error, lane_k)},
           rows[k], found);
    }
  }

  /// Near singular postures the damping holds the last digits back, and rounding keeps attempts in float from the goal.
  /// With less damping a solve may lead away: then all stays as it is.
  void try_further(const IkTarget<double>& target, std::size_t i, IkSolutions& found) {
    IkSettings ik = settings_;
    ik.damping = std::min(ik.damping, kLeastDamping);
    std::vector<double> q(row(i, found).begin(), row(i, found).end());
    GoalSolve<double, double> solve(tree_, params_, chain_, ik, without_posture_, target, q.data(), ws_);
    solve.look();
    for (int n = 0; n < ik.max_iterations && !solve.result().success; ++n) {
      (void)solve.step(true);
      solve.look();
    }
    if (!solve.result().success) return;
    take(solve.result(), i, found);
    std::ranges::copy(q, row(i, found).begin());
  }

  void keep_within_limits(std::span<double> q) const {
    for (const std::size_t dof : chain_.dofs) {
      double& x = q[static_cast<std::size_t>(tree_.dof_q[dof])];
      x = clamp(x, params_.lower[dof], params_.upper[dof]);
    }
  }

  const Tree<double>& tree_;
  const Params<double>& params_;
  Workspace<double>& ws_;
  Workspace<DoubleLanes>& lanes_;
  const IkChain& chain_;
  const IkGoal& goal_;
  IkGoal without_posture_ = goal_;
  IkSettings settings_;
};

}  // namespace manyhands::internal
