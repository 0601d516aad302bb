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

constexpr std::array<Golden, 21> kScenes{{
    {"boxes", 0xe3c4da991c971ab7, 0x7e948f42049d598f},
    {"pinch", 0xd05a2c185d206434, 0xe396f4e6b6043f0a},
    {"arm among boxes", 0xc157a284c7bb7988, 0x6468a80e8e687820},
    {"surfaces", 0x7b705028c786cd7e, 0x83486811f8f26a52},
    {"four-bar", 0x23ef4a470424070e, 0xd6bf110e2831c8d6},
    {"yielding", 0x8e5b1f6715dc5893, 0x89c6b0197075a95},
    {"stack", 0xf38e1656e6e7fb96, 0x703f5627a39cdf26},
    {"panda and cube", 0xd4efabd86c4e3dcb, 0x1af34e6919c9e4f6},
    {"panda falls", 0x3939597999b57896, 0x52e74c69726751be},
    {"arm6", 0xc3d65d27e0b014db, 0x56be53b8c1a46a51},
    {"joints", 0xab5c43a2eb62a3e9, 0x5540c7b620a887dd},
    {"actuators", 0xb829489bdf3c6073, 0x241022311f68ff84},
    {"equalities", 0x5007c8f7825251e3, 0xe60289916fa275f1},
    {"hulls", 0x8b8503a84474c352, 0x3043b36edcad2d76},
    {"heap", 0xb58e435c573d185f, 0xed18a013458abfa9},
    {"ground", 0xee8268839ad7a423, 0x706e9e5321a530d2},
    {"bouncing", 0xd37f9ae2495d7671, 0x59cb51edafd717c5},
    {"heavy", 0x2ee7bbd08cce2520, 0x67ad2ef22913201},
    {"wall", 0xe27c7b130c96df7a, 0x6aa0a77c8574a62e},
    {"gripper", 0xd963d2f1cf23433e, 0x674e13d5d2d5829f},
    {"crowd", 0x443422f01df3983c, 0xdb2b837b1fb6fa8b},
}};

constexpr std::array<std::pair<const char*, std::uint64_t>, 6> kTasks{{
    {"PandaReach-v3", 0x53bf568b88520591},
    {"PandaPush-v3", 0x7a345735f47b5853},
    {"PandaSlide-v3", 0x103d049062b139d0},
    {"PandaPickAndPlace-v3", 0x4330a69ff0f8f319},
    {"PandaStack-v3", 0xb133edae2dc8a8bb},
    {"PandaFlip-v3", 0xe891a512f3d00f0f},
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
