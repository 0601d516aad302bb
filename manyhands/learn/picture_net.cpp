#include "manyhands/learn/picture_net.h"

#include "manyhands/learn/random.h"

namespace manyhands::learn {

namespace {

/// Actions are small at first, away from the flat ends of tanh.
constexpr float kActionScale = 0.1f;

}  // namespace

template <class S>
PictureNet<S>::PictureNet(const PictureNetShape& shape)
    : encoders_(static_cast<std::size_t>(shape.eyes), Encoder<S>(shape.pictures, shape.layers)),
      head_(layer_sizes(shape.eyes * encoders_.front().num_features() + shape.own, shape.hidden_layers, shape.outputs),
            OutputActivation::kLinear) {}

template <class S>
void PictureNet<S>::initialise(std::uint64_t seed) {
  std::uint64_t number = 0;
  for (Encoder<S>& encoder : encoders_) encoder.initialise(derive_seed(seed, Purpose::kEncoderSeed, number++));
  head_.initialise(derive_seed(seed, Purpose::kActorSeed, 0), static_cast<S>(kActionScale));
}

template <class S>
Vector<S>& PictureNet<S>::parameters(int part) {
  return part + 1 == num_parts() ? head_.parameters() : encoders_[static_cast<std::size_t>(part)].parameters();
}

template <class S>
const Vector<S>& PictureNet<S>::parameters(int part) const {
  return part + 1 == num_parts() ? head_.parameters() : encoders_[static_cast<std::size_t>(part)].parameters();
}

template <class S>
PictureTape<S> PictureNet<S>::make_tape(int batch) const {
  PictureTape<S> tape;
  for (const Encoder<S>& encoder : encoders_) tape.eyes.push_back(encoder.make_tape(batch));
  tape.head = head_.make_tape(batch);
  return tape;
}

template <class S>
void PictureNet<S>::forward(PictureTape<S>& tape) const {
  Eigen::Index row = 0;
  for (std::size_t eye = 0; eye < encoders_.size(); ++eye) {
    encoders_[eye].forward(tape.eyes[eye]);
    const Matrix<S>& features = tape.eyes[eye].features();
    tape.head.input().middleRows(row, features.rows()) = features;
    row += features.rows();
  }
  head_.forward(tape.head);
}

template <class S>
void PictureNet<S>::backward(PictureTape<S>& tape, std::vector<Vector<S>>& gradient) const {
  head_.backward(tape.head, {.parameters = true, .input = true}, gradient.back());
  Eigen::Index row = 0;
  for (std::size_t eye = 0; eye < encoders_.size(); ++eye) {
    EncoderTape<S>& own = tape.eyes[eye];
    own.output_gradient = tape.head.input_gradient().middleRows(row, own.output_gradient.rows());
    encoders_[eye].backward(own, gradient[eye]);
    row += own.output_gradient.rows();
  }
}

template class PictureNet<float>;
template class PictureNet<double>;

}  // namespace manyhands::learn
