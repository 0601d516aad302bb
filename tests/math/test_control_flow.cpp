#include <type_traits>

#include "manyhands/math/control_flow.h"
#include "tests/math/conformance.h"

namespace manyhands::testing {
namespace {

// A branch on a varying condition must not compile.
template <class M>
concept Branches = requires(M m) { m ? 1 : 0; };
template <class M>
concept ShortCircuits = requires(M m) { m && m; } || requires(M m) { m || m; };

template <class T>
class LaneMasks : public ::testing::Test {};
TYPED_TEST_SUITE(LaneMasks, LaneTypes);

TYPED_TEST(LaneMasks, DoNotConvertToBool) {
  using M = mask_t<TypeParam>;
  static_assert(!std::is_same_v<M, bool>);
  static_assert(!std::is_convertible_v<M, bool> && !std::is_constructible_v<bool, M>);
  static_assert(!std::is_convertible_v<M, int> && !std::is_constructible_v<int, M>);
  static_assert(!Branches<M> && Branches<bool>);
  static_assert(!ShortCircuits<M> && ShortCircuits<bool>);
  static_assert(!std::is_convertible_v<TypeParam, float> && !std::is_convertible_v<TypeParam, bool>);
}

template <class T>
class ControlFlow : public ::testing::Test {};
TYPED_TEST_SUITE(ControlFlow, NumberTypes);

/// 0, 1, 2, ... by lane.
template <Number T>
T count() {
  T x;
  for (int k = 0; k < width_v<T>; ++k) set_lane(x, k, real_t<T>(k));
  return x;
}

TYPED_TEST(ControlFlow, WhenRunsOnceIfAnyLaneWantsIt) {
  using T = TypeParam;
  using R = real_t<T>;
  int calls = 0;
  when(mask_t<T>(false), [&] { ++calls; });
  EXPECT_EQ(calls, 0);
  when(count<T>() == T(R(width_v<T> - 1)), [&] { ++calls; });
  EXPECT_EQ(calls, 1);
  when(mask_t<T>(true), [&] { ++calls; });
  EXPECT_EQ(calls, 2);
}

// Lane k counts to its own limit and is frozen there, although the loop runs on for the others.
TYPED_TEST(ControlFlow, IterateFreezesFinishedLanes) {
  using T = TypeParam;
  using R = real_t<T>;
  const T limit = count<T>() + T(R(1));
  T steps(R(0));
  int calls = 0;
  iterate(mask_t<T>(true), 1000, [&](mask_t<T> active) {
    ++calls;
    steps = select(active, steps + T(R(1)), steps);
    return steps < limit;
  });
  EXPECT_EQ(calls, width_v<T>);
  for (int k = 0; k < width_v<T>; ++k) EXPECT_EQ(lane(steps, k), R(k + 1));
}

// A body that claims a finished lane again does not wake it.
TYPED_TEST(ControlFlow, IterateNeverWakesALane) {
  using T = TypeParam;
  using R = real_t<T>;
  T steps(R(0));
  iterate(count<T>() == T(R(0)), 5, [&](mask_t<T> active) {
    steps = select(active, steps + T(R(1)), steps);
    return mask_t<T>(true);
  });
  for (int k = 0; k < width_v<T>; ++k) EXPECT_EQ(lane(steps, k), k == 0 ? R(5) : R(0));
}

TYPED_TEST(ControlFlow, IterateDoesNothingWithoutActiveLanes) {
  iterate(mask_t<TypeParam>(false), 5, [](mask_t<TypeParam> active) {
    ADD_FAILURE() << "the body ran";
    return active;
  });
}

TYPED_TEST(ControlFlow, ForLanesVisitsTheLanesOfTheMaskInOrder) {
  using T = TypeParam;
  using R = real_t<T>;
  const T half = count<T>() * T(R(0.5));
  std::vector<int> visited, even;
  for_lanes<T>(half == floor(half), [&](int k) { visited.push_back(k); });
  for (int k = 0; k < width_v<T>; k += 2) even.push_back(k);
  EXPECT_EQ(visited, even);
}

}  // namespace
}  // namespace manyhands::testing
