// Scripted policies that solve the tasks: proof that each can be solved, a guard against regressions, demonstrations.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "manyhands/envs/env_batch.h"

namespace manyhands {

/// Acts in n worlds of one task from what is observed, here or in panda-gym. It may remember where each world is in its
/// plan, and begins anew where an episode begins: where the hand is at rest to the last bit.
class Expert {
 public:
  virtual ~Expert() = default;

  /// Writes the next actions (n, action_dim), each in [-1, 1], from rows (n, observation_dim) and goals (n, goal_dim).
  /// Throws std::invalid_argument on lengths that do not fit.
  virtual void act(std::span<const float> observation, std::span<const float> desired_goal,
                   std::span<float> action) = 0;

  /// The same for a batch of the expert's task.
  virtual void act(const EnvBatch& envs, std::span<float> action) {
    act(envs.observation(), envs.desired_goal(), action);
  }

  [[nodiscard]] virtual int action_dim() const = 0;
};

/// The ids that `make_expert` knows: every task under control of the end effector or the joints.
[[nodiscard]] std::vector<std::string> expert_ids();

/// The expert of the environment `id`. Throws std::invalid_argument on an id without one; the message lists the ids.
[[nodiscard]] std::unique_ptr<Expert> make_expert(const std::string& id);

/// An expert whose advice a policy can follow: it acts by what is observed and remembers nothing. That is the expert of
/// the environment, but of Flip and under control of the joints another, which solves less. Throws as `make_expert`.
[[nodiscard]] std::unique_ptr<Expert> make_adviser(const std::string& id);

}  // namespace manyhands
