// What is tried in the worlds: the policy's actions or the expert's, and noise.
#pragma once

#include <span>

#include "manyhands/learn/mlp.h"
#include "manyhands/learn/trainer_config.h"

namespace manyhands::learn {

/// Fills `action` from the policy's (both (action_dim, worlds)) plus noise, or now and then, and while `warming_up`
/// always, with uniform ones. Where the expert acts, its advice (worlds, action_dim) plus noise: what it shows then
/// leads back to its way, too (Laskey et al., DART, 2017).
void explore(const TrainerConfig& config, std::int64_t iteration, bool warming_up, const Matrix<float>& policy_action,
             std::span<const float> advice, Matrix<float>& action);

}  // namespace manyhands::learn
