// Experience replay that relabels goals in hindsight (Andrychowicz et al., "Hindsight Experience Replay", 2017).
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "manyhands/base/memory_block.h"
#include "manyhands/envs/env_batch.h"
#include "manyhands/learn/archive.h"
#include "manyhands/learn/mlp.h"
#include "manyhands/learn/random.h"

namespace manyhands::learn {

/// One finished episode of `length` steps; row t of `observation` and `achieved_goal` is the state before step t.
struct EpisodeView {
  int length{};
  bool terminated{};                       ///< ended by success; otherwise by the step limit
  std::span<const float> observation;      ///< (length + 1, observation_dim)
  std::span<const float> achieved_goal;    ///< (length + 1, goal_dim)
  std::span<const float> desired_goal;     ///< (goal_dim)
  std::span<const float> action;           ///< (length, action_dim)
  std::span<const float> reward;           ///< (length)
  std::span<const float> advice = {};      ///< (length, advice_dim), the expert's actions for the desired goal
  std::span<const float> randomized = {};  ///< (privileged_dim), what the environment has drawn for the episode
};

/// Over how many steps a return is summed before the critics tell the rest (Sutton, 1988), and its discount.
struct Returns {
  int steps = 1;
  float gamma = 0.95f;
};

/// A mini-batch, one transition per column, or `steps` that follow one another as if they were one. Sized by
/// `ReplayBuffer::make_minibatch`.
struct Minibatch {
  Matrix<float> observation, next_observation;      ///< (observation_dim, n)
  Matrix<float> achieved_goal, next_achieved_goal;  ///< (goal_dim, n)
  Matrix<float> desired_goal;                       ///< (goal_dim, n), relabelled in the first columns
  Matrix<float> action;                             ///< (action_dim, n)
  Matrix<float> advice;                             ///< (advice_dim, n), worth something where the goal is the task's
  Matrix<float> randomized;                         ///< (privileged_dim, n)
  Vector<float> reward;                             ///< (n), discounted and summed over the steps
  Vector<float> discount;                           ///< (n), what next_* is worth: gamma^steps, 0 where nothing follows
  int relabelled = 0;                               ///< columns with a new goal: the first ones

  [[nodiscard]] int size() const { return static_cast<int>(reward.size()); }

  Returns returns;
  Matrix<float> step_achieved, step_goal;  // scratch, a column for each step that a new goal rewards
  Vector<float> step_reward;
  std::vector<std::int32_t> at;  // (n), where in the replay a column begins
};

/// How hindsight changes a mini-batch.
struct Hindsight {
  double fraction = 0.8;           ///< of the mini-batch gets a new goal: k/(k+1) for k new goals per old one
  bool success_terminates = true;  ///< whether reaching a goal ends an episode
};

/// A ring of transitions that knows where episodes end, in one block.
///
/// A new goal is what the same episode achieves at a uniformly drawn later step ("future"). Its reward comes from
/// `EnvBatch::compute_reward`. A relabelled transition is done exactly when that reward is a success reward (at least
/// the lowest with which an episode has ended so far, at first 0), because reaching the goal would have ended the
/// episode there; the flag that the environment gave belongs to the old goal. Truncation never makes it done.
class ReplayBuffer {
 public:
  /// `advice_dim`: action_dim if episodes come with an expert's advice, else 0. `privileged_dim`: how many numbers are
  /// kept of what the environment has drawn for an episode. `folder`: see `MemoryBlock`.
  /// Throws std::invalid_argument unless capacity >= spec.max_episode_steps > 0, and what `MemoryBlock` throws.
  ReplayBuffer(const EnvSpec& spec, int capacity, int advice_dim = 0, int privileged_dim = 0,
               const std::filesystem::path& folder = {});

  [[nodiscard]] int capacity() const { return capacity_; }
  [[nodiscard]] int size() const { return size_; }  ///< transitions held
  [[nodiscard]] float lowest_reward() const { return lowest_reward_; }
  [[nodiscard]] float highest_reward() const { return highest_reward_; }

  /// Appends an episode, overwriting the oldest transitions. Throws std::invalid_argument on wrong lengths.
  void add(const EpisodeView& episode);

  [[nodiscard]] Minibatch make_minibatch(int n, const Returns& returns = {}) const;

  /// Fills every column with a transition drawn uniformly and, of its episode, the `returns.steps` - 1 after it, as far
  /// as there are. Does not allocate. Requires size() > 0.
  void sample(const EnvBatch& task, const Hindsight& hindsight, Random random, Minibatch& batch) const;

  void save(ArchiveWriter& out) const;
  void load(ArchiveReader& in);

 private:
  [[nodiscard]] const float* row(std::size_t at) const {
    return data_.as<float>() + at * static_cast<std::size_t>(row_);
  }
  [[nodiscard]] const float* next_achieved(std::size_t at) const;
  [[nodiscard]] std::size_t later(std::size_t at, std::uint32_t steps) const;
  void copy(std::size_t at, int column, Minibatch& batch) const;
  void reward_new_goals(const EnvBatch& task, Minibatch& batch) const;
  void follow(int column, const Hindsight& hindsight, Minibatch& batch) const;

  EnvSpec spec_;
  int capacity_ = 0, size_ = 0, next_ = 0;
  int advice_dim_ = 0, privileged_dim_ = 0;
  // Floats per transition: observation, achieved, next of both, desired, action, advice, randomized, reward.
  int row_ = 0;
  MemoryBlock data_;                        // floats (capacity, row_)
  std::vector<std::int32_t> steps_to_end_;  // (capacity), 0 at the last step of an episode
  std::vector<std::uint8_t> terminated_;    // (capacity)
  float lowest_reward_ = 0, highest_reward_ = 0, success_reward_ = 0;
};

}  // namespace manyhands::learn
