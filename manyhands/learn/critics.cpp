#include "manyhands/learn/critics.h"

#include "manyhands/learn/parameters.h"
#include "manyhands/learn/quantiles.h"
#include "manyhands/learn/random.h"

namespace manyhands::learn {

Critics::Critics(int state_dim, int action_dim, const TrainerConfig& config)
    : state_dim_(state_dim),
      action_dim_(action_dim),
      quantiles_(config.num_quantiles),
      kept_(config.num_quantiles == 1 ? 1 : (config.num_quantiles - config.dropped_quantiles) * config.num_critics),
      policy_takes_least_(config.algorithm == Algorithm::kSac),
      target_rate_(config.target_rate) {
  for (int i = 0; i < config.num_critics; ++i) {
    Mlp<float> net(layer_sizes(state_dim + action_dim, config.hidden_layers, quantiles_), OutputActivation::kLinear,
                   config.activation);
    net.initialise(derive_seed(config.seed, Purpose::kCriticSeed, static_cast<std::uint64_t>(i)), 1.0f);
    const int n = net.num_parameters();
    critics_.push_back({net, net, Adam<float>(n, config.critic_learning_rate)});
  }
}

CriticTape Critics::make_tape(int columns) const {
  CriticTape tape;
  for (const Critic& critic : critics_) {
    tape.net.push_back(critic.net.make_tape(columns));
    tape.gradient.push_back(Vector<float>::Zero(critic.net.num_parameters()));
  }
  tape.target.setZero(kept_, columns);
  tape.value.setZero(columns);
  tape.action_gradient.setZero(action_dim_, columns);
  if (quantiles_ > 1) {
    tape.atoms.setZero(quantiles_ * size(), columns);
    tape.quantiles.setZero(quantiles_, columns);
  }
  return tape;
}

void Critics::set_input(const Matrix<float>& state, const Matrix<float>& action, CriticTape& tape) const {
  for (MlpTape<float>& net : tape.net) {
    net.input().topRows(state_dim_) = state;
    net.input().bottomRows(action_dim_) = action;
  }
}

void Critics::set_targets(const Matrix<float>& state, const Matrix<float>& action, CriticTape& tape) const {
  set_input(state, action, tape);
  for (std::size_t k = 0; k < critics_.size(); ++k) {
    critics_[k].target.forward(tape.net[k]);
    const Matrix<float>& value = tape.net[k].output();
    if (quantiles_ > 1) {
      tape.atoms.middleRows(static_cast<Eigen::Index>(k) * quantiles_, quantiles_) = value;
    } else if (k == 0) {
      tape.target = value;
    } else {
      tape.target = tape.target.cwiseMin(value);
    }
  }
  if (quantiles_ > 1) keep_lowest(tape.atoms, tape.target);
}

void Critics::set_gradients(const Matrix<float>& state, const Matrix<float>& action, float weight,
                            CriticTape& tape) const {
  set_input(state, action, tape);
  tape.loss = 0;
  for (std::size_t k = 0; k < critics_.size(); ++k) {
    MlpTape<float>& net = tape.net[k];
    critics_[k].net.forward(net);
    if (k == 0) tape.value_sum = static_cast<double>(net.output().sum()) / quantiles_;
    if (quantiles_ > 1) {
      tape.loss += quantile_loss(net.output(), tape.target, net.output_gradient());
      net.output_gradient() *= weight;
    } else {
      net.output_gradient() = net.output() - tape.target;
      tape.loss += static_cast<double>(net.output_gradient().squaredNorm());
      net.output_gradient() *= 2 * weight;
    }
    critics_[k].net.backward(net, {}, tape.gradient[k]);
  }
}

void Critics::set_action_gradient(const Matrix<float>& state, const Matrix<float>& action, float weight,
                                  CriticTape& tape) const {
  const std::size_t asked = policy_takes_least_ ? critics_.size() : 1;
  set_input(state, action, tape);
  for (std::size_t k = 0; k < asked; ++k) critics_[k].net.forward(tape.net[k]);
  choose_worth(weight, tape);
  for (std::size_t k = 0; k < asked; ++k) {
    critics_[k].net.backward(tape.net[k], {.parameters = false, .input = true}, tape.gradient[k]);
    const auto by_action = tape.net[k].input_gradient().bottomRows(action_dim_);
    if (k == 0) {
      tape.action_gradient = by_action;
    } else {
      tape.action_gradient += by_action;
    }
  }
}

/// tape.value, and the gradient of -weight times it by the networks' outputs.
void Critics::choose_worth(float weight, CriticTape& tape) const {
  if (!policy_takes_least_) {
    tape.value = tape.net[0].output().row(0).transpose();
    tape.net[0].output_gradient().setConstant(-weight);
    return;
  }
  if (quantiles_ > 1) {
    const float share = 1.0f / static_cast<float>(quantiles_ * size());
    tape.value.setZero();
    for (MlpTape<float>& net : tape.net) {
      tape.value += share * net.output().colwise().sum().transpose();
      net.output_gradient().setConstant(-weight * share);
    }
    return;
  }
  for (Eigen::Index i = 0; i < tape.value.size(); ++i) {
    std::size_t least = 0;
    for (std::size_t k = 0; k < tape.net.size(); ++k) {
      tape.net[k].output_gradient()(0, i) = 0;
      if (tape.net[k].output()(0, i) < tape.net[least].output()(0, i)) least = k;
    }
    tape.net[least].output_gradient()(0, i) = -weight;
    tape.value[i] = tape.net[least].output()(0, i);
  }
}

const Matrix<float>& Critics::first_values(const Matrix<float>& state, const Matrix<float>& action,
                                           CriticTape& tape) const {
  MlpTape<float>& net = tape.net.front();
  net.input().topRows(state_dim_) = state;
  net.input().bottomRows(action_dim_) = action;
  critics_.front().net.forward(net);
  return net.output();
}

void Critics::begin_step(float rate_scale) {
  for (Critic& critic : critics_) critic.optimiser.begin_step(rate_scale);
}

void Critics::apply(int part, const std::array<CriticTape*, 2>& tapes, bool move_targets) {
  for (std::size_t k = 0; k < critics_.size(); ++k) {
    Critic& critic = critics_[k];
    const auto [begin, end] = part_of(critic.net.num_parameters(), part);
    Vector<float>& gradient = tapes[0]->gradient[k];
    gradient.segment(begin, end - begin) += tapes[1]->gradient[k].segment(begin, end - begin);
    critic.optimiser.apply(critic.net.parameters(), gradient, begin, end);
    if (move_targets) {
      polyak_average(critic.target.parameters(), critic.net.parameters(), target_rate_, begin, end);
    }
  }
}

void Critics::save(ArchiveWriter& out) const {
  for (const Critic& critic : critics_) {
    out.array(floats(critic.net.parameters()));
    out.array(floats(critic.target.parameters()));
    save_optimiser(critic.optimiser, out);
  }
}

void Critics::load(ArchiveReader& in) {
  for (Critic& critic : critics_) {
    in.array(floats(critic.net.parameters()));
    in.array(floats(critic.target.parameters()));
    load_optimiser(critic.optimiser, in);
  }
}

}  // namespace manyhands::learn
