// A trained policy that acts: without training, without Python, in as many worlds at once as there are.
#pragma once

#include <cstdint>
#include <span>

#include "manyhands/learn/actor.h"
#include "manyhands/learn/evaluation.h"
#include "manyhands/learn/normaliser.h"
#include "manyhands/learn/policy.h"

namespace manyhands::learn {

class PolicyRunner {
 public:
  /// Throws std::invalid_argument if the policy's arrays do not fit each other.
  explicit PolicyRunner(const Policy& policy);

  [[nodiscard]] int action_dim() const { return actor_.action_dim(); }

  /// The best actions (n, action_dim) in n states: observation (n, observation_dim), goals (n, goal_dim). Every
  /// component lies in [-1, 1], or is the index of a choice. Throws std::invalid_argument on other lengths.
  void act(std::span<const float> observation, std::span<const float> achieved_goal,
           std::span<const float> desired_goal, std::span<float> action);

  /// As `evaluate_policy`. Throws std::invalid_argument if the policy is of other sizes than the environment.
  [[nodiscard]] EvalResult evaluate(EnvBatch& envs, int episodes, std::uint64_t first_seed) const;

 private:
  int observation_dim_, goal_dim_;
  InputNormaliser normaliser_;
  Actor actor_;
  MlpTape<float> tape_;
  Matrix<float> action_;
};

}  // namespace manyhands::learn
