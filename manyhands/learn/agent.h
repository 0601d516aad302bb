// The off-policy actor-critic update: deterministic or soft policy gradient with target networks.
//
// DDPG: Lillicrap et al., "Continuous control with deep reinforcement learning", 2016.
// TD3: Fujimoto, van Hoof, Meger, "Addressing function approximation error in actor-critic methods", 2018.
// SAC: Haarnoja et al., "Soft actor-critic algorithms and applications", 2018.
#pragma once

#include <array>
#include <cstdint>

#include "manyhands/learn/actor.h"
#include "manyhands/learn/archive.h"
#include "manyhands/learn/critics.h"
#include "manyhands/learn/halves.h"
#include "manyhands/learn/squashed_gaussian.h"
#include "manyhands/learn/trainer_config.h"

namespace manyhands::learn {

/// Half of a mini-batch as the networks see it, one transition per column.
struct AgentBatch {
  Matrix<float> state, next_state;  ///< (state_dim + privileged_dim, n), normalised; the policy sees the first rows
  Matrix<float> action;             ///< (action_dim, n)
  Matrix<float> advice;             ///< (action_dim, n), an expert's actions; read if `cloning_weight` is not 0
  Vector<float> advised;            ///< (n), 1 where there is advice, else 0
  Vector<float> reward;             ///< (n)
  Vector<float> discount;           ///< (n), gamma, or 0 where nothing follows
};

/// Bounds of any return, so of any sensible target value.
struct ValueBounds {
  float low{}, high{};
};

/// Means over the mini-batch.
struct UpdateStats {
  float critic_loss{};  ///< squared Bellman error or quantile loss, averaged over the critics
  float q{};            ///< value of the sampled actions under the first critic
  bool policy_updated{};
  float policy_q{};  ///< what the policy's own actions are worth, if the policy was updated
  float entropy{};   ///< SAC: of the policy, if it was updated
};

/// Actor, critics, their targets and optimisers. Knows nothing of environments, goals or replay.
class Agent {
 public:
  /// `privileged_dim`: rows of a state that critics alone see, below the others.
  Agent(int state_dim, int action_dim, const TrainerConfig& config, int privileged_dim = 0);

  /// The policy that acts.
  [[nodiscard]] const Actor& actor() const { return config_.average_policy ? actor_target_ : actor_; }

  /// The two halves, to be filled before `update`; a half owns its columns, so each may be filled on its own thread.
  [[nodiscard]] AgentBatch& half(int index) { return halves_[static_cast<std::size_t>(index)].batch; }

  /// One gradient step on both halves: critics always, policy and targets every `policy_delay` steps. Learning rates
  /// are `rate_scale` times the config's.
  UpdateStats update(Halves& halves, const ValueBounds& bounds, float rate_scale = 1);

  [[nodiscard]] std::int64_t gradient_steps() const { return gradient_steps_; }
  [[nodiscard]] float temperature() const;

  void save(ArchiveWriter& out) const;
  void load(ArchiveReader& in);

 private:
  /// What one half needs and leaves; the gradients of both are summed in fixed order.
  struct Half {
    AgentBatch batch;
    MlpTape<float> actor;
    SquashedDraw<float> draw;
    CriticTape critics;
    Matrix<float> next_action;
    Vector<float> cloned;  // per transition: whether the policy shall act as the expert
    Vector<float> actor_gradient;
    double policy_q_sum{}, log_probability_sum{};
  };

  [[nodiscard]] bool soft() const { return config_.algorithm == Algorithm::kSac; }
  [[nodiscard]] bool has_critics() const { return config_.algorithm != Algorithm::kDagger; }
  void update_critics(Halves& halves, const ValueBounds& bounds, float rate_scale, bool targets_follow);
  void update_policy(Halves& halves, float rate_scale);
  void compute_targets(Half& half, int index, const ValueBounds& bounds) const;
  void choose_next_action(Half& half, int index) const;
  void compute_actor_gradient(Half& half, int index) const;
  void draw_action(Half& half, int index) const;
  void climb_value(Half& half, const Matrix<float>& action, float weight) const;
  void clone_expert(Half& half) const;
  void apply_actor(int part);
  void follow_entropy(float rate_scale);

  TrainerConfig config_;
  int state_dim_;
  Actor actor_, actor_target_;
  Adam<float> actor_optimiser_;
  Critics critics_;
  Vector<float> log_temperature_;  // (1)
  Adam<float> temperature_optimiser_;
  std::array<Half, 2> halves_;
  std::int64_t gradient_steps_ = 0;
};

}  // namespace manyhands::learn
