#include "manyhands/learn/ppo.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "manyhands/learn/action_distribution.h"
#include "manyhands/learn/parameters.h"

namespace manyhands::learn {

namespace {

constexpr float kAdamEpsilon = 1e-5f;
constexpr float kMostReward = 10;  // after scaling, as in Engstrom et al.

Adam<float> optimiser(int parameters, float learning_rate) {
  return {parameters, learning_rate, 0.9f, 0.999f, kAdamEpsilon};
}

}  // namespace

Ppo::Ppo(const EnvSpec& spec, int num_worlds, int input_dim, const TrainerConfig& config)
    : config_(config),
      privileged_(spec, config),
      actor_(policy_kind(Algorithm::kPpo, spec.choices), input_dim, spec.choices > 0 ? spec.choices : spec.action_dim,
             config),
      average_(actor_),
      value_(layer_sizes(input_dim + privileged_.dim(), config.hidden_layers, 1), OutputActivation::kLinear,
             config.activation),
      actor_optimiser_(optimiser(actor_.net().num_parameters(), config.actor_learning_rate)),
      value_optimiser_(optimiser(value_.num_parameters(), config.critic_learning_rate)),
      log_std_optimiser_(optimiser(static_cast<int>(actor_.log_std().size()), config.actor_learning_rate)),
      reward_scale_(num_worlds, static_cast<float>(config.gamma), config.scale_rewards),
      rollout_(config.rollout_steps, num_worlds, input_dim + privileged_.dim(), actor_.action_dim(),
               config.cloning_weight > 0 ? actor_.action_dim() : 0),
      acting_(actor_.make_tape(num_worlds)),
      valuing_(value_.make_tape(num_worlds)) {
  if (rollout_.size() < config.batch_size) {
    throw std::invalid_argument("TrainerConfig: batch_size is " + std::to_string(config.batch_size) + ", but " +
                                std::to_string(num_worlds) + " worlds make " + std::to_string(rollout_.size()) +
                                " transitions in rollout_steps of " + std::to_string(config.rollout_steps));
  }
  if (spec.choices > 0 && config.cloning_weight > 0) {
    throw std::invalid_argument("TrainerConfig: cloning_weight is not 0, but " + spec.id +
                                " has discrete actions, of which there is no distance to an expert's");
  }
  value_.initialise(derive_seed(config.seed, Purpose::kCriticSeed, 0), 1.0f);
  for (Half& half : halves_) {
    half.actor = actor_.make_tape(config.batch_size / 2);
    half.value = value_.make_tape(config.batch_size / 2);
    half.actor_gradient.setZero(actor_.net().num_parameters());
    half.value_gradient.setZero(value_.num_parameters());
    half.log_std_gradient.setZero(actor_.log_std().size());
  }
  order_.resize(static_cast<std::size_t>(rollout_.size()));
}

/// What the critic sees of the worlds as they are.
void Ppo::write_states(const EnvBatch& envs, const InputNormaliser& normaliser) {
  learn::write_states(envs, normaliser, valuing_.input());
  privileged_.write_below(envs, valuing_.input());
}

void Ppo::choose_actions(const Collector& worlds, const InputNormaliser& normaliser, std::int64_t iteration,
                         Matrix<float>& action) {
  write_states(worlds.envs(), normaliser);
  acting_.input() = valuing_.input().topRows(normaliser.dim());
  actor_.draw(acting_, Random(config_.seed, Purpose::kExploration, static_cast<std::uint64_t>(iteration)), action);
  value_.forward(valuing_);
  const int begin = rollout_.filled * rollout_.worlds;
  rollout_.state.middleCols(begin, rollout_.worlds) = valuing_.input();
  rollout_.action.middleCols(begin, rollout_.worlds) = action;
  if (rollout_.advice.size() > 0) {
    rollout_.advice.middleCols(begin, rollout_.worlds) =
        Eigen::Map<const Matrix<float>>(worlds.advice().data(), rollout_.advice.rows(), rollout_.worlds);
  }
  rollout_.value.segment(begin, rollout_.worlds) = valuing_.output().row(0).transpose();
  const ActionDistribution<float> policy{actor_.kind(), acting_.output(), actor_.log_std()};
  for (int w = 0; w < rollout_.worlds; ++w) {
    rollout_.log_probability[begin + w] = policy.log_probability(w, action.col(w).data());
  }
}

void Ppo::observe(const Collector& worlds, const InputNormaliser& normaliser) {
  const EnvBatch& envs = worlds.envs();
  const int begin = rollout_.filled * rollout_.worlds;
  reward_scale_.add(envs.reward());
  const float scale = reward_scale_.scale();
  for (int w = 0; w < rollout_.worlds; ++w) {
    const float reward = scale * envs.reward()[static_cast<std::size_t>(w)];
    rollout_.reward[begin + w] = std::clamp(reward, -kMostReward, kMostReward);
    rollout_.ended[static_cast<std::size_t>(begin + w)] = 0;
  }
  if (!worlds.finished().empty()) {
    write_states(envs, normaliser);
    value_.forward(valuing_);
  }
  for (const int w : worlds.finished()) {
    const bool terminated = envs.terminated()[static_cast<std::size_t>(w)] != 0;
    rollout_.ended[static_cast<std::size_t>(begin + w)] = 1;
    rollout_.last_value[begin + w] = terminated ? 0.0f : valuing_.output()(0, w);
    reward_scale_.end(w);
    privileged_.add(worlds.episode(w).randomized);
  }
  privileged_.refresh();
  ++rollout_.filled;
}

void Ppo::learn(const Collector& worlds, const InputNormaliser& normaliser, Halves& halves, LearnStats& stats) {
  if (!rollout_.full()) return;
  write_states(worlds.envs(), normaliser);
  value_.forward(valuing_);
  rollout_.set_advantages(valuing_.output().row(0).transpose(), static_cast<float>(config_.gamma),
                          static_cast<float>(config_.gae_lambda));
  const auto batch = static_cast<std::size_t>(config_.batch_size);
  for (int epoch = 0; epoch < config_.epochs; ++epoch) {
    Random random(config_.seed, Purpose::kShuffle, static_cast<std::uint64_t>(epochs_++));
    std::iota(order_.begin(), order_.end(), 0);
    for (std::size_t i = order_.size() - 1; i > 0; --i) {
      std::swap(order_[i], order_[random.below(static_cast<std::uint32_t>(i + 1))]);
    }
    for (std::size_t begin = 0; begin + batch <= order_.size(); begin += batch) {
      update(std::span(order_).subspan(begin, batch), halves, stats);
    }
  }
  rollout_.filled = 0;
}

/// One gradient step on `rows` of the rollout.
void Ppo::update(std::span<const int> rows, Halves& halves, LearnStats& stats) {
  double sum = 0, squares = 0;
  for (const int row : rows) sum += static_cast<double>(rollout_.advantage[row]);
  const double n = static_cast<double>(rows.size()), mean = sum / n;
  for (const int row : rows) squares += std::pow(static_cast<double>(rollout_.advantage[row]) - mean, 2);
  advantage_mean_ = static_cast<float>(mean);
  advantage_scale_ = static_cast<float>(1 / (std::sqrt(squares / (n - 1)) + 1e-8));

  halves.run([&](int half) { compute_gradients(rows, half); });
  step(halves);

  const double loss = (halves_[0].squared_error + halves_[1].squared_error) / n;
  if (!std::isfinite(loss)) {
    throw DivergenceError("Trainer: training diverged after " + std::to_string(gradient_steps()) +
                          " gradient steps (the loss is not finite); try smaller learning rates");
  }
  stats.critic_loss += loss;
  stats.q += (halves_[0].value_sum + halves_[1].value_sum) / n;
  stats.entropy += (halves_[0].entropy + halves_[1].entropy) / n;
  ++stats.steps;
  ++stats.policy_steps;
}

/// Of the mean of -min(r A, clip(r, 1 - c, 1 + c) A) - entropy_weight H + value_weight (V - target)^2 over every second
/// row, with r = pi(a|s) / pi_old(a|s); and where an expert is asked of cloning_weight |mean - its action|^2
/// (Rajeswaran et al., DAPG, 2018, with advice in the policy's own states).
void Ppo::compute_gradients(std::span<const int> rows, int index) {
  Half& half = halves_[static_cast<std::size_t>(index)];
  const Eigen::Index columns = half.actor.input().cols();
  const float weight = 1.0f / static_cast<float>(config_.batch_size);
  const float cloning = 2 * weight * config_.cloning_weight_at(gradient_steps());
  const auto row_of = [&](Eigen::Index column) { return rows[static_cast<std::size_t>(2 * column + index)]; };
  for (Eigen::Index i = 0; i < columns; ++i) half.value.input().col(i) = rollout_.state.col(row_of(i));
  half.actor.input() = half.value.input().topRows(half.actor.input().rows());
  actor_.net().forward(half.actor);
  value_.forward(half.value);

  const ActionDistribution<float> policy{actor_.kind(), half.actor.output(), actor_.log_std()};
  half.log_std_gradient.setZero();
  half.squared_error = half.value_sum = half.entropy = 0;
  for (Eigen::Index i = 0; i < columns; ++i) {
    const int row = row_of(i);
    const float* action = rollout_.action.col(row).data();
    const float advantage = (rollout_.advantage[row] - advantage_mean_) * advantage_scale_;
    const float ratio = std::exp(policy.log_probability(i, action) - rollout_.log_probability[row]);
    const bool clipped = advantage > 0 ? ratio > 1 + config_.clip_range : ratio < 1 - config_.clip_range;
    policy.backward(i, action, clipped ? 0.0f : -weight * ratio * advantage, -weight * config_.entropy_weight,
                    half.actor.output_gradient(), half.log_std_gradient);
    if (rollout_.advice.size() > 0) {
      half.actor.output_gradient().col(i) += cloning * (half.actor.output().col(i) - rollout_.advice.col(row));
    }
    const float error = half.value.output()(0, i) - rollout_.value_target[row];
    half.value.output_gradient()(0, i) = 2 * weight * config_.value_weight * error;
    half.squared_error += static_cast<double>(error * error);
    half.value_sum += static_cast<double>(half.value.output()(0, i));
    half.entropy += static_cast<double>(policy.entropy(i));
  }
  actor_.net().backward(half.actor, {}, half.actor_gradient);
  value_.backward(half.value, {}, half.value_gradient);
}

/// Sums the halves' gradients, shortens them together to `max_gradient_norm`, and moves all parameters.
void Ppo::step(Halves& halves) {
  Half &sum = halves_[0], &other = halves_[1];
  std::array<double, 2> squares{};
  const auto for_part = [&](int part, auto&& visit) {
    const auto [actor_begin, actor_end] = part_of(actor_.net().num_parameters(), part);
    const auto [value_begin, value_end] = part_of(value_.num_parameters(), part);
    visit(sum.actor_gradient, other.actor_gradient, actor_.net().parameters(), actor_optimiser_, actor_begin,
          actor_end);
    visit(sum.value_gradient, other.value_gradient, value_.parameters(), value_optimiser_, value_begin, value_end);
  };
  halves.run([&](int part) {
    for_part(part, [&](Vector<float>& to, Vector<float>& from, Vector<float>&, Adam<float>&, int begin, int end) {
      to.segment(begin, end - begin) += from.segment(begin, end - begin);
      squares[static_cast<std::size_t>(part)] += static_cast<double>(to.segment(begin, end - begin).squaredNorm());
    });
  });
  sum.log_std_gradient += other.log_std_gradient;
  const double norm = std::sqrt(squares[0] + squares[1] + static_cast<double>(sum.log_std_gradient.squaredNorm()));
  const auto scale = static_cast<float>(std::min(1.0, static_cast<double>(config_.max_gradient_norm) / (norm + 1e-6)));
  const float rates = rate_scale() * config_.rate_scale(gradient_steps());
  for (Adam<float>* adam : {&actor_optimiser_, &value_optimiser_, &log_std_optimiser_}) adam->begin_step(rates);
  halves.run([&](int part) {
    for_part(part, [&](Vector<float>& gradient, Vector<float>&, Vector<float>& parameters, Adam<float>& adam, int begin,
                       int end) {
      gradient.segment(begin, end - begin) *= scale;
      adam.apply(parameters, gradient, begin, end);
    });
    const auto [begin, end] = part_of(actor_.net().num_parameters(), part);
    polyak_average(average_.net().parameters(), actor_.net().parameters(), config_.target_rate, begin, end);
  });
  sum.log_std_gradient *= scale;
  log_std_optimiser_.apply(actor_.log_std(), sum.log_std_gradient, 0, static_cast<int>(actor_.log_std().size()));
  average_.log_std() = actor_.log_std();
}

void Ppo::save(ArchiveWriter& out, bool /*with_replay*/) const {
  privileged_.save(out);
  out.array(floats(actor_.net().parameters()));
  out.array(floats(actor_.log_std()));
  out.array(floats(average_.net().parameters()));
  out.array(floats(average_.log_std()));
  out.array(floats(value_.parameters()));
  for (const Adam<float>* adam : {&actor_optimiser_, &value_optimiser_, &log_std_optimiser_}) {
    save_optimiser(*adam, out);
  }
  reward_scale_.save(out);
  rollout_.save(out);
  out.value(epochs_);
}

void Ppo::load(ArchiveReader& in) {
  privileged_.load(in);
  in.array(floats(actor_.net().parameters()));
  in.array(floats(actor_.log_std()));
  in.array(floats(average_.net().parameters()));
  in.array(floats(average_.log_std()));
  in.array(floats(value_.parameters()));
  for (Adam<float>* adam : {&actor_optimiser_, &value_optimiser_, &log_std_optimiser_}) load_optimiser(*adam, in);
  reward_scale_.load(in);
  rollout_.load(in);
  in.value(epochs_);
}

}  // namespace manyhands::learn
