#include "manyhands/learn/learner.h"

#include <stdexcept>

#include "manyhands/learn/off_policy.h"
#include "manyhands/learn/picture_cloning.h"
#include "manyhands/learn/ppo.h"

namespace manyhands::learn {

namespace {

class StatePerformer final : public Performer {
 public:
  StatePerformer(const EnvBatch& envs, const InputNormaliser& normaliser, const Actor& actor)
      : envs_(envs), normaliser_(normaliser), actor_(actor), tape_(actor.make_tape(envs.num_envs())) {}

  void act(int /*step*/, std::span<const std::uint8_t> /*running*/, Matrix<float>& action) override {
    write_states(envs_, normaliser_, tape_.input());
    actor_.act(tape_, action);
  }

 private:
  const EnvBatch& envs_;
  const InputNormaliser& normaliser_;
  const Actor& actor_;
  MlpTape<float> tape_;
};

}  // namespace

std::unique_ptr<Performer> Learner::performer(const EnvBatch& envs, const InputNormaliser& normaliser) const {
  return std::make_unique<StatePerformer>(envs, normaliser, *actor());
}

Policy Learner::policy(const EnvSpec& spec, const InputNormaliser& normaliser) const {
  return export_policy(spec, normaliser, *actor());
}

std::unique_ptr<Learner> make_learner(const EnvBatch& envs, int input_dim, const TrainerConfig& config,
                                      const std::vector<Eye>& eyes) {
  const EnvSpec& spec = envs.spec();
  if (!eyes.empty() && config.algorithm != Algorithm::kDagger) {
    throw std::invalid_argument("there are cameras, from whose pictures only DAgger learns; set algorithm to it");
  }
  if (config.algorithm == Algorithm::kPpo) return std::make_unique<Ppo>(spec, envs.num_envs(), input_dim, config);
  if (spec.choices > 0) {
    throw std::invalid_argument(spec.id + " has discrete actions, which TD3, DDPG, SAC and TQC cannot choose; use PPO");
  }
  if (!eyes.empty()) return std::make_unique<PictureCloning>(envs, input_dim, config, eyes);
  return std::make_unique<OffPolicy>(spec, envs.num_envs(), input_dim, config);
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
