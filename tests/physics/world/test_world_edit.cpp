// Parts that come and go, parameters of one world, and drives.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/physics/world/world_scenes.h"

namespace manyhands {
namespace {

using testing::stack;

NewBody box(const std::string& name, const Vec3<double>& p, double mass = 0.1) {
  return {.name = name,
          .shape = {.type = ShapeType::kBox, .size = {0.02, 0.02, 0.02}},
          .mass = mass,
          .X_WB = {Mat3<double>::identity(), p}};
}

NewBody floor() { return {.name = "floor", .shape = {.type = ShapeType::kPlane}, .fixed = true}; }

/// A world that was edited goes on as one that was built that way, in the middle of contact, bit for bit.
TEST(WorldEdit, WhatStaysGoesOnAsIfNothingHadHappened) {
  World world;
  world.add_body(floor());
  world.add_body(box("a", {0, 0, 0.021}));
  world.add_body(box("b", {0.001, 0, 0.062}));
  World alone = world;
  world.step(100);
  alone.step(100);
  world.add_body(box("far", {5, 0, 0.3}));
  EXPECT_EQ(world.q().size(), 21u);
  world.step(20);
  alone.step(20);
  world.remove("far");
  world.step(20);
  alone.step(20);
  ASSERT_EQ(world.q().size(), alone.q().size());
  EXPECT_TRUE(std::ranges::equal(world.q(), alone.q()));
  EXPECT_TRUE(std::ranges::equal(world.v(), alone.v()));
}

TEST(WorldEdit, RemovingTheLowerLetsTheUpperFall) {
  World world;
  world.add_body(floor());
  world.add_body(box("low", {0, 0, 0.02}));
  world.add_body(box("high", {0, 0, 0.06}));
  world.step(200);
  EXPECT_NEAR(world.body_pose("high").p.z, 0.06, 1e-3);
  world.remove("low");
  EXPECT_EQ(world.names(), (std::vector<std::string>{"floor", "high"}));
  world.step(500);
  EXPECT_NEAR(world.body_pose("high").p.z, 0.02, 1e-3);
  EXPECT_THROW(world.remove("low"), std::out_of_range);
  world.add_body(box("low", {0.3, 0, 0.1}));  // the name is free again
  EXPECT_NEAR(world.body_pose("low").p.z, 0.1, 1e-15);
}

TEST(WorldEdit, RobotsJoinUnderNamesOfTheirOwn) {
  const LoadedModel panda = load_urdf(asset_path("panda/panda.urdf"));
  World world;
  world.add(panda.model, {Mat3<double>::identity(), {0, 1, 0}}, "left");
  world.add(panda.model, {Mat3<double>::identity(), {0, -1, 0}}, "right");
  EXPECT_EQ(world.q().size(), 2u * static_cast<std::size_t>(panda.model.nq()));
  EXPECT_EQ(world.names(), (std::vector<std::string>{"left", "right"}));
  const Vec3<double> apart = world.body_pose("left/panda_hand").p - world.body_pose("right/panda_hand").p;
  EXPECT_NEAR(norm(apart - Vec3<double>{0, 2, 0}), 0, 1e-12);
  EXPECT_THROW(world.add(panda.model, Transform<double>::identity(), "left"), ModelError);
  EXPECT_EQ(world.q().size(), 2u * static_cast<std::size_t>(panda.model.nq()));

  World alone(std::make_shared<const Model>(panda.model));
  world.step(100);
  alone.step(100);
  for (std::size_t i = 0; i < alone.q().size(); ++i) EXPECT_NEAR(world.q()[i], alone.q()[i], 1e-9) << i;
  world.remove("left");
  EXPECT_EQ(world.names(), (std::vector<std::string>{"right"}));
  for (std::size_t i = 0; i < alone.q().size(); ++i) EXPECT_NEAR(world.q()[i], alone.q()[i], 1e-9) << i;
}

TEST(WorldEdit, ParametersAndCommandsComeAlong) {
  World world(stack(1));
  world.set_friction("cube0", 0.9);
  world.set_mass("cube0", 0.3);
  world.set_gravity({0, 0, -5});
  world.set_damping("cube0_free", 0.2);
  world.set_geom_size("cube0", {0.03, 0.03, 0.03});
  world.set_tau(std::vector{0.0, 0.0, 0.0, 0.0, 0.0, 0.5});
  world.add_body(box("other", {1, 0, 1}));
  EXPECT_EQ(world.friction("cube0"), 0.9);
  EXPECT_EQ(world.mass("cube0"), 0.3);
  EXPECT_EQ(world.gravity().z, -5);
  EXPECT_EQ(world.damping("cube0_free"), 0.2);
  EXPECT_EQ(world.geom_size("cube0").x, 0.03);
  EXPECT_EQ(world.tau()[5], 0.5);
}

/// A body thrown upwards with another mass and the same momentum rises by another height; inertia follows mass.
TEST(WorldParameters, MassScalesInertia) {
  ModelBuilder builder;
  builder.set_gravity({0, 0, 0});
  testing::add_cube(builder, "cube", {0, 0, 0}, 0.1);
  World world(std::make_shared<const Model>(builder.build()), 0.01);
  world.set_mass("cube", 0.4);
  world.apply_force("cube", {1, 0, 0}, {0, 0, 0.001});
  world.step();
  EXPECT_NEAR(world.body_velocity("cube").v.x, 0.01 / 0.4, 1e-12);
  EXPECT_NEAR(world.body_velocity("cube").w.z, 0.01 * 0.001 / (0.4 / 6 * 0.04 * 0.04), 1e-9);
}

TEST(WorldEdit, RefusesWhatIsNoBody) {
  World world;
  EXPECT_THROW(world.add_body(box("a", {0, 0, 0}, 0)), ModelError);
  EXPECT_THROW(world.add_body(box("a", {0, 0, 0}, -1)), ModelError);
  EXPECT_THROW(world.add_body({.name = "a", .shape = {.type = ShapeType::kSphere, .size = {0, 0, 0}}}),
               std::invalid_argument);
  EXPECT_THROW(world.add_body({.name = "a", .shape = {.type = ShapeType::kPlane}}), ModelError);
  EXPECT_THROW(world.add_body(box("", {0, 0, 0})), ModelError);
  EXPECT_THROW(world.add_body(box("a", {0, 0, 0}, 1e-12)), ModelError);  // no inertia to speak of
  world.add_body(box("a", {0, 0, 0}));
  EXPECT_THROW(world.add_body(box("a", {0, 0, 0})), ModelError);
  EXPECT_EQ(world.names(), (std::vector<std::string>{"a"}));
}

TEST(WorldDrives, CommandsStayInRangeAndMotorsStayAway) {
  ModelBuilder builder;
  const LinkId rod = builder.add_link("rod", {.mass = 1, .inertia = {0.1, 0.1, 0.1, 0, 0, 0}});
  const JointId hinge =
      builder.add_joint({.name = "hinge", .type = JointType::kContinuous, .parent = builder.world(), .child = rod});
  builder.add_actuator({.name = "servo",
                        .type = ActuatorType::kPosition,
                        .joint = hinge,
                        .kp = 10,
                        .kd = 2,
                        .min_ctrl = -1,
                        .max_ctrl = 1});
  World world(std::make_shared<const Model>(builder.build()));
  world.set_ctrl(std::vector{5.0});
  EXPECT_EQ(world.ctrl()[0], 1);
  world.step(5000);
  EXPECT_NEAR(world.q()[0], 1, 1e-6);
  const std::vector<double> zero{0.0}, one{1.0};
  try {
    world.set_motors({.target_q = zero, .target_v = zero, .kp = zero, .kd = one, .max_force = one});
    FAIL() << "no error";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("'hinge'"), std::string::npos) << error.what();
  }
  world.set_gains("servo", 20, 3);
  EXPECT_EQ(world.gains("servo"), (std::pair{20.0, 3.0}));
  EXPECT_THROW(world.set_gains("servo", -1, 0), std::invalid_argument);
}

TEST(WorldFiles, AreToldByTheirContent) {
  const World world = World::from_file(asset_path("panda/panda.urdf"));
  EXPECT_EQ(world.time_step(), 0.002);
  EXPECT_GT(world.q().size(), 6u);
  EXPECT_THROW((void)World::from_file("nowhere.xml"), FileNotFound);
}

}  // namespace
}  // namespace manyhands
