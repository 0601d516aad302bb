// Each half runs once per round, whichever thread takes it.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <thread>

#include "manyhands/learn/contest.h"
#include "manyhands/learn/halves.h"

namespace manyhands::learn {
namespace {

TEST(Halves, RunsEachHalfOncePerRoundAndWaitsForBoth) {
  for (const int threads : {1, 2, 5}) {
    Halves halves(threads);
    std::array<long, 2> runs{};  // plain: a half that overlapped the next round would be a race
    for (long round = 1; round <= 20'000; ++round) {
      halves.run([&](int half) {
        for (volatile int i = 0; i < 1000;) i = i + 1;  // long enough for the helper to take part
        ++runs[static_cast<std::size_t>(half)];
      });
      ASSERT_EQ(runs[0], round);
      ASSERT_EQ(runs[1], round);
    }
  }
}

TEST(Halves, WaitsForASlowHelperAndAfterALongPause) {
  Halves halves(2);
  for (int round = 0; round < 60; ++round) {
    std::array<bool, 2> ran{};
    halves.run([&](int half) {  // a helper pays here, slow as it is
      std::this_thread::sleep_for(std::chrono::milliseconds(half == 0 ? 1 : 3));
      ran[static_cast<std::size_t>(half)] = true;
    });
    EXPECT_TRUE(ran[0] && ran[1]);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));  // the helper falls asleep
  }
}

TEST(Halves, UsesAHelperThatPays) {
  Halves halves(2);
  const std::thread::id caller = std::this_thread::get_id();
  int helped = 0;  // plain: rounds follow one another
  for (int round = 0; round < 60; ++round) {
    halves.run([&](int half) {
      if (half == 1 && std::this_thread::get_id() != caller) ++helped;
      // Sleeping halves pay on any machine, and sleep longer than a busy one keeps a thread waiting.
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    });
  }
  EXPECT_GE(helped, 30);
}

TEST(Halves, LeavesAHelperAloneThatIsLateAgainAndAgain) {
  Halves halves(2);
  const std::thread::id caller = std::this_thread::get_id();
  int helped = 0;
  for (int round = 0; round < 400; ++round) {
    std::atomic<bool> taken = false;
    halves.run([&](int half) {
      if (half == 0) {
        for (int i = 0; !taken && i < 2; ++i) std::this_thread::sleep_for(std::chrono::microseconds(100));
      } else if (std::this_thread::get_id() != caller) {
        taken = true;
        ++helped;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      }
    });
  }
  EXPECT_LE(helped, 8);
}

/// Rounds that take what `without` and `with` say, in ms; returns how many of the last `n` ran with the helper.
int count_helped(Contest& contest, int n, int without, int with) {
  int helped = 0;
  for (int round = 0; round < n; ++round) {
    helped += contest.with_helper();
    contest.record(std::chrono::milliseconds(contest.with_helper() ? with : without));
  }
  return helped;
}

TEST(Contest, GoesOnInTheQuickerWay) {
  Contest contest;
  EXPECT_GE(count_helped(contest, 10'000, 10, 6), 9'500);
  EXPECT_LE(count_helped(contest, 10'000, 10, 15), 3'200);  // the last trial's result holds for a while
  EXPECT_LE(count_helped(contest, 10'000, 10, 15), 200);
}

TEST(Contest, LeavesTheCoreToOthersWhereAHelperGainsNothing) {
  Contest contest;
  EXPECT_LE(count_helped(contest, 10'000, 10, 10), 500);
}

}  // namespace
}  // namespace manyhands::learn
