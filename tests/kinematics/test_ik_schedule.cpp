#include <gtest/gtest.h>

#include <array>

#include "manyhands/kinematics/ik_schedule.h"

namespace manyhands::internal {
namespace {

constexpr std::array<std::size_t, 2> kOpen{3, 7};

TEST(IkSchedule, BeginsEachTargetAndGoesOnWithThoseThatFail) {
  IkSchedule schedule(kOpen, 1, 2);
  const IkAttempt a = *schedule.next({}), b = *schedule.next({});
  EXPECT_EQ(a.target, 3u);
  EXPECT_EQ(b.target, 7u);
  EXPECT_EQ(a.round, 1);
  EXPECT_FALSE(schedule.next({}));  // nothing runs ahead of what has just begun
  schedule.end(a, false);
  const IkAttempt again = *schedule.next({});
  EXPECT_EQ(again.target, 3u);
  EXPECT_EQ(again.round, 2);
  schedule.end(again, false);
  EXPECT_FALSE(schedule.next({}));  // no further round
}

TEST(IkSchedule, RunsAheadAndTakesTheFirstRoundThatSucceeds) {
  constexpr std::array<std::size_t, 1> one{0};
  IkSchedule schedule(one, 0, 9);
  std::vector<IkAttempt> running{*schedule.next({})};
  for (int round = 1; round < 4; ++round) running.push_back(*schedule.next(running));
  EXPECT_EQ(running[3].round, 3);
  schedule.end(running[2], true);
  EXPECT_TRUE(schedule.is_late(running[3]));
  EXPECT_FALSE(schedule.is_late(running[1]));
  EXPECT_FALSE(schedule.next(running));  // settled, but for what runs
  schedule.end(running[1], true);
  schedule.end(running[0], false);
  EXPECT_EQ(schedule.winner(0), 1);
  EXPECT_FALSE(schedule.next({}));
}

}  // namespace
}  // namespace manyhands::internal
