// What one step does by formula: motors, limits, damping, gravity.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "manyhands/model/model_builder.h"
#include "manyhands/physics/world/world.h"
#include "tests/physics/dynamics/random_tree.h"

namespace manyhands {
namespace {

using testing::Generator;

/// A chain of hinges and slides, so that gravity and inertia couple all of them.
std::shared_ptr<const Model> chain(std::uint64_t seed, int links, JointLimits limits = {}, double damping = 0) {
  Generator rng(seed);
  ModelBuilder builder("chain");
  LinkId parent = builder.world();
  for (int i = 0; i < links; ++i) {
    const LinkId child = builder.add_link("link" + std::to_string(i), testing::random_inertial(rng));
    builder.add_joint({.name = "joint" + std::to_string(i),
                       .type = i % 3 == 2 ? JointType::kPrismatic : JointType::kRevolute,
                       .parent = parent,
                       .child = child,
                       .X_PF = {to_matrix(testing::random_rotation(rng)), testing::random_vector(rng, 0.4)},
                       .axis = testing::random_vector(rng, 1),
                       .limits = limits,
                       .damping = damping});
    parent = child;
  }
  return std::make_shared<const Model>(builder.build());
}

struct Motors {
  explicit Motors(const World& world, double force)
      : q(size(world)), v(q), kp(q), kd(size(world), 1.0), F(size(world), force) {}
  static std::size_t size(const World& world) { return static_cast<std::size_t>(world.model().nv()); }
  void apply(World& world) const {
    world.set_motors({.target_q = q, .target_v = v, .kp = kp, .kd = kd, .max_force = F});
  }
  std::vector<double> q, v, kp, kd, F;
};

/// panda-gym's motor law: with force enough, 0.9 of the error is left after each step, whatever gravity does.
TEST(Step, AStrongMotorRemovesATenthOfItsErrorPerStep) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    World world(chain(seed, 7), 0.002);
    Generator rng(seed);
    Motors motors(world, 1e9);
    std::vector<double> error(motors.q.size());
    for (std::size_t i = 0; i < error.size(); ++i) {
      motors.q[i] = error[i] = testing::uniform(rng, -1, 1);
      motors.kp[i] = 0.1;
    }
    motors.apply(world);
    for (int step = 0; step < 50; ++step) {
      world.step();
      for (std::size_t i = 0; i < error.size(); ++i) {
        error[i] *= 0.9;
        ASSERT_NEAR(motors.q[i] - world.q()[i], error[i], 1e-12) << "seed " << seed << ", step " << step;
      }
    }
  }
}

TEST(Step, AMotorHoldsItsVelocityAgainstGravity) {
  World world(chain(3, 6), 0.001);
  Motors motors(world, 1e9);
  for (std::size_t i = 0; i < motors.v.size(); ++i) motors.v[i] = 0.1 * static_cast<double>(i) - 0.2;
  motors.apply(world);
  world.step(100);
  for (std::size_t i = 0; i < motors.v.size(); ++i) {
    EXPECT_NEAR(world.v()[i], motors.v[i], 1e-11);
    EXPECT_NEAR(world.q()[i], 0.1 * motors.v[i], 1e-11);
  }
}

/// A saturated motor is a constant force: h F / m per step on a slide, with the sign of what it wants.
TEST(Step, AWeakMotorGivesExactlyItsForce) {
  ModelBuilder builder("slide");
  builder.set_gravity({0, 0, 0});
  const LinkId cart = builder.add_link("cart", {.mass = 4, .inertia = {1, 1, 1, 0, 0, 0}});
  builder.add_joint(
      {.name = "rail", .type = JointType::kPrismatic, .parent = builder.world(), .child = cart, .axis = {1, 0, 0}});
  const auto model = std::make_shared<const Model>(builder.build());
  for (const double sign : {1.0, -1.0}) {
    World world(model, 0.01);
    Motors motors(world, 6);
    motors.q[0] = sign * 100;
    motors.kp[0] = 0.1;
    motors.apply(world);
    double v = 0, q = 0;
    for (int step = 0; step < 40; ++step) {
      world.step();
      v += sign * 0.01 * 6 / 4;
      q += 0.01 * v;
      ASSERT_NEAR(world.v()[0], v, 1e-13);
      ASSERT_NEAR(world.q()[0], q, 1e-13);
    }
  }
}

/// The same on coupled joints: the accelerations are those of forward dynamics under +-F.
TEST(Step, SaturatedMotorsActAsForces) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const auto model = chain(seed, 6);
    World pushed(model, 0.001), forced(model, 0.001);
    Motors motors(pushed, 2);
    Generator rng(seed);
    std::vector<double> tau(motors.q.size());
    for (std::size_t i = 0; i < tau.size(); ++i) {
      const double sign = rng() % 2 == 0 ? 1 : -1;
      motors.v[i] = sign * 1e6;  // [rad/s or m/s], out of reach
      tau[i] = sign * 2;
    }
    motors.apply(pushed);
    forced.set_tau(tau);
    pushed.step(20);
    forced.step(20);
    for (std::size_t i = 0; i < tau.size(); ++i)
      EXPECT_NEAR(pushed.v()[i], forced.v()[i], 1e-9 * (1 + std::abs(forced.v()[i])));
  }
}

