#include "manyhands/kinematics/ik_search.h"

#include <algorithm>
#include <numeric>

#include "manyhands/kinematics/ik_attempts.h"
#include "manyhands/math/instantiate.h"

namespace manyhands {

namespace {

using internal::IkAttempts;
using internal::IkQuestion;

/// Configurations that attempts in float have found are refined and judged in double, the others only measured.
class Refinement {
 public:
  Refinement(const Tree<double>& tree, const Params<double>& params, Workspace<double>& ws, const IkChain& chain,
             const IkGoal& goal, const IkSettings& settings)
      : tree_(tree), params_(params), ws_(ws), chain_(chain), goal_(goal), settings_(settings) {
    without_posture_.posture.clear();
  }

  void finish(std::span<const IkTarget<double>> targets, IkSolutions& found) {
    const auto nq = static_cast<std::size_t>(tree_.nq);
    for (std::size_t i = 0; i < targets.size(); ++i) {
      const std::span<double> q = std::span(found.q).subspan(i * nq, nq);
      if (settings_.respect_limits) keep_within_limits(q);
      const IkResult<double> result = refine(targets[i], found.success[i] != 0, q);
      found.success[i] = result.success;
      found.position_error[i] = result.position_error;
      found.rotation_error[i] = result.rotation_error;
    }
  }

 private:
  static constexpr int kRefinements = 5;
  static constexpr double kLeastDamping = 1e-12;

  IkResult<double> refine(const IkTarget<double>& target, bool reached, std::span<double> q) {
    IkSettings ik = settings_;
    ik.patience = 0;
    if (reached && !goal_.posture.empty()) {
      const IkResult<double> result = solve_goal(tree_, params_, chain_, ik, goal_, target, q.data(), ws_);
      if (result.success) return result;
    }
    const IkResult<double> result = polish(ik, target, reached ? kRefinements : 0, q);
    if (result.success) return result;
    // Near singular postures the damping holds the last digits back, and rounding keeps attempts in float from the
    // goal. With less damping a solve may lead away.
    ik.damping = std::min(ik.damping, kLeastDamping);
    const std::vector<double> refined(q.begin(), q.end());
    const IkResult<double> further = polish(ik, target, ik.max_iterations, q);
    if (further.success) return further;
    std::ranges::copy(refined, q.begin());
    return result;
  }

