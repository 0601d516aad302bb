#include "manyhands/envs/autoreset.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

#include "manyhands/base/hash.h"
#include "manyhands/physics/world/snapshot.h"

namespace manyhands {

namespace {

bool any(std::span<const std::uint8_t> mask) {
  return std::ranges::any_of(mask, [](std::uint8_t byte) { return byte != 0; });
}

void append_row(std::span<const float> rows, int world, int dim, std::vector<float>& to) {
  const auto row =
      rows.subspan(static_cast<std::size_t>(world) * static_cast<std::size_t>(dim), static_cast<std::size_t>(dim));
  to.insert(to.end(), row.begin(), row.end());
}

bool is_unstable(const EnvBatch& envs, std::size_t world) {
  return !envs.unstable().empty() && envs.unstable()[world] != 0;
}

void require_length(const char* what, std::size_t actual, std::size_t expected) {
  if (actual == 0 || actual == expected) return;
  throw std::invalid_argument("AutoresetBatch::reset: " + std::string(what) + " has length " + std::to_string(actual) +
                              ", expected one per world: " + std::to_string(expected));
}

}  // namespace

AutoresetBatch::AutoresetBatch(EnvBatch& envs, AutoresetMode mode, int max_episode_steps)
    : envs_(envs), mode_(mode), max_episode_steps_(max_episode_steps) {
  if (max_episode_steps < 0) {
    throw std::invalid_argument("AutoresetBatch: max_episode_steps is " + std::to_string(max_episode_steps) +
                                ", expected a positive number, or 0 for no limit");
  }
  const auto n = static_cast<std::size_t>(envs.num_envs());
  steps_.resize(n);
  reward_.resize(n);
  terminated_.resize(n);
  truncated_.resize(n);
  done_.resize(n);
}

void AutoresetBatch::reset(std::span<const std::uint8_t> mask, std::span<const std::uint64_t> seeds,
                           std::span<const std::uint8_t> seeded) {
  const std::size_t n = steps_.size();
  require_length("mask", mask.size(), n);
  require_length("seeds", seeds.size(), n);
  require_length("seeded", seeded.size(), seeds.size());

  std::vector<std::uint8_t> with_seed(n), without_seed(n);
  for (std::size_t i = 0; i < n; ++i) {
    if (!mask.empty() && mask[i] == 0) continue;
    const bool has_seed = !seeded.empty() && seeded[i] != 0;
    (has_seed ? with_seed : without_seed)[i] = 1;
    steps_[i] = 0;
    terminated_[i] = truncated_[i] = done_[i] = 0;
  }
  if (any(with_seed)) envs_.reset(with_seed, seeds);
  if (any(without_seed)) envs_.reset(without_seed);
  forget_final_rows();
}

void AutoresetBatch::step(std::span<const float> action) {
  const bool restart = any(done_);
  if (restart && mode_ == AutoresetMode::kDisabled) {
    throw std::logic_error("AutoresetBatch::step: world " +
                           std::to_string(std::ranges::find(done_, 1) - done_.begin()) +
                           " has ended its episode and autoreset is disabled; reset it first");
  }
  envs_.step(action);
  forget_final_rows();
  record_outcomes();
  if (mode_ == AutoresetMode::kNextStep && restart) {
    envs_.reset(done_);
    for (std::size_t i = 0; i < done_.size(); ++i) {
      if (done_[i] == 0) continue;
      steps_[i] = 0;
      reward_[i] = 0;
      terminated_[i] = truncated_[i] = 0;
    }
  }
  for (std::size_t i = 0; i < done_.size(); ++i) done_[i] = terminated_[i] | truncated_[i];
  if (mode_ == AutoresetMode::kSameStep && any(done_)) {
    keep_final_rows();
    if (look_) look_(final_.world);
    envs_.reset(done_);
    for (const int world : final_.world) steps_[static_cast<std::size_t>(world)] = 0;
    std::ranges::fill(done_, std::uint8_t{0});
  }
}

namespace {

SnapshotOwner episodes_of(const EnvBatch& envs, int max_episode_steps) {
  Hash hash;
  hash.add(max_episode_steps);
  return {"episodes of at most " + std::to_string(max_episode_steps) + " steps of " + envs.spec().id + ", " +
              std::to_string(envs.num_envs()) + " worlds",
          hash.value()};
}

}  // namespace

std::vector<std::uint8_t> AutoresetBatch::snapshot() const {
  const std::vector<std::uint8_t> inner = envs_.snapshot();
  SnapshotWriter out(episodes_of(envs_, max_episode_steps_));
  out.put(static_cast<std::int64_t>(inner.size()));
  out.put_bytes(inner);
  for (const std::int32_t steps : steps_) out.put(static_cast<std::int64_t>(steps));
  out.put_bytes(done_);
  return out.finish();
}

void AutoresetBatch::restore(std::span<const std::uint8_t> snapshot) {
  SnapshotReader in(snapshot, episodes_of(envs_, max_episode_steps_));
  const auto inner =
      in.take_bytes(static_cast<std::size_t>(in.take_count("a length", static_cast<std::int64_t>(in.left()))));
  std::vector<std::int32_t> steps;
  std::vector<std::uint8_t> done;
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    steps.push_back(static_cast<std::int32_t>(in.take_count("a count of steps", std::numeric_limits<int>::max())));
  }
  for (std::size_t i = 0; i < done_.size(); ++i) done.push_back(in.take<std::uint8_t>() != 0);
  in.finish();
  envs_.restore(inner);
  steps_ = std::move(steps);
  done_ = std::move(done);
  std::ranges::fill(reward_, 0);
  std::ranges::fill(terminated_, std::uint8_t{0});
  std::ranges::fill(truncated_, std::uint8_t{0});
  forget_final_rows();
}

void AutoresetBatch::record_outcomes() {
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    ++steps_[i];
    reward_[i] = static_cast<double>(envs_.reward()[i]);
    terminated_[i] = envs_.terminated()[i];
    truncated_[i] = (max_episode_steps_ > 0 && steps_[i] >= max_episode_steps_) || is_unstable(envs_, i);
  }
}

void AutoresetBatch::keep_final_rows() {
  const EnvSpec& spec = envs_.spec();
  for (std::size_t i = 0; i < done_.size(); ++i) {
    if (done_[i] == 0) continue;
    const auto world = static_cast<int>(i);
    final_.world.push_back(world);
    append_row(envs_.observation(), world, spec.observation_dim, final_.observation);
    append_row(envs_.achieved_goal(), world, spec.goal_dim, final_.achieved_goal);
    append_row(envs_.desired_goal(), world, spec.goal_dim, final_.desired_goal);
    final_.is_success.push_back(envs_.is_success()[i]);
    final_.unstable.push_back(is_unstable(envs_, i));
    append_row(envs_.randomized(), world, static_cast<int>(spec.randomized.size()), final_.randomized);
  }
}

void AutoresetBatch::forget_final_rows() {
  final_.world.clear();
  final_.observation.clear();
  final_.achieved_goal.clear();
  final_.desired_goal.clear();
  final_.is_success.clear();
  final_.unstable.clear();
  final_.randomized.clear();
}

}  // namespace manyhands
