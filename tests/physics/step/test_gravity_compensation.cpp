// Gravity compensation: bodies that float, and the energy of those that it carries in part.
#include <gtest/gtest.h>

#include "manyhands/physics/world/batch.h"
#include "manyhands/physics/world/world.h"
#include "tests/physics/dynamics/random_tree.h"

namespace manyhands {
namespace {

/// A random tree, each link carried by the share that `share(i)` gives.
template <class Share>
std::shared_ptr<const Model> carried_tree(std::uint64_t seed, Share&& share) {
  testing::Generator rng(seed);
  const JointType types[] = {JointType::kRevolute, JointType::kSpherical, JointType::kFixed, JointType::kPrismatic,
                             JointType::kPlanar};
  ModelBuilder builder("tree");
  LinkId parent = builder.world();
  for (int i = 0; i < 5; ++i) {
    const LinkId link = builder.add_link("link" + std::to_string(i), testing::random_inertial(rng));
    builder.link(link).gravity_compensation = share(i);
    builder.add_joint({.name = "joint" + std::to_string(i),
                       .type = types[i],
                       .parent = parent,
                       .child = link,
                       .X_PF = {to_matrix(testing::random_rotation(rng)), testing::random_vector(rng, 0.4)},
                       .axis = testing::random_vector(rng, 1)});
    parent = link;
  }
  return std::make_shared<const Model>(builder.build());
}

TEST(GravityCompensation, WhatItCarriesWhollyStaysAtRest) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    World world(carried_tree(seed, [](int) { return 1.0; }));
    world.step(500);
    for (const double v : world.v()) EXPECT_NEAR(v, 0, 1e-11) << seed;
  }
}

TEST(GravityCompensation, AFreeBodyFallsByTheShareThatIsLeft) {
  ModelBuilder builder("ball");
  const LinkId link = builder.add_link("ball", {.mass = 2, .com = {0.1, 0, 0}, .inertia = {1, 1, 1, 0, 0, 0}});
  builder.link(link).gravity_compensation = 0.75;
  builder.add_joint({.name = "free", .type = JointType::kFloating, .parent = builder.world(), .child = link});
  World world(std::make_shared<const Model>(builder.build()), 0.002);
  world.step(500);
  EXPECT_NEAR(world.v()[5], -0.25 * 9.81, 1e-12);
  EXPECT_NEAR(world.q()[2], -0.5 * 0.25 * 9.81, 1e-12);
  EXPECT_NEAR(world.v()[0], 0, 1e-12);
}

/// Links of one body may be carried by different shares: the force acts at the centre of what it carries.
TEST(GravityCompensation, KeepsTheEnergy) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    World world(carried_tree(seed, [](int i) { return 0.3 * i - 0.2; }), 5e-4, Integrator::kRungeKutta4);
    const double before = world.energy().kinetic + world.energy().potential;
    world.step(400);
    EXPECT_NEAR(world.energy().kinetic + world.energy().potential, before, 1e-6) << seed;
    EXPECT_GT(world.energy().kinetic, 1e-3);
  }
}

/// Two links of one body, carried by different shares, and a free ball.
std::shared_ptr<const Model> mixed(double mass, double ball_mass) {
  const auto ball_inertia = [](double I) { return SymMat3<double>{I, I, I, 0, 0, 0}; };
  ModelBuilder builder("mixed");
  const LinkId arm = builder.add_link("arm", {.mass = 2, .com = {0.3, 0, 0}, .inertia = ball_inertia(1)});
  const LinkId load = builder.add_link("load", {.mass = mass, .com = {0, 0.1, 0}, .inertia = ball_inertia(mass / 3)});
  const LinkId ball = builder.add_link("ball", {.mass = ball_mass, .com = {}, .inertia = ball_inertia(ball_mass)});
  builder.link(arm).gravity_compensation = 1;
  builder.link(load).gravity_compensation = -1;
  builder.link(ball).gravity_compensation = 0.5;
  builder.add_joint(
      {.name = "hinge", .type = JointType::kRevolute, .parent = builder.world(), .child = arm, .axis = {0, 1, 0}});
  builder.add_joint({.name = "fixed", .parent = arm, .child = load, .X_PF = {Mat3<double>::identity(), {0.6, 0, 0}}});
  builder.add_joint({.name = "free", .type = JointType::kFloating, .parent = builder.world(), .child = ball});
  return std::make_shared<const Model>(builder.build());
}

TEST(GravityCompensation, FollowsMassesThatAreSet) {
  World world(mixed(3, 1)), expected(mixed(5, 7));
  world.set_mass("load", 5);
  world.set_mass("ball", 7);
  // Parts that come change no numbers of those that are there.
  world.add_body({.name = "other", .shape = {.type = ShapeType::kSphere, .size = {0.1, 0, 0}}});
  Batch batch(mixed(3, 1), 2, 0.002, {.num_threads = 1});
  batch.set_mass("load", std::array{3.0f, 5.0f});
  world.step(100);
  expected.step(100);
  batch.step(100);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(world.q()[i], expected.q()[i], 1e-12) << i;
  EXPECT_NEAR(batch.q()[8], expected.q()[0], 1e-5);
  EXPECT_GT(std::abs(expected.q()[0]), 0.1);
  EXPECT_GT(std::abs(batch.q()[0] - batch.q()[8]), 1e-3);
}

}  // namespace
}  // namespace manyhands
