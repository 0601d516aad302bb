// World::diagnose: what commonly goes wrong is told, and nothing else.
#include <gtest/gtest.h>

#include "manyhands/model/model_builder.h"
#include "manyhands/physics/world/world.h"

namespace manyhands {
namespace {

NewBody ball(const std::string& name, double x) {
  return {.name = name,
          .shape = {.type = ShapeType::kSphere, .size = {0.05, 0, 0}},
          .mass = 0.2,
          .X_WB = {Mat3<double>::identity(), {x, 0, 1}}};
}

/// A weight of 2 kg, half a metre from its hinge: 9.81 N m hold it level.
World lever(double max_force) {
  ModelBuilder builder("lever");
  const LinkId link = builder.add_link("lever", {.mass = 2, .com = {0.5, 0, 0}, .inertia = {0.1, 0.1, 0.1, 0, 0, 0}});
  builder.add_joint({.name = "hinge",
                     .type = JointType::kRevolute,
                     .parent = builder.world(),
                     .child = link,
                     .axis = {0, -1, 0},
                     .limits = {.lower = -1, .upper = 1}});
  World world(std::make_shared<Model>(builder.build()));
  world.set_joint_motor(JointId(0), {.target_q = 0, .kp = 0.1, .kd = 1, .max_force = max_force});
  world.step();
  return world;
}

std::vector<std::string> kinds(const World& world) {
  std::vector<std::string> found;
  for (const Finding& finding : world.diagnose()) found.push_back(finding.kind);
  return found;
}

using Kinds = std::vector<std::string>;

TEST(WorldDiagnosis, WhatFallsWithoutAPlane) {
  World world;
  world.add_body(ball("first", 0));
  world.add_body(ball("second", 1));
  EXPECT_EQ(kinds(world), Kinds{"no_step"});
  world.step(100);
  const std::vector<Finding> found = world.diagnose();
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].kind, "no_ground");
  EXPECT_EQ(found[0].parts, (Kinds{"first", "second"}));
  world.remove("first");
  EXPECT_EQ(world.diagnose()[0].parts, Kinds{"second"});
  world.add_body({.name = "floor", .shape = {.type = ShapeType::kPlane}, .fixed = true});
  EXPECT_EQ(kinds(world), Kinds{});
}

TEST(WorldDiagnosis, WhatFallsUpwardsHasItsGravityWrong) {
  World world;
  world.add_body({.name = "floor", .shape = {.type = ShapeType::kPlane}, .fixed = true});
  world.add_body(ball("ball", 0));
  world.set_gravity({0, 0, 9.81});
  world.step(100);
  EXPECT_EQ(kinds(world), Kinds{"gravity"});
}

TEST(WorldDiagnosis, AMotorIsTooWeakBelowWhatStaticsAsks) {
  EXPECT_EQ(kinds(lever(9.9)), Kinds{});
  EXPECT_EQ(kinds(lever(9.7)), Kinds{"weak_motor"});
  EXPECT_NE(lever(9.7).diagnose()[0].text.find("'hinge': its motor gives all that it may, 9.7 N m; to hold still takes "
                                               "9.81 N m"),
            std::string::npos);
}

TEST(WorldDiagnosis, ATargetBeyondALimit) {
  World world = lever(20);
  world.set_joint_motor(JointId(0), {.target_q = 1.5, .kp = 0.1, .kd = 1, .max_force = 20});
  EXPECT_EQ(kinds(world), Kinds{"target_beyond_limit"});
  world.set_joint_motor(JointId(0), {.target_q = 1.5, .kp = 0.1, .kd = 1, .max_force = 0});  // a motor that is off
  EXPECT_EQ(kinds(world), Kinds{});
}

}  // namespace
}  // namespace manyhands
