// Randomised episodes: what is drawn, that it acts as it says, and that nothing else changes.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <random>

#include "manyhands/envs/control/control.h"
#include "manyhands/envs/make.h"
#include "manyhands/envs/panda.h"
#include "manyhands/envs/randomize.h"
#include "manyhands/envs/tasks/push.h"
#include "tests/envs/rough_policy.h"

namespace manyhands {
namespace {

const std::vector<RandomRange> kEverything{
    {"object_mass", 0.5, 2, true}, {"object_size", 0.8, 1.2},     {"object_friction", 0.5, 1.5},
    {"table_friction", 0.5, 1.5},  {"finger_friction", 0.5, 1.5}, {"gravity", 0.9, 1.1},
    {"joint_damping", 0, 5},       {"motor_gain", 0.5, 2, true},  {"motor_force", 0.5, 1},
    {"action_latency", 0, 3},      {"action_noise", 0, 0.1},      {"observation_noise", 0, 0.01}};

std::vector<std::uint64_t> seeds(int n) {
  std::vector<std::uint64_t> all(static_cast<std::size_t>(n));
  std::iota(all.begin(), all.end(), 1000);
  return all;
}

std::vector<std::uint32_t> bits(const EnvBatch& env) {
  std::vector<std::uint32_t> all;
  for (const auto rows : {env.observation(), env.achieved_goal(), env.desired_goal(), env.reward(), env.randomized()})
    for (const float x : rows) all.push_back(std::bit_cast<std::uint32_t>(x));
  return all;
}

class RandomizedTasks : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, RandomizedTasks,
                         ::testing::Values("PandaReach-v3", "PandaSlide-v3", "PandaPush-v3", "PandaPickAndPlace-v3",
                                           "PandaStack-v3", "PandaFlip-v3"));

TEST_P(RandomizedTasks, AreTheSameForAnyLanesAndThreads) {
  constexpr int n = 19;
  std::vector<std::uint32_t> expected;
  std::uint64_t hash = 0;
  for (const auto& [lanes, threads] : {std::pair{1, 1}, {1, 2}, {4, 1}, {8, 3}, {16, 2}}) {
    const auto env = make_env_batch(GetParam(), n, {.num_threads = threads, .randomize = kEverything, .lanes = lanes});
    env->reset({}, seeds(n));
    for (int step = 1; step <= 40; ++step) {
      env->step(rough_actions(*env, step));
      if (step == 20) env->reset(std::vector<std::uint8_t>{1, 0, 1, 1, 0, 0, 1, 0, 1, 1, 1, 0, 1, 0, 1, 1, 0, 1, 1});
    }
    if (expected.empty()) {
      expected = bits(*env);
      hash = env->state_hash();
    }
    EXPECT_EQ(bits(*env), expected) << lanes << " lanes, " << threads << " threads";
    EXPECT_EQ(env->state_hash(), hash) << lanes << " lanes, " << threads << " threads";
  }
  const auto alone = make_env_batch(GetParam(), 1, {.randomize = kEverything});
  alone->reset({}, std::vector<std::uint64_t>{1004});
  const auto many = make_env_batch(GetParam(), n, {.num_threads = 1, .randomize = kEverything});
  many->reset({}, seeds(n));
  EXPECT_TRUE(
      std::ranges::equal(alone->randomized(), many->randomized().subspan(4 * kRandomizedCount, kRandomizedCount)));
}

TEST_P(RandomizedTasks, ContinueFromASnapshotBitForBit) {
  constexpr int n = 5;
  const auto env = make_env_batch(GetParam(), n, {.num_threads = 1, .randomize = kEverything});
  env->reset({}, seeds(n));
  for (int step = 1; step <= 23; ++step) env->step(rough_actions(*env, step));
  const std::vector<std::uint8_t> snapshot = env->snapshot();
  const std::uint64_t hash = env->state_hash();
  const std::vector<float> there(env->observation().begin(), env->observation().end());
  const auto go_on = [](EnvBatch& envs) {
    for (int step = 24; step <= 40; ++step) envs.step(rough_actions(envs, step));
    std::vector<std::uint32_t> all = bits(envs);
    envs.reset({});  // the streams go on too
    const std::vector<std::uint32_t> next = bits(envs);
    all.insert(all.end(), next.begin(), next.end());
    return all;
  };
  const std::vector<std::uint32_t> expected = go_on(*env);
  for (const int lanes : {0, 1}) {
    const auto other = make_env_batch(GetParam(), n, {.num_threads = 2, .randomize = kEverything, .lanes = lanes});
    other->restore(snapshot);
    EXPECT_EQ(other->state_hash(), hash);
    EXPECT_TRUE(std::ranges::equal(other->observation(), there)) << "the same noise";
    EXPECT_EQ(go_on(*other), expected) << lanes;
  }
}

/// Parameters of its own in every world, all of them the task's: the bits of one set for all.
TEST_P(RandomizedTasks, AtTheUsualValuesAreThePlainOnes) {
  constexpr int n = 9;
  const std::vector<RandomRange> usual{{"object_mass"}, {"object_size"},          {"gravity"},
                                       {"motor_gain"},  {"action_latency", 0, 0}, {"action_noise", 0, 0}};
  const auto plain = make_env_batch(GetParam(), n, {}), own = make_env_batch(GetParam(), n, {.randomize = usual});
  for (EnvBatch* env : {plain.get(), own.get()}) {
    env->reset({}, seeds(n));
    for (int step = 1; step <= 30; ++step) env->step(rough_actions(*env, step));
  }
  EXPECT_TRUE(std::ranges::equal(plain->observation(), own->observation()));
}

TEST_P(RandomizedTasks, BeginWhereThePlainOnesDo) {
  constexpr int n = 9;
  const std::vector<RandomRange> ranges{{"object_mass", 0.5, 2}, {"motor_force", 0.5, 1}, {"action_noise", 0, 1}};
  const auto plain = make_env_batch(GetParam(), n, {}), own = make_env_batch(GetParam(), n, {.randomize = ranges});
  for (int episode = 0; episode < 3; ++episode) {
    for (EnvBatch* env : {plain.get(), own.get()})
      env->reset({}, episode == 0 ? seeds(n) : std::vector<std::uint64_t>{});
    EXPECT_TRUE(std::ranges::equal(plain->observation(), own->observation()));
    EXPECT_TRUE(std::ranges::equal(plain->desired_goal(), own->desired_goal()));
  }
}

/// Statistics of 4000 draws: the mean's deviation is the range's / sqrt(12 n), five of which are allowed.
TEST(Randomizer, DrawsWhatItIsTold) {
  const Randomizer randomizer(
      std::vector<RandomRange>{{"gravity", 0.5, 1.5}, {"object_mass", 0.25, 4, true}, {"action_latency", 1, 3}});
  constexpr int n = 4000;
  std::array<double, 3> sum{};
  std::array<int, 4> latencies{};
  for (std::uint64_t i = 0; i < n; ++i) {
    const RandomValues values = randomizer.draw({.seed = i / 10, .episode = i % 10});
    std::array<float, 3> row{};
    randomizer.write(values, row);
    EXPECT_TRUE(row[0] >= 0.5f && row[0] <= 1.5f && row[1] >= 0.25f && row[1] <= 4.0f);
    ASSERT_TRUE(row[2] >= 1 && row[2] <= 3 && row[2] == std::floor(row[2]));
    sum[0] += double{row[0]};
    sum[1] += std::log(double{row[1]});
    ++latencies[static_cast<std::size_t>(row[2])];
    EXPECT_EQ(values[static_cast<std::size_t>(Randomized::kMotorForce)], 1.0f) << "not asked for";
  }
  EXPECT_NEAR(sum[0] / n, 1, 5 / std::sqrt(12.0 * n));
  EXPECT_NEAR(sum[1] / n, 0, 5 * 2 * std::log(4.0) / std::sqrt(12.0 * n));
  for (const int k : {1, 2, 3})
    EXPECT_NEAR(latencies[static_cast<std::size_t>(k)], n / 3.0, 5 * std::sqrt(n * 2 / 9.0));
}

TEST(Randomizer, AValueDoesNotDependOnTheOthers) {
  const RandomRange force{"motor_force", 0.5, 1};
  const Randomizer alone(std::span(&force, 1)), among(kEverything);
  const std::size_t kind = static_cast<std::size_t>(Randomized::kMotorForce);
  for (std::uint64_t i = 0; i < 10; ++i) EXPECT_EQ(alone.draw({i, 3})[kind], among.draw({i, 3})[kind]);
  EXPECT_NE(alone.draw({1, 3})[kind], alone.draw({1, 4})[kind]);
  EXPECT_NE(alone.draw({1, 3})[kind], alone.draw({2, 3})[kind]);
}

TEST(Randomizer, RefusesWhatMakesNoSense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const RandomRange& range :
       {RandomRange{"colour"}, RandomRange{"object_mass", 2, 1}, RandomRange{"object_mass", 0, 1},
        RandomRange{"gravity", nan, 1}, RandomRange{"gravity", 1, INFINITY}, RandomRange{"gravity", 0, 1, true},
        RandomRange{"action_latency", 0, 1.5}, RandomRange{"action_latency", 1, 2, true},
        RandomRange{"motor_gain", 1, 11}, RandomRange{"action_noise", -1, 1}}) {
    EXPECT_THROW(make_env_batch("PandaPush-v3", 1, {.randomize = {range}}), std::invalid_argument) << range.name;
  }
  EXPECT_THROW(Randomizer(std::vector<RandomRange>{{"gravity"}, {"gravity"}}), std::invalid_argument);
  try {
    const Randomizer never(std::vector<RandomRange>{{"colour"}});
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("object_mass"), std::string::npos) << error.what();
  }
}

