// PPO: advantages against their definition, learning, and the same bits from a checkpoint on.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "manyhands/learn/ppo.h"
#include "manyhands/learn/trainer.h"
#include "tests/learn/point_expert.h"
#include "tests/learn/point_reach.h"

namespace manyhands::learn {
namespace {

TEST(Rollout, AdvantagesAreTheSumsOfTheirDefinition) {
  constexpr float kGamma = 0.9f, kLambda = 0.8f;
  constexpr int kSteps = 9, kWorlds = 2;
  Rollout rollout(kSteps, kWorlds, 1, 1, 0);
  Random random(1, Purpose::kSampling, 0);
  for (int i = 0; i < rollout.size(); ++i) {
    rollout.value[i] = random.normal();
    rollout.reward[i] = random.normal();
    rollout.last_value[i] = 100;  // not to be read where no episode ends
  }
  rollout.ended[2 * 3 + 0] = 1;  // world 0 is cut at step 3, world 1 terminates at step 5
  rollout.last_value[2 * 3 + 0] = 0.7f;
  rollout.ended[2 * 5 + 1] = 1;
  rollout.last_value[2 * 5 + 1] = 0;
  const Vector<float> now = Vector<float>::Constant(kWorlds, -0.4f);
  rollout.set_advantages(now, kGamma, kLambda);

  for (int w = 0; w < kWorlds; ++w) {
    for (int t = 0; t < kSteps; ++t) {
      // sum over l of (gamma lambda)^l delta_{t+l}, to the end of the episode
      double sum = 0, factor = 1;
      for (int s = t; s < kSteps; ++s) {
        const int i = s * kWorlds + w;
        const bool ends = rollout.ended[static_cast<std::size_t>(i)] != 0;
        const float next = ends ? rollout.last_value[i] : s + 1 == kSteps ? now[w] : rollout.value[i + kWorlds];
        sum += factor * static_cast<double>(rollout.reward[i] + kGamma * next - rollout.value[i]);
        factor *= static_cast<double>(kGamma * kLambda);
        if (ends) break;
      }
      EXPECT_NEAR(rollout.advantage[t * kWorlds + w], sum, 1e-5) << "step " << t << " of world " << w;
    }
  }
}

TEST(RewardScale, IsTheDeviationOfDiscountedReturns) {
  RewardScale scale(2, 0.5f, true);
  EXPECT_EQ(scale.scale(), 1.0f);
  const float first[] = {4, 0}, second[] = {2, 8};
  scale.add(first);   // returns 4, 0
  scale.add(second);  // returns 4, 8
  EXPECT_NEAR(scale.scale(), 1 / std::sqrt(8.0), 1e-6) << "4, 0, 4, 8: mean 4, variance 8";
  scale.end(1);
  const float third[] = {0, 4};
  scale.add(third);  // returns 2, 4
  EXPECT_NEAR(scale.scale(), 1 / std::sqrt(116.0 / 6 - 22.0 / 6 * 22 / 6), 1e-6) << "4, 0, 4, 8, 2, 4";
}

TrainerConfig ppo_config() {
  TrainerConfig config;
  config.algorithm = Algorithm::kPpo;
  config.activation = HiddenActivation::kTanh;
  config.hidden_layers = {32, 32};
  config.rollout_steps = 16;
  config.batch_size = 256;
  config.epochs = 8;
  config.actor_learning_rate = config.critic_learning_rate = 1e-3f;
  config.hindsight_fraction = 0;
  return config;
}

TEST(Ppo, LearnsToReach) {
  PointReach envs(64), fresh(500);
  Trainer trainer(envs, nullptr, ppo_config());
  EXPECT_LT(trainer.evaluate(fresh, 500, 9).success_rate, 0.6);
  const TrainMetrics metrics = trainer.advance(1600);
  EXPECT_EQ(metrics.env_steps, 1600 * 64);
  EXPECT_EQ(metrics.gradient_steps, 100 * 8 * 4);
  const EvalResult result = trainer.evaluate(fresh, 500, 9);
  EXPECT_GE(result.success_rate, 0.99);
  EXPECT_LT(result.mean_length, 6);
}

TEST(Ppo, TheSameBitsOnTwoThreadsAndFromACheckpointOn) {
  const auto path = std::filesystem::temp_directory_path() / "manyhands_test_ppo.ckpt";
  const auto weights = [](const Trainer& trainer) { return trainer.policy().layers.back().weight; };
  PointReach envs(32), again(32), later(32);
  TrainerConfig config = ppo_config();
  Trainer one(envs, nullptr, config);
  config.num_threads = 1;
  Trainer two(again, nullptr, config);
  one.advance(60);
  two.advance(60);
  EXPECT_EQ(weights(one), weights(two));
  one.save(path);  // in the middle of a rollout: 60 = 3 * 16 + 12
  one.advance(40);

  Trainer resumed(later, nullptr, config);
  EXPECT_TRUE(resumed.load(path));
  resumed.advance(40);
  EXPECT_EQ(weights(one), weights(resumed));
  EXPECT_EQ(one.metrics().episodes, resumed.metrics().episodes);
  std::filesystem::remove(path);
}

TEST(Ppo, IsDrawnToTheExpert) {
  TrainerConfig config = ppo_config();
  config.initial_std = 0.2f;
  const auto after = [&](float cloning_weight) {
    PointReach envs(64), fresh(500);
    PointExpert expert;
    config.cloning_weight = cloning_weight;
    Trainer trainer(envs, nullptr, config, &expert);
    trainer.advance(96);
    return trainer.evaluate(fresh, 500, 9).mean_length;
  };
  EXPECT_LT(after(20), 0.6 * after(0));
}

TEST(Ppo, WithAnExpertGoesOnFromACheckpoint) {
  const auto path = std::filesystem::temp_directory_path() / "manyhands_test_ppo_advice.ckpt";
  TrainerConfig config = ppo_config();
  config.cloning_weight = 20;
  config.cloning_half_life = 30;
  config.average_policy = true;
  PointReach envs(32), later(32);
  PointExpert expert, new_expert;
  Trainer one(envs, nullptr, config, &expert);
  one.advance(60);  // in the middle of a rollout
  one.save(path);
  one.advance(40);
  Trainer resumed(later, nullptr, config, &new_expert);
  EXPECT_TRUE(resumed.load(path));
  resumed.advance(40);
  EXPECT_EQ(one.policy().layers.back().weight, resumed.policy().layers.back().weight);
  std::filesystem::remove(path);
}

TEST(Ppo, AdviceCountsHalfAsMuchAfterEveryHalfLife) {
  TrainerConfig config;
  config.cloning_weight = 8;
  EXPECT_EQ(config.cloning_weight_at(1'000'000), 8);
  config.cloning_half_life = 100;
  EXPECT_FLOAT_EQ(config.cloning_weight_at(0), 8);
  EXPECT_FLOAT_EQ(config.cloning_weight_at(300), 1);
}

TEST(Ppo, ARolloutMustHoldAMiniBatch) {
  PointReach envs(8);
  TrainerConfig config = ppo_config();
  try {
    const Trainer trainer(envs, nullptr, config);
    FAIL() << "8 worlds make 128 transitions";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("batch_size is 256, but 8 worlds make 128"), std::string::npos);
  }
}

TEST(SoftActorCritic, LearnsToReachAndGoesOnFromACheckpoint) {
  const auto path = std::filesystem::temp_directory_path() / "manyhands_test_sac.ckpt";
  for (const int quantiles : {1, 7}) {
    TrainerConfig config;
    config.algorithm = Algorithm::kSac;
    config.hidden_layers = {32, 32};
    config.num_critics = 2;
    config.num_quantiles = quantiles;
    config.dropped_quantiles = quantiles > 1 ? 1 : 0;
    config.batch_size = 128;
    config.warmup_transitions = 400;
    config.exploration_noise = 0;
    config.random_action_rate = 0;
    config.temperature = 0.1f;
    PointReach envs(64), again(64), fresh(500);
    Trainer trainer(envs, nullptr, config);
    trainer.advance(100);
    trainer.save(path);
    trainer.advance(100);
    EXPECT_GE(trainer.evaluate(fresh, 500, 9).success_rate, 0.98) << quantiles;

    config.num_threads = 1;
    Trainer resumed(again, nullptr, config);
    EXPECT_TRUE(resumed.load(path));
    resumed.advance(100);
    EXPECT_EQ(trainer.policy().layers.back().weight, resumed.policy().layers.back().weight);
  }
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace manyhands::learn
