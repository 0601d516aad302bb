#include "manyhands/learn/off_policy.h"

#include <cmath>
#include <stdexcept>

namespace manyhands::learn {

OffPolicy::OffPolicy(const EnvSpec& spec, int num_worlds, int input_dim, const TrainerConfig& config)
    : config_(config),
      privileged_(spec, config),
      replay_(spec, config.replay_capacity, config.wants_expert() ? spec.action_dim : 0, privileged_.dim(),
              config.replay_folder),
      minibatch_(replay_.make_minibatch(config.batch_size, {config.return_steps, static_cast<float>(config.gamma)})),
      agent_(input_dim, spec.action_dim, config, privileged_.dim()),
      exploration_(agent_.actor(), config, 0, num_worlds) {}

void OffPolicy::choose_actions(const Collector& worlds, const InputNormaliser& normaliser, std::int64_t iteration,
                               Matrix<float>& action) {
  exploration_.choose(agent_.actor(), worlds, normaliser, iteration, warming_up(), action);
}

void OffPolicy::add(const EpisodeView& episode) {
  replay_.add(episode);
  privileged_.add(episode.randomized);
}

void OffPolicy::observe(const Collector& worlds, const InputNormaliser& /*normaliser*/) {
  for (const int world : worlds.finished()) add(worlds.episode(world));
}

void OffPolicy::learn(const Collector& worlds, const InputNormaliser& normaliser, Halves& halves, LearnStats& stats) {
  if (warming_up()) return;
  privileged_.refresh();
  const auto horizon = static_cast<float>(1.0 / (1.0 - config_.gamma));
  const ValueBounds bounds = {.low = replay_.lowest_reward() * horizon, .high = replay_.highest_reward() * horizon};
  for (int i = 0; i < config_.updates_per_iteration; ++i) {
    replay_.sample(worlds.envs(), {config_.hindsight_fraction, config_.success_terminates},
                   Random(config_.seed, Purpose::kSampling, static_cast<std::uint64_t>(gradient_steps())), minibatch_);
    halves.run([&](int half) { fill_half(normaliser, half); });
    const UpdateStats update = agent_.update(halves, bounds, rate_scale());
    if (!std::isfinite(update.critic_loss) || !std::isfinite(update.policy_q)) {
      throw DivergenceError("Trainer: training diverged after " + std::to_string(gradient_steps() - 1) +
                            " gradient steps (the loss is not finite); try smaller learning rates");
    }
    stats.critic_loss += static_cast<double>(update.critic_loss);
    stats.q += static_cast<double>(update.q);
    ++stats.steps;
    if (!update.policy_updated) continue;
    stats.policy_q += static_cast<double>(update.policy_q);
    stats.entropy += static_cast<double>(update.entropy);
    ++stats.policy_steps;
  }
}

/// Normalises every second column of the mini-batch into one half, so that both hold old and new goals alike.
void OffPolicy::fill_half(const InputNormaliser& normaliser, int half) {
  AgentBatch& to = agent_.half(half);
  for (Eigen::Index column = 0; column < to.reward.size(); ++column) {
    const Eigen::Index i = 2 * column + half;
    const float* goal = minibatch_.desired_goal.col(i).data();
    normaliser.write(minibatch_.observation.col(i).data(), minibatch_.achieved_goal.col(i).data(), goal,
                     to.state.col(column).data());
    normaliser.write(minibatch_.next_observation.col(i).data(), minibatch_.next_achieved_goal.col(i).data(), goal,
                     to.next_state.col(column).data());
    for (Matrix<float>* state : {&to.state, &to.next_state}) {
      privileged_.write(minibatch_.randomized.col(i).data(), state->col(column).data() + normaliser.dim());
    }
    to.action.col(column) = minibatch_.action.col(i);
    if (minibatch_.advice.rows() > 0) {
      to.advice.col(column) = minibatch_.advice.col(i);
      to.advised[column] = i < minibatch_.relabelled ? 0.0f : 1.0f;
    }
    to.reward[column] = minibatch_.reward[i];
    to.discount[column] = minibatch_.discount[i];
  }
}

void OffPolicy::save(ArchiveWriter& out, bool with_replay) const {
  privileged_.save(out);
  agent_.save(out);
  out.value(with_replay);
  if (with_replay) replay_.save(out);
}

void OffPolicy::load(ArchiveReader& in) {
  privileged_.load(in);
  agent_.load(in);
  if (in.value<bool>()) replay_.load(in);
}

}  // namespace manyhands::learn
