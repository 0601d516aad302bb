// The probability of an action under a Gaussian or a categorical policy, the entropy, and their gradients.
#pragma once

#include <cmath>
#include <numbers>

#include "manyhands/learn/actor.h"
#include "manyhands/learn/mlp.h"

namespace manyhands::learn {

/// A policy's answer to a mini-batch: `output` of its network (outputs, n), and log_std (outputs) if it is Gaussian.
template <class S>
struct ActionDistribution {
  PolicyKind kind{};
  const Matrix<S>& output;
  const Vector<S>& log_std;

  /// log pi(a|s) of column i for the action (action_dim) at `action`.
  [[nodiscard]] S log_probability(Eigen::Index i, const S* action) const {
    if (kind == PolicyKind::kCategorical) return output(choice(action), i) - log_sum(i);
    S sum = 0;
    for (Eigen::Index k = 0; k < output.rows(); ++k) {
      const S z = (action[k] - output(k, i)) * std::exp(-log_std[k]);
      sum -= z * z / 2 + log_std[k] + S(0.5 * std::log(2 * std::numbers::pi));
    }
    return sum;
  }

  [[nodiscard]] S entropy(Eigen::Index i) const {
    S sum = 0;
    if (kind == PolicyKind::kCategorical) {
      const S all = log_sum(i);
      for (Eigen::Index k = 0; k < output.rows(); ++k) sum -= std::exp(output(k, i) - all) * (output(k, i) - all);
    } else {
      for (Eigen::Index k = 0; k < output.rows(); ++k)
        sum += log_std[k] + S(0.5 + 0.5 * std::log(2 * std::numbers::pi));
    }
    return sum;
  }

  /// The gradient of by_log_probability * log pi(a|s) + by_entropy * entropy: into column i of `by_output`, and added
  /// to `by_log_std`.
  void backward(Eigen::Index i, const S* action, S by_log_probability, S by_entropy, Matrix<S>& by_output,
                Vector<S>& by_log_std) const {
    if (kind == PolicyKind::kCategorical) {
      const S all = log_sum(i), h = entropy(i);
      for (Eigen::Index k = 0; k < output.rows(); ++k) {
        const S log_p = output(k, i) - all, p = std::exp(log_p);
        by_output(k, i) = by_log_probability * ((k == choice(action) ? S(1) : S(0)) - p) - by_entropy * p * (log_p + h);
      }
      return;
    }
    for (Eigen::Index k = 0; k < output.rows(); ++k) {
      const S precision = std::exp(-log_std[k]), z = (action[k] - output(k, i)) * precision;
      by_output(k, i) = by_log_probability * z * precision;
      by_log_std[k] += by_log_probability * (z * z - 1) + by_entropy;
    }
  }

 private:
  [[nodiscard]] static Eigen::Index choice(const S* action) { return static_cast<Eigen::Index>(*action); }

  [[nodiscard]] S log_sum(Eigen::Index i) const {
    const S most = output.col(i).maxCoeff();
    return most + std::log((output.col(i).array() - most).exp().sum());
  }
};

}  // namespace manyhands::learn
