#include <gtest/gtest.h>

#include <chrono>
#include <iostream>
#include <numeric>

#include "manyhands/kinematics/ik_search.h"
#include "manyhands/kinematics/ik_seeds.h"
#include "manyhands/math/philox.h"
#include "tests/kinematics/placed_panda.h"

namespace manyhands {
namespace {

constexpr std::size_t kJoints = 9;  // of the arm and its fingers

struct Panda : testing::PlacedPanda<double> {
  std::vector<double> neutral = robot.arm.neutral;

  /// Hand poses of random configurations within the limits.
  std::vector<Transform<double>> reachable(int n) {
    std::vector<Transform<double>> poses;
    for (int i = 0; i < n; ++i) {
      RandomStream random(4, static_cast<std::uint32_t>(i), 0);
      std::vector<double> q = neutral;
      for (const std::size_t dof : robot.arm.chain.dofs) q[dof] = random.uniform(params.lower[dof], params.upper[dof]);
      poses.push_back(hand(q.data()));
    }
    return poses;
  }
};

double angle(const Mat3<double>& a, const Mat3<double>& b) { return norm(rotation_vector(to_quat(a * transpose(b)))); }

TEST(IkSearch, ReachesNearlyAllThatCanBeReached) {
  constexpr int n = 10000;
  Panda panda;
  const std::vector<Transform<double>> targets = panda.reachable(n);
  const auto begin = std::chrono::steady_clock::now();
  const IkSolutions found = search_ik(panda.robot.model, panda.robot.arm.hand, targets, panda.neutral);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  int solved = 0, at_first = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double* q = &found.q[i * kJoints];
    for (std::size_t j = 0; j < kJoints; ++j) {  // the model's dofs are its coordinates
      ASSERT_GE(q[j], panda.params.lower[j]) << "target " << i;
      ASSERT_LE(q[j], panda.params.upper[j]) << "target " << i;
    }
    EXPECT_EQ(q[7], panda.neutral[7]);
    EXPECT_EQ(q[8], panda.neutral[8]);
    const Transform<double> X_WF = panda.hand(q);
    EXPECT_NEAR(found.position_error[i], norm(X_WF.p - targets[i].p), 1e-9);
    EXPECT_NEAR(found.rotation_error[i], angle(X_WF.R, targets[i].R), 1e-7);
    if (found.success[i] == 0) continue;
    ++solved;
    at_first += found.attempts[i] == 1;
    ASSERT_LE(norm(X_WF.p - targets[i].p), 1e-5 + 1e-12) << "target " << i;
    ASSERT_LE(angle(X_WF.R, targets[i].R), 1e-4 + 1e-7) << "target " << i;
  }
  EXPECT_GE(solved, n * 995 / 1000);
  double attempts = 0;
  for (const int a : found.attempts) attempts += a;
  std::cout << solved << " of " << n << " solved, " << at_first << " of them at the first attempt, " << attempts / n
            << " attempts a target, " << seconds << " s\n";
}

TEST(IkSearch, GivesEachTargetItsOwnAnswer) {
  Panda panda;
  const std::vector<Transform<double>> targets = panda.reachable(37);
  const IkSolutions all = search_ik(panda.robot.model, panda.robot.arm.hand, targets, panda.neutral);
  for (const std::size_t n : {2u, 5u, 36u}) {  // the first attempts of two are made in scalars
    const IkSolutions some =
        search_ik(panda.robot.model, panda.robot.arm.hand, std::span(targets).first(n), panda.neutral);
    const auto rows = static_cast<std::ptrdiff_t>(n);
    EXPECT_EQ(std::vector<double>(all.q.begin(), all.q.begin() + rows * kJoints), some.q);
    EXPECT_EQ(std::vector<int>(all.attempts.begin(), all.attempts.begin() + rows), some.attempts);
  }
}

TEST(IkSearch, BeginsNearTheTargetWhereNoStartCounts) {
  constexpr IkSearchSettings anywhere{.from_start = false};
  Panda panda;
  const std::vector<Transform<double>> targets = panda.reachable(500);
  const IkSolutions from_neutral = search_ik(panda.robot.model, panda.robot.arm.hand, targets, panda.neutral);
  const IkSolutions all = search_ik(panda.robot.model, panda.robot.arm.hand, targets, panda.neutral, anywhere);
  const auto attempts = [](const IkSolutions& found) {
    return std::accumulate(found.attempts.begin(), found.attempts.end(), 0);
  };
  EXPECT_LT(attempts(all), attempts(from_neutral));
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const double off = norm(panda.hand(&all.q[i * kJoints]).p - targets[i].p);
    EXPECT_TRUE(all.success[i] == 0 || off < 1e-5 + 1e-12) << "target " << i;
  }
  EXPECT_GE(std::accumulate(all.success.begin(), all.success.end(), 0), 498);
  const IkSolutions some =
      search_ik(panda.robot.model, panda.robot.arm.hand, std::span(targets).first(2), panda.neutral, anywhere);
  EXPECT_EQ(std::vector<double>(all.q.begin(), all.q.begin() + 2 * kJoints), some.q);
}

