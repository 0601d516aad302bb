#include "manyhands/planning/rrt_connect.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <ranges>

#include "manyhands/math/instantiate.h"
#include "manyhands/math/philox.h"

namespace manyhands {

namespace {

constexpr std::size_t kNodeLanes = width_v<NativeLanes>;
constexpr int kNoParent = -1;

/// Nodes as blocks of lanes, each with its coordinates one after the other: the nearest is found in lanes.
class RrtTree {
 public:
  explicit RrtTree(std::size_t n) : n_(n) {}

  [[nodiscard]] std::size_t size() const { return parent_.size(); }
  [[nodiscard]] int parent(int node) const { return parent_[static_cast<std::size_t>(node)]; }
  /// The longest edge to try from a node.
  [[nodiscard]] float& step(int node) { return step_[static_cast<std::size_t>(node)]; }

  int add(std::span<const float> q, int parent, float step) {
    const std::size_t i = size();
    if (i % kNodeLanes == 0) coordinates_.resize(coordinates_.size() + n_ * kNodeLanes, kFarAway);
    for (std::size_t k = 0; k < n_; ++k) coordinates_[place(i, k)] = q[k];
    parent_.push_back(parent);
    step_.push_back(step);
    return static_cast<int>(i);
  }

  void copy(int node, std::span<float> q) const {
    for (std::size_t k = 0; k < n_; ++k) q[k] = coordinates_[place(static_cast<std::size_t>(node), k)];
  }

  /// The node nearest to q.
  [[nodiscard]] int nearest(std::span<const float> q) const {
    NativeLanes least = constant<NativeLanes>(kUnreached), block_of_least = constant<NativeLanes>(0);
    const std::size_t blocks = coordinates_.size() / (n_ * kNodeLanes);
    for (std::size_t block = 0; block < blocks; ++block) {
      NativeLanes sum = constant<NativeLanes>(0);
      for (std::size_t k = 0; k < n_; ++k) {
        const NativeLanes d = load<NativeLanes>(&coordinates_[place(block * kNodeLanes, k)]) - NativeLanes(q[k]);
        sum = fma(d, d, sum);
      }
      const mask_t<NativeLanes> nearer(sum < least);
      least = select(nearer, sum, least);
      block_of_least = select(nearer, NativeLanes(static_cast<float>(block)), block_of_least);
    }
    std::size_t best = 0;
    float square = kUnreached;
    for (std::size_t k = 0; k < kNodeLanes; ++k) {
      const float d = lane(least, static_cast<int>(k));
      const std::size_t node = static_cast<std::size_t>(lane(block_of_least, static_cast<int>(k))) * kNodeLanes + k;
      if (d < square || (d == square && node < best)) {
        best = node;
        square = d;
      }
    }
    return static_cast<int>(best);
  }

 private:
  static constexpr float kFarAway = 1e15f, kUnreached = 1e30f;

  [[nodiscard]] std::size_t place(std::size_t node, std::size_t k) const {
    return ((node / kNodeLanes) * n_ + k) * kNodeLanes + node % kNodeLanes;
  }

  std::size_t n_;
  std::vector<float> coordinates_, step_;
  std::vector<int> parent_;
};

class RrtConnect {
 public:
  RrtConnect(const PlanningScene& scene, ConfigurationCheck& check, const RrtSettings& settings)
      : n_(scene.size()),
        scene_(scene),
        check_(check),
        range_(static_cast<float>(settings.range)),
        random_(settings.seed, 0, 0),
        sample_(n_),
        from_(n_),
        to_(n_),
        trees_{RrtTree(n_), RrtTree(n_)} {}

  RrtPath search(std::span<const float> start, std::span<const float> goals, const Deadline& deadline) {
    RrtPath found;
    set_bounds(start, goals);
    trees_[kFromStart].add(start, kNoParent, range_);
    bool met = false;
    for (std::size_t i = 0; i < goals.size() / n_ && !met && !deadline.has_passed(); ++i) {
      trees_[kFromGoals].add(goals.subspan(i * n_, n_), kNoParent, range_);
      met = connect(kFromGoals, static_cast<int>(i), kFromStart, 0);
    }
    while (!met && !deadline.has_passed()) {
      ++found.iterations;
      met = grow(trees_[kFromStart].size() <= trees_[kFromGoals].size() ? kFromStart : kFromGoals);
    }
    found.nodes = trees_[0].size() + trees_[1].size();
    if (met) found.rows = path();
    return found;
  }

