// Parts of a world by ids, equality constraints that come and go, and a time step that changes.
#include <gtest/gtest.h>

#include <array>

#include "manyhands/model/model_builder.h"
#include "manyhands/physics/collision/queries/queries.h"
#include "manyhands/physics/world/world.h"

namespace manyhands {
namespace {

NewBody box(const std::string& name, const Vec3<double>& p, bool fixed = false) {
  return {
      .name = name, .shape = {ShapeType::kBox, {0.1, 0.1, 0.1}}, .X_WB = {Mat3<double>::identity(), p}, .fixed = fixed};
}

/// An arm of one link, 1 kg, 0.5 m out, on a hinge across x with limits.
Model pendulum() {
  ModelBuilder builder("pendulum");
  const LinkId base = builder.add_link("base");
  const LinkId rod = builder.add_link("rod", {.mass = 1, .com = {0.5, 0, 0}, .inertia = {0.01, 0.01, 0.01, 0, 0, 0}});
  Joint hinge{.name = "hinge", .type = JointType::kRevolute, .parent = base, .child = rod, .axis = {0, 1, 0}};
  hinge.limits = {.lower = -1, .upper = 1};
  builder.add_joint(hinge);
  return builder.build();
}

TEST(WorldIds, NameTheSamePartsAsNames) {
  World world(0.002);
  world.add_body(box("ground", {0, 0, -0.1}, true));
  world.add_body(box("cube", {0.3, 0, 1}));
  const LinkId cube = world.parts().link_id("cube");
  world.add_body(box("other", {1, 0, 1}));
  EXPECT_EQ(world.parts().link_id("cube"), cube) << "parts that come leave the others their ids";
  EXPECT_EQ(norm(world.link_pose(cube).p - world.body_pose("cube").p), 0);
  world.set_link_velocity(cube, {{0, 0, 1}, {0.5, 0, 0}});
  EXPECT_EQ(world.body_velocity("cube").v.x, 0.5);
  world.apply_link_force(cube, {0, 0, 1000}, {0, 0, 0}, world.link_pose(cube).p);
  world.step();
  EXPECT_GT(world.link_velocity(cube).v.z, 1);
  EXPECT_THROW((void)world.link_pose(LinkId(99)), std::out_of_range);
  const std::int64_t before = world.edition();
  world.remove("other");
  world.step();
  EXPECT_GT(world.edition(), before);
}

TEST(WorldIds, JointsAreReadAndDriven) {
  World world(0.002);
  world.add(pendulum());
  const JointId hinge = world.parts().joint_id("hinge");
  const std::array<double, 1> q{0.3}, v{0.2};
  world.set_joint(hinge, q, v);
  EXPECT_EQ(world.joint_q(hinge)[0], 0.3);
  EXPECT_EQ(world.joint_v(hinge)[0], 0.2);
  world.set_joint_motor(hinge, {.target_q = 0.3, .kp = 0.1, .kd = 1, .max_force = 100});
  world.step(500);
  EXPECT_NEAR(world.joint_q(hinge)[0], 0.3, 1e-9);
  EXPECT_NEAR(std::abs(world.joint_forces(hinge)[0]), 9.81 * 0.5 * std::cos(0.3), 1e-6);
  world.set_joint_limits(hinge, -0.1, 0.1);
  world.set_joint_motor(hinge, {});
  world.set_joint(hinge, std::array{0.0}, std::array{0.0});
  world.step(1000);
  EXPECT_NEAR(world.joint_q(hinge)[0], 0.1, 1e-3) << "it hangs on its new limit";
  EXPECT_THROW(world.set_joint_motor(hinge, {.max_force = -1}), std::invalid_argument);
  EXPECT_THROW(world.set_joint_limits(hinge, 1, 0), std::invalid_argument);
}

TEST(WorldIds, MassPropertiesChangeWhatForcesDo) {
  World world(0.002);
  world.set_gravity({0, 0, 0});
  world.add_body(box("cube", {0, 0, 0}));
  const LinkId cube = world.parts().link_id("cube");
  world.set_link_inertial(cube, {.mass = 4, .com = {0, 0, 0}, .inertia = {0.5, 0.5, 0.5, 0, 0, 0}});
  world.apply_link_force(cube, {8, 0, 0}, {0, 0, 1}, {0, 0, 0});
  world.step();
  EXPECT_NEAR(world.link_velocity(cube).v.x, 8.0 / 4 * 0.002, 1e-15);
  EXPECT_NEAR(world.link_velocity(cube).w.z, 1 / 0.5 * 0.002, 1e-15);
  EXPECT_THROW(world.set_link_inertial(cube, {.mass = 0}), std::invalid_argument);
}

TEST(WorldIds, EqualityConstraintsComeAndGo) {
  World world(0.002);
  world.add_body(box("cube", {0, 0, 1}));
  const LinkId cube = world.parts().link_id("cube");
  EqualityConstraint weld{.name = "weld", .type = EqualityType::kFixed, .link_a = cube, .link_b = LinkId(0)};
  weld.X_LB.p = {0, 0, 1};
  world.add_equality(weld);
  world.step(200);
  EXPECT_NEAR(world.link_pose(cube).p.z, 1, 1e-6);
  weld.X_LB.p = {0, 0, 1.05};
  world.set_equality(weld);
  world.step(500);
  EXPECT_NEAR(world.link_pose(cube).p.z, 1.05, 1e-6);
  world.remove_equality("weld");
  world.step(100);
  EXPECT_LT(world.link_pose(cube).p.z, 0.9);
  EXPECT_THROW(world.remove_equality("weld"), std::out_of_range);
}

TEST(WorldIds, TheTimeStepChangesAndTimeGoesOn) {
  World world(0.002);
  world.add_body(box("cube", {0, 0, 100}));
  world.step(100);
  world.set_time_step(0.01);
  world.step(10);
  EXPECT_NEAR(world.time(), 0.3, 1e-12);
  EXPECT_NEAR(world.body_velocity("cube").v.z, -9.81 * 0.3, 1e-12);
  EXPECT_THROW(world.set_time_step(0), std::invalid_argument);
}

TEST(WorldIds, LinksMayBeKeptApart) {
  World world(0.002);
  world.add_body(box("ground", {0, 0, -0.1}, true));
  world.add_body(box("cube", {0, 0, 0.1}));
  const LinkId ground = world.parts().link_id("ground"), cube = world.parts().link_id("cube");
  EXPECT_NEAR(world.link_distance(ground, cube)->surfaces.phi, 0, 1e-12);
  world.set_link_collision(ground, cube, false);
  world.step(100);
  EXPECT_LT(world.link_pose(cube).p.z, 0);
}

}  // namespace
}  // namespace manyhands
