// The bits of twenty scenes after 500 steps, and of the six tasks, as they were when they were last looked at: a change
// that is not meant to change results must not change these. Lanes of every width give the bits of scalar float.
//
// Where a change is meant, run with MANYHANDS_PRINT_GOLDEN=1 and put what is printed in place of the table; the commit
// says why.
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <iomanip>
#include <iostream>
#include <random>

#include "manyhands/base/hash.h"
#include "manyhands/envs/make.h"
#include "manyhands/physics/world/batch.h"
#include "tests/envs/rough_policy.h"
#include "tests/physics/golden/golden_scenes.h"

namespace manyhands {
namespace {

constexpr int kSteps = 500, kWorlds = 16;

struct Golden {
  const char* name;
  std::uint64_t real, single;  ///< World in double; Batch in float
};

constexpr std::array<Golden, 20> kScenes{{
    {"boxes", 0x1c017a99e492c9b5, 0x2a1bc1c1eb70cb68},
    {"pinch", 0xa4b4879a67d3dcbd, 0xca60e385f5d7844},
    {"arm among boxes", 0x8ccbbe0db678cc7f, 0xffaac2e9074010bc},
    {"surfaces", 0xeb2a15fd7aa4c769, 0x55a51cd9d652e08},
    {"four-bar", 0xd43a3f398232cd07, 0x49ef16ea7b0d04cd},
    {"stack", 0xf5f2640d34c74f99, 0xcd7aff06ad43a56},
    {"panda and cube", 0x532ad59b1dc56a89, 0x186e6d77aa5679f5},
    {"panda falls", 0x90aa9f603c94bea9, 0x20ce238aaa333a41},
    {"arm6", 0xb21dfc02e6b0d52b, 0x80ecb618785cff4f},
    {"joints", 0xab5c43a2eb62a3e9, 0x4b5703890c4ca26e},
    {"actuators", 0xb829489bdf3c6073, 0xd297b834a37dba44},
    {"equalities", 0x5007c8f7825251e3, 0xf2efdbec319773eb},
    {"hulls", 0x5a17a2b4b5bd4c41, 0x891459bfb298c4d1},
    {"heap", 0xfd4759e19af6e6e0, 0x8151d9ad46e10d9b},
    {"ground", 0x3bc3c40e20be607f, 0xa2e632aa5111d914},
    {"bouncing", 0x1d184d430dad65a2, 0x91efe7b14639da5c},
    {"heavy", 0x43ac2945069ec2da, 0xb06797f0b3505fee},
    {"wall", 0xe13c9e3b5763f7dc, 0xf8d32959ca2726ba},
    {"gripper", 0xe1af042f7f76e493, 0x5f657361e1c29831},
    {"crowd", 0xe049052bf784fb4c, 0x66ff059b21aebafa},
}};

constexpr std::array<std::pair<const char*, std::uint64_t>, 6> kTasks{{
    {"PandaReach-v3", 0xce6f608d3d7cbe65},
    {"PandaPush-v3", 0xb8098b462b657305},
    {"PandaSlide-v3", 0x32f6006cfc809700},
    {"PandaPickAndPlace-v3", 0x3b5e37dc64f4f409},
    {"PandaStack-v3", 0xb853b3c1271d95e8},
    {"PandaFlip-v3", 0x7e4f96cfaef8ef69},
}};

bool prints() { return std::getenv("MANYHANDS_PRINT_GOLDEN") != nullptr; }

/// In [-1, 1), the same on every machine.
double any(std::mt19937& rng) { return static_cast<double>(rng()) / 2147483648.0 - 1; }

struct Start {
  std::vector<double> v{}, ctrl{}, target{}, kp{}, kd{}, force{};
};

/// Where world k begins: everything is pushed about a little.
Start start_of(const testing::GoldenScene& scene, const Model& model, int k) {
  std::mt19937 rng(static_cast<unsigned>(100 + k));
  const auto nv = static_cast<std::size_t>(model.nv());
  Start s;
  for (std::size_t i = 0; i < nv; ++i) s.v.push_back(scene.push * any(rng));
  for (int u = 0; u < model.nu(); ++u) s.ctrl.push_back(0.3 * any(rng));
  for (std::size_t i = 0; i < nv; ++i) {
    s.target.push_back(0.2 * any(rng));
    s.kp.push_back(0.1);
    s.kd.push_back(i % 3 == 0 ? 0.5 : 1.0);
    s.force.push_back(i % 2 == 0 ? scene.motor_force : 0);
  }
  return s;
}

std::uint64_t hash_in_double(const testing::GoldenScene& scene) {
  const auto model = scene.make();
  Hash hash;
  for (int k = 0; k < 2; ++k) {
    const Start s = start_of(scene, *model, k);
    const std::vector<double> rest(s.v.size(), 0.0);
    World world(model);
    world.set_v(s.v);
    world.set_ctrl(s.ctrl);
    if (scene.motor_force > 0)
      world.set_motors({.target_q = s.target, .target_v = rest, .kp = s.kp, .kd = s.kd, .max_force = s.force});
    world.step(kSteps);
    for (const double x : world.q()) hash.add(x);
    for (const double x : world.v()) hash.add(x);
  }
  return hash.value();
}

std::uint64_t hash_in_float(const testing::GoldenScene& scene, int lanes) {
  const auto model = scene.make();
  Batch batch(model, kWorlds, 0.002, {.num_threads = 1, .lanes = lanes});
  std::vector<float> v, ctrl, target, kp, kd, force;
  const auto append = [](std::vector<float>& to, const std::vector<double>& from) {
    for (const double x : from) to.push_back(static_cast<float>(x));
  };
  for (int k = 0; k < kWorlds; ++k) {
    const Start s = start_of(scene, *model, k);
    append(v, s.v);
    append(ctrl, s.ctrl);
    append(target, s.target);
    append(kp, s.kp);
    append(kd, s.kd);
    append(force, s.force);
  }
  const std::vector<float> rest(v.size(), 0.0f);
  batch.set_v(v);
  batch.set_ctrl(ctrl);
  if (scene.motor_force > 0)
    batch.set_motors({.target_q = target, .target_v = rest, .kp = kp, .kd = kd, .max_force = force});
  batch.step(kSteps);
  for (const std::uint8_t flag : batch.flags()) EXPECT_EQ(flag & BatchFlag::kNotFinite, 0) << scene.name;
  Hash hash;
  for (const float x : batch.q()) hash.add(x);
  for (const float x : batch.v()) hash.add(x);
  return hash.value();
}

std::uint64_t hash_of_task(const std::string& id, int lanes) {
  constexpr int n = 16;
  const auto env = make_env_batch(id, n, {.num_threads = 1, .lanes = lanes});
  std::vector<std::uint64_t> seeds;
  for (std::uint64_t i = 0; i < n; ++i) seeds.push_back(7 + i);
  env->reset({}, seeds);
  for (int step = 1; step <= 25; ++step) env->step(rough_actions(*env, step));
  Hash hash;
  for (const auto rows : {env->observation(), env->achieved_goal(), env->desired_goal(), env->reward()})
    for (const float x : rows) hash.add(x);
  return hash.value();
}

TEST(Golden, Scenes) {
  const auto scenes = testing::golden_scenes();
  ASSERT_EQ(scenes.size(), kScenes.size());
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const Golden& golden = kScenes[i];
    const std::uint64_t real = hash_in_double(scenes[i]), single = hash_in_float(scenes[i], 1);
    if (prints()) {
      std::cout << std::hex << "    {\"" << scenes[i].name << "\", 0x" << real << ", 0x" << single << "},\n"
                << std::dec;
      continue;
    }
    EXPECT_EQ(scenes[i].name, golden.name);
    EXPECT_EQ(real, golden.real) << golden.name << " in double";
    EXPECT_EQ(single, golden.single) << golden.name << " in float";
  }
}

TEST(Golden, ScenesInLanes) {
  if (prints()) GTEST_SKIP();
  const auto scenes = testing::golden_scenes();
  for (std::size_t i = 0; i < scenes.size(); ++i)
    for (const int lanes : {4, 8, 16})
      EXPECT_EQ(hash_in_float(scenes[i], lanes), kScenes[i].single) << scenes[i].name << " in " << lanes << " lanes";
}

TEST(Golden, Tasks) {
  const char* ids[] = {"PandaReach-v3",        "PandaPush-v3",  "PandaSlide-v3",
                       "PandaPickAndPlace-v3", "PandaStack-v3", "PandaFlip-v3"};
  for (std::size_t i = 0; i < std::size(ids); ++i) {
    const std::uint64_t single = hash_of_task(ids[i], 1);
    if (prints()) {
      std::cout << std::hex << "    {\"" << ids[i] << "\", 0x" << single << "},\n" << std::dec;
      continue;
    }
    EXPECT_STREQ(ids[i], kTasks[i].first);
    EXPECT_EQ(single, kTasks[i].second) << ids[i];
    EXPECT_EQ(hash_of_task(ids[i], 0), kTasks[i].second) << ids[i] << " in lanes";
  }
}

}  // namespace
}  // namespace manyhands
