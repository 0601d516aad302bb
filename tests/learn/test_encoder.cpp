// Encoders against a convolution written down plainly, finite differences and themselves in float.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "manyhands/learn/encoder.h"
#include "manyhands/learn/picture_net.h"
#include "manyhands/learn/random.h"

namespace manyhands::learn {
namespace {

constexpr PictureShape kShape = {.height = 13, .width = 15, .stack = 2};
const std::vector<Convolution> kLayers = {{5, 4, 3}, {17, 3, 1}, {4, 2, 1}};  // channels beside and above a register

std::vector<std::uint8_t> random_pictures(int count, std::uint64_t seed) {
  Random random(seed, Purpose::kSampling, 0);
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(count * 3 * kShape.pixels()));
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random.below(256));
  return bytes;
}

template <class S>
void show(const std::vector<std::uint8_t>& pictures, const std::vector<Shift>& shifts, EncoderTape<S>& tape) {
  const std::uint8_t* next = pictures.data();
  for (Stack& stack : tape.pictures) {
    stack.clear();
    for (int i = 0; i < kShape.stack; ++i, next += 3 * kShape.pixels()) stack.push_back(next);
  }
  tape.shifts = shifts;
}

Matrix<double> random_matrix(Eigen::Index rows, Eigen::Index columns, std::uint64_t seed) {
  Random random(seed, Purpose::kSampling, 0);
  return Matrix<double>::NullaryExpr(rows, columns, [&] { return static_cast<double>(random.normal()); });
}

/// Biases too, so that none is left out by being zero.
template <class Net>
void fill(Net& net, std::uint64_t seed) {
  net.initialise(seed);
  net.parameters() += 0.02 * random_matrix(net.parameters().size(), 1, seed);
}

/// One layer as its definition has it. `in(plane, y, x, c)`; weights as `Encoder::parameters` orders them.
template <class In>
Vector<double> convolve(const In& in, int planes, int below, int rows, int columns, const Convolution& layer,
                        const Matrix<double>& weight, const Vector<double>& bias) {
  Vector<double> out(rows * columns * layer.channels);
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      for (int k = 0; k < layer.channels; ++k) {
        double sum = bias[k];
        for (int p = 0; p < planes; ++p) {
          for (int v = 0; v < layer.kernel; ++v) {
            for (int u = 0; u < layer.kernel; ++u) {
              for (int c = 0; c < below; ++c) {
                const int i = ((p * layer.kernel + v) * layer.kernel + u) * below + c;
                sum += weight(k, i) * in(p, y * layer.stride + v, x * layer.stride + u, c);
              }
            }
          }
        }
        out[(y * columns + x) * layer.channels + k] = std::max(sum, 0.0);
      }
    }
  }
  return out;
}

TEST(Encoder, IsAConvolution) {
  Encoder<double> encoder(kShape, kLayers);
  fill(encoder, 3);
  EncoderTape<double> tape = encoder.make_tape(2);
  const std::vector<std::uint8_t> pictures = random_pictures(4, 1);
  const std::vector<Shift> shifts = {{2, -3}, {-1, 0}};
  show(pictures, shifts, tape);
  encoder.forward(tape);
  for (int sample = 0; sample < 2; ++sample) {
    const Shift shift = shifts[static_cast<std::size_t>(sample)];
    const auto pixel = [&](int plane, int y, int x, int c) {
      const int row = std::clamp(y - shift.y, 0, kShape.height - 1),
                column = std::clamp(x - shift.x, 0, kShape.width - 1);
      const int at = 3 * ((2 * sample + plane) * kShape.pixels() + row * kShape.width + column) + c;
      return pictures[static_cast<std::size_t>(at)] / 255.0 - 0.5;
    };
    // 13 x 15 pixels become 4 x 4 places, 2 x 2 and 1 x 1.
    const Vector<double> first = convolve(pixel, 2, 3, 4, 4, kLayers[0], encoder.weight(0), encoder.bias(0));
    const auto below = [](const Vector<double>& from, int columns, int channels) {
      return [&from, columns, channels](int, int y, int x, int c) { return from[(y * columns + x) * channels + c]; };
    };
    const Vector<double> second =
        convolve(below(first, 4, 5), 1, 5, 2, 2, kLayers[1], encoder.weight(1), encoder.bias(1));
    const Vector<double> third =
        convolve(below(second, 2, 17), 1, 17, 1, 1, kLayers[2], encoder.weight(2), encoder.bias(2));
    ASSERT_EQ(tape.features().rows(), third.size());
    EXPECT_LT((tape.features().col(sample) - third).norm(), 1e-12 * (1 + third.norm()));
    EXPECT_GT(first.norm(), 0.1);
  }
}

