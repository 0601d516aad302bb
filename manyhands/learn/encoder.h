// Convolutional encoders: from pictures in bytes to features, and back for gradients.
//
// A layer gathers the patches of one picture into a matrix whose columns are places, and is then a product
// (`product.h`) with relu fused in; gathered patches and what comes of them stay in the cache. Everything is a template
// over the scalar so that gradients are checked in double.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "manyhands/learn/mlp.h"

namespace manyhands::learn {

/// One layer: square kernels moved by `stride` within the picture, then relu.
struct Convolution {
  int channels{}, kernel{}, stride{};
};

/// What an encoder takes: the last `stack` pictures of a camera, in red, green and blue.
struct PictureShape {
  int height{}, width{}, stack{};

  [[nodiscard]] int pixels() const { return height * width; }
};

/// A stack of pictures, newest first, (height, width, 3) each.
using Stack = std::vector<const std::uint8_t*>;

/// By how many pixels a picture is moved to the right and down; what comes in repeats its edge.
struct Shift {
  int x = 0, y = 0;
};

/// Activations of one mini-batch, and scratch. One per thread of work.
template <class S>
struct EncoderTape {
  std::vector<Stack> pictures;        ///< (batch), to be filled in
  std::vector<Shift> shifts;          ///< (batch), likewise
  std::vector<Matrix<S>> activation;  ///< [layer] (channels places, batch): place by place, row by row
  Matrix<S> output_gradient;          ///< (features, batch)
  std::vector<S> moved;               ///< the stack of one sample as numbers, picture by picture
  Matrix<S> patches, delta, delta_below;
  std::vector<S> panel;

  [[nodiscard]] const Matrix<S>& features() const { return activation.back(); }
};

template <class S>
class Encoder {  ///< pictures to numbers, by convolutions
 public:
  Encoder() = default;
  /// Parameters are zero until `initialise`. Throws std::invalid_argument unless every layer has a place left.
  Encoder(const PictureShape& shape, std::vector<Convolution> layers);

  /// Weights uniform with variance 2 / inputs (He et al., 2015), biases 0.
  void initialise(std::uint64_t seed);

  [[nodiscard]] const PictureShape& shape() const { return shape_; }
  [[nodiscard]] const std::vector<Convolution>& layers() const { return layers_; }
  [[nodiscard]] int num_features() const { return sizes_.back().numbers(); }

  /// Flat, layer by layer: weights (channels x inputs, column-major), then biases. The inputs of a kernel are ordered
  /// by picture of the stack, row, column, channel.
  [[nodiscard]] const Vector<S>& parameters() const { return parameters_; }
  [[nodiscard]] Vector<S>& parameters() { return parameters_; }
  [[nodiscard]] Eigen::Map<const Matrix<S>> weight(int layer) const;
  [[nodiscard]] Eigen::Map<const Vector<S>> bias(int layer) const;

  [[nodiscard]] EncoderTape<S> make_tape(int batch) const;

  /// From tape.pictures and tape.shifts to tape.features(); those of a sample without pictures stay as they are.
  void forward(EncoderTape<S>& tape) const;

  /// After `forward`, from tape.output_gradient to `gradient` = dL/dparameters (overwritten).
  void backward(EncoderTape<S>& tape, Vector<S>& gradient) const;

 private:
  /// What a layer takes in: `planes` of (height, width, channels).
  struct Size {
    int planes{}, height{}, width{}, channels{};
    [[nodiscard]] int plane() const { return height * width * channels; }
    [[nodiscard]] int numbers() const { return planes * plane(); }
  };

  [[nodiscard]] int num_inputs(int layer) const;  // of one kernel
  [[nodiscard]] int num_places(int layer) const;
  [[nodiscard]] int bias_begin(int layer) const;
  [[nodiscard]] int num_channels(int layer) const { return layers_[static_cast<std::size_t>(layer)].channels; }
  [[nodiscard]] int weight_begin(int layer) const { return begin_[static_cast<std::size_t>(layer)]; }
  [[nodiscard]] const S* input(const EncoderTape<S>& tape, int layer, Eigen::Index sample) const;
  void move(EncoderTape<S>& tape, Eigen::Index sample) const;
  void gather(int layer, const S* from, S* patches) const;
  void scatter(int layer, const S* patches, S* to) const;
  void backward_layer(EncoderTape<S>& tape, int layer, Eigen::Index sample, Vector<S>& gradient) const;

  PictureShape shape_;
  std::vector<Convolution> layers_;
  std::vector<Size> sizes_;  // [layer] what it takes in; last what comes out
  std::vector<int> begin_;   // of each layer's weights in parameters_
  Vector<S> parameters_;
};

extern template class Encoder<float>;
extern template class Encoder<double>;

}  // namespace manyhands::learn
