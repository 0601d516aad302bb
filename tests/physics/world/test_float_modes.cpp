// What a caller sets of rounding and denormals changes no bit of a simulation, and is in force again afterwards.
#include <gtest/gtest.h>

#include <memory>

#include "manyhands/envs/make.h"
#include "manyhands/physics/world/batch.h"
#include "tests/base/float_modes.h"
#include "tests/physics/world/world_scenes.h"

namespace manyhands {
namespace {

using testing::FloatModes;

/// Runs `play` once as the program begins, and once for each mode, each time on worlds that `make` made before.
template <class Make, class Play>
void expect_no_bit_changes(const Make& make, const Play& play) {
  auto reference = make();
  play(*reference);
  for (const int rounding : {FE_UPWARD, FE_TOWARDZERO, FE_TONEAREST}) {
    const auto worlds = make();
    const FloatModes modes(rounding, true);
    play(*worlds);
    EXPECT_EQ(worlds->state_hash(), reference->state_hash()) << "rounding " << rounding;
    EXPECT_EQ(std::fegetround(), rounding);
  }
}

TEST(FloatModes, OfTheCallerChangeNoBitOfAWorld) {
  expect_no_bit_changes([] { return std::make_unique<World>(testing::panda_and_cube()); },
                        [](World& world) {
                          world.set_mass("cube", 0.3);
                          world.set_body_pose("cube", {Mat3<double>::identity(), {0.51, 0.02, 0.03}});
                          world.apply_force("cube", {0.1, 0.2, 0.3}, {0.01, 0, 0});
                          world.step(60);
                          world.add_body({.name = "ball", .shape = {.size = {0.1, 0, 0}}, .mass = 0.7});
                          world.step(10);
                        });
}

TEST(FloatModes, OfTheCallerChangeNoBitOfABatch) {
  expect_no_bit_changes(
      [] { return std::make_unique<Batch>(testing::panda_and_cube(), 20, 0.002, BatchOptions{.num_threads = 2}); },
      [](Batch& batch) {
        batch.set_mass("cube", std::vector<float>(20, 0.3f));
        batch.apply_force("cube", std::vector<float>(60, 0.1f), std::vector<float>(60, 0.01f));
        batch.step(60);
      });
}

TEST(FloatModes, OfTheCallerChangeNoBitOfEnvironments) {
  expect_no_bit_changes([] { return make_env_batch("PandaPush-v3", 20, {.num_threads = 2}); },
                        [](EnvBatch& envs) {
                          envs.reset({}, std::vector<std::uint64_t>(20, 3));
                          for (int step = 0; step < 3; ++step) envs.step(std::vector<float>(60, 0.3f));
                        });
}

}  // namespace
}  // namespace manyhands
