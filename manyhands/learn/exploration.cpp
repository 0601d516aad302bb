#include "manyhands/learn/exploration.h"

#include <algorithm>
#include <cmath>

#include "manyhands/learn/performer.h"
#include "manyhands/learn/random.h"

namespace manyhands::learn {

Exploration::Exploration(const TrainerConfig& config, int first, int count)
    : config_(config),
      led_(std::lround(config.expert_rate * (first + count)) - std::lround(config.expert_rate * first)) {}

void Exploration::vary(const Matrix<float>& policy_action, std::span<const float> advice, std::int64_t iteration,
                       bool warming_up, Matrix<float>& action) const {
  const Eigen::Index led = config_.expert_rate > 0 && warming_up ? action.cols() : led_;
  Random random(config_.seed, Purpose::kExploration, static_cast<std::uint64_t>(iteration));
  for (Eigen::Index world = 0; world < action.cols(); ++world) {
    const bool random_now = random.uniform() < static_cast<float>(config_.random_action_rate);
    const bool uniform = world >= led && (warming_up || random_now);
    const float* wanted =
        world < led ? &advice[static_cast<std::size_t>(world * action.rows())] : policy_action.col(world).data();
    for (Eigen::Index k = 0; k < action.rows(); ++k) {
      const float chosen = wanted[k] + config_.exploration_noise * random.normal();
      action(k, world) = uniform ? random.uniform(-1.0f, 1.0f) : std::clamp(chosen, -1.0f, 1.0f);
    }
  }
}

StateExploration::StateExploration(const Actor& actor, const TrainerConfig& config, int first, int count)
    : config_(config),
      exploration_(config, first, count),
      tape_(actor.make_tape(count)),
      policy_action_(Matrix<float>::Zero(actor.action_dim(), count)) {}

void StateExploration::choose(const Actor& actor, const Collector& worlds, const InputNormaliser& normaliser,
                              std::int64_t iteration, bool warming_up, Matrix<float>& action) {
  write_states(worlds.envs(), normaliser, tape_.input());
  if (config_.algorithm == Algorithm::kSac) {
    actor.draw(tape_, Random(config_.seed, Purpose::kActing, static_cast<std::uint64_t>(iteration)), policy_action_);
  } else {
    actor.act(tape_, policy_action_);
  }
  exploration_.vary(policy_action_, worlds.advice(), iteration, warming_up, action);
}

}  // namespace manyhands::learn
