// Networks against finite differences, Adam against its closed form.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "manyhands/learn/mlp.h"
#include "manyhands/learn/random.h"

namespace manyhands::learn {
namespace {

Matrix<double> random_matrix(Eigen::Index rows, Eigen::Index columns, std::uint64_t seed) {
  Random random(seed, Purpose::kSampling, 0);
  return Matrix<double>::NullaryExpr(rows, columns, [&] { return static_cast<double>(random.normal()); });
}

/// L = sum of (y * weight) over the batch, so dL/dy = weight.
double loss(const Mlp<double>& net, MlpTape<double>& tape, const Matrix<double>& weight) {
  net.forward(tape);
  return tape.output().cwiseProduct(weight).sum();
}

double central_difference(double& x, const std::function<double()>& f) {
  constexpr double kStep = 1e-6;
  const double before = x;
  x = before + kStep;
  const double above = f();
  x = before - kStep;
  const double below = f();
  x = before;
  return (above - below) / (2 * kStep);
}

class MlpGradient : public testing::TestWithParam<std::tuple<OutputActivation, HiddenActivation>> {};

TEST_P(MlpGradient, EqualsFiniteDifferences) {
  Mlp<double> net({5, 7, 6, 3}, std::get<0>(GetParam()), std::get<1>(GetParam()));
  net.initialise(3, 1.0);
  MlpTape<double> tape = net.make_tape(4);
  tape.input() = random_matrix(5, 4, 1);
  const Matrix<double> weight = random_matrix(3, 4, 2);
  const auto value = [&] { return loss(net, tape, weight); };
  value();
  tape.output_gradient() = weight;
  Vector<double> gradient = Vector<double>::Constant(net.num_parameters(), 1e3);  // must be overwritten
  net.backward(tape, {.parameters = true, .input = true}, gradient);
  const Matrix<double> input_gradient = tape.input_gradient();

  // The loss is piecewise smooth with second derivatives of order 1: central differences at 1e-6 hold 1e-8.
  for (int i = 0; i < net.num_parameters(); ++i) {
    EXPECT_NEAR(gradient[i], central_difference(net.parameters()[i], value), 1e-7) << "parameter " << i;
  }
  for (Eigen::Index i = 0; i < tape.input().size(); ++i) {
    EXPECT_NEAR(input_gradient(i), central_difference(tape.input()(i), value), 1e-7) << "input " << i;
  }
  EXPECT_GT(gradient.norm(), 0.1);
}

INSTANTIATE_TEST_SUITE_P(Activations, MlpGradient,
                         testing::Combine(testing::Values(OutputActivation::kLinear, OutputActivation::kTanh),
                                          testing::Values(HiddenActivation::kRelu, HiddenActivation::kTanh)));

TEST(Mlp, ComputesAHandWorkedExample) {
  Mlp<double> net({2, 2, 1}, OutputActivation::kLinear);
  // W1 = [1 -1; 2 0.5], b1 = [0.5, -3], W2 = [2, 1], b2 = [0.25]; weights are stored column by column.
  net.parameters() << 1, 2, -1, 0.5, 0.5, -3, 2, 1, 0.25;
  MlpTape<double> tape = net.make_tape(2);
  tape.input() << 1, 2,  // column 0: x = (1, 3): relu(-1.5), relu(0.5) -> 0.5 + 0.25
      3, 1;              // column 1: x = (2, 1): relu(1.5), relu(1.5) -> 3 + 1.5 + 0.25
  net.forward(tape);
  EXPECT_DOUBLE_EQ(tape.output()(0, 0), 0.75);
  EXPECT_DOUBLE_EQ(tape.output()(0, 1), 4.75);
}

TEST(Mlp, FloatAgreesWithDouble) {
  Mlp<double> reference({6, 32, 32, 2}, OutputActivation::kTanh);
  reference.initialise(5, 1.0);
  Mlp<float> net({6, 32, 32, 2}, OutputActivation::kTanh);
  net.parameters() = reference.parameters().cast<float>();
  MlpTape<double> expected = reference.make_tape(33);
  expected.input() = random_matrix(6, 33, 9);
  MlpTape<float> tape = net.make_tape(33);
  tape.input() = expected.input().cast<float>();
  reference.forward(expected);
  net.forward(tape);
  EXPECT_LT((tape.output().cast<double>() - expected.output()).cwiseAbs().maxCoeff(), 2e-6);
}

TEST(Mlp, RejectsSenselessSizes) {
  EXPECT_THROW(Mlp<float>({3}, OutputActivation::kLinear), std::invalid_argument);
  EXPECT_THROW(Mlp<float>({3, 0, 2}, OutputActivation::kLinear), std::invalid_argument);
}

TEST(Adam, TakesStepsOfTheLearningRateUnderAConstantGradient) {
  // With a constant gradient both corrected moments are exact: every step is rate * g / (|g| + epsilon).
  Vector<double> x(3), gradient(3);
  x << 1, -2, 0.5;
  gradient << 0.3, -7.0, 1e-3;
  const Vector<double> start = x;
  Adam<double> adam(3, 0.01);
  for (int step = 1; step <= 100; ++step) {
    adam.begin_step(step <= 50 ? 1.0 : 0.5);
    adam.apply(x, gradient, 0, 2);
    adam.apply(x, gradient, 2, 3);
    const double whole_steps = std::min(step, 50) + 0.5 * std::max(step - 50, 0);
    for (Eigen::Index i = 0; i < 3; ++i) {
      const double expected = start[i] - whole_steps * 0.01 * gradient[i] / (std::abs(gradient[i]) + 1e-8);
      EXPECT_NEAR(x[i], expected, 1e-12) << "step " << step;
    }
  }
}

TEST(Adam, FollowsTheSumsThatDefineIt) {
  // m_t = (1 - b1) sum b1^(t-i) g_i and likewise v_t, written as sums instead of recursions.
  const double gradients[] = {1.0, -0.5, 2.0, 0.25};
  const double rate = 0.1, b1 = 0.8, b2 = 0.95;
  Adam<double> adam(1, rate, b1, b2);
  Vector<double> x = Vector<double>::Zero(1), gradient(1);
  double expected = 0;
  for (int t = 1; t <= 4; ++t) {
    double m = 0, v = 0;
    for (int i = 1; i <= t; ++i) {
      const double g = gradients[i - 1];
      m += (1 - b1) * std::pow(b1, t - i) * g;
      v += (1 - b2) * std::pow(b2, t - i) * g * g;
    }
    expected -= rate * (m / (1 - std::pow(b1, t))) / (std::sqrt(v / (1 - std::pow(b2, t))) + 1e-8);
    gradient[0] = gradients[t - 1];
    adam.begin_step();
    adam.apply(x, gradient, 0, 1);
    EXPECT_NEAR(x[0], expected, 1e-12) << "step " << t;
  }
}

TEST(PolyakAverage, MovesTheGivenShareOfTheWay) {
  Vector<double> target(4), source(4);
  target << 0, 1, 2, 3;
  source << 10, 11, 12, 13;
  polyak_average(target, source, 0.1, 1, 3);
  EXPECT_DOUBLE_EQ(target[0], 0);
  EXPECT_DOUBLE_EQ(target[1], 2);
  EXPECT_DOUBLE_EQ(target[2], 3);
  EXPECT_DOUBLE_EQ(target[3], 3);
}

}  // namespace
}  // namespace manyhands::learn
