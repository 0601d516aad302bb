// What learners with a replay try in the worlds.
#pragma once

#include <cstdint>
#include <span>

#include "manyhands/learn/actor.h"
#include "manyhands/learn/collector.h"
#include "manyhands/learn/normaliser.h"

namespace manyhands::learn {

/// Varies what a policy would do in worlds first, ..., first + count - 1 of all, and says where the expert acts.
class Exploration {
 public:
  /// The expert leads in the same share of any stretch of the worlds.
  Exploration(const TrainerConfig& config, int first, int count);

  /// Fills `action` (action_dim, count): the policy's plus noise, or now and then, and during the warm-up always, a
  /// uniform one. Where the expert acts, its `advice` (count, action_dim) plus noise: what it shows then leads back to
  /// its way, too (Laskey et al., DART, 2017). The same arguments give the same actions.
  void vary(const Matrix<float>& policy_action, std::span<const float> advice, std::int64_t iteration, bool warming_up,
            Matrix<float>& action) const;

 private:
  TrainerConfig config_;
  Eigen::Index led_;  // worlds in which the expert acts
};

/// The same for an actor that sees the state. Of SAC, an action drawn from it is varied.
class StateExploration {
 public:
  StateExploration(const Actor& actor, const TrainerConfig& config, int first, int count);

  /// Fills `action` (action_dim, count). The same arguments give the same actions.
  void choose(const Actor& actor, const Collector& worlds, const InputNormaliser& normaliser, std::int64_t iteration,
              bool warming_up, Matrix<float>& action);

 private:
  TrainerConfig config_;
  Exploration exploration_;
  MlpTape<float> tape_;
  Matrix<float> policy_action_;  // (action_dim, count)
};

}  // namespace manyhands::learn
