// The autoreset modes on worlds whose episodes are known beforehand. tests/python/envs/test_vector.py compares them
// with Gymnasium's own.
#include <gtest/gtest.h>

#include <stdexcept>

#include "manyhands/envs/autoreset.h"

namespace manyhands {
namespace {

using Floats = std::vector<float>;
using Bytes = std::vector<std::uint8_t>;

/// World i ends its episodes with success after i + 2 steps. It observes [steps, seed], and step t is rewarded with t.
class Clocks final : public EnvBatch {
 public:
  explicit Clocks(int worlds) : observation_(static_cast<std::size_t>(2 * worlds)) {
    spec_.observation_dim = 2;
    spec_.goal_dim = spec_.action_dim = 1;
    const auto n = static_cast<std::size_t>(worlds);
    goal_.resize(n);
    reward_.resize(n);
    done_.resize(n);
    never_.resize(n);
  }

  const EnvSpec& spec() const override { return spec_; }
  int num_envs() const override { return static_cast<int>(done_.size()); }
  void reset(std::span<const std::uint8_t> mask, std::span<const std::uint64_t> seeds) override {
    for (std::size_t i = 0; i < done_.size(); ++i) {
      if (!mask.empty() && mask[i] == 0) continue;
      observation_[2 * i] = 0;
      if (!seeds.empty()) observation_[2 * i + 1] = static_cast<float>(seeds[i]);
      done_[i] = 0;
    }
  }
  void step(std::span<const float> action) override {
    if (action.size() != done_.size()) throw std::invalid_argument("Clocks: wrong length");
    for (std::size_t i = 0; i < done_.size(); ++i) {
      reward_[i] = ++observation_[2 * i];
      done_[i] = reward_[i] >= static_cast<float>(i + 2);
    }
  }
  std::span<const float> observation() const override { return observation_; }
  std::span<const float> achieved_goal() const override { return goal_; }
  std::span<const float> desired_goal() const override { return goal_; }
  std::span<const float> reward() const override { return reward_; }
  std::span<const std::uint8_t> is_success() const override { return done_; }
  std::span<const std::uint8_t> terminated() const override { return done_; }
  std::span<const std::uint8_t> truncated() const override { return never_; }
  std::uint64_t state_hash() const override { return 0; }
  std::vector<std::uint8_t> snapshot() const override { throw std::logic_error("no test needs it"); }
  void restore(std::span<const std::uint8_t>) override { throw std::logic_error("no test needs it"); }
  void compute_reward(std::span<const float>, std::span<const float>, std::span<float>) const override {}

