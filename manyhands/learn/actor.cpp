#include "manyhands/learn/actor.h"

#include <cmath>
#include <utility>

#include "manyhands/learn/squashed_gaussian.h"

namespace manyhands::learn {

namespace {

/// The actor starts with small actions, away from the flat ends of tanh.
constexpr float kLastLayerScale = 0.1f;

Eigen::Index most_likely(const Matrix<float>& logits, Eigen::Index column) {
  Eigen::Index best = 0;
  logits.col(column).maxCoeff(&best);
  return best;
}

/// Inverts the distribution function of softmax(logits) at `uniform` in [0, 1).
Eigen::Index drawn(const Matrix<float>& logits, Eigen::Index column, float uniform) {
  const float most = logits.col(column).maxCoeff();
  const float total = (logits.col(column).array() - most).exp().sum();
  float left = uniform * total;
  for (Eigen::Index k = 0; k + 1 < logits.rows(); ++k) {
    left -= std::exp(logits(k, column) - most);
    if (left < 0) return k;
  }
  return logits.rows() - 1;
}

}  // namespace

PolicyKind policy_kind(Algorithm algorithm, int choices) {
  if (algorithm == Algorithm::kTd3 || algorithm == Algorithm::kDagger) return PolicyKind::kDeterministic;
  if (algorithm == Algorithm::kSac) return PolicyKind::kSquashedGaussian;
  return choices > 0 ? PolicyKind::kCategorical : PolicyKind::kGaussian;
}

Actor::Actor(PolicyKind kind, int state_dim, int outputs, const TrainerConfig& config)
    : kind_(kind),
      outputs_(outputs),
      net_(layer_sizes(state_dim, config.hidden_layers, kind == PolicyKind::kSquashedGaussian ? 2 * outputs : outputs),
           kind == PolicyKind::kDeterministic ? OutputActivation::kTanh : OutputActivation::kLinear,
           config.activation) {
  net_.initialise(derive_seed(config.seed, Purpose::kActorSeed, 0), kLastLayerScale);
  if (kind == PolicyKind::kGaussian) log_std_.setConstant(outputs, std::log(config.initial_std));
}

Actor::Actor(PolicyKind kind, Mlp<float> net) : kind_(kind), outputs_(net.sizes().back()), net_(std::move(net)) {
  if (kind == PolicyKind::kGaussian) log_std_.setZero(outputs_);
}

void Actor::act(MlpTape<float>& tape, Matrix<float>& action) const {
  net_.forward(tape);
  const Matrix<float>& output = tape.output();
  switch (kind_) {
    case PolicyKind::kDeterministic:
    case PolicyKind::kGaussian:
      action = output;
      break;
    case PolicyKind::kSquashedGaussian:
      action = output.topRows(outputs_).array().tanh();
      break;
    case PolicyKind::kCategorical:
      for (Eigen::Index i = 0; i < output.cols(); ++i) action(0, i) = static_cast<float>(most_likely(output, i));
      break;
  }
}

void Actor::draw(MlpTape<float>& tape, Random random, Matrix<float>& action) const {
  net_.forward(tape);
  const Matrix<float>& output = tape.output();
  for (Eigen::Index i = 0; i < output.cols(); ++i) {
    if (kind_ == PolicyKind::kCategorical) {
      action(0, i) = static_cast<float>(drawn(output, i, random.uniform()));
      continue;
    }
    for (Eigen::Index k = 0; k < outputs_; ++k) {
      action(k, i) = output(k, i);
      if (kind_ == PolicyKind::kGaussian) action(k, i) += std::exp(log_std_[k]) * random.normal();
      if (kind_ == PolicyKind::kSquashedGaussian) {
        action(k, i) = std::tanh(output(k, i) + std::exp(bounded_log_std(output(outputs_ + k, i))) * random.normal());
      }
    }
  }
}

}  // namespace manyhands::learn
