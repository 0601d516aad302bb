// Scripted policies that solve the tasks: proof that each can be solved, a guard against regressions, demonstrations.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "manyhands/envs/env_batch.h"

namespace manyhands {

/// Acts in every world of a batch, from what is observed. Made for one batch: it may remember where each world is in
/// its plan, and begins anew where an episode begins.
class Expert {
 public:
  virtual ~Expert() = default;

  /// Writes the next actions (n, action_dim), each in [-1, 1]. Throws std::invalid_argument if `envs` are of another id
  /// than the expert, or on a wrong length.
  virtual void act(const EnvBatch& envs, std::span<float> action) = 0;
};

/// The ids that `make_expert` knows: every task under end-effector control.
[[nodiscard]] std::vector<std::string> expert_ids();

/// The expert of the environment `id`. Throws std::invalid_argument on an id without one; the message lists the ids.
[[nodiscard]] std::unique_ptr<Expert> make_expert(const std::string& id);

}  // namespace manyhands
