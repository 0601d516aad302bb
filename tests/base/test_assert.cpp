// With asserts on whatever the build type: the header is included as the dev build sees it.
#undef NDEBUG
#include <gtest/gtest.h>

#include "manyhands/base/assert.h"

namespace {

TEST(Assert, HoldsInSilence) {
  int evaluated = 0;
  MANYHANDS_ASSERT(++evaluated == 1);
  EXPECT_EQ(evaluated, 1);
}

TEST(AssertDeathTest, NamesFileLineAndCondition) {
  EXPECT_DEATH(MANYHANDS_ASSERT(1 + 1 == 3), "test_assert[.]cpp:[0-9]+: assertion failed: 1 \\+ 1 == 3");
}

}  // namespace
