#include "manyhands/learn/trainer_config.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace manyhands::learn {

namespace {

template <class T>
void require(bool holds, const char* field, T value, const char* wanted) {
  if (holds) return;
  std::ostringstream message;
  message << "TrainerConfig: " << field << " is " << value << ", it must be " << wanted;
  throw std::invalid_argument(message.str());
}

template <class T>
void require_range(const char* field, T value, T low, T high) {
  std::ostringstream wanted;
  wanted << "in [" << low << ", " << high << "]";
  require(std::isfinite(value) && value >= low && value <= high, field, value, wanted.str().c_str());
}

void require_at_least(const char* field, int value, int least) {
  require(value >= least, field, value, ("at least " + std::to_string(least)).c_str());
}

/// 1, 1/2 after the half-life, ...; without one always 1.
float halved(std::int64_t steps, int half_life) {
  if (half_life == 0) return 1;
  return static_cast<float>(std::exp2(-static_cast<double>(steps) / half_life));
}

}  // namespace

void TrainerConfig::validate() const {
  require_at_least("num_threads", num_threads, 1);
  require(!hidden_layers.empty(), "the number of hidden_layers", hidden_layers.size(), "at least 1");
  for (const int units : hidden_layers) require(units >= 1 && units <= 8192, "a hidden layer", units, "in [1, 8192]");
  require(num_critics >= 1 && num_critics <= 16, "num_critics", num_critics, "in [1, 16]");
  require(batch_size >= 2 && batch_size % 2 == 0, "batch_size", batch_size, "even and at least 2");
  require(gamma >= 0 && gamma < 1, "gamma", gamma, "in [0, 1)");
  require(return_steps >= 1 && return_steps <= 100, "return_steps", return_steps, "in [1, 100]");
  require(target_rate > 0 && target_rate <= 1, "target_rate", target_rate, "in (0, 1]");
  require(actor_learning_rate > 0 && actor_learning_rate <= 1, "actor_learning_rate", actor_learning_rate, "in (0, 1]");
  require(critic_learning_rate > 0 && critic_learning_rate <= 1, "critic_learning_rate", critic_learning_rate,
          "in (0, 1]");
  require_at_least("learning_rate_half_life", learning_rate_half_life, 0);
  require_at_least("policy_delay", policy_delay, 1);
  require_range("target_noise", target_noise, 0.0f, 10.0f);
  require_range("target_noise_clip", target_noise_clip, 0.0f, 10.0f);
  require_range("action_penalty", action_penalty, 0.0f, 1e6f);
  require(num_quantiles >= 1 && num_quantiles <= 256, "num_quantiles", num_quantiles, "in [1, 256]");
  require(dropped_quantiles >= 0 && dropped_quantiles < num_quantiles, "dropped_quantiles", dropped_quantiles,
          "at least 0 and less than num_quantiles");
  require(num_quantiles == 1 || algorithm == Algorithm::kSac, "num_quantiles", num_quantiles,
          "1 but with SAC, whose policy takes their mean");
  require(temperature > 0 && std::isfinite(temperature), "temperature", temperature, "positive");
  require(std::isfinite(target_entropy), "target_entropy", target_entropy, "finite");
  require_range("cloning_weight", cloning_weight, 0.0f, 1e6f);
  require(differences.size() % 2 == 0, "the length of differences", differences.size(), "even, two for each pair");
  for (const int i : differences) require_at_least("an index in differences", i, 0);
  require_at_least("cube_rotation", cube_rotation, -1);
  require(input_clip > 0 && std::isfinite(input_clip), "input_clip", input_clip, "positive");
  require_at_least("rollout_steps", rollout_steps, 1);
  require_at_least("epochs", epochs, 1);
  require_range("gae_lambda", gae_lambda, 0.0, 1.0);
  require_range("clip_range", clip_range, 0.0f, 1.0f);
  require_range("entropy_weight", entropy_weight, 0.0f, 1e3f);
  require_range("value_weight", value_weight, 0.0f, 1e3f);
  require(max_gradient_norm > 0, "max_gradient_norm", max_gradient_norm, "positive");
  require(!channels.empty() && channels.size() <= 8, "the number of channels", channels.size(), "in [1, 8]");
  for (const int count : channels) require(count >= 1 && count <= 1024, "one of channels", count, "in [1, 1024]");
  require(frame_stack >= 1 && frame_stack <= 16, "frame_stack", frame_stack, "in [1, 16]");
  require(shift >= 0 && shift <= 64, "shift", shift, "in [0, 64]");
  require_range("state_weight", state_weight, 0.0f, 1e6f);
  require_at_least("updates_per_iteration", updates_per_iteration, 0);
  require_at_least("replay_capacity", replay_capacity, 1);
  require(warmup_transitions >= 1 && warmup_transitions <= replay_capacity, "warmup_transitions", warmup_transitions,
          "at least 1 and at most replay_capacity");
  require_range("hindsight_fraction", hindsight_fraction, 0.0, 1.0);
  require_range("expert_rate", expert_rate, 0.0, 1.0);
  require_range("exploration_noise", exploration_noise, 0.0f, 10.0f);
  require_range("random_action_rate", random_action_rate, 0.0, 1.0);
  require(algorithm != Algorithm::kPpo || expert_rate == 0, "expert_rate", expert_rate,
          "0 with PPO, which learns from what its own policy does");
  require(initial_std > 0 && initial_std <= 10, "initial_std", initial_std, "in (0, 10]");
  require_at_least("cloning_half_life", cloning_half_life, 0);
  require(algorithm != Algorithm::kDagger || (cloning_weight > 0 && !cloning_filter), "cloning_weight", cloning_weight,
          "positive, and cloning_filter false, with DAgger, which learns from the expert alone");
  require(algorithm == Algorithm::kTd3 || algorithm == Algorithm::kDagger || policy_delay == 1, "policy_delay",
          policy_delay, "1 with SAC and PPO");
  require(algorithm != Algorithm::kSac || cloning_weight == 0, "cloning_weight", cloning_weight,
          "0 with SAC; TD3, PPO and DAgger are drawn to the expert");
  require_at_least("round_steps", round_steps, 1);
  require_at_least("evaluation_interval", evaluation_interval, 1);
  require_at_least("evaluation_episodes", evaluation_episodes, 1);
  require_range("stop_success_rate", stop_success_rate, 0.0, 1.0);
  require_at_least("stop_streak", stop_streak, 0);
}

float TrainerConfig::rate_scale(std::int64_t gradient_steps) const {
  return halved(gradient_steps, learning_rate_half_life);
}

float TrainerConfig::cloning_weight_at(std::int64_t gradient_steps) const {
  return cloning_weight * halved(gradient_steps, cloning_half_life);
}

}  // namespace manyhands::learn