/// An action that comes two steps late: what two zeros and then the same actions do.
TEST(Latency, DelaysActions) {
  const auto late = make_env_batch("PandaReach-v3", 3, {.randomize = {{"action_latency", 2, 2}}}),
             plain = make_env_batch("PandaReach-v3", 3, {});
  for (EnvBatch* env : {late.get(), plain.get()}) env->reset({}, seeds(3));
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::vector<std::vector<float>> sent(2, std::vector<float>(9, 0.0f));
  for (std::size_t step = 0; step < 20; ++step) {
    sent.emplace_back(9);
    for (float& a : sent.back()) a = uniform(random);
    late->step(sent.back());
    plain->step(sent[step]);
    ASSERT_TRUE(std::ranges::equal(late->observation(), plain->observation())) << step;
  }
}

TEST(Noise, HasTheDeviationThatIsAskedFor) {
  constexpr int n = 64;
  const std::vector<RandomRange> noise{{"observation_noise", 0.02, 0.02}};
  const auto noisy = make_env_batch("PandaPush-v3", n, {.randomize = noise}), plain = make_env_batch("PandaPush-v3", n);
  for (EnvBatch* env : {noisy.get(), plain.get()}) env->reset({}, seeds(n));
  const std::vector<float> rest(n * 3, 0.0f);
  double sum = 0, squares = 0, count = 0;
  for (int step = 0; step < 10; ++step) {
    for (std::size_t i = 0; i < plain->observation().size(); ++i) {
      const double difference = double{noisy->observation()[i]} - double{plain->observation()[i]};
      sum += difference;
      squares += difference * difference;
      ++count;
    }
    EXPECT_TRUE(std::ranges::equal(noisy->achieved_goal(), plain->achieved_goal()));
    for (EnvBatch* env : {noisy.get(), plain.get()}) env->step(rest);
  }
  EXPECT_EQ(noisy->state_hash() == plain->state_hash(), false) << "what was drawn belongs to the state";
  EXPECT_NEAR(sum / count, 0, 5 * 0.02 / std::sqrt(count));
  EXPECT_NEAR(std::sqrt(squares / count), 0.02, 5 * 0.02 / std::sqrt(2 * count));
}

