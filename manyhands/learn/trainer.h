// Trains a policy on a batch of environments: the loop, evaluations and checkpoints around a learner.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "manyhands/envs/env_batch.h"
#include "manyhands/learn/collector.h"
#include "manyhands/learn/evaluation.h"
#include "manyhands/learn/halves.h"
#include "manyhands/learn/learner.h"
#include "manyhands/learn/normaliser.h"
#include "manyhands/learn/policy.h"
#include "manyhands/learn/share.h"
#include "manyhands/learn/trainer_config.h"

namespace manyhands::learn {

/// Where training stands. Counters run from the beginning (across checkpoints); losses and q are means over the call
/// to `advance` that returned them, 0 where it took no gradient step; times are of this process. Where there is no
/// critic (DAgger) its loss is the squared error of actions.
struct TrainMetrics {
  std::int64_t iterations{}, env_steps{}, gradient_steps{}, episodes{};
  double success_rate{};  ///< of the last (up to) 100 training episodes, which explore
  double critic_loss{}, q_mean{}, policy_q_mean{};
  double entropy{};                  ///< of the policy: PPO, SAC
  double mean_return{};              ///< undiscounted, of the last (up to) 100 training episodes
  double evaluation_success_rate{};  ///< of the last periodic evaluation
  int evaluations{}, streak{};       ///< evaluations made; how many in a row, up to now, were good enough
  bool solved{};                     ///< the streak is long enough: `advance` does nothing more
  double collect_seconds{}, learn_seconds{}, evaluate_seconds{};
};

class Trainer {  ///< steps environments, collects, learns and keeps checkpoints
 public:
  /// Borrows both batches, which must outlive the trainer and be stepped by nobody else. `evaluation` serves the
  /// periodic evaluations (its worlds are the episodes run at a time); without it nothing is evaluated or stopped.
  /// `expert`, borrowed likewise, is asked in every state if the config wants one; it may be null if not.
  /// `eyes` are the cameras of a policy that sees pictures, in training and evaluation.
  /// Throws std::invalid_argument if the config makes no sense or the batches are of different kinds.
  Trainer(EnvBatch& envs, EnvBatch* evaluation, const TrainerConfig& config, Expert* expert = nullptr,
          const std::vector<Eye>& eyes = {});

  [[nodiscard]] const TrainerConfig& config() const { return config_; }
  [[nodiscard]] int action_dim() const { return spec_.action_dim; }

  /// Runs up to `iterations` more: each one step of the batch and `updates_per_iteration` gradient steps, now and then
  /// an evaluation. Stops early when solved. Throws DivergenceError if the networks diverge to non-numbers.
  TrainMetrics advance(int iterations);

  /// From now on every world of training runs elsewhere, in shares of so many (`Share`); those of `envs` rest, and only
  /// say what goals are worth. To be called first. Instead of `advance` there are rounds: each share runs `order` from
  /// its `place` on, `receive` takes what they bring, and while they run the next order, `learn` learns from that. So
  /// the policy of an order knows nothing of the round before it, and the same seed and shares give the same bits.
  /// Throws std::invalid_argument if the algorithm learns from worlds of its own alone.
  void spread(std::vector<int> shares);

  /// What all shares are to do now, and where share i begins. Both hold until `receive`, across checkpoints.
  [[nodiscard]] const Message& order() const { return rounds_.order; }
  [[nodiscard]] const Message& place(int share) const { return rounds_.places[static_cast<std::size_t>(share)]; }

  /// Takes in what the shares brought, in their order, and makes the next order. Throws CheckpointError, having taken
  /// nothing, if something else came.
  void receive(std::span<const Message> results);

  /// The gradient steps and evaluations that are due after a round.
  TrainMetrics learn();

  [[nodiscard]] TrainMetrics metrics() const { return metrics_; }

  /// From now on learning rates are `scale` times the config's: for schedules, which checkpoints know nothing of.
  /// Throws std::invalid_argument unless it is finite and at least 0.
  void scale_rates(float scale);

  /// Runs the noise-free policy for `episodes` episodes; episode k is the same whatever the size of `envs`: it starts
  /// from seed first_seed + k. Throws std::invalid_argument if `envs` is another kind of environment.
  [[nodiscard]] EvalResult evaluate(EnvBatch& envs, int episodes, std::uint64_t first_seed) const;

  [[nodiscard]] Policy policy() const;

  /// The policy's actions (n, action_dim) in n states: observation (n, observation_dim), goals (n, goal_dim). With
  /// `draw` they are drawn as in training, and differ from call to call; else they are the best. Throws
  /// std::logic_error if the policy sees pictures.
  void predict(std::span<const float> observation, std::span<const float> achieved_goal,
               std::span<const float> desired_goal, bool draw, std::span<float> action);

  /// Writes everything from which training goes on exactly: networks, optimisers, statistics, counters, running
  /// episodes and, if wanted, the replay buffer. The file appears whole or not at all. Throws CheckpointError.
  void save(const std::filesystem::path& path, bool with_replay = true) const;

  /// Continues from a file written by a trainer with the same task, algorithm, number of worlds, networks and replay
  /// capacity; the seed is taken from the file, the rest of the config stays as it is. With the replay, and an
  /// environment that gives the same bits again, everything that follows is what would have followed `save`. Returns
  /// whether the running episodes could be restored; if not, every world starts a new one. Throws CheckpointError,
  /// leaving the trainer as it was.
  bool load(const std::filesystem::path& path);

 private:
  static constexpr int kRecentEpisodes = 100;

  /// What is under way in worlds elsewhere, so that it can be done again.
  struct Rounds {
    std::vector<int> shares;  // worlds of each
    Message order;
    std::vector<Message> places;
  };

  void collect();
  void learn_once(LearnStats& stats);
  TrainMetrics report(const LearnStats& stats);
  void check_progress();
  void count_episode(const EpisodeView& episode, bool succeeded);
  void make_order(std::int64_t iteration);
  void save_rounds(ArchiveWriter& out) const;
  void require_same_task(const EnvBatch& envs) const;
  void save_shape(ArchiveWriter& out) const;
  void expect_shape(ArchiveReader& in) const;
  [[nodiscard]] Rounds read_rounds(ArchiveReader& in) const;

  TrainerConfig config_;
  EnvSpec spec_;
  EnvBatch* evaluation_ = nullptr;
  std::vector<Eye> eyes_;
  Collector collector_;
  InputNormaliser normaliser_;
  std::unique_ptr<Learner> learner_;
  std::unique_ptr<Halves> halves_;
  Rounds rounds_;
  Matrix<float> actions_;                       // (action_dim, worlds)
  std::vector<std::uint8_t> recent_successes_;  // rings of the last training episodes
  std::vector<float> recent_returns_;
  std::uint64_t predictions_ = 0;
  TrainMetrics metrics_;
};

}  // namespace manyhands::learn
