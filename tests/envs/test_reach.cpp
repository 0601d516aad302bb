// Reach through the batch API: the same bits whatever the lanes, the threads and the company; resets, goals, errors.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "manyhands/envs/make.h"

namespace manyhands {
namespace {

std::uint64_t seed_of(int world) { return 1000 + 17 * static_cast<std::uint64_t>(world); }

std::vector<std::uint64_t> seeds(int n) {
  std::vector<std::uint64_t> all;
  for (int i = 0; i < n; ++i) all.push_back(seed_of(i));
  return all;
}

/// Actions of one step: those of world i depend on i and the step only, and reach beyond the limits.
std::vector<float> actions(const EnvBatch& env, int step) {
  std::vector<float> all;
  for (int i = 0; i < env.num_envs(); ++i) {
    std::mt19937 random(static_cast<unsigned>(i * 7919 + step));
    for (int k = 0; k < env.spec().action_dim; ++k) all.push_back(static_cast<float>(random() % 2401) * 1e-3f - 1.2f);
  }
  return all;
}

/// All that a batch shows of world i, as bits.
std::vector<std::uint32_t> view(const EnvBatch& env, int i) {
  std::vector<std::uint32_t> bits;
  const auto add = [&](std::span<const float> rows) {
    const std::size_t columns = rows.size() / static_cast<std::size_t>(env.num_envs());
    for (const float x : rows.subspan(static_cast<std::size_t>(i) * columns, columns))
      bits.push_back(std::bit_cast<std::uint32_t>(x));
  };
  add(env.observation());
  add(env.achieved_goal());
  add(env.desired_goal());
  add(env.reward());
  for (const auto flags : {env.is_success(), env.terminated(), env.truncated()})
    bits.push_back(flags[static_cast<std::size_t>(i)]);
  return bits;
}

constexpr int kEpisode = 50;

/// trace[step][world]; the reset is step 0.
using Trace = std::vector<std::vector<std::vector<std::uint32_t>>>;

struct Episode {
  Trace trace;
  std::uint64_t hash;
};

Episode run(const std::string& id, int num_envs, int lanes, int threads) {
  const auto env = make_env_batch(id, num_envs, {.num_threads = threads, .lanes = lanes});
  env->reset({}, seeds(num_envs));
  Episode result;
  for (int step = 0; step <= kEpisode; ++step) {
    if (step > 0) env->step(actions(*env, step));
    result.trace.emplace_back();
    for (int i = 0; i < num_envs; ++i) result.trace.back().push_back(view(*env, i));
  }
  result.hash = env->state_hash();
  return result;
}

class ReachBits : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Control, ReachBits, ::testing::Values("PandaReach-v3", "PandaReachJointsDense-v3"));

TEST_P(ReachBits, AreTheSameForAnyLanesThreadsAndCompany) {
  const Episode reference = run(GetParam(), 64, 1, 1);
  for (const int num_envs : {1, 3, 17, 64}) {
    const std::uint64_t hash = num_envs == 64 ? reference.hash : run(GetParam(), num_envs, 1, 1).hash;
    for (const int lanes : {1, 4, 8, 16}) {
      for (const int threads : {1, 3}) {
        const Episode found = run(GetParam(), num_envs, lanes, threads);
        EXPECT_EQ(found.hash, hash) << num_envs << " worlds, " << lanes << " lanes, " << threads << " threads";
        for (std::size_t step = 0; step < found.trace.size(); ++step) {
          for (std::size_t i = 0; i < static_cast<std::size_t>(num_envs); ++i) {
            ASSERT_EQ(found.trace[step][i], reference.trace[step][i])
                << "world " << i << " of " << num_envs << ", step " << step << ", " << lanes << " lanes, " << threads
                << " threads";
          }
        }
      }
    }
  }
}

/// Hashes after 100 steps of `actions` from `seeds`: to notice when a change alters results that should have stayed.
/// They hold for every lane width, on processors with fused multiply-add, with -ffp-contract=off. After an intended
/// change copy the new ones from the failure of this test.
TEST(Reach, EndsInTheStateItAlwaysDid) {
  const auto end = [](const char* id) {
    const auto env = make_env_batch(id, 5, {.num_threads = 1});
    env->reset({}, seeds(5));
    for (int step = 1; step <= 100; ++step) env->step(actions(*env, step));
    return env->state_hash();
  };
  EXPECT_EQ(end("PandaReach-v3"), 10239157435353793747u);
  EXPECT_EQ(end("PandaReachJoints-v3"), 6220582456553199339u);
}

TEST(Reach, AGoalThatIsNoNumberIsNotReached) {
  const auto env = make_env_batch("PandaReach-v3", 1);
  std::vector<float> reward(1);
  env->compute_reward(std::vector<float>(3, std::numeric_limits<float>::quiet_NaN()), std::vector<float>(3), reward);
  EXPECT_EQ(reward[0], -1);
}

TEST(Reach, ResetsOnlyTheWorldsOfTheMask) {
  const int n = 19;
  const auto env = make_env_batch("PandaReach-v3", n, {.num_threads = 2}),
             other = make_env_batch("PandaReach-v3", n, {.num_threads = 2});
  env->reset({}, seeds(n));
  other->reset({}, seeds(n));
  for (int step = 1; step <= 10; ++step) {
    env->step(actions(*env, step));
    other->step(actions(*other, step));
  }
  std::vector<std::uint8_t> mask(static_cast<std::size_t>(n), 0);
  for (const std::size_t i : {0u, 7u, 8u, 16u, 18u}) mask[i] = 1;
  std::vector<std::vector<std::uint32_t>> before;
  for (int i = 0; i < n; ++i) before.push_back(view(*env, i));
  env->reset(mask);
  const auto fresh = make_env_batch("PandaReach-v3", n, {});  // its worlds' second goals
  fresh->reset({}, seeds(n));
  fresh->reset({});
  for (int i = 0; i < n; ++i) {
    const bool touched = mask[static_cast<std::size_t>(i)] != 0;
    EXPECT_EQ(view(*env, i), touched ? view(*fresh, i) : before[static_cast<std::size_t>(i)]) << i;
  }
  for (int step = 1; step <= 60; ++step) {  // and they go on as if nothing had happened beside them
    env->step(actions(*env, 10 + step));
    other->step(actions(*other, 10 + step));
    fresh->step(actions(*fresh, 10 + step));
    for (int i = 0; i < n; ++i) {
      ASSERT_EQ(view(*env, i), view(mask[static_cast<std::size_t>(i)] != 0 ? *fresh : *other, i))
          << "world " << i << ", step " << step;
    }
  }
}

/// A finished episode is over: what came before leaves no trace in the next.
TEST(Reach, RepeatsAnEpisodeBitForBit) {
  const auto env = make_env_batch("PandaReach-v3", 3, {});
  std::vector<Episode> runs(2);
  for (Episode& result : runs) {
    env->reset({}, seeds(3));
    for (int step = 1; step <= kEpisode; ++step) env->step(actions(*env, step));
    for (int i = 0; i < 3; ++i) result.trace.push_back({view(*env, i)});
    result.hash = env->state_hash();
  }
  EXPECT_EQ(runs[0].trace, runs[1].trace);
  EXPECT_EQ(runs[0].hash, runs[1].hash);
}

/// Goals that panda-gym draws for the seeds 0 and 42, and then without a seed.
TEST(Reach, DrawsPandaGymsGoals) {
  const std::vector<std::uint64_t> two{0, 42};
  constexpr float kFirst[]{0.041089f, -0.069064f, 0.012292f, 0.082187f, -0.018336f, 0.257579f};
  constexpr float kSecond[]{-0.145042f, 0.093981f, 0.273827f, 0.059210f, -0.121747f, 0.292687f};
  const auto env = make_env_batch("PandaReach-v3", 2, {});
  env->reset({}, two);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(env->desired_goal()[i], kFirst[i], 1e-6f);
  env->reset({});
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(env->desired_goal()[i], kSecond[i], 1e-6f);
}

TEST(Reach, RewardsAsComputeRewardDoes) {
  for (const char* id : {"PandaReach-v3", "PandaReachDense-v3"}) {
    const int n = 23;
    const auto env = make_env_batch(id, n, {.distance_threshold = 0.15});
    env->reset({}, seeds(n));
    std::vector<float> reward(static_cast<std::size_t>(n));
    int successes = 0;
    for (int step = 1; step <= kEpisode; ++step) {
      env->step(actions(*env, step));
      env->compute_reward(env->achieved_goal(), env->desired_goal(), reward);
      for (std::size_t i = 0; i < reward.size(); ++i) {
        EXPECT_EQ(std::bit_cast<std::uint32_t>(reward[i]), std::bit_cast<std::uint32_t>(env->reward()[i]))
            << id << ", step " << step;
        const float *a = &env->achieved_goal()[3 * i], *d = &env->desired_goal()[3 * i];
        const double distance = std::hypot(double{a[0]} - d[0], double{a[1]} - d[1], double{a[2]} - d[2]);
        if (std::abs(distance - 0.15) < 1e-6) continue;  // float may decide either way
        EXPECT_EQ(env->is_success()[i] != 0, distance < 0.15);
        const double expected = std::string(id) == "PandaReach-v3" ? (distance < 0.15 ? 0 : -1) : -distance;
        EXPECT_NEAR(reward[i], expected, 1e-6);
        successes += env->is_success()[i];
      }
    }
    EXPECT_GT(successes, 0) << "success was not tested";
  }
}

TEST(Reach, EndsByTheStepLimitAndBySuccess) {
  const auto env = make_env_batch("PandaReach-v3", 1, {.distance_threshold = 10.0});
  const auto going_on = make_env_batch("PandaReach-v3", 1, {.terminate_on_success = false, .distance_threshold = 10.0});
  const std::vector<float> still(3, 0.0f);
  for (int step = 1; step <= kEpisode; ++step) {
    env->step(still);
    going_on->step(still);
    EXPECT_EQ(env->terminated()[0], 1);
    EXPECT_EQ(going_on->terminated()[0], 0);
    EXPECT_EQ(going_on->is_success()[0], 1);
    EXPECT_EQ(env->truncated()[0], step == kEpisode ? 1 : 0) << step;
  }
  env->reset({});
  EXPECT_EQ(env->terminated()[0] + env->truncated()[0], 0);
}

TEST(Reach, ClipsActions) {
  const auto big = make_env_batch("PandaReachJoints-v3", 1, {}), one = make_env_batch("PandaReachJoints-v3", 1, {});
  for (const auto& env : {big.get(), one.get()}) env->reset({}, seeds(1));
  std::vector<float> far, near;
  for (int k = 0; k < 7; ++k) {
    near.push_back(k % 2 == 0 ? 1.0f : -1.0f);
    far.push_back(1e6f * near.back());
  }
  for (int step = 0; step < 10; ++step) {
    big->step(far);
    one->step(near);
  }
  EXPECT_EQ(big->state_hash(), one->state_hash());
}

/// The call throws std::invalid_argument with a message that holds all parts.
template <class Call>
void expect_refused(Call&& call, std::initializer_list<const char*> parts) {
  try {
    call();
    ADD_FAILURE() << "nothing was thrown; expected a message with " << *parts.begin();
  } catch (const std::invalid_argument& error) {
    for (const char* part : parts) EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

TEST(Reach, RefusesWhatItCannotMake) {
  const auto make = [](int num_envs, const EnvOptions& options, const char* id = "PandaReach-v3") {
    return [=] { (void)make_env_batch(id, num_envs, options); };
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_refused(make(1, {}, "PandaReach-v4"), {"PandaReach-v4", "PandaReach-v3", "PandaReachJointsDense-v3"});
  expect_refused(make(0, {}), {"num_envs", "0"});
  expect_refused(make(-3, {}), {"num_envs", "-3"});
  expect_refused(make(1, {.num_threads = 2000}), {"num_threads", "2000"});
  expect_refused(make(1, {.num_threads = -1}), {"num_threads", "-1"});
  expect_refused(make(1, {.n_substeps = 0}), {"n_substeps", "0"});
  expect_refused(make(1, {.time_step = 0}), {"time_step"});
  expect_refused(make(1, {.time_step = nan}), {"time_step", "nan"});
  expect_refused(make(1, {.distance_threshold = -1}), {"distance_threshold"});
  expect_refused(make(1, {.distance_threshold = nan}), {"distance_threshold", "nan"});
  expect_refused(make(1, {.lanes = 5}), {"lanes", "5"});
}

TEST(Reach, RefusesWhatItCannotDoAndStaysAsItWas) {
  const auto env = make_env_batch("PandaReach-v3", 4, {});
  env->reset({}, seeds(4));
  env->step(actions(*env, 1));
  const std::uint64_t before = env->state_hash();
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    std::vector<float> action(12, 0.0f);
    action[7] = bad;
    expect_refused([&] { env->step(action); }, {"action", "world 2", "finite"});
  }
  expect_refused([&] { env->step(std::vector<float>(11)); }, {"action", "11", "12"});
  expect_refused([&] { env->reset(std::vector<std::uint8_t>(3)); }, {"mask", "3", "4"});
  expect_refused([&] { env->reset({}, seeds(5)); }, {"seeds", "5", "4"});
  std::vector<float> reward(2);
  expect_refused([&] { env->compute_reward(std::vector<float>(6), std::vector<float>(5), reward); },
                 {"desired goal", "5", "6"});
  expect_refused([&] { env->compute_reward(std::vector<float>(7), std::vector<float>(6), reward); },
                 {"achieved goal", "7", "6"});
  EXPECT_EQ(env->state_hash(), before);
}

}  // namespace
}  // namespace manyhands
