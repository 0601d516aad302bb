// The drag of a medium: terminal speeds and decay by formula, and bodies that it holds fast.
#include <gtest/gtest.h>

#include <numbers>

#include "manyhands/model/equivalent_box.h"
#include "manyhands/model/model_builder.h"
#include "manyhands/physics/world/batch.h"
#include "manyhands/physics/world/world.h"
#include "tests/physics/dynamics/random_tree.h"

namespace manyhands {
namespace {

constexpr double kMass = 2, kStep = 0.002;
const Vec3<double> kSize{0.3, 0.2, 0.1};

/// A box whose axes are those of the world, turned as `order` says, free in a medium.
ModelBuilder box_in(const Medium& medium) {
  const auto moment = [](double a, double b) { return kMass / 12 * (a * a + b * b); };
  const SymMat3<double> inertia{moment(kSize.y, kSize.z), moment(kSize.x, kSize.z), moment(kSize.x, kSize.y), 0, 0, 0};
  ModelBuilder builder("box");
  builder.set_medium(medium);
  const LinkId link = builder.add_link("box", {.mass = kMass, .com = {}, .inertia = inertia});
  builder.add_joint({.name = "free", .type = JointType::kFloating, .parent = builder.world(), .child = link});
  return builder;
}

World world_of(const ModelBuilder& builder) { return World(std::make_shared<const Model>(builder.build()), kStep); }

TEST(Drag, TheEquivalentBoxHasTheSameInertia) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    testing::Generator rng(seed);
    const Inertial inertial = testing::random_inertial(rng);
    const auto [X, size] = equivalent_box(inertial);
    const auto moment = [&](double a, double b) { return inertial.mass / 12 * (a * a + b * b); };
    const SymMat3<double> own{moment(size.y, size.z), moment(size.x, size.z), moment(size.x, size.y), 0, 0, 0};
    const SymMat3<double> found = rotated(X.R, own);
    EXPECT_NEAR(found.xx, inertial.inertia.xx, 1e-12);
    EXPECT_NEAR(found.yz, inertial.inertia.yz, 1e-12);
    EXPECT_NEAR(found.xy, inertial.inertia.xy, 1e-12);
    EXPECT_EQ(X.p.x, inertial.com.x);
  }
}

TEST(Drag, ABoxFallsAtItsTerminalSpeed) {
  World world = world_of(box_in({.density = 1.2}));
  world.step(20000);
  EXPECT_NEAR(world.v()[5], -std::sqrt(2 * kMass * 9.81 / (1.2 * kSize.x * kSize.y)), 1e-9);
}

TEST(Drag, WindTakesABoxAlong) {
  ModelBuilder builder = box_in({.viscosity = 3, .wind = {1, -2, 0.5}});
  builder.set_gravity({});
  World world = world_of(builder);
  world.step(10000);
  EXPECT_NEAR(world.v()[3], 1, 1e-9);
  EXPECT_NEAR(world.v()[4], -2, 1e-9);
  EXPECT_NEAR(world.v()[5], 0.5, 1e-9);
}

TEST(Drag, SlowMotionDecaysByTheExponential) {
  constexpr double kViscosity = 0.5;
  ModelBuilder builder = box_in({.viscosity = kViscosity});
  builder.set_gravity({});
  const double rate = 3 * std::numbers::pi * (kSize.x + kSize.y + kSize.z) / 3 * kViscosity / kMass;
  for (const bool runge_kutta : {false, true}) {
    World world(std::make_shared<const Model>(builder.build()), kStep,
                runge_kutta ? Integrator::kRungeKutta4 : Integrator::kSemiImplicit);
    world.set_v(std::array{0.0, 0.0, 0.0, 0.0, 1.0, 0.0});
    world.step(500);
    EXPECT_NEAR(world.v()[4], std::exp(-rate), runge_kutta ? 1e-12 : rate * rate * kStep);
  }
}

/// However dense the medium is, nothing is turned back by it.
TEST(Drag, HoldsFastWithoutPushingBack) {
  for (const bool is_dense : {true, false}) {
    ModelBuilder builder = box_in({.density = is_dense ? 1e12 : 0, .viscosity = is_dense ? 0 : 1e12});
    builder.set_gravity({});
    World world = world_of(builder);
    world.set_v(std::array{3.0, -4.0, 5.0, 100.0, 50.0, -30.0});
    double before = world.energy().kinetic;
    for (int n = 0; n < 20; ++n) {
      world.step();
      EXPECT_LE(world.energy().kinetic, before);
      before = world.energy().kinetic;
    }
  }
}

TEST(Drag, ActsOnPartsThatAreAdded) {
  World world = world_of(box_in({.density = 1.2}));
  world.add(box_in({}).build(), Transform<double>::identity(), "late");
  world.step(20000);
  EXPECT_NEAR(world.body_velocity("late/box").v.z, world.body_velocity("box").v.z, 1e-12);
}

TEST(Drag, IsTheSameInLanes) {
  const auto model = std::make_shared<const Model>(box_in({.density = 3, .viscosity = 0.1, .wind = {1, 0, 0}}).build());
  std::vector<std::uint64_t> hashes;
  for (const int lanes : {1, 8, 16}) {
    Batch batch(model, 20, kStep, {.num_threads = 1, .lanes = lanes});
    batch.step(100);
    hashes.push_back(batch.state_hash());
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[0], hashes[2]);
}

TEST(Drag, RefusesWhatIsNoMedium) {
  ModelBuilder builder("none");
  EXPECT_THROW(builder.set_medium({.density = -1}), ModelError);
  EXPECT_THROW(builder.set_medium({.viscosity = std::numeric_limits<double>::quiet_NaN()}), ModelError);
  EXPECT_THROW(builder.set_medium({.wind = {0, std::numeric_limits<double>::infinity(), 0}}), ModelError);
}

}  // namespace
}  // namespace manyhands