TEST(IkSearch, SaysHowFarOffAnUnreachableTargetIs) {
  Panda panda;
  Transform<double> far = panda.hand(panda.neutral.data());
  far.p = {-0.6, 0, 3.0};  // the arm reaches about 1.19 m above its base
  const IkSolutions found =
      search_ik(panda.robot.model, panda.robot.arm.hand, std::span(&far, 1), panda.neutral, {.restarts = 5});
  EXPECT_EQ(found.success[0], 0);
  EXPECT_EQ(found.attempts[0], 6);
  EXPECT_NEAR(found.position_error[0], norm(panda.hand(found.q.data()).p - far.p), 1e-12);
  EXPECT_GT(found.position_error[0], 3.0 - 1.4);
  EXPECT_LT(found.position_error[0], 3.0);  // it stretches towards it
}

/// Whether an attempt's iterates come within tolerance, where a search ends it. `solve_goal` takes one step more, which
/// may lead out again where a tolerance is as wide as 1 rad.
bool reaches(GoalSolve<float, float>& solve, int most) {
  for (int i = 0; i <= most; ++i) {
    solve.look();
    if (solve.reached()) return true;
    if (!solve.step(i < most)) break;
  }
  return false;
}

/// A search ends with the first attempt that reaches its target, also where one before it came nearer by the sum of
/// both errors but missed a tolerance: what one attempt after another finds in scalars decides.
TEST(IkSearch, EndsWithTheFirstAttemptThatReaches) {
  constexpr int n = 3000;
  constexpr IkSearchSettings settings{.ik = {.rotation_tolerance = 1.0, .patience = 3}, .restarts = 8};
  Panda panda;
  const Tree<float> tree(panda.robot.model);
  const ParamsStorage<float> params(panda.robot.model);
  Workspace<float> ws(tree);
  const std::vector<Transform<double>> targets = panda.reachable(n);
  const IkSolutions found = search_ik(panda.robot.model, panda.robot.arm.hand, targets, panda.neutral, settings);
  static_assert(settings.restarts <= internal::IkSeeds::kRanks);
  const internal::IkSeeds seeds(tree, params, panda.robot.arm.chain);
  for (std::size_t i = 0; i < n; ++i) {
    int attempts = 0;
    bool reached = false;
    while (!reached && attempts <= settings.restarts) {
      std::vector<float> q(panda.neutral.begin(), panda.neutral.end());
      if (attempts > 0) std::ranges::copy(seeds.near({}, {targets[i], {}}, attempts - 1), q.begin());
      const IkTarget<float> target{broadcast<float>(targets[i]), Vec3<float>::zero()};
      const IkGoal pose;
      GoalSolve<float, float> solve(tree, params, panda.robot.arm.chain, settings.ik, pose, target, q.data(), ws);
      reached = reaches(solve, settings.ik.max_iterations);
      ++attempts;
    }
    EXPECT_EQ(found.attempts[i], attempts) << "target " << i;
  }
}

TEST(IkSearch, RefusesAStartOfTheWrongLength) {
  Panda panda;
  EXPECT_THROW((void)search_ik(panda.robot.model, panda.robot.arm.hand, {}, std::vector<double>(7)),
               std::invalid_argument);
  EXPECT_TRUE(search_ik(panda.robot.model, panda.robot.arm.hand, {}, panda.neutral).q.empty());
}

}  // namespace
}  // namespace manyhands
