// Other arms and obstacles in the tasks: what they do, and what is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "manyhands/envs/experts/expert.h"
#include "manyhands/envs/make.h"
#include "manyhands/model/io/urdf/urdf.h"

namespace manyhands {
namespace {

const std::vector<std::uint64_t> kSeed{4};

std::vector<std::uint64_t> seeds_below(std::uint64_t n) {
  std::vector<std::uint64_t> all(n);
  std::iota(all.begin(), all.end(), 0);
  return all;
}

Obstacle box(const Vec3<double>& half, const Vec3<double>& p) {
  Obstacle obstacle{.shape = {.type = ShapeType::kBox, .size = half}};
  obstacle.X_WO.p = p;
  return obstacle;
}

/// The message with which an environment of these options is refused.
std::string refusal(const EnvOptions& options, const char* id = "PandaPush-v3") {
  try {
    (void)make_env_batch(id, 1, options);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

/// The hand, told to go ahead for two seconds.
std::array<float, 3> hand_ahead(const EnvOptions& options) {
  const auto env = make_env_batch("PandaReach-v3", 1, options);
  env->reset({}, kSeed);
  for (int step = 0; step < 50; ++step) env->step(std::vector<float>{0.4f, 0, 0});
  return {env->observation()[0], env->observation()[1], env->observation()[2]};
}

TEST(Obstacles, StopTheHand) {
  EXPECT_GT(hand_ahead({})[0], 0.18f);
  const std::array<Obstacle, 3> walls{box({0.01, 0.2, 0.2}, {0.15, 0, 0.2}),
                                      Obstacle{.shape = {.type = ShapeType::kSphere, .size = {0.1, 0, 0}},
                                               .X_WO = {Mat3<double>::identity(), {0.24, 0, 0.22}}},
                                      Obstacle{.shape = {.type = ShapeType::kCylinder, .size = {0.1, 0.2, 0}},
                                               .X_WO = {Mat3<double>::identity(), {0.24, 0, 0.2}}}};
  for (const Obstacle& wall : walls) {
    const float x = hand_ahead({.obstacles = {wall}})[0];
    EXPECT_GT(x, 0.05f);
    EXPECT_LT(x, 0.14f);
  }
}

TEST(Obstacles, StopAnObject) {
  const auto end = [](const EnvOptions& options) {
    const auto env = make_env_batch("PandaSlide-v3", 1, options);
    const auto expert = make_expert("PandaSlide-v3");
    env->reset({}, kSeed);
    std::vector<float> action(3);
    for (int step = 0; step < 50; ++step) {
      expert->act(*env, action);
      env->step(action);
    }
    return env->observation()[6];
  };
  EXPECT_GT(end({}), 0.25f);
  EXPECT_LT(end({.obstacles = {box({0.01, 0.3, 0.02}, {0.2, 0, 0.02})}}), 0.17f);
}

TEST(Obstacles, GiveTheSameBitsInAnyLanes) {
  std::uint64_t expected = 0;
  for (const int lanes : {1, 4, 8, 16}) {
    const auto env = make_env_batch(
        "PandaPush-v3", 5, {.num_threads = 2, .lanes = lanes, .obstacles = {box({0.01, 0.2, 0.1}, {0.2, 0, 0.1})}});
    env->reset({}, std::vector<std::uint64_t>{1, 2, 3, 4, 5});
    for (int step = 0; step < 30; ++step) env->step(std::vector<float>(15, step % 7 < 4 ? 0.8f : -0.5f));
    if (lanes == 1) expected = env->state_hash();
    EXPECT_EQ(env->state_hash(), expected) << lanes;
  }
}

/// A wall through the middle of the table: cubes and goals whose centres would be nearer than half an edge are drawn
/// again; the others stay where the seed puts them without a wall.
TEST(Obstacles, AreClearOfObjectsAndGoals) {
  constexpr int n = 100;
  constexpr double kHalf = 0.02, kCube = 0.02;
  for (const char* id : {"PandaPush-v3", "PandaPickAndPlace-v3", "PandaStack-v3"}) {
    const auto plain = make_env_batch(id, n),
               walled = make_env_batch(id, n, {.obstacles = {box({kHalf, 0.3, 0.04}, {0, 0, 0.04})}});
    for (EnvBatch* env : {plain.get(), walled.get()}) env->reset({}, seeds_below(n));
    const EnvSpec& spec = plain->spec();
    const auto columns = static_cast<std::size_t>(spec.observation_dim),
               goals = static_cast<std::size_t>(spec.goal_dim);
    const std::size_t object = spec.action_dim == 4 ? 7 : 6;
    int stayed = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const auto is_clear = [&](const EnvBatch& env) {
        bool clear = true;
        for (std::size_t k = 0; k < goals; k += 3) {
          const float* p = &env.observation()[columns * i + object + 4 * k];
          const float* goal = &env.desired_goal()[goals * i + k];
          for (const float* place : {p, goal})
            clear = clear && (std::abs(place[0]) >= kHalf + kCube - 1e-6 || place[2] >= 0.08 + kCube - 1e-6);
        }
        return clear;
      };
      EXPECT_TRUE(is_clear(*walled)) << id << ", world " << i;
      if (!is_clear(*plain)) continue;
      ++stayed;
      for (std::size_t k = 0; k < columns; ++k)
        EXPECT_EQ(walled->observation()[columns * i + k], plain->observation()[columns * i + k]) << id;
    }
    EXPECT_GT(stayed, n / 10) << id;
    EXPECT_LT(stayed, n) << id;
  }
}

TEST(Obstacles, AreClearOfTheHandsGoals) {
  constexpr int n = 200;
  const Vec3<double> p{0.08, 0.1, 0.06};
  const Obstacle ball{.shape = {.type = ShapeType::kSphere, .size = {0.06, 0, 0}},
                      .X_WO = {Mat3<double>::identity(), p}};
  const auto nearest = [&](const EnvOptions& options) {
    const auto env = make_env_batch("PandaReach-v3", n, options);
    env->reset({}, seeds_below(n));
    double least = 1;
    for (std::size_t i = 0; i < 3 * n; i += 3) {
      const float* goal = &env->desired_goal()[i];
      least = std::min(least, std::hypot(double{goal[0]} - p.x, double{goal[1]} - p.y, double{goal[2]} - p.z));
    }
    return least;
  };
  EXPECT_LT(nearest({}), 0.06);
  EXPECT_GE(nearest({.obstacles = {ball}}), 0.06 - 1e-5);
}

TEST(Obstacles, AreRefusedWhereTheyLeaveNoRoom) {
  const Obstacle far = box({0.05, 0.05, 0.05}, {0.5, 0.3, 0.05});
  EXPECT_EQ(refusal({.obstacles = {far, box({0.2, 0.2, 0.01}, {0, 0, 0.01})}}),
            "obstacle 1 covers where 'object' starts: of 200 starts drawn, obstacles leave 0; move it away");
  EXPECT_EQ(refusal({.obstacles = {box({0.2, 0.2, 0.03}, {0.4, 0, 0.03})}}, "PandaSlide-v3"),
            "obstacle 0 covers where goals of 'object' are: of 200 starts drawn, obstacles leave 0; move it away");
  EXPECT_EQ(refusal({.obstacles = {box({0.2, 0.2, 0.01}, {0, 0, -0.01})}}), "") << "level with the table";
}

TEST(Obstacles, AreRefusedWithAReason) {
  const Obstacle far = box({0.05, 0.05, 0.05}, {0.5, 0.3, 0.05});
  EXPECT_EQ(refusal({.obstacles = {far}}), "");
  EXPECT_NE(refusal({.obstacles = {far, box({0.05, 0.05, 0.05}, {0.04, 0, 0.3})}}).find("obstacle 1 touches the arm's"),
            std::string::npos);
  EXPECT_NE(refusal({.obstacles = {box({0.05, 0, 0.05}, {0.5, 0.3, 0.05})}}).find("obstacle 0"), std::string::npos);
  EXPECT_NE(refusal({.obstacles = {box({0.05, 0.1, 0.05}, {0.5, std::nan(""), 0.05})}}).find("obstacle 0"),
            std::string::npos);
  Obstacle plane;
  plane.shape.type = ShapeType::kPlane;
  EXPECT_EQ(refusal({.obstacles = {plane}}), "obstacle 0 is no box, sphere, cylinder or capsule");
  Obstacle icy = far;
  icy.friction = -1;
  EXPECT_NE(refusal({.obstacles = {icy}}).find("obstacle 0"), std::string::npos);
}

TEST(Arms, AreRefusedWithAReason) {
  const auto refused = [](auto&& change, const char* id = "PandaPickAndPlace-v3") {
    ArmSpec arm = arm_spec("arm6");
    change(arm);
    return refusal({.arm = arm}, id);
  };
  EXPECT_NE(refused([](ArmSpec& arm) {
              arm.joints[2] = "elbow";
            }).find("no joint 'elbow'; those that move are: 'arm6_joint1'"),
            std::string::npos);
  EXPECT_EQ(refused([](ArmSpec& arm) { arm.joints[2] = arm.joints[0]; }),
            "joint 'arm6_joint1' is listed twice in the arm's joints");
  EXPECT_EQ(refused([](ArmSpec& arm) { arm.fingers[1] = arm.fingers[0]; }),
            "joint 'arm6_finger_joint1' is listed twice in the arm's joints");
  EXPECT_NE(refused([](ArmSpec& arm) { arm.hand = "palm"; }).find("'palm'"), std::string::npos);
  EXPECT_NE(refused([](ArmSpec& arm) {
              arm.neutral.pop_back();
            }).find("8 joints, fingers included, has 7 numbers in neutral"),
            std::string::npos);
  EXPECT_NE(refused([](ArmSpec& arm) { arm.max_force[3] = -1; }).find("max_force holds -1"), std::string::npos);
  EXPECT_NE(refused([](ArmSpec& arm) { arm.fingers[0] = "arm6_joint6"; }).find("fingers must slide"),
            std::string::npos);
  EXPECT_NE(refused([](ArmSpec& arm) { arm.opening = {1}; }).find("2 fingers needs as many finite numbers in opening"),
            std::string::npos);
  EXPECT_NE(refused([](ArmSpec& arm) { arm.opening = {1, 0}; }).find("opening holds 0"), std::string::npos);
  EXPECT_NE(refused([](ArmSpec& arm) {
              arm.closed = {0, std::nan("")};
            }).find("2 fingers needs as many finite numbers in closed"),
            std::string::npos);
  EXPECT_NE(refused([](ArmSpec& arm) {
              arm.model = std::make_shared<const Model>(load_urdf(arm.urdf, {.fixed_base = false}).model);
            }).find("must stand fixed"),
            std::string::npos);
  const auto fingerless = [](ArmSpec& arm) {
    arm.fingers.clear();
    arm.neutral.resize(6);
    arm.max_force.resize(6);
  };
  EXPECT_EQ(refused(fingerless), "the task needs a gripper, but the arm has no fingers");
  EXPECT_EQ(refused(fingerless, "PandaReach-v3"), "");
  EXPECT_THROW((void)arm_spec("arm7"), std::invalid_argument);
}

}  // namespace
}  // namespace manyhands
