// Policies that act by their arrays alone: as the trainer that they are from, and as the files say that ship.
#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "manyhands/base/assets.h"
#include "manyhands/envs/make.h"
#include "manyhands/learn/policy_file.h"
#include "manyhands/learn/policy_runner.h"
#include "manyhands/learn/trainer.h"
#include "tests/learn/point_reach.h"
#include "tests/learn/small_config.h"

namespace manyhands::learn {
namespace {

std::filesystem::path shipped(const std::string& id) {
  return asset_root().parent_path() / "python/manyhands/policies" / (id + ".onnx");
}

TEST(PolicyRunner, DoesAsTheTrainerThatItIsFrom) {
  for (const Algorithm algorithm : {Algorithm::kTd3, Algorithm::kSac, Algorithm::kPpo}) {
    PointReach envs(16), fresh(40);
    TrainerConfig config = small_config({24, 16}, 400, 20'000);
    config.algorithm = algorithm;
    config.activation = HiddenActivation::kTanh;
    config.differences = {3, 0};
    Trainer trainer(envs, nullptr, config);
    trainer.advance(100);
    PolicyRunner runner(trainer.policy());
    const EvalResult own = trainer.evaluate(fresh, 100, 11), its = runner.evaluate(fresh, 100, 11);
    EXPECT_EQ(its.success_rate, own.success_rate);
    EXPECT_EQ(its.mean_return, own.mean_return);
    EXPECT_EQ(its.mean_length, own.mean_length);

    fresh.reset({}, {});
    std::vector<float> expected(40 * 3), action(40 * 3);
    trainer.predict(fresh.observation(), fresh.achieved_goal(), fresh.desired_goal(), false, expected);
    runner.act(fresh.observation(), fresh.achieved_goal(), fresh.desired_goal(), action);
    for (std::size_t i = 0; i < action.size(); ++i) EXPECT_EQ(action[i], std::clamp(expected[i], -1.0f, 1.0f));
  }
}

TEST(PolicyRunner, RefusesArraysThatDoNotFit) {
  PointReach envs(16);
  Trainer trainer(envs, nullptr, small_config({8}, 400, 20'000));
  const Policy whole = trainer.policy();
  EXPECT_NO_THROW(whole.validate());
  const auto refused = [&](auto change) {
    Policy policy = whole;
    change(policy);
    EXPECT_THROW(PolicyRunner{policy}, std::invalid_argument);
  };
  refused([](Policy& p) { p.mean.pop_back(); });
  refused([](Policy& p) { p.layers[0].weight.pop_back(); });
  refused([](Policy& p) { p.layers[0].weight[3] = NAN; });
  refused([](Policy& p) { p.layers.pop_back(); });
  refused([](Policy& p) { p.layers.clear(); });
  refused([](Policy& p) { p.relations.differences = {0, 5}; });
  refused([](Policy& p) { p.action_dim = 2; });
  refused([](Policy& p) { p.clip = 0; });

  PolicyRunner runner(whole);
  std::vector<float> action(3);
  EXPECT_THROW(runner.act(std::vector<float>(6), std::vector<float>(3), std::vector<float>(4), action),
               std::invalid_argument);
  EXPECT_THROW(runner.act(std::vector<float>(12), std::vector<float>(6), std::vector<float>(6), action),
               std::invalid_argument);
}

TEST(PolicyFile, ShippedOnesSolveTheirTask) {
  const Policy policy = read_policy(shipped("PandaReach-v3"));
  EXPECT_EQ(policy.env_id, "PandaReach-v3");
  const auto envs = make_env_batch("PandaReach-v3", 64);
  EXPECT_GT(PolicyRunner(policy).evaluate(*envs, 128, 5).success_rate, 0.97);
  const auto push = make_env_batch("PandaPush-v3", 4);
  EXPECT_THROW(static_cast<void>(PolicyRunner(policy).evaluate(*push, 4, 5)), std::invalid_argument);
}

TEST(PolicyFile, OtherFilesAreRefused) {
  EXPECT_THROW(static_cast<void>(read_policy("nowhere.onnx")), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(read_policy(asset_root())), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(read_policy(asset_root() / "panda/panda.urdf")), std::invalid_argument);
}

/// Whatever the bytes, a policy comes of them or an exception.
TEST(PolicyFile, DamageNeverCrashes) {
  std::ifstream file(shipped("PandaReach-v3"), std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  ASSERT_GT(whole.size(), 1000u);
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "damaged.onnx";
  std::mt19937 random(1);
  int refused = 0;
  for (int i = 0; i < 1000; ++i) {
    std::string damaged = i % 3 == 0 ? whole.substr(0, random() % whole.size()) : whole;
    for (int k = 0; k < 6 && !damaged.empty(); ++k) {
      // Mostly where the structure is: at the beginning, or in the last part.
      const std::size_t end = std::min<std::size_t>(damaged.size(), 400);
      const std::size_t at = random() % 2 == 0 ? random() % end : damaged.size() - 1 - random() % end;
      damaged[at] = static_cast<char>(random());
    }
    std::ofstream(path, std::ios::binary) << damaged;
    try {
      PolicyRunner runner(read_policy(path));
    } catch (const std::invalid_argument&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 300);
}

}  // namespace
}  // namespace manyhands::learn
