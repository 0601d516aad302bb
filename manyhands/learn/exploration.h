// What off-policy learners try in the worlds.
#pragma once

#include "manyhands/learn/actor.h"
#include "manyhands/learn/collector.h"
#include "manyhands/learn/normaliser.h"

namespace manyhands::learn {

/// The policy's action plus noise, of SAC an action drawn from it, or now and then, and during the warm-up always, a
/// uniform one. Where the expert acts, its action plus noise: what it shows then leads back to its way, too (Laskey et
/// al., DART, 2017).
class Exploration {
 public:
  /// For worlds first, ..., first + count - 1 of all: the expert leads in the same share of any stretch of them.
  Exploration(const Actor& actor, const TrainerConfig& config, int first, int count);

  /// Fills `action` (action_dim, count). The same arguments give the same actions.
  void choose(const Actor& actor, const Collector& worlds, const InputNormaliser& normaliser, std::int64_t iteration,
              bool warming_up, Matrix<float>& action);

 private:
  TrainerConfig config_;
  Eigen::Index led_;  // worlds in which the expert acts
  MlpTape<float> tape_;
  Matrix<float> policy_action_;  // (action_dim, count)
};

}  // namespace manyhands::learn
