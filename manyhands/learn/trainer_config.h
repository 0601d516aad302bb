// Everything that can be set about training, with the defaults that solve PandaReach in seconds.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "manyhands/learn/mlp.h"
#include "manyhands/learn/relations.h"

namespace manyhands::learn {

enum class Algorithm {
  kTd3,     ///< deterministic policy gradient: DDPG, and with its three additions TD3
  kSac,     ///< soft actor-critic, and with quantiles TQC
  kPpo,     ///< proximal policy optimisation: on-policy
  kDagger,  ///< imitation of the expert in the states that the policy comes to; the reward is not learned from
};

struct TrainerConfig {  ///< all that a run is told
  Algorithm algorithm = Algorithm::kTd3;
  std::uint64_t seed = 0;  ///< of networks, exploration, sampling and episodes
  int num_threads = 2;     ///< 1 or 2 are used for gradient steps; the results are the same bits

  // Networks and their update
  std::vector<int> hidden_layers = {64, 64};  ///< units of each hidden layer, of actor and critics alike
  HiddenActivation activation = HiddenActivation::kRelu;
  int num_critics = 1;        ///< 1: DDPG; more: the smallest of their values is the target (TD3, SAC)
  int batch_size = 256;       ///< transitions per gradient step, even
  double gamma = 0.95;        ///< discount per environment step, in [0, 1)
  int return_steps = 1;       ///< rewards that are summed before the critics tell the rest (n-step returns)
  float target_rate = 0.05f;  ///< Polyak rate of the target networks, in (0, 1]
  float actor_learning_rate = 1e-3f;
  float critic_learning_rate = 1e-3f;
  int learning_rate_half_life = 0;  ///< gradient steps after which learning rates are half as large; 0: they stay
  int policy_delay = 1;             ///< critic steps per policy (and target) step; TD3: 2
  bool average_policy = false;      ///< act by a running mean of the policy's weights: TD3's target network
  float target_noise = 0.0f;        ///< standard deviation of the smoothing noise on target actions; TD3: 0.2
  float target_noise_clip = 0.5f;   ///< its largest magnitude
  float action_penalty = 0.0f;      ///< weight of |action|^2 in the policy's loss
  int num_quantiles = 1;            ///< of the return, that a critic gives; 1: its mean; TQC: 25
  int dropped_quantiles = 0;        ///< the largest of each critic that a target leaves out; TQC: 2
  float temperature = 1.0f;         ///< SAC: weight of the policy's entropy beside the return, at first
  bool learned_temperature = true;  ///< SAC: it follows so that the entropy becomes `target_entropy`
  float target_entropy = 0.0f;      ///< SAC: of the policy; 0: -action_dim
  float cloning_weight = 0.0f;      ///< in the policy's loss, of |action - the expert's|^2 where the goal is the task's
  bool cloning_filter = true;       ///< only where the first critic prefers the expert's action to the policy's
  int cloning_half_life = 0;        ///< gradient steps after which cloning_weight counts half as much; 0: it stays
  /// Pairs (i, k): the network also sees o[i, i + 3) - o[k, k + 3) of an observation o, as fine as 2 cm: where a hand
  /// must be within millimetres of something, both of which it knows to a tenth of a metre.
  std::vector<int> differences = {};
  int cube_rotation = -1;   ///< where in an observation a cube's quaternion is that the goal wants, see `Relations`
  float input_clip = 5.0f;  ///< largest normalised network input, in standard deviations
  bool privileged_critic = false;  ///< critics see what the environment has randomised, too; the policy does not

  // PPO
  int rollout_steps = 32;          ///< environment steps of every world between updates
  int epochs = 10;                 ///< how often an update goes through them
  double gae_lambda = 0.95;        ///< of the advantages, in [0, 1]
  float clip_range = 0.2f;         ///< by which a probability may change in one update, as a part of it
  float initial_std = 1.0f;        ///< of the actions that are drawn, at first
  float entropy_weight = 0.0f;     ///< in the loss, of -entropy
  float value_weight = 0.5f;       ///< in the loss, of the squared error of the value
  float max_gradient_norm = 0.5f;  ///< of policy and value together; longer ones are shortened
  bool scale_rewards = true;       ///< by the standard deviation of the discounted return so far

  // DAgger from pictures
  std::vector<int> channels = {16, 32, 32};  ///< of the layers that see: 4 x 4 pixels, then 3 x 3 of the layer below
  int frame_stack = 2;                       ///< pictures of each camera that are seen, the last ones
  int shift = 3;                             ///< in learning, pictures are moved by up to so many pixels
  float state_weight = 1.0f;  ///< in the loss, of the squared error of the state, which the network is asked to tell

  // Experience
  int updates_per_iteration = 8;    ///< gradient steps after each step of the batch
  int replay_capacity = 1'000'000;  ///< transitions
  std::string replay_folder = {};   ///< the replay lies in a file there rather than in memory, unless it is empty
  int warmup_transitions = 2000;    ///< in the replay before learning starts; until then actions are random
  double hindsight_fraction = 0.8;  ///< of a mini-batch gets a goal achieved later in the same episode; 0: no HER
  bool success_terminates = true;   ///< whether the task ends an episode at its goal
  double expert_rate = 0.0;  ///< share of the worlds in which the expert acts; if not 0, in all of them until learning
  float exploration_noise = 0.2f;   ///< standard deviation of the noise on actions
  double random_action_rate = 0.2;  ///< probability of a uniform action instead

  int round_steps = 5;  ///< of worlds elsewhere: steps of each under one policy

  // Stopping: evaluations of the noise-free policy on fresh episodes, if the trainer has an evaluation batch
  int evaluation_interval = 25;    ///< iterations between evaluations
  int evaluation_episodes = 250;   ///< episodes of each
  double stop_success_rate = 1.0;  ///< an evaluation at or above this counts towards stopping
  int stop_streak = 3;             ///< this many in a row end the training; 0: never

  /// Throws std::invalid_argument naming the first field that makes no sense, its value and what would.
  void validate() const;

  [[nodiscard]] Relations relations() const { return {differences, cube_rotation}; }

  /// What the learning rates are multiplied with after so many gradient steps.
  [[nodiscard]] float rate_scale(std::int64_t gradient_steps) const;

  /// `cloning_weight` after so many gradient steps.
  [[nodiscard]] float cloning_weight_at(std::int64_t gradient_steps) const;

  /// Whether something here asks for the task's expert.
  [[nodiscard]] bool wants_expert() const { return expert_rate > 0 || cloning_weight > 0; }
};

}  // namespace manyhands::learn
