// How a policy does in fresh episodes.
#pragma once

#include <cstdint>

#include "manyhands/envs/env_batch.h"
#include "manyhands/learn/performer.h"

namespace manyhands::learn {

/// Means over episodes.
struct EvalResult {
  int episodes{};
  double success_rate{};  ///< is_success at the last step of the episode
  double mean_return{};   ///< undiscounted
  double mean_length{};   ///< environment steps
};

/// Runs `episodes` episodes, as many at a time as there are worlds. Episode k is the same
/// whatever the size of `envs`: it starts from seed first_seed + k. Throws std::invalid_argument if there is none to
/// run.
[[nodiscard]] EvalResult evaluate_policy(EnvBatch& envs, Performer& performer, int episodes, std::uint64_t first_seed);

}  // namespace manyhands::learn
