// What gives way instead of holding exactly: closed forms, and worlds that take parts with it in.
#include <gtest/gtest.h>

#include <cmath>

#include "manyhands/model/model_builder.h"
#include "manyhands/physics/world/world.h"
#include "tests/physics/step/oscillator.h"

namespace manyhands {
namespace {

constexpr double kStep = 0.002, kGravity = 9.81;

std::shared_ptr<const Model> built(const ModelBuilder& builder) {
  return std::make_shared<const Model>(builder.build());
}

/// One impedance whatever the error.
Compliance even(double stiffness, double damping, double impedance) {
  return {.stiffness = stiffness, .damping = damping, .impedance = impedance, .largest_impedance = impedance};
}

/// Blocks on slides up from the world.
ModelBuilder blocks(const std::vector<double>& masses, const JointLimits& limits = {}) {
  ModelBuilder builder("blocks");
  for (std::size_t i = 0; i < masses.size(); ++i) {
    const std::string name = "block" + std::to_string(i);
    const LinkId link = builder.add_link(name, {.mass = masses[i], .com = {}, .inertia = {1, 1, 1, 0, 0, 0}});
    builder.add_joint(
        {.name = name, .type = JointType::kPrismatic, .parent = builder.world(), .child = link, .limits = limits});
  }
  return builder;
}

/// It sinks to where (1 - d) / d / m m g = stiffness / d^2 d depth, or less stiff where two steps are slower.
TEST(Compliance, AWeightOnASoftLimitRestsByTheLaw) {
  for (const double stiffness : {100.0, 2500.0, 1e6, 1e10}) {
    for (const double h : {1e-4, 2e-3, 0.02}) {
      for (const double impedance : {0.1, 0.9, 0.999}) {
        const Compliance soft = even(stiffness, 2 * std::sqrt(stiffness), impedance);
        World world(built(blocks({0.3, 20}, {.lower = -0.01, .compliance = soft})), h);
        world.step(static_cast<int>(3 / h));
        const double stiff = std::min(stiffness, 1 / (4 * h * h));
        const double depth = (1 - impedance) * kGravity / stiff;
        for (const double q : world.q()) EXPECT_NEAR(q, -0.01 - depth, 1e-6 * depth + 1e-9) << stiffness << ", " << h;
      }
    }
  }
}

/// Where it does not damp, what joins two blocks swings with its own frequency, whatever they weigh, as by the
/// trapezoidal rule; and it keeps their momentum. Of bodies it knows their mean mobility alone, of which slides have a
/// third.
TEST(Compliance, EquationsSwingWithTheirOwnFrequency) {
  for (const EqualityType type :
       {EqualityType::kPoint, EqualityType::kFixed, EqualityType::kJoint, EqualityType::kTendon}) {
    for (const double stiffness : {1.0, 1e4, 2e5}) {
      ModelBuilder builder = blocks({2, 0.5});
      builder.set_gravity({});
      EqualityConstraint equality{.type = type, .compliance = even(stiffness, 0, 0.9)};
      if (type == EqualityType::kJoint) {
        equality.joint_a = JointId(0);
        equality.joint_b = JointId(1);
      } else if (type == EqualityType::kTendon) {
        equality.tendon_b = builder.add_tendon({.name = "apart", .joints = {{JointId(0), 1}, {JointId(1), -1}}});
        equality.polynomial = {};
      } else {
        equality.link_a = LinkId(1);
        equality.link_b = LinkId(2);
      }
      builder.add_equality(equality);
      World world(built(builder), kStep);
      world.set_q(std::array{0.1, 0.0});
      const bool joins_bodies = type == EqualityType::kPoint || type == EqualityType::kFixed;
      const double faster = joins_bodies ? 3 / (2 * 0.9 + 1) : 1;
      const testing::Oscillator oscillator(faster * stiffness, 1, kStep);
      for (int n = 1; n <= 500; ++n) {
        world.step();
        ASSERT_NEAR(world.q()[0] - world.q()[1], oscillator.at(n), 1e-7 * oscillator.scale() * n)
            << static_cast<int>(type) << ", " << stiffness;
        ASSERT_NEAR(2 * world.v()[0] + 0.5 * world.v()[1], 0, (1e-11 + 1e-15 * kStep * stiffness) * n);
      }
    }
  }
}

/// A limit does not hold back what leaves it.
TEST(Compliance, ASoftLimitOnlyPushes) {
  const JointLimits limits{.lower = -1, .upper = 0, .compliance = even(1, 100, 0.9)};
  ModelBuilder builder = blocks({1}, limits);
  World world(built(builder), kStep);  // it is past the limit, and falls off it
  world.set_q(std::array{1e-6});
  world.step(50);
  EXPECT_NEAR(world.v()[0], -kGravity * 50 * kStep, 1e-9);
}

/// A world that grows and shrinks keeps what gives way.
TEST(Compliance, PartsComeAndGo) {
  const Compliance soft = even(2500, 100, 0.5);
  World world(built(blocks({1}, {.lower = -0.01, .compliance = soft})), kStep);
  world.add(blocks({3}, {.lower = -0.02, .compliance = soft}).build(), Transform<double>::identity(), "more");
  world.step(2000);
  const double depth = 0.5 * kGravity / 2500;
  EXPECT_NEAR(world.q()[0], -0.01 - depth, 1e-6);
  EXPECT_NEAR(world.q()[1], -0.02 - depth, 1e-6);
  world.remove("block0");
  world.step(100);
  EXPECT_NEAR(world.q()[0], -0.02 - depth, 1e-6);
}

TEST(Compliance, NumbersThatCannotBeAreRefused) {
  EXPECT_THROW((void)blocks({1}, {.compliance = even(-1, 1, 0.5)}), ModelError);
  EXPECT_THROW((void)blocks({1}, {.compliance = even(1, 1, 1)}), ModelError);
  EXPECT_THROW((void)blocks({1}, {.compliance = even(1, 1, 0)}), ModelError);
  EXPECT_THROW((void)blocks({1}, {.compliance = Compliance{.power = 0.5}}), ModelError);
  EXPECT_THROW((void)blocks({1}, {.compliance = Compliance{.width = -1}}), ModelError);
  ModelBuilder builder = blocks({1, 1});
  const EqualityConstraint bounded{.type = EqualityType::kPoint,
                                   .link_a = LinkId(1),
                                   .link_b = LinkId(2),
                                   .max_force = 1,
                                   .compliance = Compliance()};
  EXPECT_THROW((void)builder.add_equality(bounded), ModelError);
}

}  // namespace
}  // namespace manyhands
