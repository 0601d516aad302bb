// panda-gym's laws in a world that people build: drag turns no spin aside, and the inverse kinematics of an action.
#include <gtest/gtest.h>

#include "manyhands/envs/panda.h"
#include "manyhands/envs/panda_gym.h"
#include "manyhands/envs/tasks/slide.h"

namespace manyhands {
namespace {

constexpr double kTimeStep = 0.002;

TEST(StepInAir, SlowsASpinAboutATiltedAxisWithoutTurningIt) {
  const auto objects = Slide{}.objects();
  World world(std::make_shared<const Model>(task_scene(panda_arm(), Table{}, objects)), kTimeStep);
  const Quat<double> r = quat_from_rotation_vector(Vec3<double>{0.7, -0.4, 0.2});
  const Transform<double> X_WL{to_matrix(r), {0, 0, 2}};
  const Vec3<double> spin = 5.0 * X_WL.R.x;  // about a principal axis that is not the puck's own
  world.set_body_pose("object", X_WL);
  world.set_body_velocity("object", {spin, Vec3<double>::zero()});
  const std::vector<std::string> links{"object"};
  step_in_air(world, 1, links);
  const double left = 1 - kTimeStep * 0.04 * (1 + 5);
  EXPECT_LT(norm(world.body_velocity("object").w - left * spin), 1e-9);
  for (const double tau : world.tau()) EXPECT_EQ(tau, 0);
  EXPECT_THROW(step_in_air(world, 1, std::vector<std::string>{"panda_link3"}), std::invalid_argument);
}

TEST(Approach, FallsShortAsPandaGymDoesAndLeavesWhatNoJointMoves) {
  const LonePanda panda;
  const Model& model = panda.model;
  std::vector<double> q(static_cast<std::size_t>(model.nq()));
  std::ranges::copy(panda.arm.neutral, q.begin());
  World world(std::make_shared<const Model>(model), kTimeStep);
  world.set_q(q);
  const Mat3<double> down{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  const Vec3<double> step{0.05, 0, 0}, p = world.body_pose("panda_grasptarget").p;
  const std::vector<double> there = approach(model, panda.arm.hand, {down, p + step}, q);
  EXPECT_NEAR(there[1], 0.50923, 1e-5);
  world.set_q(there);
  EXPECT_NEAR(world.body_pose("panda_grasptarget").p.x - p.x, 0.05 - 0.0153, 1e-4);
  EXPECT_EQ(approach(model, model.frame_id("panda_link0"), {down, p}, q), q);
}

}  // namespace
}  // namespace manyhands