TEST(Step, AMotorThatIsSwitchedOffLeavesNothingBehind) {
  const auto model = chain(8, 5);
  World world(model, 0.001), other(model, 0.001);
  Motors motors(world, 2);
  for (double& v : motors.v) v = -1e6;  // pushes down with all it has
  motors.apply(world);
  world.step();
  for (double& F : motors.F) F = 0;
  motors.apply(world);
  other.set_q(world.q());
  other.set_v(world.v());
  world.step(10);
  other.step(10);
  for (std::size_t i = 0; i < motors.v.size(); ++i) EXPECT_NEAR(world.v()[i], other.v()[i], 1e-10);
}

TEST(Step, NothingPassesALimit) {
  constexpr double kLower = -0.3, kUpper = 0.4;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    World world(chain(seed, 7, {.lower = kLower, .upper = kUpper}), 0.002);
    Generator rng(seed);
    Motors motors(world, seed % 2 == 0 ? 0 : 200);
    motors.kp.assign(motors.kp.size(), 0.1);
    for (double& q : motors.q) q = testing::uniform(rng, -2, 2);
    motors.apply(world);
    world.set_v(testing::random_numbers(motors.v.size(), rng));
    int touched = 0;
    for (int step = 0; step < 500; ++step) {
      world.step();
      for (const double q : world.q()) {
        ASSERT_GE(q, kLower - 1e-12) << "seed " << seed << ", step " << step;
        ASSERT_LE(q, kUpper + 1e-12) << "seed " << seed << ", step " << step;
        touched += q < kLower + 1e-9 || q > kUpper - 1e-9;
      }
    }
    EXPECT_GT(touched, 0) << "the limits were not tested, seed " << seed;
  }
}

/// A step removes a fifth of a violation, at up to 1 rad/s, while something pushes the joint outwards, and never lets
/// it grow.
TEST(Step, AJointBeyondItsLimitReturns) {
  World world(chain(1, 5, {.lower = -0.5, .upper = 0.5}), 0.002);
  const std::vector<double> outside{0.8, -0.9, 0.7, -0.6, 1.2};
  world.set_q(outside);
  std::vector<double> violation(5);
  for (std::size_t i = 0; i < 5; ++i) violation[i] = std::abs(outside[i]) - 0.5;
  for (int step = 0; step < 500; ++step) {
    world.step();
    for (std::size_t i = 0; i < 5; ++i) {
      violation[i] -= std::min(0.2 * violation[i], 1.0 * 0.002);
      ASSERT_LE(std::abs(world.q()[i]) - 0.5, violation[i] + 1e-12) << "step " << step << ", joint " << i;
    }
  }
}

/// v_n = v_0 / (1 + h d / m)^n: the implicit scheme, stable for any damping.
TEST(Step, DampingIsImplicit) {
  for (const double damping : {0.5, 30.0, 1e6}) {
    ModelBuilder builder("slide");
    builder.set_gravity({0, 0, 0});
    const LinkId cart = builder.add_link("cart", {.mass = 2, .inertia = {1, 1, 1, 0, 0, 0}});
    builder.add_joint(
        {.name = "rail", .type = JointType::kPrismatic, .parent = builder.world(), .child = cart, .damping = damping});
    World world(std::make_shared<const Model>(builder.build()), 0.01);
    world.set_v(std::vector{3.0});
    for (int step = 1; step <= 50; ++step) {
      world.step();
      ASSERT_NEAR(world.v()[0], 3 * std::pow(1 + 0.01 * damping / 2, -step), 1e-13) << damping;
    }
  }
}

/// A parabola, whatever the step; the rotation is that of a free sphere, steady.
TEST(Step, AFreeBodyFallsAndTurnsByFormula) {
  ModelBuilder builder("ball");
  builder.set_gravity({0.3, 0, -9.81});
  const LinkId ball = builder.add_link("ball", {.mass = 0.7, .inertia = {0.02, 0.02, 0.02, 0, 0, 0}});
  builder.add_joint({.name = "free", .type = JointType::kFloating, .parent = builder.world(), .child = ball});
  const double h = 0.002;
  World world(std::make_shared<const Model>(builder.build()), h);
  const Vec3<double> omega{1.0, -2.0, 0.5}, velocity{0.2, 0.1, 3.0};
  world.set_v(std::vector{omega.x, omega.y, omega.z, velocity.x, velocity.y, velocity.z});
  const int n = 500;
  world.step(n);
  const double t = n * h, fall = t * t / 2;
  EXPECT_NEAR(world.q()[0], velocity.x * t + 0.3 * fall, 1e-11);
  EXPECT_NEAR(world.q()[1], velocity.y * t, 1e-11);
  EXPECT_NEAR(world.q()[2], velocity.z * t - 9.81 * fall, 1e-11);
  EXPECT_NEAR(world.v()[5], velocity.z - 9.81 * t, 1e-11);
  const Quat<double> r = quat_from_rotation_vector(t * omega);
  const double sign = r.w * world.q()[6] < 0 ? -1 : 1;
  EXPECT_NEAR(world.q()[3], sign * r.x, 1e-11);
  EXPECT_NEAR(world.q()[4], sign * r.y, 1e-11);
  EXPECT_NEAR(world.q()[5], sign * r.z, 1e-11);
  EXPECT_NEAR(world.q()[6], sign * r.w, 1e-11);
}

}  // namespace
}  // namespace manyhands
