// Lanes come in the order of their keys, none is lost, and few move.
#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "manyhands/envs/gather_lanes.h"

namespace manyhands {
namespace {

struct Worlds {
  explicit Worlds(std::vector<std::uint64_t> of_worlds) : keys(std::move(of_worlds)), worlds(keys.size()) {
    std::iota(worlds.begin(), worlds.end(), 0);
  }

  /// How many exchanges it took.
  int gather(LaneGatherer& gatherer) {
    int exchanges = 0;
    gatherer.gather([&](std::size_t lane) { return keys[worlds[lane]]; },
                    [&](std::size_t a, std::size_t b) {
                      std::swap(worlds[a], worlds[b]);
                      ++exchanges;
                    });
    return exchanges;
  }
  [[nodiscard]] bool is_ordered() const {
    for (std::size_t i = 1; i < worlds.size(); ++i) {
      if (keys[worlds[i]] > keys[worlds[i - 1]]) return false;
    }
    return true;
  }

  std::vector<std::uint64_t> keys;  ///< by world
  std::vector<std::size_t> worlds;  ///< by lane
};

TEST(GatherLanes, OrdersAnyKeysAndLosesNobody) {
  std::mt19937_64 random(1);
  for (const std::size_t n : {0u, 1u, 2u, 16u, 48u, 1024u}) {
    for (const std::uint64_t kinds : {1u, 2u, 5u, 40u}) {
      std::vector<std::uint64_t> keys(n);
      for (std::uint64_t& key : keys) key = (random() % kinds) << 60 | random() % 2;
      Worlds lanes(keys);
      LaneGatherer gatherer(n);
      EXPECT_LT(lanes.gather(gatherer), std::max<int>(1, static_cast<int>(n)));
      EXPECT_TRUE(lanes.is_ordered());
      std::vector<std::size_t> sorted = lanes.worlds;
      std::sort(sorted.begin(), sorted.end());
      for (std::size_t i = 0; i < n; ++i) EXPECT_EQ(sorted[i], i);
      EXPECT_EQ(lanes.gather(gatherer), 0);
    }
  }
}

TEST(GatherLanes, AWorldThatChangesMovesNoMoreThanOneOfEachKey) {
  std::vector<std::uint64_t> keys(160);
  for (std::size_t i = 0; i < keys.size(); ++i) keys[i] = i % 4;
  Worlds lanes(keys);
  LaneGatherer gatherer(keys.size());
  lanes.gather(gatherer);
  lanes.keys[100] = 3;  // from the last to the first
  ASSERT_EQ(keys[100], 0u);
  EXPECT_LE(lanes.gather(gatherer), 3);
  EXPECT_TRUE(lanes.is_ordered());
}

}  // namespace
}  // namespace manyhands
