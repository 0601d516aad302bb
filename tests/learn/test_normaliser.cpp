// Running statistics against the two-pass formulas.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "manyhands/learn/normaliser.h"
#include "manyhands/learn/random.h"

namespace manyhands::learn {
namespace {

TEST(InputNormaliser, ScalesByMeanAndDeviationOfWhatItWasGiven) {
  Random random(1, Purpose::kSampling, 0);
  InputNormaliser normaliser(2, 1, 1.5f);
  std::vector<std::array<double, 4>> samples;
  for (int i = 0; i < 500; ++i) {
    const std::array<float, 2> observation = {100.0f + 3.0f * random.normal(), 7.0f};  // the second never moves
    const float achieved = random.normal(), desired = 0.1f * random.normal();
    normaliser.add(observation.data(), &achieved, &desired);
    samples.push_back({static_cast<double>(observation[0]), 7.0, static_cast<double>(desired),
                       static_cast<double>(desired - achieved)});
  }
  normaliser.refresh();
  for (std::size_t k = 0; k < 4; ++k) {
    double mean = 0, variance = 0;
    for (const auto& sample : samples) mean += sample[k] / 500;
    for (const auto& sample : samples) variance += (sample[k] - mean) * (sample[k] - mean) / 500;
    const double deviation = std::max(std::sqrt(variance), 1e-2);
    const auto at = static_cast<Eigen::Index>(k);
    EXPECT_NEAR(static_cast<double>(normaliser.mean()[at]), mean, 1e-5 + 1e-6 * std::abs(mean)) << k;
    EXPECT_NEAR(static_cast<double>(normaliser.scale()[at]) * deviation, 1.0, 1e-5) << k;
  }
}

TEST(InputNormaliser, LaysOutObservationGoalAndTheWayToItAndClips) {
  const InputNormaliser fresh(2, 1, 1.5f);  // mean 0, scale 1
  const std::array<float, 2> observation = {0.5f, -9.0f};
  const float achieved = 1.0f, desired = 0.25f;
  std::array<float, 4> z{};
  fresh.write(observation.data(), &achieved, &desired, z.data());
  EXPECT_EQ(z, (std::array<float, 4>{0.5f, -1.5f, 0.25f, -0.75f}));
}

TEST(InputNormaliser, SeesDifferencesWithinTheObservationAsFineAsTwoCentimetres) {
  InputNormaliser normaliser(7, 1, 5.0f, {.differences = {4, 0, 0, 3}});
  ASSERT_EQ(normaliser.dim(), 7 + 2 + 6);
  const std::array<float, 7> observation = {0.1f, 0.2f, 0.3f, 0.4f, 0.11f, 0.18f, 0.9f};
  const float goal = 1, achieved = 0.5f;
  for (int i = 0; i < 10; ++i) normaliser.add(observation.data(), &achieved, &goal);
  normaliser.refresh();
  std::array<float, 15> z{};
  normaliser.write(observation.data(), &achieved, &goal, z.data());
  const std::array<float, 6> expected = {0.5f,  -1.0f, 5.0f,   // o[4..6] - o[0..2] = 0.01, -0.02, 0.6: clipped
                                         -5.0f, 4.5f,  5.0f};  // o[0..2] - o[3..5] = -0.3, 0.09, 0.12
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(z[9 + i], expected[i], 1e-5f) << i;
  EXPECT_EQ(z[0], 0.0f) << "the rest is measured";
}

TEST(InputNormaliser, MeasuresACubesRotation) {
  InputNormaliser normaliser(4, 4, 5.0f, {.cube_rotation = 0});
  ASSERT_EQ(normaliser.dim(), 4 + 8 + 24);
  const std::array<float, 4> none = {0, 0, 0, 1}, half = {0, 0, 1, 0};
  normaliser.add(none.data(), none.data(), none.data());
  normaliser.add(none.data(), none.data(), half.data());
  normaliser.refresh();
  std::array<float, 36> z{};
  normaliser.write(none.data(), none.data(), half.data(), z.data());
  EXPECT_NEAR(z[12], -1, 1e-6f) << "the first entry was 1 and -1";
  EXPECT_EQ(z[20], 0) << "the last was 1 in both";
}

TEST(InputNormaliser, RefusesRelationsOutsideOfTheObservation) {
  EXPECT_THROW(InputNormaliser(7, 1, 5.0f, {.differences = {5, 0}}), std::invalid_argument);
  EXPECT_NO_THROW(InputNormaliser(7, 1, 5.0f, {.differences = {4, 0}}));
  EXPECT_THROW(InputNormaliser(7, 1, 5.0f, {.cube_rotation = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace manyhands::learn
