// Goals that ask for less than a pose: lanes against the scalar, poses against solve_ik, and what is refused.
#include <gtest/gtest.h>

#include <bit>

#include "manyhands/envs/panda.h"
#include "manyhands/kinematics/ik_goals.h"
#include "manyhands/kinematics/ik_search.h"
#include "manyhands/math/instantiate.h"
#include "manyhands/math/philox.h"

namespace manyhands {
namespace {

constexpr std::size_t kJoints = 9;  // of the arm and its fingers

struct Problem {
  std::vector<float> start;
  IkTarget<float> target;
};

/// A configuration within reach, somewhere to start, and a point the hand looks at.
Problem random_problem(const LonePanda& robot, const Tree<float>& tree, const Params<float>& params,
                       Workspace<float>& ws, std::uint32_t seed) {
  RandomStream random(seed, 0, 0);
  std::vector<float> there(kJoints, 0.0F);
  Problem made{there, {}};
  for (const std::size_t i : robot.arm.chain.dofs) {
    there[i] = random.uniform(params.lower[i], params.upper[i]);
    made.start[i] = random.uniform(params.lower[i], params.upper[i]);
  }
  forward_kinematics(tree, there.data(), ws);
  made.target.X_WF = frame_pose(robot.arm.chain.body, broadcast<float>(robot.arm.chain.X_BF), ws);
  made.target.toward = made.target.X_WF.p + made.target.X_WF.R.z;
  return made;
}

std::vector<IkGoal> goals(const std::vector<double>& posture) {
  std::vector<IkGoal> all;
  for (const IkOrientation orientation :
       {IkOrientation::kFull, IkOrientation::kFree, IkOrientation::kAxisAlong, IkOrientation::kAxisAt}) {
    for (const bool prefers : {false, true}) {
      IkGoal goal{.orientation = orientation, .rotation_weight = 0.5};
      if (prefers) goal.posture = posture;
      all.push_back(goal);
      if (orientation == IkOrientation::kFree) continue;
      goal.position_weight = 0;
      all.push_back(goal);
    }
  }
  return all;
}

template <class T>
class IkGoalLanes : public ::testing::Test {};
using LaneTypes = ::testing::Types<Lanes4, Lanes8, Lanes16>;
TYPED_TEST_SUITE(IkGoalLanes, LaneTypes);

TYPED_TEST(IkGoalLanes, EqualTheScalarBitForBit) {
  using T = TypeParam;
  const LonePanda robot;
  const Tree<float> tree(robot.model);
  const ParamsStorage<float> params(robot.model);
  Workspace<T> ws(tree);
  Workspace<float> scalar_ws(tree);
  std::size_t number = 0;
  for (const IkGoal& goal : goals(robot.arm.neutral)) {
    SCOPED_TRACE("goal " + std::to_string(number++));
    std::vector<T> q(kJoints);
    IkTarget<T> targets{Transform<T>::identity(), Vec3<T>::zero()};
    std::vector<Problem> problems;
    for (int k = 0; k < width_v<T>; ++k) {
      Problem problem = random_problem(robot, tree, params, scalar_ws, static_cast<std::uint32_t>(k));
      if (goal.orientation == IkOrientation::kAxisAlong) problem.target.toward = problem.target.X_WF.R.z;
      for (std::size_t i = 0; i < kJoints; ++i) set_lane(q[i], k, problem.start[i]);
      const auto set = [k](Vec3<T>& to, const Vec3<float>& from) {
        set_lane(to.x, k, from.x);
        set_lane(to.y, k, from.y);
        set_lane(to.z, k, from.z);
      };
      set(targets.X_WF.R.x, problem.target.X_WF.R.x);
      set(targets.X_WF.R.y, problem.target.X_WF.R.y);
      set(targets.X_WF.R.z, problem.target.X_WF.R.z);
      set(targets.X_WF.p, problem.target.X_WF.p);
      set(targets.toward, problem.target.toward);
      problems.push_back(problem);
    }
    const IkSettings settings;
    const IkResult<T> found = solve_goal(tree, params, robot.arm.chain, settings, goal, targets, q.data(), ws);
    int solved = 0;
    for (int k = 0; k < width_v<T>; ++k) {
      Problem& alone = problems[static_cast<std::size_t>(k)];
      const IkResult<float> result =
          solve_goal(tree, params, robot.arm.chain, settings, goal, alone.target, alone.start.data(), scalar_ws);
      solved += result.success;
      EXPECT_EQ(lane(found.success, k), result.success);
      EXPECT_EQ(lane(found.position_error, k), result.position_error);
      EXPECT_EQ(lane(found.rotation_error, k), result.rotation_error);
      for (std::size_t i = 0; i < kJoints; ++i)
        ASSERT_EQ(std::bit_cast<std::uint32_t>(lane(q[i], k)), std::bit_cast<std::uint32_t>(alone.start[i]))
            << "lane " << k << ", joint " << i;
    }
    EXPECT_GT(solved, 0);
  }
}

TEST(IkGoal, OfAWholePoseIsSolveIk) {
  const LonePanda robot;
  const Tree<float> tree(robot.model);
  const ParamsStorage<float> params(robot.model);
  Workspace<float> ws(tree);
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    const Problem problem = random_problem(robot, tree, params, ws, seed);
    std::vector<float> q = problem.start, expected = problem.start;
    (void)solve_goal(tree, params, robot.arm.chain, {}, {}, problem.target, q.data(), ws);
    (void)solve_ik(tree, params, robot.arm.chain, {}, problem.target.X_WF, expected.data(), ws);
    EXPECT_EQ(q, expected) << "seed " << seed;
  }
}

/// The smallest rotation takes one direction to the other, also where they are opposite and nearly so.
TEST(IkGoal, RotatesBetweenDirections) {
  for (const double angle : {0.0, 1e-7, 0.5, 3.1, std::numbers::pi - 1e-4, std::numbers::pi}) {
    for (const Vec3<double>& a : {Vec3<double>{1, 0, 0}, Vec3<double>{0, 1, 0}, Vec3<double>{0.6, 0, -0.8}}) {
      const Vec3<double> about = std::abs(a.y) < 0.5 ? Vec3<double>{0, 1, 0} : Vec3<double>{1, 0, 0};
      const Vec3<double> b = to_matrix(quat_from_rotation_vector(angle * about)) * a;
      const Vec3<double> r = internal::rotation_between(a, b);
      EXPECT_NEAR(norm(r), angle, 1e-9);
      EXPECT_LT(norm(to_matrix(quat_from_rotation_vector(r)) * a - b), 1e-9) << angle;
    }
  }
}

TEST(IkGoal, RefusesWhatMakesNoSense) {
  const LonePanda robot;
  const auto refused = [&](const IkGoal& goal, const std::string& text) {
    try {
      (void)search_ik(robot.model, robot.arm.hand, goal, {}, robot.arm.neutral);
      FAIL() << text;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
    }
  };
  refused({.orientation = IkOrientation::kFree, .position_weight = 0}, "no position and no orientation");
  refused({.position_weight = -1}, "position_weight");
  refused({.rotation_weight = 0}, "rotation_weight");
  refused({.orientation = IkOrientation::kAxisAt, .axis = {0, 0, 2}}, "unit length");
  refused({.posture = {0.0}}, "posture has 1 numbers");
}

}  // namespace
}  // namespace manyhands
