// Fits a network to pairs of inputs and outputs: imitation of what was demonstrated.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "manyhands/learn/halves.h"
#include "manyhands/learn/mlp.h"

namespace manyhands::learn {

/// Everything that can be set about a regression.
struct RegressionConfig {
  std::uint64_t seed = 0;  ///< of the first weights and of the mini-batches
  int num_threads = 1;     ///< 1 or 2 are used; the results are the same bits
  std::vector<int> hidden_layers = {256, 256};
  int batch_size = 256;  ///< pairs of a gradient step, even
  float learning_rate = 1e-3f;
  float averaging_rate = 1e-3f;  ///< at which the fitted network follows the one that learns, in (0, 1]
  bool bounded = true;           ///< outputs pass tanh, as actions do; otherwise they are linear

  /// Throws std::invalid_argument naming the first setting that makes no sense.
  void validate() const;
};

/// Minimises the mean of (y(x) - target)^2 over all known targets by Adam on mini-batches drawn uniformly.
///
/// The result is a running mean of the weights (Polyak and Juditsky, 1992), which does what a falling learning rate
/// would, without a number of steps that has to be known beforehand. A target that is NaN is unknown: nothing is asked
/// of that output there.
class Regression {
 public:
  /// `inputs` (n, input_dim) and `targets` (n, output_dim) are row-major. Throws std::invalid_argument on lengths that
  /// do not fit, no pairs, an input that is not finite, an infinite target, or a config that makes no sense.
  Regression(std::vector<float> inputs, int input_dim, std::vector<float> targets, int output_dim,
             const RegressionConfig& config);

  /// Takes so many gradient steps, without allocating, and returns their mean loss (0 if there are none). Throws
  /// DivergenceError if the network diverges to non-numbers.
  double advance(int steps);

  /// What has been fitted so far.
  [[nodiscard]] const Mlp<float>& network() const { return average_; }

 private:
  /// One half of the mini-batch.
  struct Half {
    MlpTape<float> tape;
    Vector<float> gradient;
    double squared_error = 0;
  };

  double step();
  void compute_gradient(int half);
  void apply(int part);

  RegressionConfig config_;
  std::vector<float> inputs_, targets_;  // (n, input_dim), (n, output_dim)
  int input_dim_ = 0, output_dim_ = 0;
  std::uint32_t pairs_ = 0;
  Mlp<float> net_, average_;
  Adam<float> optimiser_;
  std::array<Half, 2> halves_;
  Halves threads_;
};

}  // namespace manyhands::learn
