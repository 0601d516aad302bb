#include "manyhands/learn/learner.h"

#include <stdexcept>

#include "manyhands/learn/off_policy.h"
#include "manyhands/learn/ppo.h"

namespace manyhands::learn {

std::unique_ptr<Learner> make_learner(const EnvSpec& spec, int num_worlds, int input_dim, const TrainerConfig& config) {
  if (config.algorithm == Algorithm::kPpo) return std::make_unique<Ppo>(spec, num_worlds, input_dim, config);
  if (spec.choices > 0) {
    throw std::invalid_argument(spec.id + " has discrete actions, which TD3, DDPG, SAC and TQC cannot choose; use PPO");
  }
  return std::make_unique<OffPolicy>(spec, num_worlds, input_dim, config);
}

void write_states(const EnvBatch& envs, const InputNormaliser& normaliser, Matrix<float>& state) {
  const EnvSpec& spec = envs.spec();
  for (int world = 0; world < envs.num_envs(); ++world) {
    normaliser.write(envs.observation().data() + world * spec.observation_dim,
                     envs.achieved_goal().data() + world * spec.goal_dim,
                     envs.desired_goal().data() + world * spec.goal_dim, state.col(world).data());
  }
}

}  // namespace manyhands::learn
