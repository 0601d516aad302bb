// What an environment has drawn for the episode is seen by critics, and by no policy.
#include <gtest/gtest.h>

#include <filesystem>
#include <vector>

#include "manyhands/envs/make.h"
#include "manyhands/learn/policy_runner.h"
#include "manyhands/learn/privileged_input.h"
#include "manyhands/learn/trainer.h"
#include "tests/learn/point_reach.h"
#include "tests/learn/small_config.h"

namespace manyhands::learn {
namespace {

/// A step ends the episode and earns what has been drawn for it, -1 or 1, of which nothing is observed.
class HiddenReward final : public EnvBatch {
 public:
  explicit HiddenReward(int worlds)
      : worlds_(static_cast<std::size_t>(worlds)),
        observation_(2 * worlds_, 0.5f),
        drawn_(2 * worlds_),
        reward_(worlds_),
        ended_(worlds_, 1),
        none_(worlds_, 0) {
    spec_ = {.id = "HiddenReward",
             .observation_dim = 2,
             .goal_dim = 0,
             .action_dim = 1,
             .max_episode_steps = 1,
             .randomized = {"what is earned", "always 7"}};
  }

  const EnvSpec& spec() const override { return spec_; }
  int num_envs() const override { return static_cast<int>(worlds_); }
  void reset(std::span<const std::uint8_t> mask, std::span<const std::uint64_t> seeds) override {
    for (std::size_t w = 0; w < worlds_; ++w) {
      if (!mask.empty() && mask[w] == 0) continue;
      drawn_[2 * w] = seeds[w] % 2 == 0 ? -1.0f : 1.0f;
      drawn_[2 * w + 1] = 7;
    }
  }
  void step(std::span<const float> /*action*/) override {
    for (std::size_t w = 0; w < worlds_; ++w) reward_[w] = drawn_[2 * w];
  }
  std::span<const float> observation() const override { return observation_; }
  std::span<const float> achieved_goal() const override { return {}; }
  std::span<const float> desired_goal() const override { return {}; }
  std::span<const float> reward() const override { return reward_; }
  std::span<const std::uint8_t> is_success() const override { return none_; }
  std::span<const std::uint8_t> terminated() const override { return ended_; }
  std::span<const std::uint8_t> truncated() const override { return none_; }
  std::span<const float> randomized() const override { return drawn_; }
  void compute_reward(std::span<const float>, std::span<const float>, std::span<float>) const override {}
  std::uint64_t state_hash() const override { return 1; }
  std::vector<std::uint8_t> snapshot() const override { throw std::logic_error("no test needs it"); }
  void restore(std::span<const std::uint8_t>) override { throw std::logic_error("no test needs it"); }

