#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <type_traits>

#include "manyhands/math/philox.h"

namespace manyhands {
namespace {

static_assert(std::is_trivially_copyable_v<RandomStream>);

// The known-answer vectors that the authors publish with Random123 (kat_vectors, philox4x32 10).
TEST(Philox, GivesThePublishedAnswers) {
  using Counter = std::array<std::uint32_t, 4>;
  constexpr std::uint32_t kOnes = 0xffffffffu;
  EXPECT_EQ(philox4x32({0, 0, 0, 0}, {0, 0}), (Counter{0x6627e8d5u, 0xe169c58du, 0xbc57ac4cu, 0x9b00dbd8u}));
  EXPECT_EQ(philox4x32({kOnes, kOnes, kOnes, kOnes}, {kOnes, kOnes}),
            (Counter{0x408f276du, 0x41c83b0eu, 0xa20bc7c6u, 0x6d5451fdu}));
  EXPECT_EQ(philox4x32({0x243f6a88u, 0x85a308d3u, 0x13198a2eu, 0x03707344u}, {0xa4093822u, 0x299f31d0u}),
            (Counter{0xd16cfe09u, 0x94fdccebu, 0x5001e420u, 0x24126ea1u}));
}

TEST(RandomStream, WalksTheCountersOfItsKey) {
  RandomStream stream(0x0123456789abcdefu, 7, 0x200000003u);
  for (std::uint32_t block = 0; block < 3; ++block) {
    for (const std::uint32_t word : philox4x32({block, 7, 3, 2}, {0x89abcdefu, 0x01234567u})) {
      EXPECT_EQ(stream.bits(), word);
    }
  }
}

TEST(RandomStream, DependsOnSeedWorldAndEpisode) {
  std::set<std::uint32_t> firsts;
  for (const std::uint64_t seed : {0ull, 1ull, 1ull << 32}) {
    for (const std::uint32_t world : {0u, 1u, 2u}) {
      for (const std::uint64_t episode : {0ull, 1ull, 1ull << 32}) {
        firsts.insert(RandomStream(seed, world, episode).bits());
      }
    }
  }
  EXPECT_EQ(firsts.size(), 27u);
}

template <class R>
class RandomDraws : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(RandomDraws, Reals);

TYPED_TEST(RandomDraws, UniformStaysInItsIntervalAndHasItsMoments) {
  using R = TypeParam;
  RandomStream stream(1, 2, 3);
  constexpr int kDraws = 200'000;
  double sum = 0, squares = 0;
  for (int i = 0; i < kDraws; ++i) {
    const R x = stream.template uniform<R>(R(-1), R(3));
    ASSERT_GE(x, R(-1));
    ASSERT_LT(x, R(3));
    sum += static_cast<double>(x);
    squares += static_cast<double>(x) * static_cast<double>(x);
  }
  const double mean = sum / kDraws;
  EXPECT_NEAR(mean, 1.0, 5 * std::sqrt(16.0 / 12 / kDraws));
  EXPECT_NEAR(squares / kDraws - mean * mean, 16.0 / 12, 0.02);
}

TYPED_TEST(RandomDraws, UniformNeverReachesItsUpperEnd) {
  using R = TypeParam;
  const R almost_one = std::nextafter(R(1), R(0));
  const R high = std::nextafter(R(1000), R(2000));  // an interval of one float: the sum would round up to its end
  EXPECT_EQ(uniform_from_unit(almost_one, R(1000), high), R(1000));
  EXPECT_EQ(uniform_from_unit(R(0.5), R(2), R(2)), R(2));
}

TYPED_TEST(RandomDraws, NormalHasItsMomentsAndTails) {
  using R = TypeParam;
  RandomStream stream(1, 2, 3);
  constexpr int kDraws = 200'000;
  double sum = 0, squares = 0, fourths = 0;
  int beyond_two = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = static_cast<double>(stream.template normal<R>());
    sum += x;
    squares += x * x;
    fourths += x * x * x * x;
    beyond_two += std::abs(x) > 2;
  }
  EXPECT_NEAR(sum / kDraws, 0, 5 / std::sqrt(kDraws));
  EXPECT_NEAR(squares / kDraws, 1, 5 * std::sqrt(2.0 / kDraws));
  EXPECT_NEAR(fourths / kDraws, 3, 5 * std::sqrt(96.0 / kDraws));
  EXPECT_NEAR(beyond_two / static_cast<double>(kDraws), std::erfc(std::sqrt(2.0)), 5 * std::sqrt(0.0455 / kDraws));
}

TYPED_TEST(RandomDraws, NormalIsFiniteAtTheEndsOfTheUnitInterval) {
  using R = TypeParam;
  const R almost_one = std::is_same_v<R, float> ? R(1) - R(0x1p-24) : R(1) - R(0x1p-53);
  EXPECT_EQ(normal_from_units(R(0), R(0.25)), R(0));
  EXPECT_TRUE(std::isfinite(normal_from_units(almost_one, R(0))));
  EXPECT_GT(normal_from_units(almost_one, R(0)), R(5));
}

template <class T>
class RandomLanes : public testing::Test {};
using LaneTypes = testing::Types<double, float, Lanes<float, 4>, Lanes<float, 8>, Lanes<float, 16>>;
TYPED_TEST_SUITE(RandomLanes, LaneTypes);

TYPED_TEST(RandomLanes, LaneDrawsWhatItsWorldDraws) {
  using T = TypeParam;
  using R = real_t<T>;
  RandomStreams<T> lanes(11, 100, 5);
  std::array<RandomStream, width_v<T>> worlds;
  for (int k = 0; k < width_v<T>; ++k) {
    worlds[static_cast<std::size_t>(k)] = RandomStream(11, 100 + static_cast<std::uint32_t>(k), 5);
  }
  const int restarted = width_v<T> - 1;
  for (int i = 0; i < 1000; ++i) {
    if (i == 500) {
      lanes[restarted] = worlds[static_cast<std::size_t>(restarted)] = RandomStream(11, 3, 6);
    }
    const T uniform = lanes.uniform(T(R(-2)), T(R(5))), normal = lanes.normal();
    for (int k = 0; k < width_v<T>; ++k) {
      RandomStream& world = worlds[static_cast<std::size_t>(k)];
      ASSERT_EQ(lane(uniform, k), world.template uniform<R>(R(-2), R(5)));
      ASSERT_EQ(lane(normal, k), world.template normal<R>());
    }
  }
}

}  // namespace
}  // namespace manyhands
