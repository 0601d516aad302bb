#include "manyhands/kinematics/ik_search.h"

#include <algorithm>
#include <numbers>
#include <numeric>

#include "manyhands/math/instantiate.h"
#include "manyhands/math/philox.h"

namespace manyhands {

namespace {

using T = NativeLanes;
constexpr int W = width_v<T>;

/// One search: what all attempts share, and the best that each target has so far.
class Search {
 public:
  Search(const Model& model, FrameId frame, const IkGoal& goal, std::span<const IkTarget<double>> targets,
         std::span<const double> start, const IkSearchSettings& settings)
      : chain_(model, frame),
        goal_(goal),
        targets_(targets),
        settings_(settings),
        lanes_ik_(settings.ik),
        tree_(model),
        params_(model),
        ws_(tree_),
        start_(start.begin(), start.end()),
        q_(start.size()),
        error2_(targets.size(), std::numeric_limits<double>::infinity()) {
    lanes_ik_.position_tolerance = std::max(settings.ik.position_tolerance, kFinestInFloat);
    lanes_ik_.rotation_tolerance = std::max(settings.ik.rotation_tolerance, kFinestInFloat);
    for (std::size_t i = 0; i < targets.size(); ++i) found_.q.insert(found_.q.end(), start.begin(), start.end());
    found_.success.assign(targets.size(), 0);
    found_.position_error = found_.rotation_error = error2_;
    found_.attempts.assign(targets.size(), 0);
  }

  /// An attempt of each of `rounds` for each target of `open`; keeps there those that have not been reached.
  void attempt(int first_round, int rounds, std::vector<std::size_t>& open) {
    attempts_.clear();
    for (int round = first_round; round < first_round + rounds; ++round) {
      for (const std::size_t i : open) attempts_.push_back({i, round});
    }
    const std::span<const Attempt> all(attempts_);
    for (std::size_t first = 0; first < all.size(); first += W)
      attempt_block(all.subspan(first, std::min<std::size_t>(W, all.size() - first)));
    std::erase_if(open, [&](std::size_t i) { return found_.success[i] != 0; });
  }

  /// Solutions are refined and judged in double, the others only measured.
  IkSolutions finish(const Model& model) {
    const Tree<double> tree(model);
    const ParamsStorage<double> params(model);
    Workspace<double> ws(tree);
    for (std::size_t i = 0; i < targets_.size(); ++i) {
      double* q = &found_.q[i * q_.size()];
      if (settings_.ik.respect_limits) keep_within_limits(tree, params, q);
      const IkResult<double> result = refine(i, tree, params, q, ws);
      found_.success[i] = result.success;
      found_.position_error[i] = result.position_error;
      found_.rotation_error[i] = result.rotation_error;
    }
    return std::move(found_);
  }

 private:
  static constexpr int kRefinements = 5;
  static constexpr double kLeastDamping = 1e-12;  // in double
  static constexpr double kFinestInFloat = 1e-6;  // [m, rad], to which lanes tell errors from rounding; double goes on

  IkResult<double> refine(std::size_t i, const Tree<double>& tree, const Params<double>& params, double* q,
                          Workspace<double>& ws) {
    IkSettings ik = settings_.ik;
    if (found_.success[i] == 0)
      ik.max_iterations = 0;
    else if (goal_.posture.empty())
      ik.max_iterations = kRefinements;
    const auto solve = [&] { return solve_goal(tree, params, chain_, ik, goal_, targets_[i], q, ws); };
    const IkResult<double> result = solve();
    if (found_.success[i] == 0 || result.success) return result;
    // Near singular postures the damping holds the last digits back; with less of it a solve may lead away.
    ik.damping = std::min(ik.damping, kLeastDamping);
    ik.max_iterations = settings_.ik.max_iterations;
    const std::vector<double> refined(q, q + q_.size());
    const IkResult<double> further = solve();
    if (further.success) return further;
    std::ranges::copy(refined, q);
    return result;
  }

  struct Attempt {
    std::size_t target;
    int round;
  };

