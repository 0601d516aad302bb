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
  Search(const Model& model, FrameId frame, std::span<const Transform<double>> targets, std::span<const double> start,
         const IkSearchSettings& settings)
      : chain_(model, frame),
        targets_(targets),
        settings_(settings),
        tree_(model),
        params_(model),
        ws_(tree_),
        start_(start.begin(), start.end()),
        q_(start.size()),
        error2_(targets.size(), std::numeric_limits<double>::infinity()) {
    for (std::size_t i = 0; i < targets.size(); ++i) found_.q.insert(found_.q.end(), start.begin(), start.end());
    found_.success.assign(targets.size(), 0);
    found_.position_error = found_.rotation_error = error2_;
    found_.attempts.assign(targets.size(), 0);
  }

  /// One attempt for each target of `open`; keeps there those that have not been reached.
  void attempt(int round, std::vector<std::size_t>& open) {
    for (std::size_t first = 0; first < open.size(); first += W) {
      attempt_block(round, std::span(open).subspan(first, std::min<std::size_t>(W, open.size() - first)));
    }
    std::erase_if(open, [&](std::size_t i) { return found_.success[i] != 0; });
  }

  /// Solutions are refined and judged in double, the others only measured.
  IkSolutions finish(const Model& model) {
    const Tree<double> tree(model);
    const ParamsStorage<double> params(model);
    Workspace<double> ws(tree);
    for (std::size_t i = 0; i < targets_.size(); ++i) {
      double* q = &found_.q[i * q_.size()];
      IkSettings ik = settings_.ik;
      ik.max_iterations = found_.success[i] != 0 ? kRefinements : 0;
      if (ik.respect_limits) keep_within_limits(tree, params, q);
      const IkResult<double> result = solve_ik(tree, params, chain_, ik, targets_[i], q, ws);
      found_.success[i] = result.success;
      found_.position_error[i] = result.position_error;
      found_.rotation_error[i] = result.rotation_error;
    }
    return std::move(found_);
  }

 private:
  static constexpr int kRefinements = 5;

  void attempt_block(int round, std::span<const std::size_t> block) {
    Transform<T> target = Transform<T>::identity();
    for (int k = 0; k < W; ++k) {
      const std::size_t i =
          block[std::min(static_cast<std::size_t>(k), block.size() - 1)];  // spare lanes repeat the last
      set_target(target, k, broadcast<float>(targets_[i]));
      set_start(round, i, k);
    }
    const IkResult<T> result = solve_ik(tree_, params_, chain_, settings_.ik, target, q_.data(), ws_);
    const T error2 = square(result.position_error) + square(result.rotation_error);
    for (std::size_t at = 0; at < block.size(); ++at) keep(block[at], static_cast<int>(at), error2, result.success);
  }

  static void set_target(Transform<T>& lanes, int k, const Transform<float>& target) {
    const auto set = [k](Vec3<T>& to, const Vec3<float>& from) {
      set_lane(to.x, k, from.x);
      set_lane(to.y, k, from.y);
      set_lane(to.z, k, from.z);
    };
    set(lanes.R.x, target.R.x);
    set(lanes.R.y, target.R.y);
    set(lanes.R.z, target.R.z);
    set(lanes.p, target.p);
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
    ++found_.attempts[i];
    const double error = lane(error2, k);
    if (!(error < error2_[i])) return;
    error2_[i] = error;
    found_.success[i] = lane(success, k);
    for (std::size_t j = 0; j < q_.size(); ++j) found_.q[i * q_.size() + j] = static_cast<double>(lane(q_[j], k));
  }

  void keep_within_limits(const Tree<double>& tree, const Params<double>& params, double* q) const {
    for (const std::size_t dof : chain_.dofs) {
      double& x = q[tree.dof_q[dof]];
      x = clamp(x, params.lower[dof], params.upper[dof]);
    }
  }

  IkChain chain_;
  std::span<const Transform<double>> targets_;
  IkSearchSettings settings_;
  Tree<float> tree_;
  ParamsStorage<float> params_;
  Workspace<T> ws_;
  std::vector<double> start_;
  std::vector<T> q_;
  std::vector<double> error2_;  ///< (n) squared, of the best attempt
  IkSolutions found_;
};

}  // namespace

IkSolutions search_ik(const Model& model, FrameId frame, std::span<const Transform<double>> targets,
                      std::span<const double> start, const IkSearchSettings& settings) {
  if (start.size() != static_cast<std::size_t>(model.nq())) {
    throw std::invalid_argument("the start has " + std::to_string(start.size()) + " numbers; the model's q has " +
                                std::to_string(model.nq()));
  }
  Search search(model, frame, targets, start, settings);
  std::vector<std::size_t> open(targets.size());
  std::iota(open.begin(), open.end(), std::size_t{0});
  for (int round = 0; round <= settings.restarts && !open.empty(); ++round) search.attempt(round, open);
  return search.finish(model);
}

}  // namespace manyhands
