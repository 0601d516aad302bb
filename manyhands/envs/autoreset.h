// What becomes of a world whose episode has ended: the three autoreset modes of Gymnasium's vector environments.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "manyhands/envs/env_batch.h"

namespace manyhands {

/// When a finished world starts its next episode (https://farama.org/Vector-Autoreset-Mode).
enum class AutoresetMode : std::uint8_t {
  kNextStep,  ///< with the step after the last: that step ignores its action and gives reward 0
  kSameStep,  ///< with the last step: it returns the new episode's start, and the last observation as a final row
  kDisabled,  ///< when the caller resets it; stepping on before that is an error
};

/// Steps a batch with resets and a limit on episodes as Gymnasium's SyncVectorEnv does with TimeLimit environments.
///
/// Observations, goals and successes are read from `envs()` after a call. The views of this class are overwritten by
/// the next `step` or `reset`.
class AutoresetBatch {
 public:
  /// `envs` is borrowed and must be stepped by nobody else. An episode is truncated after `max_episode_steps` steps, in
  /// place of the batch's own limit; 0: never. Throws std::invalid_argument if it is negative.
  AutoresetBatch(EnvBatch& envs, AutoresetMode mode, int max_episode_steps);

  [[nodiscard]] const EnvBatch& envs() const { return envs_; }
  [[nodiscard]] AutoresetMode mode() const { return mode_; }

  /// Starts a new episode in the worlds whose `mask` byte is not 0 (all if empty). World i's random stream restarts
  /// from seeds[i] where `seeded`[i] is not 0 and continues elsewhere; both have length n or are empty (nothing is
  /// seeded). Throws std::invalid_argument on a wrong length.
  void reset(std::span<const std::uint8_t> mask, std::span<const std::uint64_t> seeds,
             std::span<const std::uint8_t> seeded);

  /// One step of every world under `action` (n, action_dim), and the resets that the mode asks for.
  /// Throws std::invalid_argument on a bad action, std::logic_error in mode kDisabled if a finished world has not been
  /// reset; nothing has been stepped then.
  void step(std::span<const float> action);

  [[nodiscard]] std::span<const double> reward() const { return reward_; }                ///< (n), of the last step
  [[nodiscard]] std::span<const std::uint8_t> terminated() const { return terminated_; }  ///< (n), success ended it
  [[nodiscard]] std::span<const std::uint8_t> truncated() const {
    return truncated_;
  }  ///< (n), the limit or instability

  /// The batch's snapshot, and where each world is in its episode.
  [[nodiscard]] std::vector<std::uint8_t> snapshot() const;
  /// Continues from a snapshot; outcomes are zeros until the next step. Throws std::invalid_argument if it is of
  /// another environment.
  void restore(std::span<const std::uint8_t> snapshot);

  /// The k worlds that ended and started anew within the last `step` (mode kSameStep), and their last rows.
  struct Final {
    std::vector<int> world;                                       // (k), ascending
    std::vector<float> observation, achieved_goal, desired_goal;  // (k, ...)
    std::vector<std::uint8_t> is_success, unstable;               // (k)
    std::vector<float> randomized;                                // (k, spec().randomized.size())
  };
  [[nodiscard]] const Final& final() const { return final_; }
  /// In mode kSameStep, `look` is called with the worlds that have ended before they start anew: what it sees of
  /// `envs()` is the end of their episodes. For pictures, which rows do not hold.
  void on_final(std::function<void(std::span<const int>)> look) { look_ = std::move(look); }

 private:
  void record_outcomes();
  void keep_final_rows();
  void forget_final_rows();

  EnvBatch& envs_;
  AutoresetMode mode_;
  int max_episode_steps_;
  std::vector<std::int32_t> steps_;                   // (n), of the running episode
  std::vector<double> reward_;                        // (n)
  std::vector<std::uint8_t> terminated_, truncated_;  // (n)
  std::vector<std::uint8_t> done_;                    // (n), ended and not reset yet
  Final final_;
  std::function<void(std::span<const int>)> look_;
};

}  // namespace manyhands
