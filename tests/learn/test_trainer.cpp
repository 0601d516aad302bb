// Learning, determinism and the policy's arrays, on an environment that is solved in a second.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "manyhands/learn/trainer.h"
#include "tests/learn/point_reach.h"
#include "tests/learn/small_config.h"

namespace manyhands::learn {
namespace {

TrainerConfig trainer_config() { return small_config({32, 32}, 400, 20'000); }

/// The exported arrays applied as their documentation says, in double.
std::array<double, 3> apply(const Policy& policy, const std::vector<double>& observation,
                            const std::vector<double>& achieved, const std::vector<double>& desired) {
  std::vector<double> x = observation;
  x.insert(x.end(), desired.begin(), desired.end());
  for (std::size_t i = 0; i < desired.size(); ++i) x.push_back(desired[i] - achieved[i]);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto clip = static_cast<double>(policy.clip);
    x[i] = std::clamp((x[i] - static_cast<double>(policy.mean[i])) * static_cast<double>(policy.scale[i]), -clip, clip);
  }
  for (std::size_t l = 0; l < policy.layers.size(); ++l) {
    const Policy::Layer& layer = policy.layers[l];
    std::vector<double> y(layer.bias.begin(), layer.bias.end());
    for (std::size_t o = 0; o < y.size(); ++o) {
      for (std::size_t i = 0; i < x.size(); ++i) y[o] += static_cast<double>(layer.weight[o * x.size() + i]) * x[i];
      y[o] = l + 1 == policy.layers.size() ? std::tanh(y[o]) : std::max(y[o], 0.0);
    }
    x = y;
  }
  return {x[0], x[1], x[2]};
}

/// Learns and checks what came of it on 1000 episodes that training has not seen.
void expect_learns(const TrainerConfig& config) {
  PointReach envs(64), evaluation(250), fresh(1000);
  Trainer trainer(envs, &evaluation, config);
  EXPECT_LT(trainer.evaluate(fresh, 1000, 99).success_rate, 0.6) << "nothing is left to learn";
  const TrainMetrics metrics = trainer.advance(1000);
  EXPECT_TRUE(metrics.solved) << "seed " << config.seed;
  const EvalResult result = trainer.evaluate(fresh, 1000, 99);
  EXPECT_EQ(result.episodes, 1000);
  EXPECT_GE(result.success_rate, 0.99) << "seed " << config.seed;
  EXPECT_LT(result.mean_length, 4.0) << "seed " << config.seed;  // a straight line at full speed takes 2.5
  EXPECT_NEAR(result.mean_return, 1.0 - result.mean_length, 0.02) << "-1 for every step but the last";
  EXPECT_EQ(trainer.advance(10).iterations, metrics.iterations) << "a solved task is not trained further";
}

TEST(Trainer, LearnsToReachWithItsDefaults) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the next test learns with less arithmetic, which sanitizers make slow";
#endif
  expect_learns({.seed = 1});
}

TEST(Trainer, LearnsToReachWithSmallNetworks) {
  for (const std::uint64_t seed : {1u, 2u}) {
    TrainerConfig config = {.seed = seed, .hidden_layers = {32, 32}};
    config.batch_size = 64;
    expect_learns(config);
  }
}

TEST(Trainer, LearnsToReachWithTwinCriticsDelayAndSmoothing) {
  TrainerConfig config = {.seed = 3, .hidden_layers = {32, 32}, .num_critics = 2, .batch_size = 64};
  config.policy_delay = 2;
  config.target_noise = 0.2f;
  expect_learns(config);
}

TEST(Trainer, GivesTheSameBitsOnOneAndTwoThreads) {
  for (const int critics : {1, 2}) {
    std::vector<Policy> policies;
    std::vector<double> losses;
    for (const int threads : {1, 2, 2, 3}) {
      PointReach envs(16);
      TrainerConfig config = trainer_config();
      config.num_threads = threads;
      config.num_critics = critics;
      config.target_noise = 0.1f;
      Trainer trainer(envs, nullptr, config);
      losses.push_back(trainer.advance(150).critic_loss);
      policies.push_back(trainer.policy());
    }
    ASSERT_GT(losses[0], 0);
    for (std::size_t i = 1; i < policies.size(); ++i) {
      EXPECT_EQ(losses[i], losses[0]);
      for (std::size_t l = 0; l < policies[0].layers.size(); ++l) {
        EXPECT_EQ(policies[i].layers[l].weight, policies[0].layers[l].weight);
        EXPECT_EQ(policies[i].layers[l].bias, policies[0].layers[l].bias);
      }
      EXPECT_EQ(policies[i].mean, policies[0].mean);
    }
  }
}

TEST(Trainer, DependsOnTheSeed) {
  std::vector<Policy> policies;
  for (const std::uint64_t seed : {1u, 2u}) {
    PointReach envs(16);
    TrainerConfig config = trainer_config();
    config.seed = seed;
    Trainer trainer(envs, nullptr, config);
    trainer.advance(60);
    policies.push_back(trainer.policy());
  }
  EXPECT_NE(policies[0].layers[0].weight, policies[1].layers[0].weight);
  EXPECT_NE(policies[0].mean, policies[1].mean);
}

/// Passes everything on; tests override what they change.
class Wrapper : public EnvBatch {
 public:
  explicit Wrapper(PointReach& envs) : envs_(envs) {}

