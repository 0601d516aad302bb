// Joint springs: the motions of oscillators by formula, energy, and the bits of lanes.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "manyhands/model/model_builder.h"
#include "manyhands/physics/world/batch.h"
#include "manyhands/physics/world/world.h"
#include "tests/physics/dynamics/random_tree.h"
#include "tests/physics/step/oscillator.h"

namespace manyhands {
namespace {

constexpr double kMass = 2, kStep = 0.002;

/// A block on a slide without gravity, whose spring is at rest at 0.3 m.
std::shared_ptr<const Model> block(double stiffness) {
  ModelBuilder builder("block");
  const LinkId link = builder.add_link("block", {.mass = kMass, .com = {}, .inertia = {1, 1, 1, 0, 0, 0}});
  builder.add_joint({.name = "slide",
                     .type = JointType::kPrismatic,
                     .parent = builder.world(),
                     .child = link,
                     .stiffness = stiffness,
                     .spring_reference = {0.3}});
  builder.set_gravity({});
  return std::make_shared<const Model>(builder.build());
}

/// So amplitudes neither grow nor fall, even where a step takes thousands of periods: there it turns by a right angle.
TEST(Springs, AStepTurnsTheOscillatorAsTheTrapezoidalRule) {
  for (const double stiffness : {1.0, 1e3, 1e6, 1e12}) {
    World world(block(stiffness), kStep);
    world.set_q(std::array{0.4});
    const testing::Oscillator oscillator(stiffness, kMass, kStep);
    for (int n = 1; n <= 2000; ++n) {
      world.step();
      ASSERT_NEAR(world.q()[0] - 0.3, oscillator.at(n), 1e-9 * oscillator.scale() * n)
          << stiffness << " N/m, step " << n;
    }
  }
}

/// Half a turn a step, to which the trapezoidal rule tends, would carry q by another 0.2 m in every one.
TEST(Springs, HoweverStiffSwingNoFarther) {
  for (const double stiffness : {1e3, 1e6, 4e6, 1e8, 1e12}) {
    World world(block(stiffness), kStep);
    world.set_q(std::array{0.4});
    for (int n = 0; n < 500; ++n) {
      world.step();
      ASSERT_LT(std::abs(world.q()[0] - 0.3), 0.1 * 1.5) << stiffness << " N/m, step " << n;
    }
  }
}

TEST(Springs, RungeKuttaFollowsTheCosine) {
  World world(block(800), kStep, Integrator::kRungeKutta4);
  world.set_q(std::array{0.4});
  world.step(500);
  EXPECT_NEAR(world.q()[0], 0.3 + 0.1 * std::cos(20 * 500 * kStep), 1e-7);
}

/// A ball on a ball joint, turned about any axis, swings about that axis only, however far: theta = theta_0 cos(w t).
TEST(Springs, ABallJointTurnsBackAlongItsRotationVector) {
  constexpr double kInertia = 0.05, kStiffness = 3;
  ModelBuilder builder("ball");
  const LinkId link =
      builder.add_link("ball", {.mass = 1, .com = {}, .inertia = {kInertia, kInertia, kInertia, 0, 0, 0}});
  const Vec3<double> rest{0.3, -0.2, 0.4}, axis = (1 / norm(Vec3<double>{1, 2, -1})) * Vec3<double>{1, 2, -1};
  const Quat<double> reference = quat_from_rotation_vector(rest);
  const double theta = 2.9;
  const Quat<double> start = quat_from_rotation_vector(theta * axis) * reference;
  builder.add_joint({.name = "ball",
                     .type = JointType::kSpherical,
                     .parent = builder.world(),
                     .child = link,
                     .X_PF = {to_matrix(quat_from_rotation_vector(Vec3<double>{1, 1, 0})), {1, 2, 3}},
                     .stiffness = kStiffness,
                     .initial = {start.x, start.y, start.z, start.w},
                     .spring_reference = {reference.x, reference.y, reference.z, reference.w}});
  World world(std::make_shared<const Model>(builder.build()), 1e-4, Integrator::kRungeKutta4);
  const double omega = std::sqrt(kStiffness / kInertia), time = 1.3;
  const double energy = world.energy().potential;
  EXPECT_NEAR(energy - 0.5 * kStiffness * theta * theta, 9.81 * 3, 1e-12);
  world.step(13000);
  const Vec3<double> expected = theta * std::cos(omega * time) * axis;
  const std::span<const double> q = world.q();
  const Quat<double> back{-reference.x, -reference.y, -reference.z, reference.w};
  const Vec3<double> found = rotation_vector(Quat<double>{q[0], q[1], q[2], q[3]} * back);
  EXPECT_NEAR(norm(found - expected), 0, 1e-6);
}

/// A tree of all kinds of joints with a spring at each.
std::shared_ptr<const Model> sprung_tree(std::uint64_t seed) {
  testing::Generator rng(seed);
  const JointType types[] = {JointType::kFloating,  JointType::kRevolute, JointType::kSpherical,
                             JointType::kPrismatic, JointType::kPlanar,   JointType::kContinuous};
  ModelBuilder builder("tree");
  LinkId parent = builder.world();
  for (int i = 0; i < 6; ++i) {
    const LinkId link = builder.add_link("link" + std::to_string(i), testing::random_inertial(rng));
    builder.add_joint({.name = "joint" + std::to_string(i),
                       .type = types[i],
                       .parent = parent,
                       .child = link,
                       .X_PF = {to_matrix(testing::random_rotation(rng)), testing::random_vector(rng, 0.4)},
                       .axis = testing::random_vector(rng, 1),
                       .stiffness = testing::uniform(rng, 1, 30)});
    parent = link;
  }
  return std::make_shared<const Model>(builder.build());
}

/// Forces and potential energy are written in two places: together they keep the energy, to the integrator's order.
TEST(Springs, KeepTheEnergyOfTrees) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    std::array<double, 2> drift{};
    for (std::size_t k = 0; k < 2; ++k) {
      const double h = k == 0 ? 1e-3 : 5e-4;
      World world(sprung_tree(seed), h, Integrator::kRungeKutta4);
      testing::Generator rng(seed);
      std::vector<double> v(static_cast<std::size_t>(world.model().nv()));
      for (double& x : v) x = testing::uniform(rng, -1, 1);
      world.set_v(v);
      const auto total = [&] { return world.energy().kinetic + world.energy().potential; };
      const double before = total();
      world.step(static_cast<int>(std::lround(0.2 / h)));
      drift[k] = std::abs(total() - before);
    }
    EXPECT_LT(drift[0], 1e-4) << seed;
    EXPECT_LT(drift[1], drift[0] / 8 + 1e-9) << seed;
  }
}

TEST(Springs, LanesHaveTheBitsOfScalars) {
  const auto model = sprung_tree(7);
  const auto states = [&](int lanes) {
    Batch batch(model, 20, kStep, {.num_threads = 1, .lanes = lanes});
    std::vector<float> stiffness(20);
    for (std::size_t i = 0; i < stiffness.size(); ++i) stiffness[i] = i % 3 == 0 ? 0.0f : static_cast<float>(i);
    batch.set_stiffness("joint2", stiffness);
    batch.step(200);
    return batch.q();
  };
  const std::vector<float> scalar = states(1);
  for (const int lanes : {4, 8, 16}) EXPECT_EQ(states(lanes), scalar) << lanes;
}

}  // namespace
}  // namespace manyhands
