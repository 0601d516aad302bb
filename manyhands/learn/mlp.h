// Multilayer perceptrons on Eigen: forward, backward, Adam and Polyak averaging over one flat parameter vector.
//
// A mini-batch is a matrix whose columns are samples, so a sample is contiguous. Everything is a template over the
// scalar so that gradients are checked in double; float and double are instantiated in mlp.cpp.
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "manyhands/learn/eigen.h"

namespace manyhands::learn {

/// The networks have left the finite numbers. The message says after how many steps, and what to try.
class DivergenceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

template <class S>
using Matrix = Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic>;
template <class S>
using Vector = Eigen::Matrix<S, Eigen::Dynamic, 1>;

enum class OutputActivation { kLinear, kTanh };  ///< after the last layer
enum class HiddenActivation { kRelu, kTanh };    ///< after every other layer

/// Activations and deltas of one mini-batch: sized once, so that passes do not allocate. One per thread of work.
template <class S>
struct MlpTape {
  std::vector<Matrix<S>> activation;  ///< [layer] (size of that layer, batch); [0] is the input, to be filled in
  std::vector<Matrix<S>> delta;       ///< [layer] loss gradient by that layer's output, then by its pre-activation
  std::vector<S> panel;               ///< scratch of the products

  [[nodiscard]] Matrix<S>& input() { return activation.front(); }
  [[nodiscard]] const Matrix<S>& output() const { return activation.back(); }
  [[nodiscard]] Matrix<S>& output_gradient() { return delta.back(); }
  [[nodiscard]] const Matrix<S>& input_gradient() const { return delta.front(); }
};

/// What `Mlp::backward` computes besides the deltas of the hidden layers.
struct BackwardWants {
  bool parameters = true;
  bool input = false;
};

/// y = out(W_L act(... act(W_1 x + b_1) ...) + b_L).
template <class S>
class Mlp {
 public:
  Mlp() = default;
  /// `sizes`: input, hidden..., output, all positive, at least two. Throws std::invalid_argument otherwise.
  /// All parameters are zero until `initialise` or `parameters() = ...`.
  Mlp(std::vector<int> sizes, OutputActivation output, HiddenActivation hidden = HiddenActivation::kRelu);

  /// Weights and biases uniform in +-1/sqrt(inputs of the layer); those of the last layer times `last_layer_scale`.
  void initialise(std::uint64_t seed, S last_layer_scale);

  [[nodiscard]] const std::vector<int>& sizes() const { return sizes_; }
  [[nodiscard]] HiddenActivation hidden() const { return hidden_; }
  [[nodiscard]] int num_layers() const { return static_cast<int>(sizes_.size()) - 1; }
  [[nodiscard]] int num_parameters() const { return static_cast<int>(parameters_.size()); }

  /// Flat, layer by layer: W (outputs x inputs, column-major), then b.
  [[nodiscard]] const Vector<S>& parameters() const { return parameters_; }
  [[nodiscard]] Vector<S>& parameters() { return parameters_; }
  [[nodiscard]] Eigen::Map<const Matrix<S>> weight(int layer) const;
  [[nodiscard]] Eigen::Map<const Vector<S>> bias(int layer) const;

  [[nodiscard]] MlpTape<S> make_tape(int batch) const;

  /// From tape.input() to tape.output().
  void forward(MlpTape<S>& tape) const;

  /// After `forward`, from tape.output_gradient() = dL/dy to `gradient` = dL/dparameters (overwritten; same layout)
  /// and, if wanted, tape.input_gradient() = dL/dx.
  void backward(MlpTape<S>& tape, BackwardWants wants, Vector<S>& gradient) const;

 private:
  [[nodiscard]] int weight_begin(int layer) const { return begin_[static_cast<std::size_t>(layer)]; }
  [[nodiscard]] int bias_begin(int layer) const;
  [[nodiscard]] bool ends_in_tanh(int layer) const;

  std::vector<int> sizes_;
  std::vector<int> begin_;  // of each layer's weights in parameters_
  OutputActivation output_ = OutputActivation::kLinear;
  HiddenActivation hidden_ = HiddenActivation::kRelu;
  Vector<S> parameters_;
};

/// {inputs, hidden..., outputs}, as `Mlp` takes them.
[[nodiscard]] std::vector<int> layer_sizes(int inputs, const std::vector<int>& hidden, int outputs);

/// Adam (Kingma and Ba, 2015, algorithm 1) with bias-corrected moments.
template <class S>
class Adam {
 public:
  Adam() = default;
  Adam(int num_parameters, S learning_rate, S beta1 = S(0.9), S beta2 = S(0.999), S epsilon = S(1e-8));

  /// Advances the step count; call once before the `apply` calls that together cover all parameters. The learning rate
  /// of this step is `rate_scale` times that of the constructor.
  void begin_step(S rate_scale = S(1));
  /// Moves parameters [begin, end) against the gradient. Disjoint ranges may run on different threads.
  void apply(Vector<S>& parameters, const Vector<S>& gradient, int begin, int end);

  [[nodiscard]] std::int64_t step_count() const { return step_count_; }
  void set_step_count(std::int64_t count) { step_count_ = count; }
  [[nodiscard]] Vector<S>& first_moment() { return first_; }
  [[nodiscard]] Vector<S>& second_moment() { return second_; }
  [[nodiscard]] const Vector<S>& first_moment() const { return first_; }
  [[nodiscard]] const Vector<S>& second_moment() const { return second_; }

 private:
  S learning_rate_{}, beta1_{}, beta2_{}, epsilon_{};
  S step_size_{}, inverse_root_correction_{};
  std::int64_t step_count_ = 0;
  Vector<S> first_, second_;
};

/// target[begin, end) += rate (source - target).
template <class S>
void polyak_average(Vector<S>& target, const Vector<S>& source, S rate, int begin, int end);

extern template class Mlp<float>;
extern template class Mlp<double>;
extern template class Adam<float>;
extern template class Adam<double>;

}  // namespace manyhands::learn
