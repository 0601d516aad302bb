#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <type_traits>

#include "manyhands/math/numpy_random.h"
#include "tests/math/numpy_golden.h"

namespace manyhands {
namespace {

static_assert(std::is_trivially_copyable_v<NumpyRandom>);

TEST(NumpyRandom, SeedsAsNumpyDoes) {
  for (const NumpyGolden& golden : kNumpyGolden) {
    const NumpyRandom random(golden.seed);
    EXPECT_EQ(random.state().state, golden.state) << "seed " << golden.seed;
    EXPECT_EQ(random.state().increment, golden.increment) << "seed " << golden.seed;
  }
}

TEST(NumpyRandom, DrawsNumpysBits) {
  for (const NumpyGolden& golden : kNumpyGolden) {
    SCOPED_TRACE(golden.seed);
    NumpyRandom random(golden.seed);
    EXPECT_EQ(random.random(), golden.random);
    EXPECT_EQ(random.uniform(-0.15, 0.15), golden.goal[0]);
    EXPECT_EQ(random.uniform(-0.15, 0.15), golden.goal[1]);
    EXPECT_EQ(random.uniform(0, 0.3), golden.goal[2]);
    for (const double normal : golden.normals) EXPECT_EQ(random.standard_normal(), normal);
    std::uint64_t bits = 0;
    double largest = 0;
    for (int i = 0; i < kManyNormals; ++i) {
      const double normal = random.standard_normal();
      bits ^= std::bit_cast<std::uint64_t>(normal);
      largest = std::max(largest, std::abs(normal));
    }
    EXPECT_EQ(bits, golden.bits_of_many);
    EXPECT_EQ(largest, golden.largest_of_many);
    EXPECT_EQ(random.state().state, golden.end);
  }
}

// The goal of panda-gym's Reach task after reset(seed=0).
TEST(NumpyRandom, GivesThePandaGymGoal) {
  NumpyRandom random(0);
  EXPECT_NEAR(random.uniform(-0.15, 0.15), 0.041089, 5e-7);
  EXPECT_NEAR(random.uniform(-0.15, 0.15), -0.069064, 5e-7);
  EXPECT_NEAR(random.uniform(0, 0.3), 0.012292, 5e-7);
}

TEST(NumpyRandom, ContinuesFromASavedState) {
  NumpyRandom random(5);
  (void)random.standard_normal();
  const NumpyRandom::State saved = random.state();
  const double expected = random.standard_normal();
  NumpyRandom restored(saved);
  EXPECT_EQ(restored.standard_normal(), expected);
}

}  // namespace
}  // namespace manyhands
