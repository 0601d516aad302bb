#include "manyhands/learn/agent.h"

#include <algorithm>

#include "manyhands/learn/random.h"

namespace manyhands::learn {

namespace {

/// The actor starts with small actions, away from the flat ends of tanh.
constexpr float kActorLastLayerScale = 0.1f;

std::vector<int> layer_sizes(int inputs, const std::vector<int>& hidden, int outputs) {
  std::vector<int> sizes = {inputs};
  sizes.insert(sizes.end(), hidden.begin(), hidden.end());
  sizes.push_back(outputs);
  return sizes;
}

/// Part 0 or 1 of n parameters, split at a multiple of a cache line.
std::pair<int, int> part_of(int n, int part) {
  const int middle = n / 2 / 16 * 16;
  return part == 0 ? std::pair(0, middle) : std::pair(middle, n);
}

template <class V>
auto floats(V& vector) {
  return std::span(vector.data(), static_cast<std::size_t>(vector.size()));
}

void save_optimiser(const Adam<float>& adam, ArchiveWriter& out) {
  out.value(adam.step_count());
  out.array(floats(adam.first_moment()));
  out.array(floats(adam.second_moment()));
}

void load_optimiser(Adam<float>& adam, ArchiveReader& in) {
  adam.set_step_count(in.value<std::int64_t>());
  in.array(floats(adam.first_moment()));
  in.array(floats(adam.second_moment()));
}

}  // namespace

Agent::Agent(int state_dim, int action_dim, const TrainerConfig& config)
    : config_(config),
      state_dim_(state_dim),
      action_dim_(action_dim),
      actor_(layer_sizes(state_dim, config.hidden_layers, action_dim), OutputActivation::kTanh) {
  actor_.initialise(derive_seed(config.seed, Purpose::kActorSeed, 0), kActorLastLayerScale);
  actor_target_ = actor_;
  actor_optimiser_ = Adam<float>(actor_.num_parameters(), config.actor_learning_rate);
  for (int i = 0; i < config.num_critics; ++i) {
    Mlp<float> net(layer_sizes(state_dim + action_dim, config.hidden_layers, 1), OutputActivation::kLinear);
    net.initialise(derive_seed(config.seed, Purpose::kCriticSeed, static_cast<std::uint64_t>(i)), 1.0f);
    const int n = net.num_parameters();
    critics_.push_back({net, net, Adam<float>(n, config.critic_learning_rate)});
  }
  const int columns = config.batch_size / 2;
  for (Half& half : halves_) {
    half.batch.state.setZero(state_dim, columns);
    half.batch.next_state.setZero(state_dim, columns);
    half.batch.action.setZero(action_dim, columns);
    half.batch.advice.setZero(action_dim, columns);
    half.batch.advised.setZero(columns);
    half.batch.reward.setZero(columns);
    half.batch.discount.setZero(columns);
    half.actor = actor_.make_tape(columns);
    half.critic = critics_.front().net.make_tape(columns);
    half.target_value.setZero(columns);
    half.critic_gradient.assign(critics_.size(), Vector<float>::Zero(critics_.front().net.num_parameters()));
    half.actor_gradient.setZero(actor_.num_parameters());
  }
}

UpdateStats Agent::update(Halves& halves, const ValueBounds& bounds) {
  const bool policy = (gradient_steps_ + 1) % config_.policy_delay == 0;
  for (Critic& critic : critics_) critic.optimiser.begin_step();
  if (policy) actor_optimiser_.begin_step();

  halves.run([&](int i) {
    Half& half = halves_[static_cast<std::size_t>(i)];
    compute_targets(half, i, bounds);
    compute_critic_gradients(half);
  });
  halves.run([&](int part) { apply_critics(part, policy); });
  if (policy) {
    halves.run([&](int i) { compute_actor_gradient(halves_[static_cast<std::size_t>(i)]); });
    halves.run([&](int part) { apply_actor(part); });
  }
  ++gradient_steps_;

  const double n = config_.batch_size;
  UpdateStats stats;
  stats.critic_loss = static_cast<float>((halves_[0].squared_error + halves_[1].squared_error) / n /
                                         static_cast<double>(critics_.size()));
  stats.q = static_cast<float>((halves_[0].q_sum + halves_[1].q_sum) / n);
  stats.policy_updated = policy;
  stats.policy_q = static_cast<float>((halves_[0].policy_q_sum + halves_[1].policy_q_sum) / n);
  return stats;
}

/// y = r + gamma min_k Q'_k(s', clip(pi'(s') + clipped noise)), within the bounds of a return.
void Agent::compute_targets(Half& half, int index, const ValueBounds& bounds) const {
  half.actor.input() = half.batch.next_state;
  actor_target_.forward(half.actor);
  half.critic.input().topRows(state_dim_) = half.batch.next_state;
  auto next_action = half.critic.input().bottomRows(action_dim_);
  next_action = half.actor.output();
  if (config_.target_noise > 0) {
    Random random(config_.seed, Purpose::kTargetNoise, static_cast<std::uint64_t>(2 * gradient_steps_ + index));
    const float most = config_.target_noise_clip;
    for (Eigen::Index column = 0; column < next_action.cols(); ++column) {
      for (Eigen::Index row = 0; row < action_dim_; ++row) {
        const float noise = std::clamp(config_.target_noise * random.normal(), -most, most);
        next_action(row, column) = std::clamp(next_action(row, column) + noise, -1.0f, 1.0f);
      }
    }
  }
  for (std::size_t k = 0; k < critics_.size(); ++k) {
    critics_[k].target.forward(half.critic);
    const auto value = half.critic.output().row(0).transpose();
    if (k == 0) {
      half.target_value = value;
    } else {
      half.target_value = half.target_value.cwiseMin(value);
    }
  }
  half.target_value = (half.batch.reward + half.batch.discount.cwiseProduct(half.target_value))
                          .cwiseMax(bounds.low)
                          .cwiseMin(bounds.high);
}

/// Mean squared Bellman error of each critic.
void Agent::compute_critic_gradients(Half& half) const {
  const float weight = 2.0f / static_cast<float>(config_.batch_size);
  half.squared_error = 0;
  half.critic.input().topRows(state_dim_) = half.batch.state;
  half.critic.input().bottomRows(action_dim_) = half.batch.action;
  for (std::size_t k = 0; k < critics_.size(); ++k) {
    critics_[k].net.forward(half.critic);
    if (k == 0) half.q_sum = static_cast<double>(half.critic.output().sum());
    half.critic.output_gradient() = half.critic.output() - half.target_value.transpose();
    half.squared_error += static_cast<double>(half.critic.output_gradient().squaredNorm());
    half.critic.output_gradient() *= weight;
    critics_[k].net.backward(half.critic, {}, half.critic_gradient[k]);
  }
}

/// Minimises -Q_0(s, pi(s)) + action_penalty |pi(s)|^2, averaged.
void Agent::compute_actor_gradient(Half& half) const {
  const float weight = 1.0f / static_cast<float>(config_.batch_size);
  half.actor.input() = half.batch.state;
  actor_.forward(half.actor);
  half.critic.input().topRows(state_dim_) = half.batch.state;
  half.critic.input().bottomRows(action_dim_) = half.actor.output();
  const Mlp<float>& critic = critics_.front().net;
  critic.forward(half.critic);
  half.policy_q_sum = static_cast<double>(half.critic.output().sum());
  half.critic.output_gradient().setConstant(-weight);
  critic.backward(half.critic, {.parameters = false, .input = true}, half.critic_gradient[0]);
  half.actor.output_gradient() = half.critic.input_gradient().bottomRows(action_dim_) +
                                 (2 * weight * config_.action_penalty) * half.actor.output();
  if (config_.cloning_weight > 0) clone_expert(half);
  actor_.backward(half.actor, {}, half.actor_gradient);
}

/// Adds cloning_weight |pi(s) - expert's action|^2 to the policy's loss where there is advice; filtered, where
/// Q_0(s, expert's action) > Q_0(s, pi(s)) (Nair et al., 2018, equation 5).
void Agent::clone_expert(Half& half) const {
  half.cloned = half.batch.advised;
  if (config_.cloning_filter) {
    half.target_value = half.critic.output().row(0).transpose();
    half.critic.input().bottomRows(action_dim_) = half.batch.advice;
    critics_.front().net.forward(half.critic);
    half.cloned.array() *= (half.critic.output().row(0).transpose().array() > half.target_value.array()).cast<float>();
  }
  const float weight = 2 * config_.cloning_weight / static_cast<float>(config_.batch_size);
  for (Eigen::Index i = 0; i < half.cloned.size(); ++i) {
    half.actor.output_gradient().col(i) +=
        weight * half.cloned[i] * (half.actor.output().col(i) - half.batch.advice.col(i));
  }
}

void Agent::apply_critics(int part, bool move_targets) {
  for (std::size_t k = 0; k < critics_.size(); ++k) {
    Critic& critic = critics_[k];
    const auto [begin, end] = part_of(critic.net.num_parameters(), part);
    Vector<float>& gradient = halves_[0].critic_gradient[k];
    gradient.segment(begin, end - begin) += halves_[1].critic_gradient[k].segment(begin, end - begin);
    critic.optimiser.apply(critic.net.parameters(), gradient, begin, end);
    if (move_targets) {
      polyak_average(critic.target.parameters(), critic.net.parameters(), config_.target_rate, begin, end);
    }
  }
}

void Agent::apply_actor(int part) {
  const auto [begin, end] = part_of(actor_.num_parameters(), part);
  Vector<float>& gradient = halves_[0].actor_gradient;
  gradient.segment(begin, end - begin) += halves_[1].actor_gradient.segment(begin, end - begin);
  actor_optimiser_.apply(actor_.parameters(), gradient, begin, end);
  polyak_average(actor_target_.parameters(), actor_.parameters(), config_.target_rate, begin, end);
}

void Agent::save(ArchiveWriter& out) const {
  out.value(gradient_steps_);
  out.array(floats(actor_.parameters()));
  out.array(floats(actor_target_.parameters()));
  save_optimiser(actor_optimiser_, out);
  for (const Critic& critic : critics_) {
    out.array(floats(critic.net.parameters()));
    out.array(floats(critic.target.parameters()));
    save_optimiser(critic.optimiser, out);
  }
}

void Agent::load(ArchiveReader& in) {
  in.value(gradient_steps_);
  in.array(floats(actor_.parameters()));
  in.array(floats(actor_target_.parameters()));
  load_optimiser(actor_optimiser_, in);
  for (Critic& critic : critics_) {
    in.array(floats(critic.net.parameters()));
    in.array(floats(critic.target.parameters()));
    load_optimiser(critic.optimiser, in);
  }
}

}  // namespace manyhands::learn
