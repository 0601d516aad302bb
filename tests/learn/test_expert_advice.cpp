// An expert's advice: recorded as it was given, replayed beside its own state, cloned where it is worth something.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "manyhands/learn/agent.h"
#include "manyhands/learn/replay.h"
#include "manyhands/learn/trainer.h"
#include "tests/learn/point_expert.h"
#include "tests/learn/point_reach.h"
#include "tests/learn/small_config.h"

namespace manyhands::learn {
namespace {

TEST(Advice, IsReplayedBesideTheStateForWhichItWasGiven) {
  PointReach envs(8);
  PointExpert expert;
  Collector collector(envs, &expert, 3);
  ReplayBuffer replay(envs.spec(), 2000, 3);
  Random random(1, Purpose::kExploration, 0);
  std::vector<float> action(24);
  for (int t = 0; t < 120; ++t) {
    for (float& a : action) a = random.uniform(-1, 1);
    collector.step(action);
    for (const int world : collector.finished()) {
      const EpisodeView episode = collector.episode(world);
      ASSERT_EQ(episode.advice.size(), static_cast<std::size_t>(3 * episode.length));
      for (int i = 0; i < 3 * episode.length; ++i) {
        const auto at = static_cast<std::size_t>(i / 3 * 6 + i % 3);
        const float goal = episode.desired_goal[static_cast<std::size_t>(i % 3)];
        EXPECT_EQ(episode.advice[static_cast<std::size_t>(i)],
                  PointExpert::answer(episode.observation[at], goal, i / 3));
      }
      replay.add(episode);
    }
    collector.restart_finished();
  }
  ASSERT_GT(replay.size(), 300);

  Minibatch batch = replay.make_minibatch(500);
  replay.sample(envs, {.fraction = 0.4}, Random(2, Purpose::kSampling, 0), batch);
  EXPECT_EQ(batch.relabelled, 200);
  int fast = 0;
  for (int i = batch.relabelled; i < batch.size(); ++i) {
    std::array<bool, 2> fits = {true, true};
    for (int k = 0; k < 3; ++k) {
      for (const int asked : {0, 1}) {
        const float answer = PointExpert::answer(batch.observation(k, i), batch.desired_goal(k, i), asked);
        if (batch.advice(k, i) != answer) fits[static_cast<std::size_t>(asked)] = false;
      }
    }
    EXPECT_TRUE(fits[0] || fits[1]) << "column " << i;
    fast += fits[0];
  }
  EXPECT_GT(fast, 100);
  EXPECT_LT(fast, 300);
}

TEST(Advice, OfWrongLengthIsRefused) {
  PointReach envs(1);
  Collector collector(envs, nullptr, 3);
  ReplayBuffer replay(envs.spec(), 100, 3);
  collector.step(std::vector<float>(3, 0.0f));
  EXPECT_THROW(replay.add(collector.episode(0)), std::invalid_argument);
}

/// Trains on random states with rewards -|a - best|^2 at once, where an expert always advises `advised`; returns what
/// the policy does in the end, on average.
double cloned_action(bool filter, float weight, float best, float advised) {
  TrainerConfig config;
  config.hidden_layers = {32, 32};
  config.batch_size = 64;
  config.cloning_weight = weight;
  config.cloning_filter = filter;
  Agent agent(2, 1, config);
  Halves halves(1);
  for (int step = 0; step < 1500; ++step) {
    for (int i = 0; i < 2; ++i) {
      Random random(i == 0 ? 1 : 2, Purpose::kSampling, static_cast<std::uint64_t>(step));
      AgentBatch& batch = agent.half(i);
      for (Eigen::Index c = 0; c < batch.reward.size(); ++c) {
        for (int k = 0; k < 2; ++k) batch.state(k, c) = random.uniform(-1, 1);
        batch.action(0, c) = random.uniform(-1, 1);
        batch.reward[c] = -(batch.action(0, c) - best) * (batch.action(0, c) - best);
        batch.advice(0, c) = advised;
        batch.advised[c] = 1;
      }
      batch.next_state = batch.state;
      batch.discount.setZero();
    }
    agent.update(halves, {.low = -100, .high = 100});
  }
  MlpTape<float> tape = agent.actor().make_tape(64);
  Matrix<float> action = Matrix<float>::Zero(1, 64);
  agent.actor().act(tape, action);
  return static_cast<double>(action.mean());
}

TEST(Cloning, WeighsTheExpertAgainstTheCritic) {
  // The loss is (a - best)^2 + weight (a - advised)^2, least at (best + weight advised) / (1 + weight).
  EXPECT_NEAR(cloned_action(false, 1.0f, 0.5f, -0.5f), 0.0, 0.05);
  EXPECT_NEAR(cloned_action(false, 4.0f, 0.5f, -0.5f), -0.3, 0.05);
}

TEST(Cloning, FilteredFollowsABetterExpertAndLeavesAWorse) {
  // Within what the critic knows of the best action where the data are thin.
  EXPECT_NEAR(cloned_action(true, 4.0f, 0.5f, -0.5f), 0.5, 0.15);
  EXPECT_NEAR(cloned_action(true, 4.0f, 0.5f, 0.5f), 0.5, 0.15);
}

TrainerConfig guided_config() {
  TrainerConfig config = small_config({24, 16}, 100, 900);
  config.expert_rate = 0.25;
  config.cloning_weight = 2;
  config.differences = {0, 3};
  return config;
}

TEST(GuidedTrainer, NeedsAnExpert) {
  PointReach envs(4);
  EXPECT_THROW(Trainer(envs, nullptr, guided_config()), std::invalid_argument);
}

TEST(GuidedTrainer, IsLedByTheExpertBeforeItLearns) {
  TrainerConfig config = guided_config();
  config.exploration_noise = 0;
  config.warmup_transitions = 900;
  PointReach envs(64);
  PointExpert expert;
  Trainer trainer(envs, nullptr, config, &expert);
  EXPECT_EQ(trainer.advance(10).success_rate, 1.0);
}

TEST(GuidedTrainer, ContinuesToTheBitThoughTheExpertRemembers) {
  const auto path = std::filesystem::temp_directory_path() / ("manyhands_guided_" + std::to_string(::getpid()));
  PointReach envs(16), other(16);
  PointExpert expert, new_expert;
  Trainer whole(envs, nullptr, guided_config(), &expert);
  whole.advance(83);
  whole.save(path);
  whole.advance(59);

  TrainerConfig config = guided_config();
  config.num_threads = 1;
  Trainer resumed(other, nullptr, config, &new_expert);
  EXPECT_TRUE(resumed.load(path));
  resumed.advance(59);
  std::filesystem::remove(path);
  EXPECT_EQ(envs.state_hash(), other.state_hash());
  const Policy a = whole.policy(), b = resumed.policy();
  for (std::size_t l = 0; l < a.layers.size(); ++l) EXPECT_EQ(a.layers[l].weight, b.layers[l].weight);
}

}  // namespace
}  // namespace manyhands::learn
