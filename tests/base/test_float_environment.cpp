// The caller's rounding and treatment of denormals: out of force meanwhile, in force afterwards.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cfenv>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <vector>

#include "manyhands/base/float_environment.h"
#include "manyhands/base/thread_pool.h"
#include "tests/base/float_modes.h"

namespace manyhands {
namespace {

using testing::FloatModes;

/// Bits that depend on how numbers are rounded, and on whether denormals are kept.
[[gnu::noinline]] std::array<std::uint64_t, 4> probe() {
  volatile double one = 1, three = 3, ten = 10, tiny = std::numeric_limits<double>::min(), half = 0.5;
  const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };  // compared, denormals might count as 0
  return {bits(one / three), bits(-one / three), bits(one / ten), bits(tiny * half)};
}

TEST(FloatEnvironment, RoundsToNearestAndKeepsDenormalsWhateverIsSet) {
  const std::array<std::uint64_t, 4> expected = probe();
  ASSERT_NE(expected[3], 0);
  for (const int rounding : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO, FE_TONEAREST}) {
    for (const bool flush : {false, true}) {
      const FloatModes modes(rounding, flush);
      const std::array<std::uint64_t, 4> callers = probe();
      EXPECT_EQ(callers == expected, rounding == FE_TONEAREST && (!flush || !FloatModes::kCanFlush));
      {
        const FloatEnvironment floats;
        EXPECT_EQ(probe(), expected);
        const FloatEnvironment nested;
        EXPECT_EQ(probe(), expected);
      }
      EXPECT_EQ(probe(), callers);
      EXPECT_EQ(std::fegetround(), rounding);
    }
  }
}

TEST(FloatEnvironment, HoldsInEveryThreadOfAPool) {
  const std::array<std::uint64_t, 4> expected = probe();
  const FloatModes modes(FE_UPWARD, true);
  const std::array<std::uint64_t, 4> callers = probe();
  ThreadPool pool(3);  // its threads begin with the caller's modes
  std::vector<std::array<std::uint64_t, 4>> found(200);
  pool.for_each(200, [&](int item, int) { found[static_cast<std::size_t>(item)] = probe(); });
  for (const auto& bits : found) EXPECT_EQ(bits, expected);
  EXPECT_EQ(probe(), callers);
  EXPECT_THROW(pool.for_each(3, [](int, int) { throw std::runtime_error("in a body"); }), std::runtime_error);
  EXPECT_EQ(probe(), callers) << "after an exception";
}

}  // namespace
}  // namespace manyhands