TEST(Encoder, FloatAgreesWithDouble) {
  Encoder<double> reference(kShape, kLayers);
  fill(reference, 5);
  Encoder<float> encoder(kShape, kLayers);
  encoder.parameters() = reference.parameters().cast<float>();
  EncoderTape<double> exact = reference.make_tape(3);
  EncoderTape<float> tape = encoder.make_tape(3);
  const std::vector<std::uint8_t> pictures = random_pictures(6, 2);
  const std::vector<Shift> shifts = {{0, 0}, {15, 4}, {-20, 13}};  // up to beyond the picture
  show(pictures, shifts, exact);
  show(pictures, shifts, tape);
  reference.forward(exact);
  encoder.forward(tape);
  EXPECT_LT((tape.features().cast<double>() - exact.features()).norm(), 1e-5 * exact.features().norm());
  EXPECT_GT(exact.features().norm(), 0.1);

  exact.output_gradient = random_matrix(exact.features().rows(), 3, 4);
  tape.output_gradient = exact.output_gradient.cast<float>();
  Vector<double> wanted;
  Vector<float> gradient;
  reference.backward(exact, wanted);
  encoder.backward(tape, gradient);
  EXPECT_LT((gradient.cast<double>() - wanted).norm(), 1e-5 * wanted.norm());
}

TEST(Encoder, RefusesPicturesThatAreTooSmall) {
  EXPECT_THROW(Encoder<float>(kShape, {{8, 4, 4}, {8, 4, 2}}), std::invalid_argument);
  EXPECT_THROW(Encoder<float>(kShape, {{8, 0, 4}}), std::invalid_argument);
}

TEST(PictureNet, GradientsEqualFiniteDifferences) {
  PictureNet<double> net(
      {.eyes = 2, .pictures = kShape, .layers = kLayers, .own = 3, .hidden_layers = {7}, .outputs = 4});
  net.initialise(6);
  for (int part = 0; part < net.num_parts(); ++part) {
    net.parameters(part) += 0.02 * random_matrix(net.parameters(part).size(), 1, static_cast<std::uint64_t>(part));
  }
  PictureTape<double> tape = net.make_tape(2);
  const std::vector<std::uint8_t> left = random_pictures(4, 7), right = random_pictures(4, 8);
  show(left, {{1, 0}, {0, 2}}, tape.eyes[0]);
  show(right, {{0, 0}, {-2, 1}}, tape.eyes[1]);
  const Matrix<double> own = random_matrix(3, 2, 9), weight = random_matrix(4, 2, 10);
  for (Eigen::Index sample = 0; sample < 2; ++sample) std::copy_n(own.col(sample).data(), 3, tape.own(sample, 3));
  const auto value = [&] {
    net.forward(tape);
    return tape.head.output().cwiseProduct(weight).sum();
  };
  value();
  tape.head.output_gradient() = weight;
  std::vector<Vector<double>> gradient;
  for (int part = 0; part < net.num_parts(); ++part) {
    gradient.push_back(Vector<double>::Constant(net.parameters(part).size(), 1e3));  // must be overwritten
  }
  net.backward(tape, gradient);
  for (int part = 0; part < net.num_parts(); ++part) {
    Vector<double>& parameters = net.parameters(part);
    const Vector<double>& found = gradient[static_cast<std::size_t>(part)];
    EXPECT_GT(found.norm(), 0.01) << "part " << part;
    for (Eigen::Index i = 0; i < parameters.size(); ++i) {
      const double before = parameters[i];
      parameters[i] = before + 1e-6;
      const double above = value();
      parameters[i] = before - 1e-6;
      const double below = value();
      parameters[i] = before;
      // Piecewise linear but for products of layers: central differences at 1e-6 hold 1e-8.
      ASSERT_NEAR(found[i], (above - below) / 2e-6, 1e-7) << "part " << part << ", parameter " << i;
    }
  }
}

}  // namespace
}  // namespace manyhands::learn
