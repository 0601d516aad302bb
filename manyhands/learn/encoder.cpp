#include "manyhands/learn/encoder.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "manyhands/learn/product.h"
#include "manyhands/learn/random.h"

namespace manyhands::learn {

namespace {

constexpr int kColours = 3;

/// Sums what a product adds to what is there.
template <class S>
struct AddTo {
  const S* sum{};

  template <class T>
  MANYHANDS_INLINE T operator()(T product, std::ptrdiff_t /*row*/, std::ptrdiff_t at) const {
    return product + load<T>(sum + at);
  }
};

}  // namespace

template <class S>
Encoder<S>::Encoder(const PictureShape& shape, std::vector<Convolution> layers)
    : shape_(shape), layers_(std::move(layers)) {
  sizes_.push_back({shape.stack, shape.height, shape.width, kColours});
  int total = 0;
  for (const Convolution& layer : layers_) {
    const Size& in = sizes_.back();
    if (layer.channels <= 0 || layer.kernel <= 0 || layer.stride <= 0 || layer.kernel > std::min(in.height, in.width)) {
      throw std::invalid_argument("Encoder: a kernel of " + std::to_string(layer.kernel) +
                                  " pixels does not fit the pictures (" + std::to_string(shape.width) + " x " +
                                  std::to_string(shape.height) + "), which are too small or their layers too many");
    }
    begin_.push_back(total);
    total += layer.channels * (in.planes * layer.kernel * layer.kernel * in.channels + 1);
    const auto places = [&](int length) { return (length - layer.kernel) / layer.stride + 1; };
    sizes_.push_back({1, places(in.height), places(in.width), layer.channels});
  }
  parameters_.setZero(total);
}

template <class S>
int Encoder<S>::num_inputs(int layer) const {
  const auto l = static_cast<std::size_t>(layer);
  return sizes_[l].planes * layers_[l].kernel * layers_[l].kernel * sizes_[l].channels;
}

template <class S>
int Encoder<S>::num_places(int layer) const {
  const Size& out = sizes_[static_cast<std::size_t>(layer) + 1];
  return out.height * out.width;
}

template <class S>
int Encoder<S>::bias_begin(int layer) const {
  return weight_begin(layer) + num_channels(layer) * num_inputs(layer);
}

template <class S>
Eigen::Map<const Matrix<S>> Encoder<S>::weight(int layer) const {
  return {parameters_.data() + weight_begin(layer), num_channels(layer), num_inputs(layer)};
}

template <class S>
Eigen::Map<const Vector<S>> Encoder<S>::bias(int layer) const {
  return {parameters_.data() + bias_begin(layer), num_channels(layer)};
}

template <class S>
void Encoder<S>::initialise(std::uint64_t seed) {
  Random random(seed, Purpose::kInitialisation, 0);
  for (int layer = 0; layer < static_cast<int>(layers_.size()); ++layer) {
    const S bound = std::sqrt(S(6) / static_cast<S>(num_inputs(layer)));
    for (int i = weight_begin(layer); i < bias_begin(layer); ++i) {
      parameters_[i] = bound * static_cast<S>(random.uniform(-1.0f, 1.0f));
    }
  }
}

template <class S>
EncoderTape<S> Encoder<S>::make_tape(int batch) const {
  EncoderTape<S> tape;
  tape.pictures.resize(static_cast<std::size_t>(batch));
  tape.shifts.resize(static_cast<std::size_t>(batch));
  for (std::size_t layer = 1; layer < sizes_.size(); ++layer) {
    tape.activation.push_back(Matrix<S>::Zero(sizes_[layer].numbers(), batch));
  }
  tape.output_gradient.setZero(num_features(), batch);
  tape.moved.resize(static_cast<std::size_t>(sizes_.front().numbers()));
  return tape;
}

/// Writes a sample's stack as numbers in [-0.5, 0.5].
template <class S>
void Encoder<S>::move(EncoderTape<S>& tape, Eigen::Index sample) const {
  const auto [dx, dy] = tape.shifts[static_cast<std::size_t>(sample)];
  const int row_size = kColours * shape_.width;
  S* to = tape.moved.data();
  for (const std::uint8_t* picture : tape.pictures[static_cast<std::size_t>(sample)]) {
    for (int y = 0; y < shape_.height; ++y, to += row_size) {
      const std::uint8_t* row = picture + std::clamp(y - dy, 0, shape_.height - 1) * row_size;
      const int first = std::clamp(dx, 0, shape_.width), last = std::clamp(shape_.width + dx, 0, shape_.width);
      const auto number = [](std::uint8_t byte) { return static_cast<S>(byte) * S(1.0 / 255) - S(0.5); };
      for (int i = kColours * first; i < kColours * last; ++i) to[i] = number(row[i - kColours * dx]);
      for (int x = 0; x < first; ++x) {
        for (int c = 0; c < kColours; ++c) to[kColours * x + c] = number(row[c]);
      }
      for (int x = last; x < shape_.width; ++x) {
        for (int c = 0; c < kColours; ++c) to[kColours * x + c] = number(row[row_size - kColours + c]);
      }
    }
  }
}

/// Copies what the kernel sees from each place into a column.
template <class S>
void Encoder<S>::gather(int layer, const S* from, S* patches) const {
  const auto l = static_cast<std::size_t>(layer);
  const Size &in = sizes_[l], &out = sizes_[l + 1];
  const auto [channels, kernel, stride] = layers_[l];
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      for (int plane = 0; plane < in.planes; ++plane) {
        const S* corner = from + plane * in.plane() + (y * stride * in.width + x * stride) * in.channels;
        for (int row = 0; row < kernel; ++row) {
          patches = std::copy_n(corner + row * in.width * in.channels, kernel * in.channels, patches);
        }
      }
    }
  }
}

