#include <gtest/gtest.h>

#include <limits>

#include "manyhands/model/model_builder.h"
#include "manyhands/physics/world/world.h"
#include "tests/physics/dynamics/random_tree.h"

namespace manyhands {
namespace {

std::shared_ptr<const Model> hinge(double lower, double upper, double gravity = 9.81) {
  ModelBuilder builder("hinge");
  builder.set_gravity({0, 0, -gravity});
  const LinkId rod = builder.add_link("rod", {.mass = 1, .com = {0, 0, -0.5}, .inertia = {0.1, 0.1, 0.01, 0, 0, 0}});
  builder.add_joint({.name = "hinge",
                     .type = JointType::kRevolute,
                     .parent = builder.world(),
                     .child = rod,
                     .axis = {0, 1, 0},
                     .limits = {.lower = lower, .upper = upper}});
  return std::make_shared<const Model>(builder.build());
}

std::vector<double> all(const World& world, double value) {
  return std::vector<double>(static_cast<std::size_t>(world.model().nv()), value);
}

void drive(World& world, double max_force) {
  const std::vector<double> q = all(world, 0.3), v = all(world, 0), kp = all(world, 0.1), kd = all(world, 1),
                            force = all(world, max_force);
  world.set_motors({.target_q = q, .target_v = v, .kp = kp, .kd = kd, .max_force = force});
}

TEST(World, ContinuesFromASnapshotWithTheSameBits) {
  const auto model = std::make_shared<const Model>(testing::random_tree(4, 9));
  World world(model, 0.001);
  drive(world, 2.0);
  world.step(20);
  const std::vector<std::uint8_t> snapshot = world.snapshot();
  const std::uint64_t hash = world.state_hash();
  world.step(30);
  const std::uint64_t later = world.state_hash();
  EXPECT_NE(later, hash);

  World other(model, 0.001);  // motors come with the snapshot
  other.restore(snapshot);
  EXPECT_EQ(other.state_hash(), hash);
  EXPECT_DOUBLE_EQ(other.time(), 0.02);
  other.step(30);
  EXPECT_EQ(other.state_hash(), later);
  EXPECT_THROW(other.restore(std::span(snapshot).first(3)), std::invalid_argument);
}

TEST(World, MotorReachesItsTargetAndHoldsIt) {
  World world(hinge(-1, 1));
  drive(world, 100);
  world.step(1000);
  EXPECT_NEAR(world.q()[0], 0.3, 1e-9);
}

TEST(World, LimitStopsTheFall) {
  World world(hinge(-0.5, 0.5));
  world.set_q(std::vector{0.4});
  world.set_v(std::vector{20.0});
  for (int i = 0; i < 2000; ++i) {
    world.step();
    ASSERT_LT(world.q()[0], 0.5 + 1e-9);
    ASSERT_GT(world.q()[0], -0.5 - 1e-9);
  }
}

TEST(World, RungeKuttaRefusesMotorsAndLimits) {
  World world(hinge(-0.5, 0.5), 0.001, Integrator::kRungeKutta4);
  drive(world, 1);
  EXPECT_THROW(world.step(), std::runtime_error);
  drive(world, 0);
  world.step(10);
  world.set_v(std::vector{5.0});
  try {
    world.step(1000);
    FAIL() << "it went through the limit";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("'hinge'"), std::string::npos) << error.what();
  }
  EXPECT_LE(world.q()[0], 0.5);
}

TEST(World, AJointFarOutsideItsLimitsReturnsAtAModestSpeed) {
  World world(hinge(-1, 1, 0));
  world.set_q(std::vector{10.0});
  double fastest = 0;
  for (int i = 0; i < 5000; ++i) {
    world.step(1);
    fastest = std::max(fastest, std::abs(world.v()[0]));
  }
  EXPECT_LE(fastest, 1 + 1e-9);
  EXPECT_LE(world.q()[0], 1 + 1e-3);
}

TEST(World, RefusesWhatIsNoState) {
  EXPECT_THROW(World(nullptr), std::invalid_argument);
  EXPECT_THROW(World(hinge(-1, 1), 0.0), std::invalid_argument);
  World world(hinge(-1, 1));
  EXPECT_THROW(world.set_q(std::vector{1.0, 2.0}), std::invalid_argument);
  EXPECT_THROW(world.set_v(std::vector{std::numeric_limits<double>::quiet_NaN()}), std::invalid_argument);
  EXPECT_THROW(world.step(-1), std::invalid_argument);
  EXPECT_THROW(world.restore(World(hinge(-1, 1), 0.01).snapshot()), std::invalid_argument);
  std::vector<std::uint8_t> spoilt = world.snapshot();
  spoilt.back() ^= 1;
  EXPECT_THROW(world.restore(spoilt), std::invalid_argument);
  const std::vector<double> one{1.0}, negative{-1.0};
  EXPECT_THROW(world.set_motors({.target_q = one, .target_v = one, .kp = one, .kd = one, .max_force = negative}),
               std::invalid_argument);

  ModelBuilder builder;
  const LinkId ball = builder.add_link("ball", {.mass = 1, .inertia = {1, 1, 1, 0, 0, 0}});
  builder.add_joint({.name = "free", .type = JointType::kFloating, .parent = builder.world(), .child = ball});
  World free(std::make_shared<const Model>(builder.build()));
  EXPECT_THROW(free.set_q(std::vector<double>(7, 0.0)), std::invalid_argument);
}

}  // namespace
}  // namespace manyhands
