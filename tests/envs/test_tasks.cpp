// The six tasks through the batch API: the same bits whatever the lanes and threads, panda-gym's goals and places,
// what is observed, and snapshots in the middle of things.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "manyhands/envs/make.h"
#include "manyhands/envs/panda.h"
#include "manyhands/envs/tasks/push.h"
#include "tests/envs/rough_policy.h"
#include "tests/physics/world/snapshot_testing.h"

namespace manyhands {
namespace {

std::vector<std::uint64_t> seeds(int n) {
  std::vector<std::uint64_t> all;
  for (int i = 0; i < n; ++i) all.push_back(1000 + 17 * static_cast<std::uint64_t>(i));
  return all;
}

std::vector<std::uint32_t> bits(const EnvBatch& env) {
  std::vector<std::uint32_t> all;
  for (const auto rows : {env.observation(), env.achieved_goal(), env.desired_goal(), env.reward()})
    for (const float x : rows) all.push_back(std::bit_cast<std::uint32_t>(x));
  for (const auto flags : {env.is_success(), env.terminated(), env.truncated()})
    for (const std::uint8_t flag : flags) all.push_back(flag);
  return all;
}

class Tasks : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, Tasks,
                         ::testing::Values("PandaReach-v3", "PandaSlide-v3", "PandaPush-v3", "PandaPickAndPlace-v3",
                                           "PandaStackJoints-v3", "PandaStackDense-v3", "PandaFlip-v3"));

TEST_P(Tasks, AreTheSameForAnyLanesAndThreads) {
  constexpr int n = 19, kSteps = 50;
  std::vector<std::uint32_t> expected;
  std::uint64_t hash = 0;
  for (const int lanes : {1, 4, 8, 16}) {
    for (const int threads : {1, 3}) {
      const auto env = make_env_batch(GetParam(), n, {.num_threads = threads, .lanes = lanes});
      env->reset({}, seeds(n));
      for (int step = 1; step <= kSteps; ++step) env->step(rough_actions(*env, step));
      if (expected.empty()) {
        expected = bits(*env);
        hash = env->state_hash();
      }
      EXPECT_EQ(bits(*env), expected) << lanes << " lanes, " << threads << " threads";
      EXPECT_EQ(env->state_hash(), hash) << lanes << " lanes, " << threads << " threads";
    }
  }
}

TEST_P(Tasks, ContinueFromASnapshotBitForBit) {
  constexpr int n = 5;
  const auto env = make_env_batch(GetParam(), n, {.num_threads = 1});
  env->reset({}, seeds(n));
  for (int step = 1; step <= 23; ++step) env->step(rough_actions(*env, step));
  const std::vector<std::uint8_t> snapshot = env->snapshot();
  const auto go_on = [](EnvBatch& envs) {
    for (int step = 24; step <= 40; ++step) envs.step(rough_actions(envs, step));
    envs.reset({});  // the random streams go on too
    return bits(envs);
  };
  const std::vector<std::uint32_t> expected = go_on(*env);
  env->restore(snapshot);
  EXPECT_EQ(go_on(*env), expected);
  const auto other = make_env_batch(GetParam(), n, {.num_threads = 2, .lanes = 1});
  other->restore(snapshot);
  EXPECT_EQ(go_on(*other), expected);
  EXPECT_THROW(env->restore(std::span(snapshot).first(snapshot.size() - 1)), std::invalid_argument);
}

/// A world that becomes unstable ends its episode where the step began; the others do not notice.
TEST_P(Tasks, EndWhereTheyStopBeingFinite) {
  constexpr int n = 9, kLost = 4;
  for (const int lanes : {1, 4, 16}) {
    const auto env = make_env_batch(GetParam(), n, {.num_threads = 1, .lanes = lanes});
    env->reset({}, seeds(n));
    const std::vector<std::uint8_t> sound = env->snapshot();
    std::vector<std::uint8_t> broken = sound;
    const std::size_t first = testing::payload_of(broken), v = static_cast<std::size_t>(env->scene().model.nq());
    testing::put(broken, first + kLost * (broken.size() - first) / n + v * sizeof(float), 1e38f);
    testing::repair(broken);
    const std::vector<float> before(env->achieved_goal().begin(), env->achieved_goal().end()),
        a = rough_actions(*env, 1);

    env->step(a);
    const auto goals = env->achieved_goal();
    std::vector<float> expected(goals.begin(), goals.end());
    const auto row = kLost * before.size() / n, columns = before.size() / n;
    std::copy_n(&before[row], columns, &expected[row]);

    env->restore(broken);
    env->step(a);
    for (int i = 0; i < n; ++i) {
      const auto world = static_cast<std::size_t>(i);
      EXPECT_EQ(env->unstable()[world], i == kLost) << lanes << " lanes, world " << i;
      EXPECT_EQ(env->truncated()[world], i == kLost) << lanes << " lanes, world " << i;
    }
    EXPECT_TRUE(std::ranges::equal(env->achieved_goal(), expected)) << lanes << " lanes";
    for (const auto rows : {env->observation(), env->reward()})
      for (const float x : rows) EXPECT_TRUE(std::isfinite(x)) << lanes << " lanes";

    env->step(a);
    EXPECT_EQ(std::ranges::count(env->unstable(), 1), 0) << "it goes on from there";
  }
}

TEST_P(Tasks, RepeatAnEpisodeBitForBit) {
  const auto env = make_env_batch(GetParam(), 3, {});
  std::vector<std::uint32_t> first;
  for (int run = 0; run < 2; ++run) {
    env->reset({}, seeds(3));
    for (int step = 1; step <= 40; ++step) env->step(rough_actions(*env, step));
    if (run == 0) first = bits(*env);
  }
  EXPECT_EQ(bits(*env), first);
}

TEST_P(Tasks, RewardAsComputeRewardDoes) {
  constexpr int n = 11;
  const auto env = make_env_batch(GetParam(), n, {});
  env->reset({}, seeds(n));
  std::vector<float> reward(n);
  for (int step = 1; step <= 20; ++step) {
    env->step(rough_actions(*env, step));
    env->compute_reward(env->achieved_goal(), env->desired_goal(), reward);
    for (std::size_t i = 0; i < reward.size(); ++i)
      EXPECT_EQ(std::bit_cast<std::uint32_t>(reward[i]), std::bit_cast<std::uint32_t>(env->reward()[i]));
  }
}

/// A world in which anything goes wrong shows it in the speed of its joints: random actions for 200 worlds.
TEST_P(Tasks, NeverThrowTheArmAbout) {
  constexpr int n = 200;
  const auto env = make_env_batch(GetParam(), n, {.num_threads = 2});
  env->reset({}, seeds(n));
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::vector<float> action(static_cast<std::size_t>(n * env->spec().action_dim));
  double fastest = 0;
  for (int step = 1; step <= 50; ++step) {
    for (float& a : action) a = uniform(random);
    env->step(action);
    for (std::size_t i = 0; i < n; ++i) {
      const float* row = &env->observation()[i * static_cast<std::size_t>(env->spec().observation_dim)];
      ASSERT_TRUE(std::isfinite(row[0]));
      fastest = std::max(fastest, double{std::hypot(row[3], row[4], row[5])});
    }
  }
  EXPECT_LT(fastest, 5) << "m/s, of the hand";
}

/// What panda-gym 3.0.8 draws for the seeds 0 and 42.
TEST(TaskStarts, AreWhatPandaGymDraws) {
  struct Case {
    const char* id;
    std::size_t object;
    std::array<std::vector<float>, 2> goal, place;
  };
  const std::array<Case, 5> cases{{
      {"PandaPush-v3",
       6,
       {{{.041089f, -.069064f, .02f}, {.082187f, -.018336f, .02f}}},
       {{{-.145042f, .093981f, .02f}, {.059210f, -.121747f, .02f}}}},
      {"PandaSlide-v3",
       6,
       {{{.441088f, -.069064f, .03f}, {.482187f, -.018336f, .03f}}},
       {{{-.145042f, .093981f, .03f}, {.059210f, -.121747f, .03f}}}},
      {"PandaPickAndPlace-v3",
       7,
       {{{.041089f, -.069064f, .02f}, {.082187f, -.018336f, .19172f}}},
       {{{.093981f, .123827f, .02f}, {-.121747f, .142687f, .02f}}}},
      {"PandaStack-v3",
       7,
       {{{.041089f, -.069064f, .02f, .041089f, -.069064f, .06f},
         {.082187f, -.018336f, .02f, .082187f, -.018336f, .06f}}},
       {{{-.145042f, .093981f, .02f}, {.059210f, -.121747f, .02f}}}},
      {"PandaFlip-v3",
       7,
       {{{.186517f, -.195973f, .950047f, .155616f}, {.188174f, -.642228f, .463431f, .580833f}}},
       {{{.093981f, .123827f, .02f}, {-.121747f, .142687f, .02f}}}},
  }};
  for (const Case& c : cases) {
    const auto env = make_env_batch(c.id, 2, {});
    env->reset({}, std::vector<std::uint64_t>{0, 42});
    const auto columns = static_cast<std::size_t>(env->spec().observation_dim);
    for (std::size_t i = 0; i < 2; ++i) {
      const std::size_t goals = c.goal[i].size();
      for (std::size_t k = 0; k < goals; ++k)
        EXPECT_NEAR(env->desired_goal()[goals * i + k], c.goal[i][k], 2e-6) << c.id;
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(env->observation()[columns * i + c.object + k], c.place[i][k], 2e-6) << c.id;
    }
  }
}

TEST(TaskSpecs, AreThoseOfPandaGym) {
  struct Case {
    const char* id;
    int observation, goal, action, steps;
  };
  for (const Case& c : {Case{"PandaReach-v3", 6, 3, 3, 50}, Case{"PandaPushJoints-v3", 18, 3, 7, 50},
                        Case{"PandaSlideDense-v3", 18, 3, 3, 50}, Case{"PandaPickAndPlace-v3", 19, 3, 4, 50},
                        Case{"PandaStackJointsDense-v3", 31, 6, 8, 100}, Case{"PandaFlip-v3", 20, 4, 4, 50}}) {
    const EnvSpec spec = make_env_batch(c.id, 1)->spec();
    EXPECT_EQ(spec.observation_dim, c.observation) << c.id;
    EXPECT_EQ(spec.goal_dim, c.goal) << c.id;
    EXPECT_EQ(spec.action_dim, c.action) << c.id;
    EXPECT_EQ(spec.max_episode_steps, c.steps) << c.id;
  }
  EXPECT_EQ(env_ids().size(), 24u);
}

/// What is observed of a turned body's motion is what its place and orientation do.
TEST(Objects, AreObservedInTheWorld) {
  const std::array<ObjectSpec, 1> objects{cube("object")};
  const Model scene = task_scene(panda_arm(), Table{}, objects);
  const Tree<double> tree(scene);
  StateStorage<double> state(scene, 0);
  const Body& body = scene.body(scene.link(scene.link_id("object")).body);
  double *q = state.q() + body.iq, *v = state.v() + body.iv;
  const Quat<double> r = quat_from_rotation_vector(Vec3<double>{0.4, -1.1, 2});
  std::ranges::copy(std::array{0.1, 0.2, 0.3, r.x, r.y, r.z, r.w}, q);
  std::ranges::copy(std::array{0.5, -0.6, 0.7, 0.1, 0.2, -0.3}, v);
  const ObjectState<double> before = observe_object(q, v);
  const double h = 1e-6;
  integrate_configuration(tree, state.v(), h, state.q(), state.q_rest());
  const ObjectState<double> after = observe_object(q, v);
  EXPECT_LT(norm((1 / h) * (after.p - before.p) - before.v), 1e-9);
  const Quat<double> turn = after.r * Quat<double>{-before.r.x, -before.r.y, -before.r.z, before.r.w};
  EXPECT_LT(norm((1 / h) * rotation_vector(turn) - before.w), 1e-6);
}

/// The gripper's widths that panda-gym measures: opened by three actions of +1, then closed by three of -1.
TEST(Gripper, OpensAndClosesAsPandaGyms) {
  const auto env = make_env_batch("PandaPickAndPlace-v3", 1);
  env->reset({}, std::vector<std::uint64_t>{0});
  const std::array<double, 6> widths{0.0703, 0.0788, 0.0799, 0.0097, 0.0012, 0.0001};
  for (std::size_t step = 0; step < 6; ++step) {
    env->step(std::vector<float>{0, 0, 0, step < 3 ? 1.0f : -1.0f});
    EXPECT_NEAR(env->observation()[6], widths[step], 2e-4) << "step " << step + 1;
  }
}

TEST(Push, AClosedHandMovesTheCube) {
  const auto env = make_env_batch("PandaPush-v3", 1);
  env->reset({}, std::vector<std::uint64_t>{0});
  const float start = env->observation()[6];
  for (int step = 0; step < 40; ++step) env->step(rough_actions(*env, step));
  EXPECT_GT(std::abs(env->observation()[6] - start), 0.02f);
  EXPECT_NEAR(env->observation()[8], 0.02, 2e-3);
}

TEST(Slide, ThePuckDropsAndRests) {
  const auto env = make_env_batch("PandaSlide-v3", 1);
  env->reset({}, std::vector<std::uint64_t>{7});
  for (int step = 0; step < 6; ++step) env->step(std::vector<float>{0, 0, 0.5f});
  EXPECT_NEAR(env->observation()[6], -0.08253, 2e-3);
  EXPECT_NEAR(env->observation()[7], -0.05974, 2e-3);
  EXPECT_NEAR(env->observation()[8], 0.01498, 1e-4);
}

}  // namespace
}  // namespace manyhands
