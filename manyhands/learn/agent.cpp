#include "manyhands/learn/agent.h"

#include <algorithm>
#include <cmath>

#include "manyhands/learn/parameters.h"
#include "manyhands/learn/random.h"

namespace manyhands::learn {

Agent::Agent(int state_dim, int action_dim, const TrainerConfig& config, int privileged_dim)
    : config_(config),
      state_dim_(state_dim),
      actor_(policy_kind(config.algorithm, 0), state_dim, action_dim, config),
      actor_target_(actor_),
      actor_optimiser_(actor_.net().num_parameters(), config.actor_learning_rate),
      critics_(state_dim + privileged_dim, action_dim, config),
      log_temperature_(Vector<float>::Constant(1, std::log(config.temperature))),
      temperature_optimiser_(1, config.actor_learning_rate) {
  if (config_.target_entropy == 0) config_.target_entropy = -static_cast<float>(action_dim);
  const int columns = config.batch_size / 2;
  for (Half& half : halves_) {
    half.batch.state.setZero(state_dim + privileged_dim, columns);
    half.batch.next_state.setZero(state_dim + privileged_dim, columns);
    half.batch.action.setZero(action_dim, columns);
    half.batch.advice.setZero(action_dim, columns);
    half.batch.advised.setZero(columns);
    half.batch.reward.setZero(columns);
    half.batch.discount.setZero(columns);
    half.actor = actor_.make_tape(columns);
    half.draw.resize(action_dim, columns);
    half.critics = critics_.make_tape(columns);
    half.next_action.setZero(action_dim, columns);
    half.actor_gradient.setZero(actor_.net().num_parameters());
  }
}

float Agent::temperature() const { return soft() ? std::exp(log_temperature_[0]) : 0.0f; }

UpdateStats Agent::update(Halves& halves, const ValueBounds& bounds, float rate_scale) {
  const bool policy = (gradient_steps_ + 1) % config_.policy_delay == 0;
  const float rates = rate_scale * config_.rate_scale(gradient_steps_);
  if (has_critics()) update_critics(halves, bounds, rates, policy);
  if (policy) update_policy(halves, rates);
  ++gradient_steps_;

  const double n = config_.batch_size;
  UpdateStats stats;
  stats.critic_loss = static_cast<float>((halves_[0].critics.loss + halves_[1].critics.loss) / n / critics_.size());
  stats.q = static_cast<float>((halves_[0].critics.value_sum + halves_[1].critics.value_sum) / n);
  stats.policy_updated = policy;
  stats.policy_q = static_cast<float>((halves_[0].policy_q_sum + halves_[1].policy_q_sum) / n);
  stats.entropy = static_cast<float>(-(halves_[0].log_probability_sum + halves_[1].log_probability_sum) / n);
  return stats;
}

void Agent::update_critics(Halves& halves, const ValueBounds& bounds, float rate_scale, bool targets_follow) {
  critics_.begin_step(rate_scale);
  const std::array tapes = {&halves_[0].critics, &halves_[1].critics};
  halves.run([&](int i) {
    Half& half = halves_[static_cast<std::size_t>(i)];
    compute_targets(half, i, bounds);
    critics_.set_gradients(half.batch.state, half.batch.action, 1.0f / static_cast<float>(config_.batch_size),
                           half.critics);
  });
  halves.run([&](int part) { critics_.apply(part, tapes, targets_follow); });
}

void Agent::update_policy(Halves& halves, float rate_scale) {
  actor_optimiser_.begin_step(rate_scale);
  halves.run([&](int i) { compute_actor_gradient(halves_[static_cast<std::size_t>(i)], i); });
  halves.run([&](int part) { apply_actor(part); });
  if (soft() && config_.learned_temperature) follow_entropy(rate_scale);
}

/// y = r + gamma (Q'(s', a') - temperature log pi(a'|s')), within the bounds of a return, to which a soft value with
/// its entropy does not keep.
void Agent::compute_targets(Half& half, int index, const ValueBounds& bounds) const {
  choose_next_action(half, index);
  critics_.set_targets(half.batch.next_state, half.next_action, half.critics);
  Matrix<float>& y = half.critics.target;
  if (soft()) y.rowwise() -= temperature() * half.draw.log_probability.transpose();
  y = (y.array().rowwise() * half.batch.discount.transpose().array()).rowwise() + half.batch.reward.transpose().array();
  if (!soft()) y = y.cwiseMax(bounds.low).cwiseMin(bounds.high);
}

/// TD3: the target policy's action and clipped noise. SAC: drawn from the policy.
void Agent::choose_next_action(Half& half, int index) const {
  Random random(config_.seed, Purpose::kTargetNoise, static_cast<std::uint64_t>(2 * gradient_steps_ + index));
  half.actor.input() = half.batch.next_state.topRows(state_dim_);
  if (soft()) {
    actor_.net().forward(half.actor);
    for (Eigen::Index i = 0; i < half.draw.noise.size(); ++i) half.draw.noise(i) = random.normal();
    draw_squashed(half.actor.output(), half.draw);
    half.next_action = half.draw.action;
    return;
  }
  actor_target_.net().forward(half.actor);
  half.next_action = half.actor.output();
  if (config_.target_noise <= 0) return;
  const float most = config_.target_noise_clip;
  for (Eigen::Index i = 0; i < half.next_action.size(); ++i) {
    const float noise = std::clamp(config_.target_noise * random.normal(), -most, most);
    half.next_action(i) = std::clamp(half.next_action(i) + noise, -1.0f, 1.0f);
  }
}

/// Minimises -Q(s, pi(s)) + action_penalty |pi(s)|^2 + cloning_weight |pi(s) - expert's|^2, averaged, without critics
/// the last two; if soft, temperature log pi(a|s) - Q(s, a) for drawn a.
void Agent::compute_actor_gradient(Half& half, int index) const {
  const float weight = 1.0f / static_cast<float>(config_.batch_size);
  half.actor.input() = half.batch.state.topRows(state_dim_);
  actor_.net().forward(half.actor);
  if (soft()) {
    draw_action(half, index);
    climb_value(half, half.draw.action, weight);
    backward_squashed(half.actor.output(), half.draw, half.critics.action_gradient, weight * temperature(),
                      half.actor.output_gradient());
  } else {
    if (has_critics()) climb_value(half, half.actor.output(), weight);
    half.actor.output_gradient() = half.critics.action_gradient;
    if (config_.cloning_weight > 0) clone_expert(half);
  }
  actor_.net().backward(half.actor, {}, half.actor_gradient);
}

void Agent::draw_action(Half& half, int index) const {
  Random random(config_.seed, Purpose::kPolicyNoise, static_cast<std::uint64_t>(2 * gradient_steps_ + index));
  for (Eigen::Index i = 0; i < half.draw.noise.size(); ++i) half.draw.noise(i) = random.normal();
  draw_squashed(half.actor.output(), half.draw);
  half.log_probability_sum = static_cast<double>(half.draw.log_probability.sum());
}

/// Sets the gradient of the policy's loss by its actions.
void Agent::climb_value(Half& half, const Matrix<float>& action, float weight) const {
  critics_.set_action_gradient(half.batch.state, action, weight, half.critics);
  half.policy_q_sum = static_cast<double>(half.critics.value.sum());
  half.critics.action_gradient += (2 * weight * config_.action_penalty) * action;
}

/// Adds cloning_weight |pi(s) - expert's action|^2 to the policy's loss where there is advice; filtered, where
/// Q_0(s, expert's action) > Q_0(s, pi(s)) (Nair et al., 2018, equation 5).
void Agent::clone_expert(Half& half) const {
  half.cloned = half.batch.advised;
  if (config_.cloning_filter) {
    const Matrix<float>& expert = critics_.first_values(half.batch.state, half.batch.advice, half.critics);
    half.cloned.array() *= (expert.row(0).transpose().array() > half.critics.value.array()).cast<float>();
  }
  const float weight = 2 * config_.cloning_weight_at(gradient_steps_) / static_cast<float>(config_.batch_size);
  for (Eigen::Index i = 0; i < half.cloned.size(); ++i) {
    half.actor.output_gradient().col(i) +=
        weight * half.cloned[i] * (half.actor.output().col(i) - half.batch.advice.col(i));
  }
}

void Agent::apply_actor(int part) {
  const auto [begin, end] = part_of(actor_.net().num_parameters(), part);
  Vector<float>& gradient = halves_[0].actor_gradient;
  gradient.segment(begin, end - begin) += halves_[1].actor_gradient.segment(begin, end - begin);
  actor_optimiser_.apply(actor_.net().parameters(), gradient, begin, end);
  polyak_average(actor_target_.net().parameters(), actor_.net().parameters(), config_.target_rate, begin, end);
}

/// Raises the temperature where the entropy is below its target, by a step along -log(temperature) (log pi + target).
void Agent::follow_entropy(float rate_scale) {
  const double log_probability = (halves_[0].log_probability_sum + halves_[1].log_probability_sum) / config_.batch_size;
  const Vector<float> gradient =
      Vector<float>::Constant(1, -(static_cast<float>(log_probability) + config_.target_entropy));
  temperature_optimiser_.begin_step(rate_scale);
  temperature_optimiser_.apply(log_temperature_, gradient, 0, 1);
}

void Agent::save(ArchiveWriter& out) const {
  out.value(gradient_steps_);
  out.array(floats(actor_.net().parameters()));
  out.array(floats(actor_target_.net().parameters()));
  save_optimiser(actor_optimiser_, out);
  critics_.save(out);
  out.array(floats(log_temperature_));
  save_optimiser(temperature_optimiser_, out);
}

void Agent::load(ArchiveReader& in) {
  in.value(gradient_steps_);
  in.array(floats(actor_.net().parameters()));
  in.array(floats(actor_target_.net().parameters()));
  load_optimiser(actor_optimiser_, in);
  critics_.load(in);
  in.array(floats(log_temperature_));
  load_optimiser(temperature_optimiser_, in);
}

}  // namespace manyhands::learn
