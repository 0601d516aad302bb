// The actor-critic update on problems whose values and best actions are known.
#include <gtest/gtest.h>

#include <string>

#include "manyhands/learn/agent.h"
#include "manyhands/learn/random.h"

namespace manyhands::learn {
namespace {

constexpr ValueBounds kWide = {.low = -1e3f, .high = 1e3f};

TrainerConfig config() {
  TrainerConfig config;
  config.hidden_layers = {32, 32};
  config.batch_size = 64;
  return config;
}

void fill_uniform(Matrix<float>& to, Random& random) {
  for (Eigen::Index i = 0; i < to.size(); ++i) to(i) = random.uniform(-1.0f, 1.0f);
}

/// Trains on transitions with random states and actions, constant reward and discount, that lead back to their state.
/// Returns the mean value at the end.
double learned_value(const TrainerConfig& config, float reward, float discount, const ValueBounds& bounds) {
  Agent agent(3, 2, config);
  Halves halves(1);
  double q = 0;
  constexpr int kSteps = 1500, kAveraged = 100;
  for (int step = 0; step < kSteps; ++step) {
    for (int i = 0; i < 2; ++i) {
      Random random(i == 0 ? 1 : 2, Purpose::kSampling, static_cast<std::uint64_t>(step));
      AgentBatch& batch = agent.half(i);
      fill_uniform(batch.state, random);
      batch.next_state = batch.state;
      fill_uniform(batch.action, random);
      batch.reward.setConstant(reward);
      batch.discount.setConstant(discount);
    }
    const UpdateStats stats = agent.update(halves, bounds);
    if (step >= kSteps - kAveraged) q += static_cast<double>(stats.q) / kAveraged;
  }
  return q;
}

TEST(Agent, ValuesAnEndAtItsReward) { EXPECT_NEAR(learned_value(config(), -1, 0, kWide), -1.0, 0.02); }

TEST(Agent, ValuesAnEndlessLoopAtTheGeometricSum) {
  for (const int critics : {1, 2}) {
    TrainerConfig twin = config();
    twin.num_critics = critics;
    twin.target_noise = critics == 2 ? 0.2f : 0.0f;
    EXPECT_NEAR(learned_value(twin, -1, 0.8f, kWide), -1 / (1 - 0.8), 0.15);
    EXPECT_NEAR(learned_value(twin, 0.5, 0.8f, kWide), 0.5 / (1 - 0.8), 0.15);
  }
}

TEST(Agent, KeepsTargetsWithinTheBoundsOfAReturn) {
  EXPECT_NEAR(learned_value(config(), -1, 0.8f, {.low = -3, .high = 0}), -3.0, 0.1);
  EXPECT_NEAR(learned_value(config(), 1, 0.8f, {.low = -3, .high = 2}), 2.0, 0.1);
}

TrainerConfig soft(int quantiles) {
  TrainerConfig soft = config();
  soft.algorithm = Algorithm::kSac;
  soft.num_critics = 2;
  soft.num_quantiles = quantiles;
  soft.dropped_quantiles = quantiles > 1 ? 1 : 0;
  soft.temperature = 0.01f;
  soft.learned_temperature = false;
  return soft;
}

class BestAction : public testing::TestWithParam<TrainerConfig> {};

TEST_P(BestAction, IsFoundInEachState) {
  // One step, reward -|a - a*(s)|^2: the best policy is a* = (s0 / 2, -s1 / 2).
  Agent agent(2, 2, GetParam());
  Halves halves(1);
  UpdateStats stats;
  for (int step = 0; step < 2000; ++step) {
    for (int i = 0; i < 2; ++i) {
      Random random(i == 0 ? 1 : 2, Purpose::kSampling, static_cast<std::uint64_t>(step));
      AgentBatch& batch = agent.half(i);
      fill_uniform(batch.state, random);
      batch.next_state = batch.state;
      fill_uniform(batch.action, random);
      batch.discount.setZero();
      for (Eigen::Index c = 0; c < batch.reward.size(); ++c) {
        const float x = batch.action(0, c) - 0.5f * batch.state(0, c),
                    y = batch.action(1, c) + 0.5f * batch.state(1, c);
        batch.reward[c] = -(x * x + y * y);
      }
    }
    stats = agent.update(halves, kWide);
  }
  EXPECT_NEAR(stats.policy_q, 0.0, GetParam().algorithm == Algorithm::kTd3 ? 0.02 : 0.05) << "soft policies spread";
  MlpTape<float> tape = agent.actor().make_tape(256);
  Random random(3, Purpose::kSampling, 0);
  fill_uniform(tape.input(), random);
  Matrix<float> regret = Matrix<float>::Zero(2, 256);
  agent.actor().act(tape, regret);
  regret.row(0) -= 0.5f * tape.input().row(0);
  regret.row(1) += 0.5f * tape.input().row(1);
  EXPECT_LT(regret.colwise().squaredNorm().mean(), 0.02f) << "doing nothing costs 1/6";
}

std::string name_of(const testing::TestParamInfo<TrainerConfig>& info) {
  if (info.param.algorithm == Algorithm::kTd3) return "Td3";
  return info.param.num_quantiles > 1 ? "Tqc" : "Sac";
}

INSTANTIATE_TEST_SUITE_P(Algorithms, BestAction, testing::Values(config(), soft(1), soft(9)), name_of);

TEST(Agent, DaggerLearnsFromAdviceAloneAndNotFromReward) {
  // The expert answers (s0 / 2, -s1 / 2) in some of the states; elsewhere its answer is nonsense. The reward asks for
  // the opposite.
  TrainerConfig dagger = config();
  dagger.algorithm = Algorithm::kDagger;
  dagger.cloning_weight = 1;
  dagger.cloning_filter = false;
  dagger.learning_rate_half_life = 500;
  dagger.validate();
  Agent agent(2, 2, dagger);
  Halves halves(1);
  for (int step = 0; step < 2000; ++step) {
    for (int i = 0; i < 2; ++i) {
      Random random(i == 0 ? 1 : 2, Purpose::kSampling, static_cast<std::uint64_t>(step));
      AgentBatch& batch = agent.half(i);
      fill_uniform(batch.state, random);
      fill_uniform(batch.action, random);
      for (Eigen::Index c = 0; c < batch.advised.size(); ++c) {
        batch.advised[c] = c % 3 == 0 ? 0.0f : 1.0f;
        batch.advice.col(c) << 0.5f * batch.state(0, c), -0.5f * batch.state(1, c);
        if (c % 3 == 0) batch.advice.col(c).setConstant(1.0f);
        batch.reward[c] = -(batch.action.col(c) + batch.advice.col(c)).squaredNorm();
      }
    }
    EXPECT_EQ(agent.update(halves, kWide).critic_loss, 0.0f);
  }
  MlpTape<float> tape = agent.actor().make_tape(256);
  Random random(3, Purpose::kSampling, 0);
  fill_uniform(tape.input(), random);
  Matrix<float> error = Matrix<float>::Zero(2, 256);
  agent.actor().act(tape, error);
  error.row(0) -= 0.5f * tape.input().row(0);
  error.row(1) += 0.5f * tape.input().row(1);
  EXPECT_LT(error.colwise().squaredNorm().mean(), 1e-4f);
}

TEST(TrainerConfig, LearningRatesFallByHalf) {
  TrainerConfig falling = config();
  EXPECT_EQ(falling.rate_scale(1'000'000), 1.0f);
  falling.learning_rate_half_life = 100;
  EXPECT_EQ(falling.rate_scale(0), 1.0f);
  EXPECT_EQ(falling.rate_scale(100), 0.5f);
  EXPECT_EQ(falling.rate_scale(300), 0.125f);
  falling.learning_rate_half_life = -1;
  EXPECT_THROW(falling.validate(), std::invalid_argument);
}

TEST(Agent, TheTemperatureBringsTheEntropyToItsTarget) {
  // Nothing pays, so nothing but the temperature holds the policy: its entropy comes to what is asked.
  for (const float target : {-1.5f, -0.5f, 0.5f}) {
    TrainerConfig learned = soft(1);
    learned.learned_temperature = true;
    learned.target_entropy = target;
    learned.temperature = 0.1f;
    learned.gamma = 0.5;
    Agent agent(2, 2, learned);
    Halves halves(1);
    double entropy = 0;
    constexpr int kSteps = 6000, kAveraged = 500;
    for (int step = 0; step < kSteps; ++step) {
      for (int i = 0; i < 2; ++i) {
        Random random(i == 0 ? 1 : 2, Purpose::kSampling, static_cast<std::uint64_t>(step));
        AgentBatch& batch = agent.half(i);
        fill_uniform(batch.state, random);
        fill_uniform(batch.action, random);
        batch.discount.setZero();
        batch.reward = -0.5f * batch.action.colwise().squaredNorm().transpose();
      }
      const UpdateStats stats = agent.update(halves, kWide);
      if (step >= kSteps - kAveraged) entropy += static_cast<double>(stats.entropy) / kAveraged;
    }
    EXPECT_NEAR(entropy, target, 0.15);
    EXPECT_GT(agent.temperature(), 0);
  }
}

TEST(Agent, LearnsFromBothHalves) {
  // The halves hold different states where opposite actions pay, so each must be learned from its own half.
  Agent agent(2, 1, config());
  Halves halves(1);
  UpdateStats stats;
  for (int step = 0; step < 600; ++step) {
    for (int i = 0; i < 2; ++i) {
      Random random(i == 0 ? 1 : 2, Purpose::kSampling, static_cast<std::uint64_t>(step));
      AgentBatch& batch = agent.half(i);
      fill_uniform(batch.state, random);
      batch.state.row(0).setConstant(i == 0 ? -1.0f : 1.0f);
      fill_uniform(batch.action, random);
      batch.reward = (i == 0 ? -1.0f : 1.0f) * batch.action.row(0).transpose();
    }
    stats = agent.update(halves, kWide);
  }
  EXPECT_LT(stats.critic_loss, 0.01f);
  EXPECT_NEAR(stats.policy_q, 1.0f, 0.1f);
}

TEST(Agent, TwinCriticsArePessimistic) {
  // With nothing to earn, what the critics disagree on is error: the smaller value must not drift above the truth.
  TrainerConfig twin = config();
  twin.num_critics = 2;
  const double pessimistic = learned_value(twin, 0, 0.99f, kWide), plain = learned_value(config(), 0, 0.99f, kWide);
  EXPECT_LT(pessimistic, plain);
}

TEST(Agent, MovesThePolicyOnlyWhenItIsDue) {
  TrainerConfig delayed = config();
  delayed.policy_delay = 3;
  Agent agent(2, 1, delayed);
  Halves halves(1);
  for (int i = 0; i < 2; ++i) {
    Random random(5, Purpose::kSampling, static_cast<std::uint64_t>(i));
    fill_uniform(agent.half(i).state, random);
    fill_uniform(agent.half(i).action, random);
  }
  for (int step = 1; step <= 7; ++step) {
    const Vector<float> before = agent.actor().net().parameters();
    const bool updated = agent.update(halves, kWide).policy_updated;
    EXPECT_EQ(updated, step % 3 == 0);
    EXPECT_EQ(agent.actor().net().parameters() != before, updated);
  }
}

}  // namespace
}  // namespace manyhands::learn
