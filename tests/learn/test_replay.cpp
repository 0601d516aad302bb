// Invariants of hindsight replay, on episodes whose numbers say where they come from.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>

#include "manyhands/learn/replay.h"
#include "tests/learn/point_reach.h"

namespace manyhands::learn {
namespace {

EnvSpec spec() { return PointReach(1).spec(); }

/// Episode `number`: at step t the point is at x = number + t / 10 and observes (number, t, 0, 0, 0, 0); its own goal
/// lies at y = 100, out of reach.
struct NumberedEpisode {
  NumberedEpisode(int number, int length, bool terminated) {
    for (int t = 0; t <= length; ++t) {
      const auto n = static_cast<float>(number), step = static_cast<float>(t);
      for (const float value : {n, step, 0.0f, 0.0f, 0.0f, 0.0f}) observation.push_back(value);
      for (const float value : {n + 0.1f * step, 0.0f, 0.0f}) achieved.push_back(value);
      if (t == length) break;
      for (const float value : {n, step, 0.5f}) action.push_back(value);
      reward.push_back(terminated && t == length - 1 ? 0.0f : -1.0f);
    }
    view = {length, terminated, observation, achieved, desired, action, reward};
  }
  NumberedEpisode(const NumberedEpisode&) = delete;
  NumberedEpisode& operator=(const NumberedEpisode&) = delete;