  const EnvSpec& spec() const override { return envs_.spec(); }
  int num_envs() const override { return envs_.num_envs(); }
  void reset(std::span<const std::uint8_t> mask, std::span<const std::uint64_t> seeds) override {
    envs_.reset(mask, seeds);
  }
  void step(std::span<const float> action) override { envs_.step(action); }
  std::span<const float> observation() const override { return envs_.observation(); }
  std::span<const float> achieved_goal() const override { return envs_.achieved_goal(); }
  std::span<const float> desired_goal() const override { return envs_.desired_goal(); }
  std::span<const float> reward() const override { return envs_.reward(); }
  std::span<const std::uint8_t> is_success() const override { return envs_.is_success(); }
  std::span<const std::uint8_t> terminated() const override { return envs_.terminated(); }
  std::span<const std::uint8_t> truncated() const override { return envs_.truncated(); }
  void compute_reward(std::span<const float> achieved, std::span<const float> desired,
                      std::span<float> reward) const override {
    envs_.compute_reward(achieved, desired, reward);
  }
  std::uint64_t state_hash() const override { return envs_.state_hash(); }
  std::vector<std::uint8_t> snapshot() const override { return envs_.snapshot(); }
  void restore(std::span<const std::uint8_t> bytes) override { envs_.restore(bytes); }

 protected:
  PointReach& envs_;
};

/// Every step earns -1 and ends the episode, by termination or by truncation.
class EndsAtOnce final : public Wrapper {
 public:
  EndsAtOnce(PointReach& envs, bool terminates)
      : Wrapper(envs),
        reward_(static_cast<std::size_t>(envs.num_envs()), -1.0f),
        terminated_(reward_.size(), terminates ? 1 : 0),
        truncated_(reward_.size(), terminates ? 0 : 1) {}
  std::span<const float> reward() const override { return reward_; }
  std::span<const std::uint8_t> terminated() const override { return terminated_; }
  std::span<const std::uint8_t> truncated() const override { return truncated_; }

 private:
  std::vector<float> reward_;
  std::vector<std::uint8_t> terminated_, truncated_;
};

TEST(Trainer, BootstrapsBeyondTheStepLimitButNotBeyondTheEnd) {
  for (const bool terminates : {true, false}) {
    PointReach point(16);
    EndsAtOnce envs(point, terminates);
    TrainerConfig config = trainer_config();
    config.gamma = 0.5;
    config.hindsight_fraction = 0;
    Trainer trainer(envs, nullptr, config);
    trainer.advance(400);
    EXPECT_NEAR(trainer.advance(100).q_mean, terminates ? -1.0 : -1.0 / (1.0 - 0.5),
                0.25);  // the policy's maximum and the bound lift it
  }
}

/// Remembers the first action of the policy under test and what it was based on.
class Probe final : public Wrapper {
 public:
  using Wrapper::Wrapper;
  std::vector<float> first_action, first_observation, first_achieved, first_desired;

