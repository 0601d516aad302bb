// Another arm in the Panda's tasks: it holds its start, reaches, grasps and lifts.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "manyhands/envs/arm6.h"
#include "manyhands/envs/experts/expert.h"
#include "manyhands/envs/panda_tasks.h"

namespace manyhands {
namespace {

template <class Task, class T = float>
TaskBatch<T, Task> batch_of(int num_envs, ArmControl control = ArmControl::kEndEffector) {
  return {EnvSpec{.id = "arm6"}, arm6(), control, Reward::kSparse, num_envs, {}};
}

void reset(EnvBatch& envs) {
  std::vector<std::uint64_t> seeds(static_cast<std::size_t>(envs.num_envs()));
  std::iota(seeds.begin(), seeds.end(), std::uint64_t{500});
  envs.reset({}, seeds);
}

std::vector<float> no_action(const EnvBatch& envs) {
  return std::vector<float>(static_cast<std::size_t>(envs.num_envs() * envs.spec().action_dim), 0.0f);
}

/// The largest difference between the hands of all worlds and `expected`.
float farthest_hand(const EnvBatch& envs, const Vec3<float>& expected) {
  const auto width = static_cast<std::size_t>(envs.spec().observation_dim);
  float farthest = 0;
  for (std::size_t i = 0; i < envs.observation().size(); i += width) {
    const float* p = &envs.observation()[i];
    farthest = std::max(farthest, std::hypot(p[0] - expected.x, p[1] - expected.y, p[2] - expected.z));
  }
  return farthest;
}

/// For how many worlds an expert of the Panda reaches the goal.
int successes(EnvBatch& envs, const char* expert_id) {
  const auto expert = make_expert(expert_id);
  reset(envs);
  std::vector<std::uint8_t> success(static_cast<std::size_t>(envs.num_envs()), 0);
  std::vector<float> action = no_action(envs);
  for (int step = 0; step < envs.spec().max_episode_steps; ++step) {
    expert->act(envs, action);
    envs.step(action);
    for (std::size_t i = 0; i < success.size(); ++i) success[i] |= envs.is_success()[i];
  }
  return static_cast<int>(std::count(success.begin(), success.end(), 1));
}

TEST(Arm6, ActsWithItsOwnJoints) {
  EXPECT_EQ(batch_of<Reach>(1).spec().action_dim, 3);
  EXPECT_EQ(batch_of<PickAndPlace>(1).spec().action_dim, 4);
  EXPECT_EQ(batch_of<PickAndPlace>(1, ArmControl::kJoints).spec().action_dim, 7);
}

TEST(Arm6, StartsPointingDownAboveTheTable) {
  const ArmSpec spec = arm6();
  const Model model = load_arm(spec);
  const Arm arm(spec, model, ArmControl::kEndEffector, true);
  const System<double> system(model);
  StateStorage<double> state(model, system.contact_numbers());
  StepWorkspace<double> ws(system);
  reset_arm(arm, state, 0);
  const HandState<double> hand = observe_hand(arm, system.tree, state, ws.dynamics);
  EXPECT_NEAR(hand.p.x, 0.04, 1e-5);
  EXPECT_NEAR(hand.p.y, 0.0, 1e-5);
  EXPECT_NEAR(hand.p.z, 0.2, 1e-5);
  const Mat3<double> R_WH = ws.dynamics.R_WB[arm.chain.body.index()] * arm.chain.X_BF.R;
  const Vec3<double> out = R_WH * Vec3<double>{0, 0, 1}, ahead = R_WH * Vec3<double>{1, 0, 0};
  EXPECT_NEAR(out.z, -1, 1e-10);
  EXPECT_NEAR(ahead.x, 1, 1e-10);
}

TEST(Arm6, HoldsItsStart) {
  for (const ArmControl control : {ArmControl::kEndEffector, ArmControl::kJoints}) {
    auto envs = batch_of<Reach>(1, control);
    reset(envs);
    for (int step = 0; step < 50; ++step) envs.step(no_action(envs));
    EXPECT_LT(farthest_hand(envs, {0.04f, 0, 0.2f}), 1e-3f);
  }
}

TEST(Arm6, Reaches) {
  auto envs = batch_of<Reach>(100);
  EXPECT_GE(successes(envs, "PandaReach-v3"), 99);
}

/// Above the cube with open fingers, down about it, close, and up.
void fetch_and_lift(const float* row, int step, float* action) {
  const float height = step < 12 ? 0.12f : step < 30 ? row[9] : 0.3f;
  const std::array target{row[7], row[8], height};
  for (std::size_t k = 0; k < 3; ++k) action[k] = std::clamp(15 * (target[k] - row[k]), -0.6f, 0.6f);
  action[3] = step < 25 ? 1.0f : -1.0f;
}

TEST(Arm6, LiftsWhatItGrasps) {
  constexpr std::size_t n = 20;
  auto envs = batch_of<PickAndPlace>(n);
  reset(envs);
  const auto width = static_cast<std::size_t>(envs.spec().observation_dim);
  std::vector<float> action = no_action(envs), grip(n);  // grip: how far the cube is below the hand
  for (int step = 0; step < 60; ++step) {
    for (std::size_t i = 0; i < n; ++i) fetch_and_lift(&envs.observation()[i * width], step, &action[4 * i]);
    envs.step(action);
    for (std::size_t i = 0; i < n; ++i) {
      const float *row = &envs.observation()[i * width], below = row[2] - row[9];
      if (step == 30) grip[i] = below;
      if (step < 59) continue;
      EXPECT_GT(row[9], 0.25f) << i;
      EXPECT_NEAR(row[6], 0.04f, 1e-3f) << i;
      EXPECT_NEAR(below, grip[i], 1e-3f) << i;
    }
  }
}

struct Task {
  const char* id;
  int least;  ///< of 100 episodes that succeed
};

class Arm6Experts : public ::testing::TestWithParam<Task> {};
INSTANTIATE_TEST_SUITE_P(All, Arm6Experts,
                         ::testing::Values(Task{"PandaReach-v3", 99}, Task{"PandaPickAndPlace-v3", 99},
                                           Task{"PandaStack-v3", 95}, Task{"PandaSlide-v3", 75},
                                           Task{"PandaPush-v3", 65}, Task{"PandaFlip-v3", 65}),
                         [](const auto& test) {
                           const std::string id = test.param.id;
                           return id.substr(5, id.find('-') - 5);
                         });

/// The Panda's experts, as they are, in its place.
TEST_P(Arm6Experts, Succeed) {
  const auto envs = make_env_batch(GetParam().id, 500, {.arm = arm6()});
  const int of_500 = successes(*envs, GetParam().id);
  EXPECT_GE(of_500, 5 * GetParam().least);
}

}  // namespace
}  // namespace manyhands
