// Proximal policy optimisation: learning from what the present policy did, in steps that change it little.
//
// Schulman et al., "Proximal policy optimization algorithms", 2017, equation 9.
#pragma once

#include <array>

#include "manyhands/learn/learner.h"
#include "manyhands/learn/privileged_input.h"
#include "manyhands/learn/reward_scale.h"
#include "manyhands/learn/rollout.h"

namespace manyhands::learn {

/// Every `rollout_steps` steps of the worlds it goes `epochs` times through them in mini-batches, in another order each
/// time; what is left over of an epoch waits for the next one.
class Ppo final : public Learner {
 public:
  Ppo(const EnvSpec& spec, int num_worlds, int input_dim, const TrainerConfig& config);

  [[nodiscard]] const Actor* actor() const override { return config_.average_policy ? &average_ : &actor_; }
  [[nodiscard]] std::int64_t gradient_steps() const override { return actor_optimiser_.step_count(); }

  void choose_actions(const Collector& worlds, const InputNormaliser& normaliser, std::int64_t iteration,
                      Matrix<float>& action) override;
  void observe(const Collector& worlds, const InputNormaliser& normaliser) override;
  void learn(const Collector& worlds, const InputNormaliser& normaliser, Halves& halves, LearnStats& stats) override;

  void save(ArchiveWriter& out, bool with_replay) const override;
  void load(ArchiveReader& in) override;

 private:
  /// What one half of a mini-batch needs and leaves.
  struct Half {
    MlpTape<float> actor, value;
    Vector<float> actor_gradient, value_gradient, log_std_gradient;
    double squared_error{}, value_sum{}, entropy{};
  };

  void update(std::span<const int> rows, Halves& halves, LearnStats& stats);
  void compute_gradients(std::span<const int> rows, int half);
  void step(Halves& halves);

  void write_states(const EnvBatch& envs, const InputNormaliser& normaliser);

  TrainerConfig config_;
  PrivilegedInput privileged_;
  Actor actor_, average_;  // the latter a running mean of the former
  Mlp<float> value_;
  Adam<float> actor_optimiser_, value_optimiser_, log_std_optimiser_;
  RewardScale reward_scale_;
  Rollout rollout_;
  MlpTape<float> acting_, valuing_;  // an input of the latter has what critics alone see below the former's
  std::array<Half, 2> halves_;
  std::vector<int> order_;  // of the rollout's rows in this epoch
  float advantage_mean_ = 0, advantage_scale_ = 1;
  std::int64_t epochs_ = 0;
};

}  // namespace manyhands::learn