/// Hands that are told to stay, with noise of 0.1 in each action: they move by 5 mm a step, each axis.
TEST(Noise, OfActionsMovesTheHand) {
  constexpr int n = 64;
  const auto env = make_env_batch("PandaReach-v3", n, {.randomize = {{"action_noise", 0.1, 0.1}}});
  env->reset({}, seeds(n));
  const std::vector<float> start(env->achieved_goal().begin(), env->achieved_goal().end());
  env->step(std::vector<float>(n * 3, 0.0f));
  double squares = 0;
  for (std::size_t i = 0; i < start.size(); ++i)
    squares += std::pow(double{env->achieved_goal()[i]} - double{start[i]}, 2);
  const double moved = std::sqrt(squares / (n * 3));
  EXPECT_GT(moved, 1e-3);
  EXPECT_LT(moved, 5e-3);
}

/// The puck of Slide falls 15 mm to the table: after a step of 40 ms it has fallen 1/2 g t^2, air aside.
TEST(Physics, GravityIsTheWorldsOwn) {
  for (const double factor : {0.25, 1.0, 1.5}) {
    const auto env = make_env_batch("PandaSlide-v3", 1, {.randomize = {{"gravity", factor, factor}}});
    env->reset({}, seeds(1));
    env->step(std::vector<float>(3, 0.0f));
    EXPECT_NEAR(env->observation()[8], 0.03 - 0.5 * 9.81 * factor * 0.04 * 0.04, 2e-5) << factor;
  }
}

