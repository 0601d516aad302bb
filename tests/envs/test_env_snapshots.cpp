// Snapshots of environments: refused where they do not belong, and never the way to numbers that are not finite.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

#include "manyhands/envs/make.h"
#include "tests/envs/rough_policy.h"
#include "tests/physics/world/snapshot_testing.h"

namespace manyhands {
namespace {

using testing::Bytes;
using testing::takes;

/// `scene`: that of the environments.
bool is_sound(const EnvBatch& envs, const EnvScene& scene) {
  for (const auto rows : {envs.observation(), envs.achieved_goal(), envs.desired_goal(), envs.reward()}) {
    for (const float x : rows) {
      if (!std::isfinite(x)) return false;
    }
  }
  std::vector<double> q(static_cast<std::size_t>(scene.model.nq()));
  std::vector<Vec3<double>> sizes(scene.objects.size());
  for (int i = 0; i < envs.num_envs(); ++i) {
    envs.see(i, q, sizes);
    for (const double x : q) {
      if (!std::isfinite(x)) return false;
    }
  }
  return true;
}

TEST(EnvSnapshots, MutantsNeverLeadToNumbersThatAreNotFinite) {
  const EnvOptions options{.num_threads = 1, .n_substeps = 2, .randomize = {{"action_latency", 1, 2}}, .lanes = 1};
  const auto envs = make_env_batch("PandaPush-v3", 2, options);
  for (int step = 0; step < 3; ++step) envs->step(rough_actions(*envs, step));
  const EnvScene scene = envs->scene();
  const Bytes sound = envs->snapshot();
  for (const bool repaired : {false, true}) {
    std::mt19937 random(repaired ? 1 : 2);
    int taken = 0;
    for (int i = 0; i < 1500; ++i) {
      Bytes mutant = testing::mutated<float>(sound, random);
      if (mutant == sound) continue;
      if (repaired) testing::repair(mutant);
      if (!takes(*envs, mutant)) continue;
      ++taken;
      ASSERT_TRUE(is_sound(*envs, scene)) << "mutant " << i << ", restored";
      envs->step(rough_actions(*envs, i));
      ASSERT_TRUE(is_sound(*envs, scene)) << "mutant " << i << ", after a step";
    }
    if (repaired) {
      EXPECT_GT(taken, 50) << "too few are taken: the test shows little";
    } else {
      EXPECT_EQ(taken, 0);
    }
    EXPECT_TRUE(takes(*envs, sound));
  }
}

TEST(EnvSnapshots, AreRefusedByAllThatTheyAreNotOf) {
  std::vector<std::pair<std::string, std::unique_ptr<EnvBatch>>> all;
  const auto add = [&](const std::string& id, int n, EnvOptions options) {
    options.num_threads = options.lanes = 1;
    all.emplace_back(id + " " + std::to_string(all.size()), make_env_batch(id, n, options));
  };
  for (const std::string& id : env_ids()) add(id, 1, {});
  add("PandaPush-v3", 2, {});
  for (const auto& [name, control] : kArmControls) {
    const bool usual = control == ArmControl::kEndEffector;
    if (!usual) add("PandaSlide-v3", 1, {.control = control});
  }
  add("PandaPush-v3", 1, {.n_substeps = 10});
  add("PandaPush-v3", 1, {.time_step = 0.001});
  add("PandaPush-v3", 1, {.terminate_on_success = false});
  add("PandaPush-v3", 1, {.distance_threshold = 0.1});
  add("PandaPush-v3", 1, {.randomize = {{"object_mass", 0.5, 2}}});
  add("PandaPush-v3", 1, {.randomize = {{"object_mass", 0.5, 3}}});
  add("PandaPush-v3", 1, {.object_shape = "sphere"});
  add("PandaPush-v3", 1, {.arm = arm_spec("arm6")});
  add("PandaPush-v3", 1, {.control = ArmControl::kImpedance});
  add("PandaPush-v3", 1, {.control = ArmControl::kImpedance, .impedance = {.stiffness = 500}});
  const Shape box{.type = ShapeType::kBox, .size = {0.02, 0.02, 0.1}};
  for (const double x : {-0.3, -0.31}) {
    add("PandaPush-v3", 1, {.obstacles = {{.shape = box, .X_WO = {Mat3<double>::identity(), {x, 0.3, 0.1}}}}});
  }
  for (const auto& [name_a, a] : all) {
    const Bytes snapshot = a->snapshot();
    for (const auto& [name_b, b] : all) {
      std::string why;
      EXPECT_EQ(takes(*b, snapshot, &why), a == b) << name_a << " by " << name_b;
      if (a != b) {
        EXPECT_NE(why.find("expected"), std::string::npos) << why;
      }
    }
  }
}

TEST(EnvSnapshots, SayWhatTheyAreOf) {
  const auto push = make_env_batch("PandaPush-v3", 2, {.num_threads = 1});
  const auto slide = make_env_batch("PandaSlideJoints-v3", 1, {.num_threads = 1, .time_step = 0.001});
  std::string why;
  EXPECT_FALSE(takes(*push, slide->snapshot(), &why));
  EXPECT_EQ(why,
            "the snapshot is of PandaSlideJoints-v3 (1 world, control joints, time_step 0.001, 20 substeps); expected "
            "one of PandaPush-v3 (2 worlds, control ee, time_step 0.002, 20 substeps)");
}

}  // namespace
}  // namespace manyhands
