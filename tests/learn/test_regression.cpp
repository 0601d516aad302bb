// Regression finds the maps that made its pairs, whatever the threads.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "manyhands/learn/random.h"
#include "manyhands/learn/regression.h"

namespace manyhands::learn {
namespace {

constexpr int kInputs = 5, kOutputs = 3, kPairs = 2000;
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

struct Pairs {
  std::vector<float> inputs, targets;
};

/// y = W x + b, with W and b drawn at random.
struct LinearMap {
  Matrix<float> weight;
  Vector<float> bias;

  explicit LinearMap(std::uint64_t seed) : weight(kOutputs, kInputs), bias(kOutputs) {
    Random random(seed, Purpose::kSampling, 0);
    for (Eigen::Index i = 0; i < weight.size(); ++i) weight(i) = random.normal();
    for (Eigen::Index i = 0; i < bias.size(); ++i) bias(i) = random.normal();
  }

  [[nodiscard]] Pairs pairs(std::uint64_t seed) const {
    Pairs made;
    Random random(seed, Purpose::kSampling, 1);
    for (int i = 0; i < kPairs; ++i) {
      const Vector<float> x = Vector<float>::NullaryExpr(kInputs, [&] { return random.normal(); });
      const Vector<float> y = weight * x + bias;
      made.inputs.insert(made.inputs.end(), x.begin(), x.end());
      made.targets.insert(made.targets.end(), y.begin(), y.end());
    }
    return made;
  }
};

RegressionConfig linear_config() {
  return {.hidden_layers = {}, .batch_size = 64, .learning_rate = 1e-2f, .averaging_rate = 1e-2f, .bounded = false};
}

Regression make(const Pairs& pairs, const RegressionConfig& config) {
  return {pairs.inputs, kInputs, pairs.targets, kOutputs, config};
}

TEST(Regression, FindsALinearMap) {
  const LinearMap map(1);
  Regression regression = make(map.pairs(2), linear_config());
  const double before = regression.advance(1);
  EXPECT_GT(before, 1);
  EXPECT_LT(regression.advance(3000), before);
  // No noise, no hidden layer: the map itself is the only minimum.
  EXPECT_LT(regression.advance(100), 1e-9);
  EXPECT_LT((regression.network().weight(0) - map.weight).cwiseAbs().maxCoeff(), 1e-4f);
  EXPECT_LT((regression.network().bias(0) - map.bias).cwiseAbs().maxCoeff(), 1e-4f);
}

TEST(Regression, AsksNothingWhereATargetIsUnknown) {
  const LinearMap map(1);
  Pairs pairs = map.pairs(2);
  for (int i = 0; i < kPairs; ++i) {
    // The last output is known in every third pair only, and nowhere where it would not be the map's.
    if (i % 3 != 0) pairs.targets[static_cast<std::size_t>(i * kOutputs + kOutputs - 1)] = kUnknown;
  }
  Regression regression = make(pairs, linear_config());
  regression.advance(4000);
  EXPECT_LT((regression.network().weight(0) - map.weight).cwiseAbs().maxCoeff(), 1e-3f);
}

TEST(Regression, LearnsACurve) {
  Pairs pairs;
  Random random(7, Purpose::kSampling, 0);
  for (int i = 0; i < kPairs; ++i) {
    const float x = random.uniform(-1.0f, 1.0f);
    pairs.inputs.push_back(x);
    pairs.targets.push_back(0.9f * std::sin(std::numbers::pi_v<float> * x));
  }
  Regression regression(pairs.inputs, 1, pairs.targets, 1, {.hidden_layers = {32, 32}, .batch_size = 64});
  regression.advance(5000);
  EXPECT_LT(regression.advance(200), 1e-3);  // the curve's own variance is 0.4
}

TEST(Regression, ThreadsDoNotShowInTheBits) {
  const Pairs pairs = LinearMap(3).pairs(4);
  std::vector<Vector<float>> fitted;
  std::vector<double> losses;
  for (const int threads : {1, 2, 1}) {
    Regression regression = make(pairs, {.seed = 5, .num_threads = threads, .hidden_layers = {33, 20}});
    losses.push_back(regression.advance(400));
    fitted.push_back(regression.network().parameters());
  }
  EXPECT_EQ(losses[0], losses[1]);
  EXPECT_TRUE(fitted[0] == fitted[1]);
  EXPECT_TRUE(fitted[0] == fitted[2]);
  Regression other = make(pairs, {.seed = 6, .hidden_layers = {33, 20}});
  other.advance(400);
  EXPECT_FALSE(fitted[0] == other.network().parameters());
}

TEST(Regression, DoesNotDependOnHowItIsCutIntoPieces) {
  const Pairs pairs = LinearMap(3).pairs(4);
  Regression whole = make(pairs, {.hidden_layers = {16}}), pieces = make(pairs, {.hidden_layers = {16}});
  whole.advance(60);
  for (const int steps : {1, 29, 0, 30}) pieces.advance(steps);
  EXPECT_TRUE(whole.network().parameters() == pieces.network().parameters());
}

TEST(Regression, RefusesWhatMakesNoSense) {
  const Pairs good = LinearMap(3).pairs(4);
  const auto refused = [](Pairs pairs, const RegressionConfig& config) {
    EXPECT_THROW(make(pairs, config), std::invalid_argument);
  };
  refused(good, {.num_threads = 0});
  refused(good, {.hidden_layers = {0}});
  refused(good, {.batch_size = 3});
  refused(good, {.learning_rate = 0});
  refused(good, {.averaging_rate = 0});
  refused({}, {});
  Pairs shorter = good;
  shorter.targets.pop_back();
  refused(shorter, {});
  Pairs bad = good;
  bad.inputs[3] = kUnknown;
  refused(bad, {});
  bad = good;
  bad.targets[3] = std::numeric_limits<float>::infinity();
  refused(bad, {});
}

TEST(Regression, SaysThatItDiverged) {
  RegressionConfig config = linear_config();
  config.learning_rate = 1e30f;
  Regression regression = make(LinearMap(3).pairs(4), config);
  EXPECT_THROW(regression.advance(100), std::runtime_error);
}

}  // namespace
}  // namespace manyhands::learn