  std::vector<float> observation, achieved, action, reward;
  std::array<float, 3> desired = {0.0f, 100.0f, 0.0f};
  EpisodeView view;
};

/// Checks every column that belongs to a numbered episode; returns how often each (episode, step) was drawn.
std::map<std::pair<int, int>, int> check_columns(const Minibatch& batch, int relabelled, const PointReach& task,
                                                 const std::map<int, NumberedEpisode*>& episodes) {
  std::map<std::pair<int, int>, int> drawn;
  for (int i = 0; i < batch.size(); ++i) {
    const int number = static_cast<int>(batch.observation(0, i));
    const int t = static_cast<int>(batch.observation(1, i));
    const EpisodeView& episode = episodes.at(number)->view;
    ++drawn[{number, t}];
    EXPECT_LT(t, episode.length);
    EXPECT_EQ(batch.next_observation(0, i), batch.observation(0, i));
    EXPECT_EQ(batch.next_observation(1, i), batch.observation(1, i) + 1);
    EXPECT_EQ(batch.action(1, i), batch.observation(1, i));
    EXPECT_EQ(batch.achieved_goal(0, i), episode.achieved_goal[static_cast<std::size_t>(3 * t)]);
    EXPECT_EQ(batch.next_achieved_goal(0, i), episode.achieved_goal[static_cast<std::size_t>(3 * t + 3)]);

    const bool own_goal = batch.desired_goal(1, i) == 100.0f;
    EXPECT_EQ(own_goal, i >= relabelled);
    const bool done = batch.discount[i] == 0.0f;
    EXPECT_TRUE(done || batch.discount[i] == batch.returns.gamma);
    if (own_goal) {
      EXPECT_EQ(done, episode.terminated && t == episode.length - 1) << "truncation is not the end of a task";
      EXPECT_EQ(batch.reward[i], episode.reward[static_cast<std::size_t>(t)]);
      continue;
    }
    const int goal_step = static_cast<int>(std::lround((batch.desired_goal(0, i) - static_cast<float>(number)) * 10));
    EXPECT_GT(goal_step, t) << "a new goal is achieved after the transition, not before";
    EXPECT_LE(goal_step, episode.length) << "a new goal comes from the same episode";
    std::array<float, 1> reward{};
    task.compute_reward({batch.next_achieved_goal.col(i).data(), 3}, {batch.desired_goal.col(i).data(), 3}, reward);
    EXPECT_EQ(batch.reward[i], reward[0]);
    EXPECT_EQ(done, reward[0] == 0.0f) << "reaching the new goal would have ended the episode";
    EXPECT_EQ(done, goal_step == t + 1);
  }
  return drawn;
}

TEST(ReplayBuffer, RelabelsWithinTheEpisodeAndRecomputesRewardAndEnd) {
  const PointReach task(1);
  ReplayBuffer replay(spec(), 100);
  NumberedEpisode stopped(1, 5, false), reached(2, 3, true), single(3, 1, true);
  for (const NumberedEpisode* e : {&stopped, &reached, &single}) replay.add(e->view);
  ASSERT_EQ(replay.size(), 9);
  Minibatch batch = replay.make_minibatch(4000);
  replay.sample(task, {.fraction = 0.75, .success_terminates = true}, Random(1, Purpose::kSampling, 3), batch);
  const auto drawn = check_columns(batch, 3000, task, {{1, &stopped}, {2, &reached}, {3, &single}});
  ASSERT_EQ(drawn.size(), 9u);
  for (const auto& [transition, times] : drawn) {  // binomial: 444 +- 20
    EXPECT_NEAR(times, 4000.0 / 9, 120) << transition.first << ", " << transition.second;
  }
}

TEST(ReplayBuffer, DrawsNewGoalsUniformlyFromTheRestOfTheEpisode) {
  const PointReach task(1);
  ReplayBuffer replay(spec(), 50);
  const NumberedEpisode episode(0, 4, false);
  replay.add(episode.view);
  Minibatch batch = replay.make_minibatch(8000);
  replay.sample(task, {.fraction = 1.0}, Random(4, Purpose::kSampling, 6), batch);
  std::map<std::pair<int, int>, int> count;
  for (int i = 0; i < batch.size(); ++i) {
    ++count[{static_cast<int>(batch.observation(1, i)), static_cast<int>(std::lround(10 * batch.desired_goal(0, i)))}];
  }
  ASSERT_EQ(count.size(), 10u);
  for (const auto& [pair, times] : count) {  // a quarter of the draws at t, split over 4 - t later states
    EXPECT_NEAR(times, 2000.0 / (4 - pair.first), 150) << pair.first << " -> " << pair.second;
  }
}

TEST(ReplayBuffer, KeepsNothingOfOverwrittenEpisodes) {
  const PointReach task(1);
  ReplayBuffer replay(spec(), 50);
  std::vector<std::unique_ptr<NumberedEpisode>> all;
  std::map<int, NumberedEpisode*> episodes;
  for (int number = 0; number < 40; ++number) {
    all.push_back(std::make_unique<NumberedEpisode>(number, 3 + number % 11, number % 2 == 0));
    episodes[number] = all.back().get();
    replay.add(all.back()->view);
  }
  ASSERT_EQ(replay.size(), 50);
  Minibatch batch = replay.make_minibatch(5000);
  replay.sample(task, {.fraction = 0.8}, Random(7, Purpose::kSampling, 9), batch);
  const auto drawn = check_columns(batch, 4000, task, episodes);
  EXPECT_EQ(drawn.size(), 50u);
  int number = 39, t = episodes[39]->view.length;
  for (int newest = 0; newest < 50; ++newest) {
    if (t == 0) t = episodes[--number]->view.length;
    --t;
    EXPECT_TRUE(drawn.contains({number, t})) << number << ", " << t;
  }
}

TEST(ReplayBuffer, WithoutTerminationReachingANewGoalIsNotTheEnd) {
  const PointReach task(1);
  ReplayBuffer replay(spec(), 50);
  const NumberedEpisode episode(0, 4, false);
  replay.add(episode.view);
  Minibatch batch = replay.make_minibatch(500);
  replay.sample(task, {.fraction = 1.0, .success_terminates = false}, Random(1, Purpose::kSampling, 1), batch);
  EXPECT_EQ(batch.reward.maxCoeff(), 0.0f);
  EXPECT_EQ(batch.discount.minCoeff(), batch.returns.gamma);
}

TEST(ReplayBuffer, SumsRewardsUntilTheStepsOrTheEpisodeEnd) {
  const PointReach task(1);
  ReplayBuffer replay(spec(), 50);
  const NumberedEpisode stopped(1, 6, false), reached(2, 6, true);
  replay.add(stopped.view);
  replay.add(reached.view);
  const float gamma = 0.5f;
  Minibatch batch = replay.make_minibatch(4000, {.steps = 3, .gamma = gamma});
  replay.sample(task, {.fraction = 0.5}, Random(1, Purpose::kSampling, 3), batch);
  for (int i = 0; i < batch.size(); ++i) {
    const int t = static_cast<int>(batch.observation(1, i));
    const bool own = i >= batch.relabelled, ends = own ? batch.observation(0, i) == 2.0f : true;
    const int goal_step = static_cast<int>(std::lround((batch.desired_goal(0, i) - batch.observation(0, i)) * 10));
    const int end = own ? 6 : goal_step;  // the state in which the task is done, or the episode stopped
    const int steps = std::min(3, end - t);
    EXPECT_EQ(batch.next_observation(1, i), static_cast<float>(t + steps));
    EXPECT_EQ(batch.next_achieved_goal(0, i), batch.observation(0, i) + 0.1f * static_cast<float>(t + steps));
    float sum = 0, discount = 1;
    for (int k = 1; k <= steps; ++k, discount *= gamma) sum -= ends && t + k == end ? 0 : discount;
    EXPECT_EQ(batch.reward[i], sum);
    EXPECT_EQ(batch.discount[i], ends && t + steps == end ? 0 : discount);
  }
}

TEST(ReplayBuffer, IsDeterministic) {
  const PointReach task(1);
  ReplayBuffer replay(spec(), 50);
  const NumberedEpisode episode(0, 40, false);
  replay.add(episode.view);
  Minibatch a = replay.make_minibatch(64), b = replay.make_minibatch(64);
  replay.sample(task, {}, Random(1, Purpose::kSampling, 3), a);
  replay.sample(task, {}, Random(1, Purpose::kSampling, 3), b);
  EXPECT_EQ(a.observation, b.observation);
  EXPECT_EQ(a.desired_goal, b.desired_goal);
  replay.sample(task, {}, Random(1, Purpose::kSampling, 4), b);
  EXPECT_NE(a.observation, b.observation);
}

TEST(ReplayBuffer, IsTheSameInAFile) {
  const PointReach task(1);
  ReplayBuffer in_memory(spec(), 50), in_file(spec(), 50, 0, 0, testing::TempDir());
  for (int number = 0; number < 5; ++number) {
    const NumberedEpisode episode(number, 17, number % 2 == 0);
    for (ReplayBuffer* replay : {&in_memory, &in_file}) replay->add(episode.view);
  }
  Minibatch a = in_memory.make_minibatch(64), b = a;
  in_memory.sample(task, {}, Random(1, Purpose::kSampling, 3), a);
  in_file.sample(task, {}, Random(1, Purpose::kSampling, 3), b);
  EXPECT_EQ(a.observation, b.observation);
  EXPECT_EQ(a.next_observation, b.next_observation);
  EXPECT_EQ(a.desired_goal, b.desired_goal);
  EXPECT_EQ(a.reward, b.reward);
}

TEST(ReplayBuffer, RejectsWhatDoesNotFit) {
  EXPECT_THROW(ReplayBuffer(spec(), 49), std::invalid_argument);
  ReplayBuffer replay(spec(), 50);
  const NumberedEpisode episode(0, 4, false);
  EpisodeView view = episode.view;
  view.length = 5;
  EXPECT_THROW(replay.add(view), std::invalid_argument);
}

}  // namespace
}  // namespace manyhands::learn
