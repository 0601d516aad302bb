// The caller's rounding and treatment of denormals: out of force meanwhile, in force afterwards.
#include <gtest/gtest.h>

#include <array>
#include <cfenv>
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
std::array<double, 3> probe() {
  volatile double one = 1, three = 3, tiny = std::numeric_limits<double>::min(), half = 0.5;
  return {one / three, -one / three, tiny * half};
}

TEST(FloatEnvironment, RoundsToNearestAndKeepsDenormalsWhateverIsSet) {
  const std::array<double, 3> expected = probe();
  ASSERT_GT(expected[2], 0);
  for (const int rounding : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO, FE_TONEAREST}) {
    for (const bool flush : {false, true}) {
      const FloatModes modes(rounding, flush);
      const std::array<double, 3> callers = probe();
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
  const std::array<double, 3> expected = probe();
  const FloatModes modes(FE_UPWARD, true);
  const std::array<double, 3> callers = probe();
  ThreadPool pool(3);  // its threads begin with the caller's modes
  std::vector<std::array<double, 3>> found(200);
  pool.for_each(200, [&](int item, int) { found[static_cast<std::size_t>(item)] = probe(); });
  for (const auto& bits : found) EXPECT_EQ(bits, expected);
  EXPECT_EQ(probe(), callers);
  EXPECT_THROW(pool.for_each(3, [](int, int) { throw std::runtime_error("in a body"); }), std::runtime_error);
  EXPECT_EQ(probe(), callers) << "after an exception";
}

}  // namespace
}  // namespace manyhands