 private:
  EnvSpec spec_;
  std::size_t worlds_;
  std::vector<float> observation_, drawn_, reward_;
  std::vector<std::uint8_t> ended_, none_;
};

TrainerConfig hidden_config(Algorithm algorithm, bool privileged) {
  TrainerConfig config = small_config({24}, 200, 5000);
  config.algorithm = algorithm;
  config.privileged_critic = privileged;
  config.hindsight_fraction = 0;
  config.rollout_steps = 8;
  config.scale_rewards = false;
  return config;
}

TEST(PrivilegedInput, CriticsSeeWhatIsDrawnAndThePolicyDoesNot) {
  for (const Algorithm algorithm : {Algorithm::kTd3, Algorithm::kSac, Algorithm::kPpo}) {
    for (const bool privileged : {false, true}) {
      HiddenReward envs(32);
      TrainerConfig config = hidden_config(algorithm, privileged);
      if (algorithm == Algorithm::kSac) config.temperature = 1e-6f;
      Trainer trainer(envs, nullptr, config);
      trainer.advance(400);
      const double loss = trainer.advance(100).critic_loss;
      if (privileged) {
        EXPECT_LT(loss, 0.02) << "what is earned is among what the critic sees";
      } else {
        EXPECT_NEAR(loss, 1.0, 0.1) << "the variance of what is earned";
      }
      EXPECT_EQ(trainer.policy().layers.front().inputs, 2);
      EXPECT_NO_THROW(PolicyRunner(trainer.policy()));
    }
  }
}

TEST(PrivilegedInput, IsInUnitsOfItsDeviation) {
  HiddenReward envs(64);
  std::vector<std::uint64_t> seeds(64);
  for (std::size_t w = 0; w < seeds.size(); ++w) seeds[w] = w;
  envs.reset({}, seeds);
  PrivilegedInput input(envs.spec(), hidden_config(Algorithm::kTd3, true));
  ASSERT_EQ(input.dim(), 2);
  for (std::size_t w = 0; w < 64; ++w) input.add(envs.randomized().subspan(2 * w, 2));
  input.refresh();
  Matrix<float> state = Matrix<float>::Constant(5, 64, 3);
  input.write_below(envs, state);
  for (Eigen::Index w = 0; w < 64; ++w) {
    EXPECT_EQ(state(2, w), 3.0f) << "the rows above are the policy's";
    EXPECT_NEAR(state(3, w), w % 2 == 0 ? -1.0f : 1.0f, 1e-6f);
    EXPECT_EQ(state(4, w), 0.0f) << "what is always the same says nothing";
  }
}

TEST(PrivilegedInput, MillimetresOfNoiseAreTold) {
  EnvSpec spec = {.id = "Noisy", .randomized = {"observation_noise"}};
  PrivilegedInput input(spec, hidden_config(Algorithm::kTd3, true));
  for (int i = 0; i <= 100; ++i) {
    const float noise = 2e-5f * static_cast<float>(i);
    input.add({&noise, 1});
  }
  input.refresh();
  float least = 0, most = 2e-3f;
  input.write(&least, &least);
  input.write(&most, &most);
  EXPECT_NEAR(least, -std::sqrt(3.0), 0.03) << "the deviation of what is uniform over 2 is 1 / sqrt(3)";
  EXPECT_NEAR(most, std::sqrt(3.0), 0.03);
}

TEST(PrivilegedInput, NothingToSeeIsRefused) {
  PointReach envs(4);
  for (const Algorithm algorithm : {Algorithm::kTd3, Algorithm::kPpo}) {
    TrainerConfig config = small_config({8}, 400, 20'000);
    config.algorithm = algorithm;
    config.privileged_critic = true;
    config.rollout_steps = 32;
    EXPECT_THROW(Trainer(envs, nullptr, config), std::invalid_argument);
  }
}

TEST(Replay, KeepsWhatWasDrawnForAnEpisode) {
  const EnvSpec spec = {.id = "Test", .observation_dim = 1, .goal_dim = 0, .action_dim = 1, .max_episode_steps = 3};
  ReplayBuffer replay(spec, 30, 0, 2);
  for (int episode = 0; episode < 6; ++episode) {
    const auto value = static_cast<float>(episode);
    const std::vector<float> observation(4, value), action(3), reward(3), drawn = {value, -value};
    replay.add({.length = 3,
                .observation = observation,
                .achieved_goal = {},
                .desired_goal = {},
                .action = action,
                .reward = reward,
                .randomized = drawn});
  }
  const PointReach task(1);
  Minibatch batch = replay.make_minibatch(64);
  replay.sample(task, {.fraction = 0}, Random(1, Purpose::kSampling, 0), batch);
  for (Eigen::Index i = 0; i < 64; ++i) {
    EXPECT_EQ(batch.randomized(0, i), batch.observation(0, i));
    EXPECT_EQ(batch.randomized(1, i), -batch.observation(0, i));
  }
  const std::vector<float> four(4), three(3);
  EXPECT_THROW(replay.add({.length = 3,
                           .observation = four,
                           .achieved_goal = {},
                           .desired_goal = {},
                           .action = three,
                           .reward = three}),
               std::invalid_argument);
}

/// Reach with what differs from episode to episode.
std::unique_ptr<EnvBatch> randomised_reach(double most_damping = 2) {
  EnvOptions options;
  options.randomize = {{"joint_damping", 0, most_damping, false}, {"action_latency", 0, 2, false}};
  return make_env_batch("PandaReach-v3", 16, options);
}

TEST(PrivilegedInput, ResumesExactly) {
  const auto path = std::filesystem::path(testing::TempDir()) / "privileged.bin";
  for (const Algorithm algorithm : {Algorithm::kTd3, Algorithm::kPpo}) {
    TrainerConfig config = small_config({24}, 400, 20'000);
    config.algorithm = algorithm;
    config.privileged_critic = true;
    config.rollout_steps = 16;
    const auto first = randomised_reach(), second = randomised_reach();
    Trainer whole(*first, nullptr, config);
    whole.advance(83);
    whole.save(path);
    const TrainMetrics expected = whole.advance(70);
    Trainer resumed(*second, nullptr, config);
    ASSERT_TRUE(resumed.load(path)) << "the running episodes play again, with what was drawn for them";
    EXPECT_EQ(resumed.advance(70).critic_loss, expected.critic_loss);
    ASSERT_GT(expected.critic_loss, 0);
    for (std::size_t l = 0; l < whole.policy().layers.size(); ++l) {
      EXPECT_EQ(resumed.policy().layers[l].weight, whole.policy().layers[l].weight);
    }

    config.privileged_critic = false;
    Trainer plain(*second, nullptr, config);
    EXPECT_THROW(static_cast<void>(plain.load(path)), CheckpointError);
  }
}

}  // namespace
}  // namespace manyhands::learn