  /// One step or more, unless `most` is 0: from a tolerance of float a single one leads far below it.
  IkResult<double> polish(const IkSettings& ik, const IkTarget<double>& target, int most, std::span<double> q) {
    GoalSolve<double, double> solve(tree_, params_, chain_, ik, without_posture_, target, q.data(), ws_);
    solve.look();
    for (int i = 0; i < most && (i == 0 || !solve.result().success); ++i) {
      solve.step(true);
      solve.look();
    }
    return solve.result();
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
  const IkChain& chain_;
  const IkGoal& goal_;
  IkGoal without_posture_ = goal_;
  const IkSettings& settings_;
};

/// Nothing found yet.
IkSolutions prepare(std::size_t n, std::span<const double> start, int attempts) {
  IkSolutions found;
  found.q.reserve(n * start.size());
  for (std::size_t i = 0; i < n; ++i) found.q.insert(found.q.end(), start.begin(), start.end());
  found.success.assign(n, 0);
  found.position_error.assign(n, 0);
  found.rotation_error.assign(n, 0);
  found.attempts.assign(n, attempts);
  return found;
}

/// Of attempts: float tells errors from rounding down to kFinestInFloat, and one that gets no nearer makes room for the
/// next.
IkSettings settings_of_attempts(const IkSearchSettings& settings) {
  constexpr double kFinestInFloat = 1e-5;  // [m, rad]
  constexpr int kPatience = 3;
  IkSettings ik = settings.ik;
  ik.position_tolerance = std::max(ik.position_tolerance, kFinestInFloat);
  ik.rotation_tolerance = std::max(ik.rotation_tolerance, kFinestInFloat);
  if (ik.patience == 0 && settings.restarts > 0) ik.patience = kPatience;
  return ik;
}

/// Attempts for all targets. A few make the first in scalars, which often suffices.
void search(const IkQuestion& question, int last_round, Workspace<float>& ws) {
  constexpr std::size_t kFew = 3;
  std::vector<std::size_t> open(question.targets.size());
  std::iota(open.begin(), open.end(), std::size_t{0});
  int round = 0;
  if (open.size() <= kFew) {
    IkAttempts<float>(question, {open, round, round}, ws).run();
    std::erase_if(open, [&](std::size_t i) { return question.found.success[i] != 0; });
    ++round;
  }
  if (open.empty() || round > last_round) return;
  Workspace<NativeLanes> lanes(question.tree);
  IkAttempts<NativeLanes>(question, {open, round, last_round}, lanes).run();
}

void require(bool holds, const std::string& otherwise) {
  if (!holds) throw std::invalid_argument(otherwise);
}

void check(int model_nq, const IkGoal& goal, std::span<const double> start) {
  const auto nq = static_cast<std::size_t>(model_nq);
  const auto has_nq = [&](const char* what, std::size_t n) {
    require(n == nq, std::string("the ") + what + " has " + std::to_string(n) + " numbers; the model's q has " +
                         std::to_string(nq));
  };
  has_nq("start", start.size());
  if (!goal.posture.empty()) has_nq("posture", goal.posture.size());
  const bool turns = goal.orientation != IkOrientation::kFree;
  const bool pointing = turns && goal.orientation != IkOrientation::kFull;
  require(goal.position_weight >= 0 && is_finite(goal.position_weight),
          "position_weight is " + std::to_string(goal.position_weight) + "; expected 0 or more");
  require(goal.rotation_weight > 0 && is_finite(goal.rotation_weight),
          "rotation_weight is " + std::to_string(goal.rotation_weight) + "; expected more than 0");
  require(turns || goal.position_weight > 0, "the goal asks for no position and no orientation; give one of them");
  require(!pointing || abs(norm(goal.axis) - 1) < 1e-6, "the goal's axis must be of unit length");
}

}  // namespace

IkSolutions search_ik(const Model& model, FrameId frame, std::span<const Transform<double>> targets,
                      std::span<const double> start, const IkSearchSettings& settings) {
  std::vector<IkTarget<double>> poses;
  poses.reserve(targets.size());
  for (const Transform<double>& X_WF : targets) poses.push_back({X_WF, Vec3<double>::zero()});
  return search_ik(model, frame, IkGoal{}, poses, start, settings);
}

IkSolutions search_ik(const Model& model, FrameId frame, const IkGoal& goal, std::span<const IkTarget<double>> targets,
                      std::span<const double> start, const IkSearchSettings& settings) {
  return IkSearch(model, frame).find(goal, targets, start, settings);
}

struct IkSearch::Parts {
  Parts(const Model& model, IkChain moved)
      : chain(std::move(moved)),
        tree(model),
        wide_tree(model),
        params(model),
        wide_params(model),
        ws(tree),
        wide_ws(wide_tree) {}

  IkChain chain;
  Tree<float> tree;
  Tree<double> wide_tree;
  ParamsStorage<float> params;
  ParamsStorage<double> wide_params;
  Workspace<float> ws;
  Workspace<double> wide_ws;
};

IkSearch::IkSearch(const Model& model, FrameId frame) : parts_(std::make_unique<Parts>(model, IkChain(model, frame))) {}

IkSearch::IkSearch(const Model& model, FrameId frame, FrameId relative_to)
    : parts_(std::make_unique<Parts>(model, IkChain(model, frame, relative_to))) {}

IkSearch::IkSearch(IkSearch&&) noexcept = default;
IkSearch& IkSearch::operator=(IkSearch&&) noexcept = default;
IkSearch::~IkSearch() = default;

IkSolutions IkSearch::find(const IkGoal& goal, std::span<const IkTarget<double>> targets, std::span<const double> start,
                           const IkSearchSettings& settings, const IkFilter& accepts) {
  Parts& own = *parts_;
  check(own.tree.nq, goal, start);
  IkSolutions found = prepare(targets.size(), start, settings.restarts + 1);
  std::vector<double> nearest(targets.size(), std::numeric_limits<double>::infinity());
  const IkQuestion question{own.tree, own.params, own.chain,     goal,    settings_of_attempts(settings),
                            targets,  start,      settings.seed, accepts, found,
                            nearest};
  search(question, settings.restarts, own.ws);
  Refinement(own.wide_tree, own.wide_params, own.wide_ws, own.chain, goal, settings.ik).finish(targets, found);
  if (!accepts) return found;
  const std::size_t nq = start.size();
  for (std::size_t i = 0; i < targets.size(); ++i)
    if (found.success[i] != 0) found.success[i] = accepts(std::span(found.q).subspan(i * nq, nq));
  return found;
}

const IkChain& IkSearch::chain() const { return parts_->chain; }

}  // namespace manyhands