  void step(std::span<const float> action) override {
    if (first_action.empty()) {
      const auto copied = [](std::span<const float> values) { return std::vector(values.begin(), values.end()); };
      first_action = copied(action);
      first_observation = copied(observation());
      first_achieved = copied(achieved_goal());
      first_desired = copied(desired_goal());
    }
    envs_.step(action);
  }
};

TEST(Trainer, ExportsThePolicyThatItRuns) {
  PointReach envs(16), fresh(40);
  Trainer trainer(envs, nullptr, trainer_config());
  trainer.advance(150);
  Probe probe(fresh);
  ASSERT_EQ(trainer.evaluate(probe, 40, 5).episodes, 40);
  const Policy policy = trainer.policy();
  const auto row = [](const std::vector<float>& rows, std::size_t w, std::size_t width) {
    return std::vector<double>(rows.begin() + static_cast<std::ptrdiff_t>(w * width),
                               rows.begin() + static_cast<std::ptrdiff_t>((w + 1) * width));
  };
  for (std::size_t w = 0; w < 40; ++w) {
    const auto expected = apply(policy, row(probe.first_observation, w, 6), row(probe.first_achieved, w, 3),
                                row(probe.first_desired, w, 3));
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(static_cast<double>(probe.first_action[3 * w + k]), expected[k], 1e-5);
    }
  }
}

TEST(Trainer, EvaluatesTheSameEpisodesWhateverTheBatch) {
  PointReach envs(16), one(1), seven(7), hundred(100);
  Trainer trainer(envs, nullptr, trainer_config());
  trainer.advance(100);
  const EvalResult a = trainer.evaluate(one, 50, 11), b = trainer.evaluate(seven, 50, 11),
                   c = trainer.evaluate(hundred, 50, 11), d = trainer.evaluate(hundred, 50, 1000);
  for (const EvalResult& other : {b, c}) {
    EXPECT_DOUBLE_EQ(a.success_rate, other.success_rate);
    EXPECT_DOUBLE_EQ(a.mean_length, other.mean_length);
    EXPECT_DOUBLE_EQ(a.mean_return, other.mean_return);
  }
  EXPECT_NE(a.mean_length, d.mean_length);
}

TEST(Trainer, EvaluationLeavesTrainingAlone) {
  std::vector<Policy> policies;
  for (const bool evaluate : {false, true}) {
    PointReach envs(16), evaluation(20);
    TrainerConfig config = trainer_config();
    config.stop_streak = 0;
    Trainer trainer(envs, evaluate ? &evaluation : nullptr, config);
    EXPECT_EQ(trainer.advance(100).evaluations > 0, evaluate);
    policies.push_back(trainer.policy());
  }
  EXPECT_EQ(policies[0].layers[1].weight, policies[1].layers[1].weight);
}

TEST(Trainer, NamesTheSettingThatMakesNoSense) {
  PointReach envs(4);
  const auto message_of = [&](auto change) -> std::string {
    TrainerConfig config;
    change(config);
    try {
      const Trainer trainer(envs, nullptr, config);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(message_of([](TrainerConfig& c) { c.gamma = 1.0; }), "TrainerConfig: gamma is 1, it must be in [0, 1)");
  EXPECT_NE(message_of([](TrainerConfig& c) { c.batch_size = 3; }).find("batch_size is 3"), std::string::npos);
  EXPECT_NE(message_of([](TrainerConfig& c) { c.hidden_layers = {}; }).find("hidden_layers"), std::string::npos);
  EXPECT_NE(message_of([](TrainerConfig& c) { c.num_critics = 17; }).find("num_critics"), std::string::npos);
  EXPECT_NE(message_of([](TrainerConfig& c) { c.exploration_noise = NAN; }).find("exploration_noise is nan"),
            std::string::npos);
  EXPECT_NE(message_of([](TrainerConfig& c) { c.replay_capacity = 10; }).find("warmup_transitions"), std::string::npos);
  EXPECT_EQ(message_of([](TrainerConfig&) {}), "no error");
  EXPECT_THROW(Trainer(envs, &envs, TrainerConfig()), std::invalid_argument);
}

}  // namespace
}  // namespace manyhands::learn
