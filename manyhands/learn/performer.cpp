#include "manyhands/learn/performer.h"

namespace manyhands::learn {

StatePerformer::StatePerformer(const EnvBatch& envs, const InputNormaliser& normaliser, const Actor& actor)
    : envs_(envs), normaliser_(normaliser), actor_(actor), tape_(actor.make_tape(envs.num_envs())) {}

void StatePerformer::act(int /*step*/, std::span<const std::uint8_t> /*running*/, Matrix<float>& action) {
  write_states(envs_, normaliser_, tape_.input());
  actor_.act(tape_, action);
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
