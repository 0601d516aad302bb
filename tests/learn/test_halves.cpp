// Each half runs once per round, whichever thread takes it.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <thread>

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
  for (int round = 0; round < 5; ++round) {
    std::array<bool, 2> ran{};
    halves.run([&](int half) {
      std::this_thread::sleep_for(std::chrono::milliseconds(half == 0 ? 1 : 5));
      ran[static_cast<std::size_t>(half)] = true;
    });
    EXPECT_TRUE(ran[0] && ran[1]);
    std::this_thread::sleep_for(std::chrono::milliseconds(3));  // the helper falls asleep
  }
}

TEST(Halves, UsesTheHelper) {
  Halves halves(2);
  std::array<std::thread::id, 2> ids;
  std::atomic<bool> helped = false;
  halves.run([&](int half) {
    ids[static_cast<std::size_t>(half)] = std::this_thread::get_id();
    if (half == 1) helped = true;
    // Long enough for the helper to wake up on a busy machine.
    for (int i = 0; half == 0 && !helped && i < 10000; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  });
  EXPECT_EQ(ids[0], std::this_thread::get_id());
  EXPECT_NE(ids[1], ids[0]);
}

TEST(Halves, LeavesAHelperAloneThatIsLateAgainAndAgain) {
  Halves halves(2);
  const std::thread::id caller = std::this_thread::get_id();
  int helped = 0;  // plain: rounds follow one another
  for (int round = 0; round < 400; ++round) {
    std::atomic<bool> taken = false;
    halves.run([&](int half) {
      if (half == 0) {
        for (int i = 0; !taken && i < 2; ++i) std::this_thread::sleep_for(std::chrono::microseconds(100));
      } else if (std::this_thread::get_id() != caller) {
        taken = true;
        ++helped;
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      }
    });
  }
  EXPECT_LE(helped, 8);
}

}  // namespace
}  // namespace manyhands::learn
