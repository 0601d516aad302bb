// Learns a goal-reaching policy on a batch of environments: off-policy actor-critic with hindsight replay.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "manyhands/envs/env_batch.h"
#include "manyhands/learn/agent.h"
#include "manyhands/learn/collector.h"
#include "manyhands/learn/halves.h"
#include "manyhands/learn/normaliser.h"
#include "manyhands/learn/replay.h"
#include "manyhands/learn/trainer_config.h"

namespace manyhands::learn {

/// Where training stands. Counters run from the beginning (across checkpoints); losses and q are means over the call
/// to `advance` that returned them, 0 where it took no gradient step; times are of this process.
struct TrainMetrics {
  std::int64_t iterations{}, env_steps{}, gradient_steps{}, episodes{};
  double success_rate{};  ///< of the last (up to) 100 training episodes, which explore
  double critic_loss{}, q_mean{}, policy_q_mean{};
  double evaluation_success_rate{};  ///< of the last periodic evaluation
  int evaluations{}, streak{};       ///< evaluations made; how many in a row, up to now, were good enough
  bool solved{};                     ///< the streak is long enough: `advance` does nothing more
  double collect_seconds{}, learn_seconds{}, evaluate_seconds{};
};

struct EvalResult {
  int episodes{};
  double success_rate{};  ///< is_success at the last step of the episode
  double mean_return{};   ///< undiscounted
  double mean_length{};   ///< environment steps
};

/// The deterministic policy as plain arrays: a = tanh(W_L relu(... relu(W_1 z + b_1) ...) + b_L) with
/// z = clip((x - mean) * scale, -clip, clip) and x = [observation, desired_goal, desired_goal - achieved_goal,
/// observation[i, i + 3) - observation[k, k + 3) for each pair of `differences`].
struct Policy {
  struct Layer {
    int inputs{}, outputs{};
    std::vector<float> weight;  ///< (outputs, inputs), row-major
    std::vector<float> bias;    ///< (outputs)
  };
  int observation_dim{}, goal_dim{}, action_dim{};
  std::vector<float> mean, scale;  ///< (observation_dim + 2 goal_dim + 3 pairs)
  float clip{};
  std::vector<int> differences;  ///< pairs (i, k)
  std::vector<Layer> layers;
};

class Trainer {
 public:
  /// Borrows both batches, which must outlive the trainer and be stepped by nobody else. `evaluation` serves the
  /// periodic evaluations (its worlds are the episodes run at a time); without it nothing is evaluated or stopped.
  /// `expert`, borrowed likewise, is asked in every state if the config wants one; it may be null if not.
  /// Throws std::invalid_argument if the config makes no sense or the batches are of different kinds.
  Trainer(EnvBatch& envs, EnvBatch* evaluation, const TrainerConfig& config, Expert* expert = nullptr);

  [[nodiscard]] const TrainerConfig& config() const { return config_; }

  /// Runs up to `iterations` more: each one step of the batch and `updates_per_iteration` gradient steps, now and then
  /// an evaluation. Stops early when solved. Throws std::runtime_error if the networks diverge to non-numbers.
  TrainMetrics advance(int iterations);

  [[nodiscard]] TrainMetrics metrics() const { return metrics_; }

  /// Runs the noise-free policy for `episodes` episodes; episode k is the same whatever the size of `envs`: it starts
  /// from seed first_seed + k. Throws std::invalid_argument if `envs` is another kind of environment.
  [[nodiscard]] EvalResult evaluate(EnvBatch& envs, int episodes, std::uint64_t first_seed) const;

  [[nodiscard]] Policy policy() const;

  /// Writes everything from which training goes on exactly: networks, optimisers, statistics, counters, running
  /// episodes and, if wanted, the replay buffer. The file appears whole or not at all. Throws CheckpointError.
  void save(const std::filesystem::path& path, bool with_replay = true) const;

  /// Continues from a file written by a trainer with the same task, number of worlds, networks and replay capacity;
  /// the seed is taken from the file, the rest of the config stays as it is. With the replay, and an environment that
  /// gives the same bits again, everything that follows is what would have followed `save`. Returns whether the
  /// running episodes could be restored; if not, every world starts a new one. Throws CheckpointError, leaving the
  /// trainer as it was.
  bool load(const std::filesystem::path& path);

 private:
  static constexpr int kRecentEpisodes = 100;

  struct Losses {
    double critic = 0, q = 0, policy_q = 0;
    int critic_steps = 0, policy_steps = 0;
  };

  [[nodiscard]] static ReplayBuffer empty_replay(const EnvSpec& spec, const TrainerConfig& config);

  void collect();
  void learn(Losses& losses);
  void check_progress();
  void choose_actions();
  void store(int world);
  void fill_half(int half);
  void act(const EnvBatch& envs, MlpTape<float>& tape) const;
  void require_same_task(const EnvBatch& envs) const;
  void save_shape(ArchiveWriter& out) const;
  void expect_shape(ArchiveReader& in) const;

  TrainerConfig config_;
  EnvSpec spec_;
  EnvBatch* evaluation_ = nullptr;
  Collector collector_;
  ReplayBuffer replay_;
  Minibatch minibatch_;
  InputNormaliser normaliser_;
  Agent agent_;
  std::unique_ptr<Halves> halves_;
  MlpTape<float> acting_;
  Matrix<float> actions_;                       // (action_dim, worlds)
  std::vector<std::uint8_t> recent_successes_;  // ring of the last training episodes
  TrainMetrics metrics_;
};

}  // namespace manyhands::learn