/// The transpose of `gather`: adds each column to where it came from. `to` is cleared first. Only of one plane.
template <class S>
void Encoder<S>::scatter(int layer, const S* patches, S* to) const {
  const auto l = static_cast<std::size_t>(layer);
  const Size &in = sizes_[l], &out = sizes_[l + 1];
  const auto [channels, kernel, stride] = layers_[l];
  const int run = kernel * in.channels;
  std::fill_n(to, in.numbers(), S(0));
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      S* corner = to + (y * stride * in.width + x * stride) * in.channels;
      for (int row = 0; row < kernel; ++row, patches += run) {
        S* at = corner + row * in.width * in.channels;
        for (int i = 0; i < run; ++i) at[i] += patches[i];
      }
    }
  }
}

/// What a layer takes in of one sample; of the first, what `move` has written last.
template <class S>
const S* Encoder<S>::input(const EncoderTape<S>& tape, int layer, Eigen::Index sample) const {
  if (layer == 0) return tape.moved.data();
  return tape.activation[static_cast<std::size_t>(layer) - 1].col(sample).data();
}

template <class S>
void Encoder<S>::forward(EncoderTape<S>& tape) const {
  for (Eigen::Index sample = 0; sample < tape.features().cols(); ++sample) {
    if (tape.pictures[static_cast<std::size_t>(sample)].empty()) continue;
    move(tape, sample);
    for (int layer = 0; layer < static_cast<int>(layers_.size()); ++layer) {
      const int inputs = num_inputs(layer), places = num_places(layer), channels = num_channels(layer);
      tape.patches.resize(inputs, places);
      gather(layer, input(tape, layer, sample), tape.patches.data());
      S* y = tape.activation[static_cast<std::size_t>(layer)].col(sample).data();
      multiply<S>(channels, places, inputs, {parameters_.data() + weight_begin(layer), 1, channels},
                  {tape.patches.data(), 1, inputs}, y, channels,
                  AddBias<S, true>{parameters_.data() + bias_begin(layer)}, tape.panel);
    }
  }
}

template <class S>
void Encoder<S>::backward(EncoderTape<S>& tape, Vector<S>& gradient) const {
  gradient.setZero(parameters_.size());
  for (Eigen::Index sample = 0; sample < tape.features().cols(); ++sample) {
    move(tape, sample);
    tape.delta_below = tape.output_gradient.col(sample);
    for (int layer = static_cast<int>(layers_.size()) - 1; layer >= 0; --layer) {
      backward_layer(tape, layer, sample, gradient);
    }
  }
}

/// From dL/dy of the layer in tape.delta_below to dL/dx there, adding to the gradient.
template <class S>
void Encoder<S>::backward_layer(EncoderTape<S>& tape, int layer, Eigen::Index sample, Vector<S>& gradient) const {
  const int inputs = num_inputs(layer), places = num_places(layer), channels = num_channels(layer);
  const auto y = tape.activation[static_cast<std::size_t>(layer)].col(sample);
  tape.delta = (y.array() > S(0)).select(tape.delta_below, S(0));
  tape.patches.resize(inputs, places);
  gather(layer, input(tape, layer, sample), tape.patches.data());
  S* sum = gradient.data() + weight_begin(layer);
  multiply<S>(channels, inputs, places, {tape.delta.data(), 1, channels}, {tape.patches.data(), inputs, 1}, sum,
              channels, AddTo<S>{sum}, tape.panel);
  for (int place = 0; place < places; ++place) {
    gradient.segment(bias_begin(layer), channels) += tape.delta.block(place * channels, 0, channels, 1);
  }
  if (layer == 0) return;
  multiply<S>(inputs, places, channels, {parameters_.data() + weight_begin(layer), channels, 1},
              {tape.delta.data(), 1, channels}, tape.patches.data(), inputs, AsIs{}, tape.panel);
  tape.delta_below.resize(sizes_[static_cast<std::size_t>(layer)].numbers(), 1);
  scatter(layer, tape.patches.data(), tape.delta_below.data());
}

template class Encoder<float>;
template class Encoder<double>;

}  // namespace manyhands::learn
