// The scripted experts solve their tasks, whatever batch a world is in.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "manyhands/envs/experts/expert.h"
#include "manyhands/envs/make.h"

namespace manyhands {
namespace {

std::vector<std::uint64_t> seeds_from(std::uint64_t first, int n) {
  std::vector<std::uint64_t> all(static_cast<std::size_t>(n));
  std::iota(all.begin(), all.end(), first);
  return all;
}

/// For each world the step of its first success, or 0 if the episode was cut off.
std::vector<int> play(EnvBatch& envs, Expert& expert, std::uint64_t first_seed) {
  const auto n = static_cast<std::size_t>(envs.num_envs());
  envs.reset({}, seeds_from(first_seed, envs.num_envs()));
  std::vector<int> success(n, 0);
  std::vector<float> action(n * static_cast<std::size_t>(envs.spec().action_dim));
  for (int step = 1; step <= envs.spec().max_episode_steps; ++step) {
    expert.act(envs, action);
    envs.step(action);
    for (std::size_t i = 0; i < n; ++i) {
      if (success[i] == 0 && envs.is_success()[i] != 0) success[i] = step;
    }
  }
  return success;
}

std::vector<int> play(const std::string& id, int num_envs, std::uint64_t first_seed, const EnvOptions& options = {}) {
  const auto envs = make_env_batch(id, num_envs, options);
  return play(*envs, *make_expert(id), first_seed);
}

struct Task {
  const char* id;
  double rate;  ///< of success, at least
};

class Experts : public ::testing::TestWithParam<Task> {};
INSTANTIATE_TEST_SUITE_P(All, Experts,
                         ::testing::Values(Task{"PandaReach-v3", 0.99}, Task{"PandaPush-v3", 0.99},
                                           Task{"PandaPickAndPlace-v3", 0.99}, Task{"PandaStack-v3", 0.95},
                                           Task{"PandaSlide-v3", 0.90}, Task{"PandaFlip-v3", 0.84},
                                           Task{"PandaReachJoints-v3", 0.99}, Task{"PandaPushJoints-v3", 0.99},
                                           Task{"PandaPickAndPlaceJoints-v3", 0.99}, Task{"PandaStackJoints-v3", 0.9},
                                           Task{"PandaSlideJoints-v3", 0.5}, Task{"PandaFlipJoints-v3", 0.5}),
                         [](const auto& test) {
                           const std::string id = test.param.id;
                           return id.substr(5, id.find('-') - 5);
                         });

TEST_P(Experts, Succeed) {
  constexpr int n = 200;
  const std::vector<int> success = play(GetParam().id, n, 7000);
  const auto failures = std::count(success.begin(), success.end(), 0);
  EXPECT_GE(static_cast<double>(n - failures) / n, GetParam().rate) << GetParam().id << ": " << failures << " failed";
}

/// Push is made for what stays where it is put; balls roll, and those at arm's length nothing brings back.
TEST(ExpertOfPush, MovesOtherShapes) {
  for (const auto& [shape, rate] : {std::pair{"cylinder", 0.99}, {"capsule", 0.94}, {"sphere", 0.8}}) {
    constexpr int n = 200;
    const std::vector<int> success = play("PandaPush-v3", n, 7000, {.object_shape = shape});
    EXPECT_GE(static_cast<double>(n - std::ranges::count(success, 0)) / n, rate) << shape;
  }
}

TEST_P(Experts, ActAlikeInAnyBatch) {
  constexpr int n = 12;
  const std::vector<int> together = play(GetParam().id, n, 40);
  for (const int i : {0, 5, 11})
    EXPECT_EQ(play(GetParam().id, 1, 40 + static_cast<std::uint64_t>(i)).at(0),
              together.at(static_cast<std::size_t>(i)));
}

/// What an expert remembers of an episode must not reach the next.
TEST_P(Experts, BeginAnewInANewEpisode) {
  constexpr int n = 8;
  const auto envs = make_env_batch(GetParam().id, n);
  const auto expert = make_expert(GetParam().id);
  const std::vector<int> once = play(*envs, *expert, 3);
  play(*envs, *expert, 100);
  EXPECT_EQ(play(*envs, *expert, 3), once);
}

TEST_P(Experts, KeepToTheRangeOfActions) {
  const auto envs = make_env_batch(GetParam().id, 16);
  std::vector<float> action(16 * static_cast<std::size_t>(envs->spec().action_dim));
  make_expert(GetParam().id)->act(*envs, action);
  for (const float a : action) EXPECT_LE(std::abs(a), 1.0f);
}

TEST(MakeAdviser, RemembersNothingAndSolvesFlipMostly) {
  constexpr int n = 256;
  const auto envs = make_env_batch("PandaFlip-v3", n);
  const auto adviser = make_adviser("PandaFlip-v3");
  const std::vector<int> success = play(*envs, *adviser, 7);
  EXPECT_GT(std::ranges::count_if(success, [](int step) { return step > 0; }), 0.75 * n);
  envs->reset({}, seeds_from(100, n));
  std::vector<float> action(4 * n), fresh(4 * n);
  for (int step = 0; step < 20; ++step) {
    adviser->act(*envs, action);
    make_adviser("PandaFlip-v3")->act(*envs, fresh);
    ASSERT_EQ(action, fresh) << step;
    envs->step(action);
  }
}

/// A policy sees no joints, so its adviser has nothing but rows to go by: none of the batch's own state.
TEST(MakeAdviser, DrivesJointsByWhatIsSeen) {
  constexpr int n = 100;
  for (const Task& task :
       {Task{"PandaReachJoints-v3", 0.99}, Task{"PandaPushJoints-v3", 0.95}, Task{"PandaPickAndPlaceJoints-v3", 0.99},
        Task{"PandaStackJoints-v3", 0.94}, Task{"PandaSlideJoints-v3", 0.4}, Task{"PandaFlipJoints-v3", 0.5}}) {
    const auto envs = make_env_batch(task.id, n);
    const auto adviser = make_adviser(task.id);
    const auto failures = std::ranges::count(play(*envs, *adviser, 7000), 0);
    EXPECT_GE(static_cast<double>(n - failures) / n, task.rate) << task.id;
    const auto size = static_cast<std::size_t>(n) * static_cast<std::size_t>(envs->spec().action_dim);
    std::vector<float> in_batch(size), of_rows(size);
    adviser->act(*envs, in_batch);
    make_adviser(task.id)->act(envs->observation(), envs->desired_goal(), of_rows);
    EXPECT_EQ(in_batch, of_rows) << task.id;
  }
}

TEST(MakeAdviser, IsTheExpertElsewhere) {
  const auto envs = make_env_batch("PandaStack-v3", 8);
  EXPECT_EQ(play(*envs, *make_adviser("PandaStack-v3"), 3), play(*envs, *make_expert("PandaStack-v3"), 3));
  EXPECT_THROW((void)make_adviser("PandaPull-v3"), std::invalid_argument);
}

TEST(MakeExpert, RefusesWhatItDoesNotKnow) {
  try {
    (void)make_expert("PandaPull-v3");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("PandaPushDense-v3"), std::string::npos) << error.what();
  }
  const auto envs = make_env_batch("PandaPush-v3", 2);
  std::vector<float> action(6), short_action(5);
  EXPECT_THROW(make_expert("PandaStack-v3")->act(*envs, action), std::invalid_argument);
  EXPECT_THROW(make_expert("PandaPush-v3")->act(*envs, short_action), std::invalid_argument);
}

}  // namespace
}  // namespace manyhands
