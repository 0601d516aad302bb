// A Gaussian squashed by tanh into (-1, 1): drawing from it, the log-probability of what was drawn, and its gradient.
//
// Haarnoja et al., "Soft actor-critic algorithms and applications", 2018, appendix C.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "manyhands/learn/mlp.h"

namespace manyhands::learn {

/// Standard deviations lie within exp of these.
inline constexpr double kLeastLogStd = -20, kMostLogStd = 2;

/// What was drawn for one mini-batch, as `backward_squashed` needs it.
template <class S>
struct SquashedDraw {
  Matrix<S> noise;            ///< (action_dim, n), standard normal, to be filled in
  Matrix<S> action;           ///< (action_dim, n), tanh(mean + exp(log_std) noise)
  Vector<S> log_probability;  ///< (n), of the action

  void resize(int action_dim, int n) {
    noise.setZero(action_dim, n);
    action.setZero(action_dim, n);
    log_probability.setZero(n);
  }
};

/// Keeps the logarithm of a standard deviation where its exponential is of use.
template <class S>
[[nodiscard]] S bounded_log_std(S raw) {
  return std::clamp(raw, S(kLeastLogStd), S(kMostLogStd));
}

/// From a network's output (2 action_dim, n), means above log standard deviations, and `draw.noise`.
template <class S>
void draw_squashed(const Matrix<S>& output, SquashedDraw<S>& draw) {
  const Eigen::Index dim = draw.action.rows();
  const S half_log_2pi = S(0.5 * std::log(2 * std::numbers::pi));
  for (Eigen::Index i = 0; i < draw.action.cols(); ++i) {
    S sum = 0;
    for (Eigen::Index k = 0; k < dim; ++k) {
      const S log_std = bounded_log_std(output(dim + k, i)), noise = draw.noise(k, i);
      const S u = output(k, i) + std::exp(log_std) * noise;
      draw.action(k, i) = std::tanh(u);
      // log(1 - tanh(u)^2), exact where tanh(u) rounds to 1
      const S log_slope =
          2 * (S(std::numbers::ln2) - u - std::log1p(std::exp(-2 * std::abs(u))) - std::max(S(0), -2 * u));
      sum += -noise * noise / 2 - log_std - half_log_2pi - log_slope;
    }
    draw.log_probability[i] = sum;
  }
}

/// The gradient of sum_i (action_gradient_i . a_i + weight log_probability_i) by the network's output, where the noise
/// stays as it is (the reparameterisation trick).
template <class S, class ActionGradient>
void backward_squashed(const Matrix<S>& output, const SquashedDraw<S>& draw, const ActionGradient& action_gradient,
                       S weight, Matrix<S>& output_gradient) {
  const Eigen::Index dim = draw.action.rows();
  for (Eigen::Index i = 0; i < draw.action.cols(); ++i) {
    for (Eigen::Index k = 0; k < dim; ++k) {
      const S a = draw.action(k, i), raw = output(dim + k, i);
      const S by_u = action_gradient(k, i) * (1 - a * a) + weight * 2 * a;
      const bool bounded = raw <= S(kLeastLogStd) || raw >= S(kMostLogStd);
      output_gradient(k, i) = by_u;
      output_gradient(dim + k, i) = bounded ? S(0) : by_u * std::exp(raw) * draw.noise(k, i) - weight;
    }
  }
}

}  // namespace manyhands::learn
