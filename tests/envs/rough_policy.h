// A policy that makes contacts, for tests that any actions will do for.
#pragma once

#include <random>
#include <vector>

#include "manyhands/envs/env_batch.h"

namespace manyhands {

/// Drives the hand to the first object and squeezes it, with some noise: contacts of every kind. Under control of
/// the joints they move at random.
[[nodiscard]] inline std::vector<float> rough_actions(const EnvBatch& env, int step) {
  const EnvSpec& spec = env.spec();
  const bool joints = spec.action_dim >= 7, gripper = spec.action_dim % 4 == 0;
  const std::size_t object = gripper ? 7 : 6;
  std::vector<float> all;
  for (int i = 0; i < env.num_envs(); ++i) {
    std::mt19937 random(static_cast<unsigned>(i * 7919 + step));
    const float* row = &env.observation()[static_cast<std::size_t>(i * spec.observation_dim)];
    for (int k = 0; k < spec.action_dim; ++k) {
      const float noise = static_cast<float>(random() % 2001) * 1e-3f - 1;
      const bool has_object = spec.observation_dim > 6;
      float a = noise;
      if (!joints && k < 3 && has_object) a = 10 * (row[object + static_cast<std::size_t>(k)] - row[k]) + 0.3f * noise;
      if (gripper && k == spec.action_dim - 1) a = step % 25 < 10 ? 1.0f : -1.0f;
      all.push_back(a);
    }
  }
  return all;
}

}  // namespace manyhands