 private:
  // Of a node's longest step, in ranges: where no edge is free, the next is shorter, so that trees creep out of
  // corners.
  static constexpr float kShrinking = 0.95f, kGrowth = 2, kLeastStep = 0.1f;
  static constexpr std::size_t kFromStart = 0, kFromGoals = 1;

  /// Samples lie within limits, and at most half a turn (or pi metres) beyond start and goals: joints that turn twice
  /// around need not be tried in every turn.
  void set_bounds(std::span<const float> start, std::span<const float> goals) {
    constexpr float kBeyond = std::numbers::pi_v<float>;
    for (std::size_t k = 0; k < n_; ++k) {
      float low = start[k], high = start[k];
      for (std::size_t i = k; i < goals.size(); i += n_) {
        low = std::min(low, goals[i]);
        high = std::max(high, goals[i]);
      }
      low_.push_back(std::max(static_cast<float>(scene_.lower[k]), low - kBeyond));
      high_.push_back(std::min(static_cast<float>(scene_.upper[k]), high + kBeyond));
    }
  }

  /// One sample: the tree takes a step towards it, and the other one comes to meet it. Whether they met.
  bool grow(std::size_t side) {
    RrtTree& tree = trees_[side];
    for (std::size_t k = 0; k < n_; ++k) sample_[k] = random_.uniform(low_[k], high_[k]);
    const int near = tree.nearest(sample_);
    tree.copy(near, from_);
    float& step = tree.step(near);
    if (step_towards(sample_, step) == Step::kStuck || !check_.is_free(from_, to_)) {
      step = std::max(step * kShrinking, kLeastStep * range_);
      return false;
    }
    step = std::min(step * kGrowth, range_);
    const int added = tree.add(to_, near, step);
    const std::size_t other = 1 - side;
    tree.copy(added, sample_);
    return connect(side, added, other, trees_[other].nearest(sample_));
  }

  /// Leads the tree `other` from its node `near` to `node` of the tree `side`, as far as edges are free.
  bool connect(std::size_t side, int node, std::size_t other, int near) {
    trees_[side].copy(node, sample_);
    trees_[other].copy(near, from_);
    for (;;) {
      const Step step = step_towards(sample_, range_);
      if (step == Step::kStuck || !check_.is_free(from_, to_)) return false;
      if (step == Step::kArrives) {
        meeting_[side] = node;
        meeting_[other] = near;
        return true;
      }
      near = trees_[other].add(to_, near, range_);
      std::swap(from_, to_);
    }
  }

  /// Sets `to_` to where a step from `from_` towards the target leads.
  Step step_towards(std::span<const float> target, float longest) {
    return manyhands::step_towards(check_, from_, target, longest, to_);
  }

  [[nodiscard]] std::vector<float> path() const {
    std::vector<int> from_start;
    for (int i = meeting_[kFromStart]; i != kNoParent; i = trees_[kFromStart].parent(i)) from_start.push_back(i);
    std::vector<float> rows;
    const auto append = [&](std::size_t side, int node) {
      rows.resize(rows.size() + n_);
      trees_[side].copy(node, std::span(rows).last(n_));
    };
    for (const int i : std::views::reverse(from_start)) append(kFromStart, i);
    for (int i = meeting_[kFromGoals]; i != kNoParent; i = trees_[kFromGoals].parent(i)) append(kFromGoals, i);
    return rows;
  }

  std::size_t n_;
  const PlanningScene& scene_;
  ConfigurationCheck& check_;
  float range_;
  RandomStream random_;
  std::vector<float> low_, high_, sample_, from_, to_;
  std::array<RrtTree, 2> trees_;
  std::array<int, 2> meeting_{};
};

}  // namespace

RrtPath rrt_connect(const PlanningScene& scene, ConfigurationCheck& check, std::span<const float> start,
                    std::span<const float> goals, const RrtSettings& settings, const Deadline& deadline) {
  return RrtConnect(scene, check, settings).search(start, goals, deadline);
}

}  // namespace manyhands
