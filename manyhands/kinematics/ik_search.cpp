#include "manyhands/kinematics/ik_search.h"

#include <algorithm>
#include <numeric>

#include "manyhands/kinematics/ik_attempts.h"
#include "manyhands/kinematics/ik_refinement.h"
#include "manyhands/math/instantiate.h"

namespace manyhands {

namespace {

using internal::IkAttempts;
using internal::IkQuestion;
using internal::IkRefinement;

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
void search(const IkQuestion& question, int last_round, Workspace<float>& ws, Workspace<NativeLanes>& lanes) {
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
  IkAttempts<NativeLanes>(question, {open, round, last_round}, lanes).run();
}

void require(bool holds, const char* otherwise) {
  if (!holds) throw std::invalid_argument(otherwise);
}

void require_size(const char* what, std::size_t n, std::size_t nq) {
  if (n == nq) return;
  throw std::invalid_argument(std::string("the ") + what + " has " + std::to_string(n) +
                              " numbers; the model's q has " + std::to_string(nq));
}

void check(std::size_t nq, const IkGoal& goal, std::span<const double> start) {
  require_size("start", start.size(), nq);
  if (!goal.posture.empty()) require_size("posture", goal.posture.size(), nq);
  const bool turns = goal.orientation != IkOrientation::kFree;
  const bool pointing = turns && goal.orientation != IkOrientation::kFull;
  require(goal.position_weight >= 0 && is_finite(goal.position_weight), "position_weight must be finite and 0 or more");
  require(goal.rotation_weight > 0 && is_finite(goal.rotation_weight), "rotation_weight must be finite and above 0");
  require(turns || goal.position_weight > 0, "the goal asks for no position and no orientation; give one of them");
  require(!pointing || abs(norm(goal.axis) - 1) < 1e-6, "the goal's axis must be of unit length");
}

}  // namespace

std::vector<double> within_limits(const Model& model, std::span<const double> q) {
  std::vector<double> inside(q.begin(), q.end());
  for (const Joint& joint : model.joints()) {
    if (configuration_size(joint.type) != 1) continue;
    double& x = inside[static_cast<std::size_t>(joint.iq)];
    x = clamp(x, joint.limits.lower, joint.limits.upper);
  }
  return inside;
}

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
  Parts(const Model& robot, IkChain moved)
      : model(robot),
        chain(std::move(moved)),
        tree(model),
        wide_tree(model),
        params(model),
        wide_params(model),
        ws(tree),
        lanes(tree),
        wide_ws(wide_tree),
        wide_lanes(wide_tree) {}

  const Model& model;
  IkChain chain;
  Tree<float> tree;
  Tree<double> wide_tree;
  ParamsStorage<float> params;
  ParamsStorage<double> wide_params;
  Workspace<float> ws;
  Workspace<NativeLanes> lanes;
  Workspace<double> wide_ws;
  Workspace<DoubleLanes> wide_lanes;
  std::optional<internal::IkSeeds> seeds{};
};

IkSearch::IkSearch(const Model& model, FrameId frame) : parts_(std::make_unique<Parts>(model, IkChain(model, frame))) {}

IkSearch::IkSearch(const Model& model, FrameId frame, FrameId relative_to)
    : parts_(std::make_unique<Parts>(model, IkChain(model, frame, relative_to))) {}

IkSearch::IkSearch(IkSearch&&) noexcept = default;
IkSearch& IkSearch::operator=(IkSearch&&) noexcept = default;
IkSearch::~IkSearch() = default;

IkSolutions IkSearch::find(const IkGoal& goal, std::span<const IkTarget<double>> targets, std::span<const double> given,
                           const IkSearchSettings& settings, const IkFilter& accepts) {
  Parts& own = *parts_;
  check(static_cast<std::size_t>(own.tree.nq), goal, given);
  const std::vector<double> start =
      settings.ik.respect_limits ? within_limits(own.model, given) : std::vector<double>(given.begin(), given.end());
  IkSolutions found = prepare(targets.size(), start, settings.restarts + 1);
  std::vector<double> nearest(targets.size(), std::numeric_limits<double>::infinity());
  constexpr std::size_t kNeeded = 6;  // with no more dofs the start does as well, and costs less
  const bool from_start = settings.from_start || own.chain.dofs.size() <= kNeeded || goal.position_weight == 0;
  const IkQuestion question{own.tree,  own.params, own.chain,     goal,       settings_of_attempts(settings),
                            targets,   start,      settings.seed, from_start, accepts,
                            own.seeds, found,      nearest};
  search(question, settings.restarts, own.ws, own.lanes);
  IkRefinement(own.wide_tree, own.wide_params, own.wide_ws, own.wide_lanes, own.chain, goal, settings.ik)
      .finish(targets, found);
  if (!accepts) return found;
  const std::size_t nq = start.size();
  for (std::size_t i = 0; i < targets.size(); ++i)
    if (found.success[i] != 0) found.success[i] = accepts(std::span(found.q).subspan(i * nq, nq));
  return found;
}

const IkChain& IkSearch::chain() const { return parts_->chain; }

}  // namespace manyhands
