// A network that sees: an encoder for each camera, and layers over their features and what the robot knows of itself.
#pragma once

#include <vector>

#include "manyhands/learn/encoder.h"
#include "manyhands/learn/mlp.h"

namespace manyhands::learn {

/// What a `PictureNet` is made of.
struct PictureNetShape {
  int eyes = 1;
  PictureShape pictures{};
  std::vector<Convolution> layers{};
  int own{};                         ///< numbers that the robot knows of itself
  std::vector<int> hidden_layers{};  ///< over features and own numbers
  int outputs{};
};

/// Encoders and layers of one mini-batch. One per thread of work.
template <class S>
struct PictureTape {
  std::vector<EncoderTape<S>> eyes;  ///< pictures and shifts to be filled in
  MlpTape<S> head;                   ///< input: features eye by eye, then own numbers, to be filled in by `own`

  [[nodiscard]] int size() const { return static_cast<int>(head.output().cols()); }
  [[nodiscard]] S* own(Eigen::Index sample, int count) {
    return head.input().col(sample).data() + head.input().rows() - count;
  }
};

/// Its outputs are linear.
template <class S>
class PictureNet {
 public:
  explicit PictureNet(const PictureNetShape& shape);

  void initialise(std::uint64_t seed);

  /// Encoders, then the layers over them: pieces with parameters of their own.
  [[nodiscard]] int num_parts() const { return static_cast<int>(encoders_.size()) + 1; }
  [[nodiscard]] Vector<S>& parameters(int part);
  [[nodiscard]] const Vector<S>& parameters(int part) const;
  [[nodiscard]] const std::vector<Encoder<S>>& encoders() const { return encoders_; }
  [[nodiscard]] const Mlp<S>& head() const { return head_; }

  [[nodiscard]] PictureTape<S> make_tape(int batch) const;

  /// From pictures, shifts and own numbers to tape.head.output().
  void forward(PictureTape<S>& tape) const;

  /// After `forward`, from tape.head.output_gradient() to dL/dparameters, `gradient` [part] (overwritten).
  void backward(PictureTape<S>& tape, std::vector<Vector<S>>& gradient) const;

 private:
  std::vector<Encoder<S>> encoders_;
  Mlp<S> head_;
};

extern template class PictureNet<float>;
extern template class PictureNet<double>;

}  // namespace manyhands::learn