 private:
  EnvSpec spec_;
  Floats observation_, goal_, reward_;
  Bytes done_, never_;
};

/// What world 1 (three steps long) shows in each of seven steps.
struct Seen {
  Floats time, reward;
  Bytes terminated, truncated;
};

Seen seen_by_world_1(AutoresetMode mode, int limit) {
  Clocks clocks(3);
  AutoresetBatch batch(clocks, mode, limit);
  batch.reset({}, {}, {});
  Seen seen;
  for (int t = 0; t < 7; ++t) {
    batch.step(Floats(3));
    seen.time.push_back(clocks.observation()[2]);
    seen.reward.push_back(static_cast<float>(batch.reward()[1]));
    seen.terminated.push_back(batch.terminated()[1]);
    seen.truncated.push_back(batch.truncated()[1]);
  }
  return seen;
}

TEST(Autoreset, NextStepSpendsAStepOnTheReset) {
  const Seen seen = seen_by_world_1(AutoresetMode::kNextStep, 0);
  EXPECT_EQ(seen.time, (Floats{1, 2, 3, 0, 1, 2, 3}));
  EXPECT_EQ(seen.reward, (Floats{1, 2, 3, 0, 1, 2, 3}));
  EXPECT_EQ(seen.terminated, (Bytes{0, 0, 1, 0, 0, 0, 1}));
  EXPECT_EQ(seen.truncated, Bytes(7));
}

TEST(Autoreset, SameStepShowsTheNextEpisodeWithTheLastReward) {
  const Seen seen = seen_by_world_1(AutoresetMode::kSameStep, 0);
  EXPECT_EQ(seen.time, (Floats{1, 2, 0, 1, 2, 0, 1}));
  EXPECT_EQ(seen.reward, (Floats{1, 2, 3, 1, 2, 3, 1}));
  EXPECT_EQ(seen.terminated, (Bytes{0, 0, 1, 0, 0, 1, 0}));
}

TEST(Autoreset, TheLimitTruncatesAndCountsFromTheReset) {
  const Seen next = seen_by_world_1(AutoresetMode::kNextStep, 2);
  EXPECT_EQ(next.time, (Floats{1, 2, 0, 1, 2, 0, 1}));
  EXPECT_EQ(next.truncated, (Bytes{0, 1, 0, 0, 1, 0, 0}));
  EXPECT_EQ(next.terminated, Bytes(7));
  const Seen both = seen_by_world_1(AutoresetMode::kSameStep, 3);
  EXPECT_EQ(both.truncated, both.terminated) << "at the limit both may hold, as with Gymnasium's TimeLimit";
  EXPECT_EQ(both.truncated, (Bytes{0, 0, 1, 0, 0, 1, 0}));
}

TEST(Autoreset, SameStepKeepsTheFinalRowsOfThisStepOnly) {
  Clocks clocks(3);
  AutoresetBatch batch(clocks, AutoresetMode::kSameStep, 0);
  batch.reset({}, std::vector<std::uint64_t>{7, 8, 9}, Bytes{1, 1, 1});
  for (int t = 0; t < 2; ++t) batch.step(Floats(3));
  EXPECT_EQ(batch.final().world, (std::vector<int>{0}));
  EXPECT_EQ(batch.final().observation, (Floats{2, 7}));
  EXPECT_EQ(batch.final().is_success, (Bytes{1}));
  batch.step(Floats(3));
  EXPECT_EQ(batch.final().world, (std::vector<int>{1}));
  EXPECT_EQ(batch.final().observation, (Floats{3, 8}));
  batch.step(Floats(3));
  EXPECT_EQ(batch.final().world, (std::vector<int>{0, 2}));
  EXPECT_EQ(batch.final().observation, (Floats{2, 7, 4, 9}));
  batch.reset({}, {}, {});
  EXPECT_TRUE(batch.final().world.empty());
}

TEST(Autoreset, DisabledAsksForAResetBeforeItStepsAnything) {
  Clocks clocks(3);
  AutoresetBatch batch(clocks, AutoresetMode::kDisabled, 0);
  batch.reset({}, {}, {});
  for (int t = 0; t < 2; ++t) batch.step(Floats(3));
  EXPECT_THROW(batch.step(Floats(3)), std::logic_error);
  EXPECT_EQ(clocks.observation()[2], 2) << "nothing was stepped";
  batch.reset(Bytes{1, 0, 0}, {}, {});
  batch.step(Floats(3));
  EXPECT_EQ(clocks.observation()[0], 1);
  EXPECT_EQ(clocks.observation()[2], 3);
}

TEST(Autoreset, SeedsOnlyWhatIsSeededAndMasked) {
  Clocks clocks(3);
  AutoresetBatch batch(clocks, AutoresetMode::kNextStep, 0);
  batch.reset({}, std::vector<std::uint64_t>{1, 2, 3}, Bytes{1, 0, 1});
  EXPECT_EQ(Floats(clocks.observation().begin(), clocks.observation().end()), (Floats{0, 1, 0, 0, 0, 3}));
  batch.reset(Bytes{1, 1, 0}, std::vector<std::uint64_t>{4, 5, 6}, Bytes{0, 1, 1});
  EXPECT_EQ(Floats(clocks.observation().begin(), clocks.observation().end()), (Floats{0, 1, 0, 5, 0, 3}));
}

TEST(Autoreset, RefusesWrongLengths) {
  Clocks clocks(3);
  AutoresetBatch batch(clocks, AutoresetMode::kNextStep, 0);
  EXPECT_THROW(batch.reset(Bytes{1, 1}, {}, {}), std::invalid_argument);
  EXPECT_THROW(batch.reset({}, std::vector<std::uint64_t>{1}, Bytes{1}), std::invalid_argument);
  EXPECT_THROW(batch.reset({}, std::vector<std::uint64_t>{1, 2, 3}, Bytes{1}), std::invalid_argument);
  EXPECT_THROW(batch.step(Floats(2)), std::invalid_argument);
  EXPECT_THROW(AutoresetBatch(clocks, AutoresetMode::kNextStep, -1), std::invalid_argument);
}

}  // namespace
}  // namespace manyhands
