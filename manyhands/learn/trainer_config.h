// Everything that can be set about training, with the defaults that solve PandaReach in seconds.
#pragma once

#include <cstdint>
#include <vector>

namespace manyhands::learn {

struct TrainerConfig {
  std::uint64_t seed = 0;  ///< of networks, exploration, sampling and episodes
  int num_threads = 2;     ///< 1 or 2 are used for gradient steps; the results are the same bits

  // Networks and their update
  std::vector<int> hidden_layers = {64, 64};  ///< units of each hidden layer, of actor and critics alike
  int num_critics = 1;                        ///< 1: DDPG; 2: the smaller of two values is the target (TD3)
  int batch_size = 256;                       ///< transitions per gradient step, even
  double gamma = 0.95;                        ///< discount per environment step, in [0, 1)
  float target_rate = 0.05f;                  ///< Polyak rate of the target networks, in (0, 1]
  float actor_learning_rate = 1e-3f;
  float critic_learning_rate = 1e-3f;
  int policy_delay = 1;            ///< critic steps per policy (and target) step; TD3: 2
  bool average_policy = false;     ///< act by the policy's target network, a running mean of its weights
  float target_noise = 0.0f;       ///< standard deviation of the smoothing noise on target actions; TD3: 0.2
  float target_noise_clip = 0.5f;  ///< its largest magnitude
  float action_penalty = 0.0f;     ///< weight of |action|^2 in the policy's loss
  float cloning_weight = 0.0f;     ///< in the policy's loss, of |action - the expert's|^2 where the goal is the task's
  bool cloning_filter = true;      ///< only where the first critic prefers the expert's action to the policy's
  /// Pairs (i, k): the network also sees o[i, i + 3) - o[k, k + 3) of an observation o, as fine as 2 cm: where a hand
  /// must be within millimetres of something, both of which it knows to a tenth of a metre.
  std::vector<int> differences = {};
  float input_clip = 5.0f;  ///< largest normalised network input, in standard deviations

  // Experience
  int updates_per_iteration = 8;    ///< gradient steps after each step of the batch
  int replay_capacity = 1'000'000;  ///< transitions
  int warmup_transitions = 2000;    ///< in the replay before learning starts; until then actions are random
  double hindsight_fraction = 0.8;  ///< of a mini-batch gets a goal achieved later in the same episode; 0: no HER
  bool success_terminates = true;   ///< whether the task ends an episode at its goal
  double expert_rate = 0.0;  ///< share of the worlds in which the expert acts; if not 0, in all of them until learning
  float exploration_noise = 0.2f;   ///< standard deviation of the noise on actions
  double random_action_rate = 0.2;  ///< probability of a uniform action instead

  // Stopping: evaluations of the noise-free policy on fresh episodes, if the trainer has an evaluation batch
  int evaluation_interval = 25;    ///< iterations between evaluations
  int evaluation_episodes = 250;   ///< episodes of each
  double stop_success_rate = 1.0;  ///< an evaluation at or above this counts towards stopping
  int stop_streak = 3;             ///< this many in a row end the training; 0: never

  /// Throws std::invalid_argument naming the first field that makes no sense, its value and what would.
  void validate() const;

  /// Whether something here asks for the task's expert.
  [[nodiscard]] bool wants_expert() const { return expert_rate > 0 || cloning_weight > 0; }
};

}  // namespace manyhands::learn