TEST(Physics, ParametersAreThoseOfTheEpisode) {
  const std::array<ObjectSpec, 1> objects{cube("object")};
  const Model scene = task_scene(panda_arm(), Table{}, objects);
  const Arm arm(panda_arm(), scene, ArmControl::kEndEffector, true);
  ParamsStorage<float> base(scene), own(scene);
  set_arm_motors(arm, base);
  const RandomValues values{2, 0.5, 3, 4, 5, 1.5, 7, 2, 0.5, 0, 0, 0};
  write_params(values, SceneParts(scene, arm, objects), view(base, 0), view(own, 0));
  const std::size_t body = scene.link(scene.link_id("object")).body.index();
  EXPECT_FLOAT_EQ(own.inertia[body].m, 2);
  EXPECT_FLOAT_EQ(own.inertia[body].I.xx, 2 * 0.02f * 0.02f / 6) << "m (2 a)^2 / 6 for half an edge of a = 1 cm";
  EXPECT_FLOAT_EQ(own.gravity[0].z, -9.81f * 1.5f);
  int fingers = 0;
  for (std::size_t i = 0; i < scene.geoms().size(); ++i) {
    const Geom& geom = scene.geoms()[i];
    const bool finger = scene.link(geom.link).name.find("finger") != std::string::npos;
    fingers += finger;
    const float factor = geom.name == "object" ? 3 : geom.name == "table" ? 4 : finger ? 5 : 1;
    EXPECT_FLOAT_EQ(own.geom_friction[i], factor * base.geom_friction[i]) << geom.name;
    EXPECT_FLOAT_EQ(own.geom_size[i].x, (geom.name == "object" ? 0.5f : 1.0f) * base.geom_size[i].x) << geom.name;
  }
  EXPECT_GE(fingers, 2);
  for (std::size_t i = 0; i < 9; ++i) {
    EXPECT_FLOAT_EQ(own.damping[arm.dof(i)], 7);
    EXPECT_FLOAT_EQ(own.motor_kp[arm.dof(i)], 0.2f);
    EXPECT_FLOAT_EQ(own.motor_max_force[arm.dof(i)], 0.5f * base.motor_max_force[arm.dof(i)]);
  }
}

