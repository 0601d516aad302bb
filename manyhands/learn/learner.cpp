#include "manyhands/learn/learner.h"

#include <stdexcept>

#include "manyhands/learn/off_policy.h"
#include "manyhands/learn/picture_cloning.h"
#include "manyhands/learn/ppo.h"

namespace manyhands::learn {

std::unique_ptr<Performer> Learner::performer(const EnvBatch& envs, const InputNormaliser& normaliser) const {
  return std::make_unique<StatePerformer>(envs, normaliser, *actor());
}

void Learner::add(const EpisodeView& /*episode*/) {
  throw std::logic_error("this algorithm learns from what its present policy does in worlds of its own alone");
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

}  // namespace manyhands::learn
