// Probabilities and losses of policies and critics: against closed forms, sums over what can happen, and finite
// differences.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "manyhands/learn/action_distribution.h"
#include "manyhands/learn/quantiles.h"
#include "manyhands/learn/random.h"
#include "manyhands/learn/squashed_gaussian.h"

namespace manyhands::learn {
namespace {

Matrix<double> random_matrix(Eigen::Index rows, Eigen::Index columns, std::uint64_t seed) {
  Random random(seed, Purpose::kSampling, 0);
  return Matrix<double>::NullaryExpr(rows, columns, [&] { return static_cast<double>(random.normal()); });
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

TEST(SquashedGaussian, TheDensityOfAnActionIntegratesToOne) {
  // p(a) da with a = tanh(mean + std noise), by the trapezoid rule over the noise's quantiles turned into actions.
  Matrix<double> output(2, 1);
  output << 0.4, std::log(0.7);
  SquashedDraw<double> draw;
  draw.resize(1, 1);
  double integral = 0, last_action = 0, last_density = 0;
  for (int i = 0; i <= 20000; ++i) {
    draw.noise(0, 0) = -8 + 16.0 * i / 20000;
    draw_squashed(output, draw);
    const double density = std::exp(draw.log_probability[0]), action = draw.action(0, 0);
    if (i > 0) integral += 0.5 * (density + last_density) * (action - last_action);
    last_action = action;
    last_density = density;
  }
  EXPECT_NEAR(integral, 1.0, 1e-5);
}

TEST(SquashedGaussian, ItsLogProbabilityStaysFiniteWhereTanhRoundsToOne) {
  Matrix<float> output(2, 2);
  output << 40.0f, -40.0f, -1.0f, 1.0f;
  SquashedDraw<float> draw;
  draw.resize(1, 2);
  draw_squashed(output, draw);
  EXPECT_FLOAT_EQ(draw.action(0, 0), 1.0f);
  for (Eigen::Index i = 0; i < 2; ++i) {
    // log N(0) - log std - 2 (log 2 - |u|)
    const double expected =
        -0.5 * std::log(2 * std::numbers::pi) - static_cast<double>(output(1, i)) - 2 * (std::numbers::ln2 - 40.0);
    EXPECT_NEAR(draw.log_probability[i], expected, 1e-4);
  }
}

TEST(SquashedGaussian, ItsGradientEqualsFiniteDifferences) {
  Matrix<double> output = 0.7 * random_matrix(6, 5, 1);
  const Matrix<double> by_action = random_matrix(3, 5, 2);
  constexpr double kWeight = 0.3;
  SquashedDraw<double> draw;
  draw.resize(3, 5);
  draw.noise = random_matrix(3, 5, 3);
  const auto value = [&] {
    draw_squashed(output, draw);
    return draw.action.cwiseProduct(by_action).sum() + kWeight * draw.log_probability.sum();
  };
  value();
  Matrix<double> gradient = Matrix<double>::Zero(6, 5);
  backward_squashed(output, draw, by_action, kWeight, gradient);
  for (Eigen::Index i = 0; i < output.size(); ++i) {
    EXPECT_NEAR(gradient(i), central_difference(output(i), value), 1e-7) << "output " << i;
  }
}

class Distribution : public testing::TestWithParam<PolicyKind> {};

TEST_P(Distribution, ItsGradientEqualsFiniteDifferences) {
  const bool categorical = GetParam() == PolicyKind::kCategorical;
  Matrix<double> output = random_matrix(3, 4, 1);
  Vector<double> log_std = random_matrix(categorical ? 0 : 3, 1, 2);
  Matrix<double> action = random_matrix(categorical ? 1 : 3, 4, 3);
  if (categorical) action << 0, 2, 1, 2;
  const ActionDistribution<double> policy{GetParam(), output, log_std};
  for (Eigen::Index i = 0; i < 4; ++i) {
    const double* a = action.col(i).data();
    const auto value = [&] { return 0.7 * policy.log_probability(i, a) + 0.2 * policy.entropy(i); };
    Matrix<double> by_output = Matrix<double>::Zero(3, 4);
    Vector<double> by_log_std = Vector<double>::Zero(log_std.size());
    policy.backward(i, a, 0.7, 0.2, by_output, by_log_std);
    for (Eigen::Index k = 0; k < 3; ++k) {
      EXPECT_NEAR(by_output(k, i), central_difference(output(k, i), value), 1e-7);
    }
    for (Eigen::Index k = 0; k < log_std.size(); ++k) {
      EXPECT_NEAR(by_log_std[k], central_difference(log_std[k], value), 1e-7);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, Distribution, testing::Values(PolicyKind::kGaussian, PolicyKind::kCategorical));

TEST(Distribution, ChoicesAddUpToOneAndEvenOddsHaveTheMostEntropy) {
  Matrix<double> output = random_matrix(4, 1, 5);
  const Vector<double> none;
  const ActionDistribution<double> policy{PolicyKind::kCategorical, output, none};
  double total = 0, entropy = 0;
  for (int k = 0; k < 4; ++k) {
    const double action = k, log_p = policy.log_probability(0, &action);
    total += std::exp(log_p);
    entropy -= std::exp(log_p) * log_p;
  }
  EXPECT_NEAR(total, 1.0, 1e-12);
  EXPECT_NEAR(policy.entropy(0), entropy, 1e-12);
  output.setConstant(3);
  EXPECT_NEAR(policy.entropy(0), std::log(4), 1e-12);
}

TEST(Actor, DrawsWhatItsDistributionSays) {
  TrainerConfig config;
  config.hidden_layers = {8};
  constexpr int kDraws = 20000;
  for (const PolicyKind kind : {PolicyKind::kCategorical, PolicyKind::kGaussian, PolicyKind::kSquashedGaussian}) {
    Actor actor(kind, 2, 3, config);
    actor.net().parameters().tail(3) << 0.5f, -0.2f, 0.1f;  // biases of the logits, the means or the log deviations
    MlpTape<float> tape = actor.make_tape(kDraws);
    Matrix<float> action = Matrix<float>::Zero(actor.action_dim(), kDraws);
    actor.draw(tape, Random(1, Purpose::kSampling, 0), action);
    const Matrix<double> output = tape.output().cast<double>();
    if (kind == PolicyKind::kCategorical) {
      const Vector<double> none;
      const ActionDistribution<double> policy{kind, output, none};
      for (int k = 0; k < 3; ++k) {
        const double choice = k, expected = std::exp(policy.log_probability(0, &choice));
        const double share = (action.array() == static_cast<float>(k)).cast<double>().mean();
        EXPECT_NEAR(share, expected, 4 * std::sqrt(expected / kDraws));
      }
      continue;
    }
    const bool squashed = kind == PolicyKind::kSquashedGaussian;
    for (int k = 0; k < 3; ++k) {
      Vector<double> u = action.row(k).cast<double>().transpose();
      if (squashed) u = u.array().min(1 - 1e-9).max(-1 + 1e-9).atanh();
      const double std = squashed ? std::exp(output(3 + k, 0)) : 1.0;
      EXPECT_NEAR(u.mean(), output(k, 0), 4 * std / std::sqrt(kDraws));
      EXPECT_NEAR(std::sqrt((u.array() - u.mean()).square().mean()), std, 0.03 * std);
    }
  }
}

TEST(Quantiles, MinimiseTheirLoss) {
  // Of targets 0, 1, ..., 99 in hundredths the quantiles (j + 1/2) / 4 are 0.12, 0.37, 0.62, 0.87: but for the Huber
  // loss's knee at 1, below which it is quadratic, so targets are spread out until the knee does not matter.
  Matrix<double> target(100, 1), quantile = Matrix<double>::Constant(4, 1, 2000.0), gradient(4, 1);
  for (int i = 0; i < 100; ++i) target(i, 0) = 100.0 * i;
  for (int step = 0; step < 40000; ++step) {
    quantile_loss(quantile, target, gradient);
    quantile -= 200 * gradient;
  }
  for (int j = 0; j < 4; ++j) EXPECT_NEAR(quantile(j, 0), 100 * (100 * (j + 0.5) / 4 - 0.5), 60) << j;
}

TEST(Quantiles, TheirLossHasItsGradient) {
  Matrix<double> quantile = 2 * random_matrix(5, 3, 1), gradient(5, 3), scratch(5, 3);
  const Matrix<double> target = 2 * random_matrix(7, 3, 2);
  quantile_loss(quantile, target, gradient);
  const auto value = [&] { return quantile_loss(quantile, target, scratch); };
  for (Eigen::Index i = 0; i < quantile.size(); ++i) {
    EXPECT_NEAR(gradient(i), central_difference(quantile(i), value), 1e-6);
  }
}

TEST(Quantiles, TheLargestAreLeftOut) {
  Matrix<float> atoms(5, 2), kept(3, 2);
  atoms << 3, -1, 1, -5, 4, -2, 2, -4, 5, -3;
  keep_lowest(atoms, kept);
  Matrix<float> expected(3, 2);
  expected << 1, -5, 2, -4, 3, -3;
  EXPECT_EQ(kept, expected);
}

}  // namespace
}  // namespace manyhands::learn