/// Objects of another size rest on the table, and goals at the height at which they can be.
TEST(Physics, ObjectsOfAnotherSizeRest) {
  for (const double size : {0.7, 1.4}) {
    const auto env = make_env_batch("PandaStack-v3", 8, {.randomize = {{"object_size", size, size}}});
    env->reset({}, seeds(8));
    for (int step = 0; step < 20; ++step) env->step(std::vector<float>(32, 0.0f));
    for (std::size_t i = 0; i < 8; ++i) {
      EXPECT_NEAR(env->observation()[31 * i + 9], 0.02 * size, 2e-4) << "the first cube";
      EXPECT_NEAR(env->desired_goal()[6 * i + 2], 0.02 * size, 1e-6);
      EXPECT_NEAR(env->desired_goal()[6 * i + 5], 0.06 * size, 1e-6);
    }
  }
}

class Shapes : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, Shapes, ::testing::Values("box", "cylinder", "sphere", "capsule"));

/// Each lies still as high as the task's own object, and moves when it is pushed.
TEST_P(Shapes, RestAndAreMoved) {
  for (const char* id : {"PandaPush-v3", "PandaSlide-v3", "PandaPickAndPlace-v3"}) {
    constexpr int n = 8;
    const auto env = make_env_batch(id, n, {.object_shape = GetParam()});
    const std::size_t object = env->spec().action_dim == 4 ? 7 : 6;
    const auto columns = static_cast<std::size_t>(env->spec().observation_dim);
    env->reset({}, seeds(n));
    const std::vector<float> start(env->observation().begin(), env->observation().end());
    const auto away = [&](std::size_t i) {
      const std::size_t at = columns * i + object;
      return std::hypot(env->observation()[at] - start[at], env->observation()[at + 1] - start[at + 1]);
    };
    for (int step = 0; step < 10; ++step)
      env->step(std::vector<float>(static_cast<std::size_t>(n * env->spec().action_dim), 0.0f));
    const double height = std::string(id) == "PandaSlide-v3" ? 0.015 : 0.02;
    int moved = 0;
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_NEAR(env->observation()[columns * i + object + 2], height, 2e-4) << id;
      EXPECT_LT(away(i), 1e-3) << id;
    }
    for (int step = 10; step < 40; ++step) env->step(rough_actions(*env, step));
    for (std::size_t i = 0; i < n; ++i) moved += away(i) > 0.01f;
    EXPECT_GE(moved, n / 2) << id;
  }
}

TEST(Shapes, AreRefusedWhereTheyMakeNoSense) {
  for (const auto& [id, shape] : {std::pair{"PandaPush-v3", "pyramid"},
                                  {"PandaReach-v3", "box"},
                                  {"PandaFlip-v3", "sphere"},
                                  {"PandaStack-v3", "sphere"}}) {
    EXPECT_THROW(make_env_batch(id, 1, {.object_shape = shape}), std::invalid_argument) << id;
  }
  EXPECT_NO_THROW(make_env_batch("PandaStack-v3", 1, {.object_shape = "cylinder"}));
}

/// The task's own shape under its name changes nothing.
TEST(Shapes, TheTasksOwnIsThePlainOne) {
  for (const auto& [id, shape] : {std::pair{"PandaPush-v3", "box"}, {"PandaSlide-v3", "cylinder"}}) {
    const auto plain = make_env_batch(id, 2, {}), same = make_env_batch(id, 2, {.object_shape = shape});
    for (EnvBatch* env : {plain.get(), same.get()}) {
      env->reset({}, seeds(2));
      for (int step = 1; step <= 10; ++step) env->step(rough_actions(*env, step));
    }
    EXPECT_EQ(plain->state_hash(), same->state_hash()) << id;
  }
}

}  // namespace
}  // namespace manyhands
