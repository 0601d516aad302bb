#include "manyhands/learn/evaluation.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "manyhands/learn/parameters.h"

namespace manyhands::learn {

EvalResult evaluate_policy(EnvBatch& envs, Performer& performer, int episodes, std::uint64_t first_seed) {
  if (episodes <= 0) throw std::invalid_argument("evaluate: episodes must be positive");
  const EnvSpec& spec = envs.spec();
  const auto worlds = static_cast<std::size_t>(envs.num_envs());
  const auto wanted = static_cast<std::size_t>(episodes);
  Matrix<float> action = Matrix<float>::Zero(spec.action_dim, envs.num_envs());
  std::vector<std::uint64_t> seeds(worlds);
  std::vector<std::uint8_t> running(worlds);
  double successes = 0, total_reward = 0, steps = 0;
  for (std::size_t done = 0; done < wanted; done += worlds) {
    std::iota(seeds.begin(), seeds.end(), first_seed + done);
    std::size_t left = std::min(worlds, wanted - done);
    for (std::size_t w = 0; w < worlds; ++w) running[w] = w < left;
    envs.reset({}, seeds);
    for (int t = 1; left > 0; ++t) {
      performer.act(t - 1, running, action);
      envs.step(floats(action));
      for (std::size_t w = 0; w < worlds; ++w) {
        if (running[w] == 0) continue;
        total_reward += static_cast<double>(envs.reward()[w]);
        ++steps;
        if (envs.terminated()[w] == 0 && envs.truncated()[w] == 0 && t < spec.max_episode_steps) continue;
        running[w] = 0;
        --left;
        successes += envs.is_success()[w];
      }
    }
  }
  return {episodes, successes / episodes, total_reward / episodes, steps / episodes};
}

}  // namespace manyhands::learn