  void attempt_block(std::span<const Attempt> block) {
    IkTarget<T> target{Transform<T>::identity(), Vec3<T>::zero()};
    for (int k = 0; k < W; ++k) {
      const auto [i, round] =
          block[std::min(static_cast<std::size_t>(k), block.size() - 1)];  // spare lanes repeat the last
      set_target(target, k, targets_[i]);
      set_start(round, i, k);
    }
    const IkResult<T> result = solve_goal(tree_, params_, chain_, lanes_ik_, goal_, target, q_.data(), ws_);
    const T error2 = square(constant<T>(goal_.position_weight) * result.position_error) +
                     square(constant<T>(goal_.rotation_weight) * result.rotation_error);
    for (std::size_t at = 0; at < block.size(); ++at)
      keep(block[at].target, static_cast<int>(at), error2, result.success);
  }

  static void set_target(IkTarget<T>& lanes, int k, const IkTarget<double>& target) {
    const auto set = [k](Vec3<T>& to, const Vec3<double>& wide) {
      const Vec3<float> from = broadcast<float>(wide);
      set_lane(to.x, k, from.x);
      set_lane(to.y, k, from.y);
      set_lane(to.z, k, from.z);
    };
    set(lanes.X_WF.R.x, target.X_WF.R.x);
    set(lanes.X_WF.R.y, target.X_WF.R.y);
    set(lanes.X_WF.R.z, target.X_WF.R.z);
    set(lanes.X_WF.p, target.X_WF.p);
    set(lanes.toward, target.toward);
  }

  void set_start(int round, std::size_t i, int k) {
    for (std::size_t j = 0; j < q_.size(); ++j) set_lane(q_[j], k, static_cast<float>(start_[j]));
    if (round == 0) return;
    RandomStream random(settings_.seed, static_cast<std::uint32_t>(i), static_cast<std::uint64_t>(round));
    for (const std::size_t dof : chain_.dofs) {
      const auto j = static_cast<std::size_t>(tree_.dof_q[dof]);
      constexpr float kFar = std::numbers::pi_v<float>;  // where there is no limit [rad or m]
      const float here = static_cast<float>(start_[j]);
      const float low = is_finite(params_.lower[dof]) ? params_.lower[dof] : here - kFar;
      const float high = is_finite(params_.upper[dof]) ? params_.upper[dof] : here + kFar;
      set_lane(q_[j], k, random.uniform(low, high));
    }
  }

  void keep(std::size_t i, int k, T error2, const mask_t<T>& success) {
    if (found_.success[i] != 0) return;  // an earlier round of the same block reached it
    ++found_.attempts[i];
    const double error = lane(error2, k);
    const bool reached = lane(success, k);  // counts more than a smaller sum of errors
    if (!reached && !(error < error2_[i])) return;
    error2_[i] = error;
    found_.success[i] = reached;
    for (std::size_t j = 0; j < q_.size(); ++j) found_.q[i * q_.size() + j] = static_cast<double>(lane(q_[j], k));
  }

  void keep_within_limits(const Tree<double>& tree, const Params<double>& params, double* q) const {
    for (const std::size_t dof : chain_.dofs) {
      double& x = q[tree.dof_q[dof]];
      x = clamp(x, params.lower[dof], params.upper[dof]);
    }
  }

  IkChain chain_;
  const IkGoal& goal_;
  std::span<const IkTarget<double>> targets_;
  IkSearchSettings settings_;
  IkSettings lanes_ik_;
  Tree<float> tree_;
  ParamsStorage<float> params_;
  Workspace<T> ws_;
  std::vector<double> start_;
  std::vector<T> q_;
  std::vector<Attempt> attempts_;
  std::vector<double> error2_;  ///< (n) squared, of the best attempt
  IkSolutions found_;
};

void require(bool holds, const std::string& otherwise) {
  if (!holds) throw std::invalid_argument(otherwise);
}

void check(const Model& model, const IkGoal& goal, std::span<const double> start) {
  const auto nq = static_cast<std::size_t>(model.nq());
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
  check(model, goal, start);
  Search search(model, frame, goal, targets, start, settings);
  std::vector<std::size_t> open(targets.size());
  std::iota(open.begin(), open.end(), std::size_t{0});
  for (int round = 0, rounds = 1; round <= settings.restarts && !open.empty(); round += rounds) {
    // Few targets leave lanes for the next rounds; but the first often suffices, and is over soon.
    const int spare = round == 0 ? 1 : std::max(1, W / static_cast<int>(std::min<std::size_t>(W, open.size())));
    rounds = std::min(spare, settings.restarts - round + 1);
    search.attempt(round, rounds, open);
  }
  return search.finish(model);
}

}  // namespace manyhands
