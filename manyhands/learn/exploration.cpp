#include "manyhands/learn/exploration.h"

#include <algorithm>
#include <cmath>

#include "manyhands/learn/learner.h"

namespace manyhands::learn {

Exploration::Exploration(const Actor& actor, const TrainerConfig& config, int first, int count)
    : config_(config),
      led_(std::lround(config.expert_rate * (first + count)) - std::lround(config.expert_rate * first)),
      tape_(actor.make_tape(count)),
      policy_action_(Matrix<float>::Zero(actor.action_dim(), count)) {}

void Exploration::choose(const Actor& actor, const Collector& worlds, const InputNormaliser& normaliser,
                         std::int64_t iteration, bool warming_up, Matrix<float>& action) {
  const auto counter = static_cast<std::uint64_t>(iteration);
  write_states(worlds.envs(), normaliser, tape_.input());
  if (config_.algorithm == Algorithm::kSac) {
    actor.draw(tape_, Random(config_.seed, Purpose::kActing, counter), policy_action_);
  } else {
    actor.act(tape_, policy_action_);
  }
  const Eigen::Index led = config_.expert_rate > 0 && warming_up ? action.cols() : led_;
  Random random(config_.seed, Purpose::kExploration, counter);
  for (Eigen::Index world = 0; world < action.cols(); ++world) {
    const bool random_now = random.uniform() < static_cast<float>(config_.random_action_rate);
    const bool uniform = world >= led && (warming_up || random_now);
    const float* wanted = world < led ? &worlds.advice()[static_cast<std::size_t>(world * action.rows())]
                                      : policy_action_.col(world).data();
    for (Eigen::Index k = 0; k < action.rows(); ++k) {
      const float chosen = wanted[k] + config_.exploration_noise * random.normal();
      action(k, world) = uniform ? random.uniform(-1.0f, 1.0f) : std::clamp(chosen, -1.0f, 1.0f);
    }
  }
}

}  // namespace manyhands::learn
