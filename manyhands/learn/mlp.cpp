#include "manyhands/learn/mlp.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "manyhands/learn/product.h"
#include "manyhands/learn/random.h"

namespace manyhands::learn {

template <class S>
Mlp<S>::Mlp(std::vector<int> sizes, OutputActivation output, HiddenActivation hidden)
    : sizes_(std::move(sizes)), output_(output), hidden_(hidden) {
  if (sizes_.size() < 2 || std::ranges::any_of(sizes_, [](int size) { return size <= 0; })) {
    throw std::invalid_argument("Mlp: sizes must be at least {input, output} and all positive");
  }
  int total = 0;
  for (std::size_t layer = 0; layer + 1 < sizes_.size(); ++layer) {
    begin_.push_back(total);
    total += sizes_[layer + 1] * (sizes_[layer] + 1);
  }
  parameters_.setZero(total);
}

template <class S>
int Mlp<S>::bias_begin(int layer) const {
  const auto l = static_cast<std::size_t>(layer);
  return begin_[l] + sizes_[l] * sizes_[l + 1];
}

template <class S>
Eigen::Map<const Matrix<S>> Mlp<S>::weight(int layer) const {
  const auto l = static_cast<std::size_t>(layer);
  return {parameters_.data() + weight_begin(layer), sizes_[l + 1], sizes_[l]};
}

template <class S>
Eigen::Map<const Vector<S>> Mlp<S>::bias(int layer) const {
  return {parameters_.data() + bias_begin(layer), sizes_[static_cast<std::size_t>(layer) + 1]};
}

template <class S>
bool Mlp<S>::ends_in_tanh(int layer) const {
  return layer + 1 == num_layers() ? output_ == OutputActivation::kTanh : hidden_ == HiddenActivation::kTanh;
}

template <class S>
void Mlp<S>::initialise(std::uint64_t seed, S last_layer_scale) {
  Random random(seed, Purpose::kInitialisation, 0);
  for (int layer = 0; layer < num_layers(); ++layer) {
    const S scale = layer + 1 == num_layers() ? last_layer_scale : S(1);
    const S bound = scale / std::sqrt(static_cast<S>(sizes_[static_cast<std::size_t>(layer)]));
    const int end = layer + 1 == num_layers() ? num_parameters() : weight_begin(layer + 1);
    for (int i = weight_begin(layer); i < end; ++i) {
      parameters_[i] = bound * static_cast<S>(random.uniform(-1.0f, 1.0f));
    }
  }
}

template <class S>
MlpTape<S> Mlp<S>::make_tape(int batch) const {
  MlpTape<S> tape;
  for (const int size : sizes_) {
    tape.activation.push_back(Matrix<S>::Zero(size, batch));
    tape.delta.push_back(Matrix<S>::Zero(size, batch));
  }
  return tape;
}

template <class S>
void Mlp<S>::forward(MlpTape<S>& tape) const {
  const auto batch = static_cast<int>(tape.input().cols());
  for (int layer = 0; layer < num_layers(); ++layer) {
    const auto l = static_cast<std::size_t>(layer);
    const int inputs = sizes_[l], outputs = sizes_[l + 1];
    Matrix<S>& y = tape.activation[l + 1];
    const Operand<S> weights{parameters_.data() + weight_begin(layer), 1, outputs},
        x{tape.activation[l].data(), 1, inputs};
    const S* bias = parameters_.data() + bias_begin(layer);
    if (layer + 1 < num_layers() && hidden_ == HiddenActivation::kRelu) {
      multiply(outputs, batch, inputs, weights, x, y.data(), outputs, AddBias<S, true>{bias}, tape.panel);
    } else {
      multiply(outputs, batch, inputs, weights, x, y.data(), outputs, AddBias<S, false>{bias}, tape.panel);
      if (ends_in_tanh(layer)) y = y.array().tanh();
    }
  }
}

template <class S>
void Mlp<S>::backward(MlpTape<S>& tape, BackwardWants wants, Vector<S>& gradient) const {
  const auto batch = static_cast<int>(tape.input().cols());
  for (int layer = num_layers() - 1; layer >= 0; --layer) {
    const auto l = static_cast<std::size_t>(layer);
    const int inputs = sizes_[l], outputs = sizes_[l + 1];
    if (ends_in_tanh(layer)) tape.delta[l + 1].array() *= S(1) - tape.activation[l + 1].array().square();
    const Matrix<S>&delta = tape.delta[l + 1], &x = tape.activation[l];
    if (wants.parameters) {
      multiply<S>(outputs, inputs, batch, {delta.data(), 1, outputs}, {x.data(), inputs, 1},
                  gradient.data() + weight_begin(layer), outputs, AsIs{}, tape.panel);
      gradient.segment(bias_begin(layer), outputs) = delta.rowwise().sum();
    }
    const Operand<S> transposed{parameters_.data() + weight_begin(layer), outputs, 1}, d{delta.data(), 1, outputs};
    if (layer > 0 && hidden_ == HiddenActivation::kRelu) {
      multiply(inputs, batch, outputs, transposed, d, tape.delta[l].data(), inputs, GateByRelu<S>{x.data()},
               tape.panel);
    } else if (layer > 0 || wants.input) {
      multiply(inputs, batch, outputs, transposed, d, tape.delta[l].data(), inputs, AsIs{}, tape.panel);
    }
  }
}

std::vector<int> layer_sizes(int inputs, const std::vector<int>& hidden, int outputs) {
  std::vector<int> sizes = {inputs};
  sizes.insert(sizes.end(), hidden.begin(), hidden.end());
  sizes.push_back(outputs);
  return sizes;
}

template <class S>
Adam<S>::Adam(int num_parameters, S learning_rate, S beta1, S beta2, S epsilon)
    : learning_rate_(learning_rate), beta1_(beta1), beta2_(beta2), epsilon_(epsilon) {
  first_.setZero(num_parameters);
  second_.setZero(num_parameters);
}

template <class S>
void Adam<S>::begin_step(S rate_scale) {
  ++step_count_;
  const auto t = static_cast<double>(step_count_);
  const auto rate = static_cast<double>(learning_rate_ * rate_scale);
  step_size_ = static_cast<S>(rate / (1.0 - std::pow(static_cast<double>(beta1_), t)));
  inverse_root_correction_ = static_cast<S>(1.0 / std::sqrt(1.0 - std::pow(static_cast<double>(beta2_), t)));
}

template <class S>
void Adam<S>::apply(Vector<S>& parameters, const Vector<S>& gradient, int begin, int end) {
  for (int i = begin; i < end; ++i) {
    const S g = gradient[i];
    first_[i] = beta1_ * first_[i] + (S(1) - beta1_) * g;
    second_[i] = beta2_ * second_[i] + (S(1) - beta2_) * g * g;
    parameters[i] -= step_size_ * first_[i] / (std::sqrt(second_[i]) * inverse_root_correction_ + epsilon_);
  }
}

template <class S>
void polyak_average(Vector<S>& target, const Vector<S>& source, S rate, int begin, int end) {
  for (int i = begin; i < end; ++i) target[i] += rate * (source[i] - target[i]);
}

template class Mlp<float>;
template class Mlp<double>;
template class Adam<float>;
template class Adam<double>;
template void polyak_average<float>(Vector<float>&, const Vector<float>&, float, int, int);
template void polyak_average<double>(Vector<double>&, const Vector<double>&, double, int, int);

}  // namespace manyhands::learn
