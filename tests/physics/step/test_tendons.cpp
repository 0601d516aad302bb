// Tendons: closed forms, the bits of lanes, and worlds that take parts with tendons in.
#include <gtest/gtest.h>

#include <cmath>

#include "manyhands/model/model_builder.h"
#include "manyhands/physics/world/batch.h"
#include "manyhands/physics/world/world.h"
#include "tests/physics/dynamics/random_tree.h"
#include "tests/physics/step/oscillator.h"

namespace manyhands {
namespace {

constexpr double kStep = 0.002, kFirst = 2, kSecond = 0.5;  // [s], [kg]

/// Two blocks on slides up from the world.
ModelBuilder two_blocks() {
  ModelBuilder builder("blocks");
  for (const auto& [name, mass] : {std::pair{"a", kFirst}, std::pair{"b", kSecond}}) {
    const LinkId link = builder.add_link(name, {.mass = mass, .com = {}, .inertia = {1, 1, 1, 0, 0, 0}});
    builder.add_joint({.name = name, .type = JointType::kPrismatic, .parent = builder.world(), .child = link});
  }
  return builder;
}

std::shared_ptr<const Model> built(const ModelBuilder& builder) {
  return std::make_shared<const Model>(builder.build());
}

/// q_a - q_b.
Tendon difference() { return {.name = "apart", .joints = {{JointId(0), 1}, {JointId(1), -1}}}; }

/// Their distance swings as by the trapezoidal rule with the reduced mass, however stiff the spring is.
TEST(Tendons, ASpringBetweenTreesIsImplicit) {
  for (const double stiffness : {1.0, 1e4, 1e12}) {
    ModelBuilder builder = two_blocks();
    builder.set_gravity({});
    Tendon tendon = difference();
    tendon.stiffness = stiffness;
    tendon.spring_lower = tendon.spring_upper = 0.3;
    builder.add_tendon(tendon);
    World world(built(builder), kStep);
    world.set_q(std::array{0.4, 0.0});
    const testing::Oscillator oscillator(stiffness, kFirst * kSecond / (kFirst + kSecond), kStep);
    for (int n = 1; n <= 1000; ++n) {
      world.step();
      ASSERT_NEAR(world.tendon_lengths()[0] - 0.3, oscillator.at(n), 1e-8 * oscillator.scale() * n) << stiffness;
      // Rounding of the spring's impulses.
      ASSERT_NEAR(kFirst * world.v()[0] + kSecond * world.v()[1], 0, (1e-12 + 1e-16 * kStep * stiffness) * n);
    }
  }
}

/// Over a pulley: a = g (m_a - m_b) / (m_a + m_b).
TEST(Tendons, AnEquationMovesAtwoodsMachine) {
  ModelBuilder builder = two_blocks();
  const TendonId rope = builder.add_tendon({.name = "rope", .joints = {{JointId(0), 1}, {JointId(1), 1}}});
  builder.add_equality({.type = EqualityType::kTendon, .tendon_b = rope, .polynomial = {}});
  World world(built(builder), kStep);
  world.step(500);
  const double a = -9.81 * (kFirst - kSecond) / (kFirst + kSecond);
  EXPECT_NEAR(world.v()[0], a * 500 * kStep, 1e-10);
  EXPECT_NEAR(world.v()[1], -a * 500 * kStep, 1e-10);
  EXPECT_NEAR(world.tendon_lengths()[0], 0, 1e-12);
}

/// b hangs on a, which a motor holds.
TEST(Tendons, ALimitHoldsAndLetsGo) {
  ModelBuilder builder = two_blocks();
  Tendon tendon = difference();
  tendon.upper = 0.25;
  builder.add_tendon(tendon);
  World world(built(builder), kStep);
  world.set_tau(std::array{9.81 * (kFirst + kSecond), 0.0});
  world.step(1000);
  EXPECT_NEAR(world.tendon_lengths()[0], 0.25, 1e-12);
  EXPECT_NEAR(world.tendon_velocities()[0], 0, 1e-10);
  const double together = world.v()[0];
  world.set_tau(std::array{9.81 * (kFirst + kSecond), 20.0});
  world.step(10);
  EXPECT_NEAR(world.v()[1], together + 10 * kStep * (20 / kSecond - 9.81), 1e-10);
}

TEST(Tendons, DryFrictionSticksUpToItsForce) {
  for (const double pull : {0.999, 1.001}) {
    ModelBuilder builder = two_blocks();
    builder.set_gravity({});
    Tendon tendon = difference();
    tendon.friction = 3;
    builder.add_tendon(tendon);
    World world(built(builder), kStep);
    // Both accelerate alike while they stick; what the tendon then transmits is its share of the force.
    const double force = pull * 3 * (kFirst + kSecond) / kSecond;
    world.set_tau(std::array{force, 0.0});
    world.step(100);
    if (pull < 1) {
      EXPECT_NEAR(world.v()[0], world.v()[1], 1e-11);
      EXPECT_NEAR(world.v()[0], force / (kFirst + kSecond) * 100 * kStep, 1e-10);
    } else {
      EXPECT_NEAR(world.v()[1], 3 / kSecond * 100 * kStep, 1e-10);
      EXPECT_NEAR(world.v()[0], (force - 3) / kFirst * 100 * kStep, 1e-10);
    }
  }
}

TEST(Tendons, ADrivePushesNoHarderThanItMay) {
  ModelBuilder builder = two_blocks();
  builder.set_gravity({});
  const TendonId apart = builder.add_tendon(difference());
  builder.add_actuator({.name = "servo",
                        .type = ActuatorType::kPosition,
                        .tendon = apart,
                        .gear = 2,
                        .ctrl_scale = 0.5,
                        .ctrl_offset = 0.2,
                        .kp = 1e4,
                        .kd = 300,
                        .max_force = 4});
  World world(built(builder), kStep);
  world.set_ctrl(std::array{3.0});
  world.step(20);
  EXPECT_NEAR(world.v()[0], 4 / kFirst * 20 * kStep, 1e-11);
  EXPECT_NEAR(world.v()[1], -4 / kSecond * 20 * kStep, 1e-11);
  world.step(4000);
  EXPECT_NEAR(2 * world.tendon_lengths()[0], 0.5 * 3 + 0.2, 1e-9);
}

/// A servo and a damper of bounded force, dry friction and limits: on a joint, or on a tendon that is the joint's q.
World rubbing_block(bool on_tendon) {
  constexpr double kFriction = 3, kLower = -0.2, kUpper = 0.3;
  ModelBuilder builder = two_blocks();
  builder.set_gravity({});
  const JointId joint(0);
  Actuator servo{.name = "servo", .type = ActuatorType::kPosition, .gear = -2, .kp = 40, .max_force = 12};
  Actuator damper{.name = "damper", .type = ActuatorType::kVelocity, .kd = 6, .max_force = 5};
  if (on_tendon) {
    servo.tendon = damper.tendon = builder.add_tendon(
        {.name = "t", .joints = {{joint, 1}}, .lower = kLower, .upper = kUpper, .friction = kFriction});
  } else {
    servo.joint = damper.joint = joint;
    builder.joint(joint).friction = kFriction;
    builder.joint(joint).limits = {.lower = kLower, .upper = kUpper};
  }
  builder.add_actuator(servo);
  builder.add_actuator(damper);
  return World(built(builder), kStep);
}

TEST(Tendons, DrivesBesideDryFrictionFollowTheLawOfJoints) {
  World joint = rubbing_block(false), tendon = rubbing_block(true);
  int rests = 0, limited = 0;
  for (int k = 0; k < 60; ++k) {
    const double wanted = std::sin(2.5 * k), speed = 0.4 * std::cos(1.7 * k);
    for (World* const world : {&joint, &tendon}) world->set_ctrl(std::array{wanted, k % 3 == 0 ? 0 : speed});
    for (int n = 0; n < 300; ++n) {
      joint.step();
      tendon.step();
      rests += joint.v()[0] == 0 ? 1 : 0;
      limited += std::abs(joint.q()[0] - 0.05) > 0.25 - 1e-9 ? 1 : 0;
      ASSERT_NEAR(tendon.q()[0], joint.q()[0], 1e-10) << k;
      ASSERT_NEAR(tendon.v()[0], joint.v()[0], 1e-9) << k;
    }
  }
  EXPECT_GT(rests, 100);
  EXPECT_GT(limited, 100);
}

/// Two fingers that one tendon drives and an equation keeps together squeeze a block, and hold it.
TEST(Tendons, AGripperHoldsABlock) {
  ModelBuilder builder("gripper");
  std::vector<JointId> slides;
  for (const double side : {1.0, -1.0}) {
    const LinkId finger =
        builder.add_link(side > 0 ? "left" : "right", {.mass = 0.05, .inertia = {1e-5, 1e-5, 1e-5, 0, 0, 0}});
    slides.push_back(builder.add_joint({.name = side > 0 ? "left" : "right",
                                        .type = JointType::kPrismatic,
                                        .parent = builder.world(),
                                        .child = finger,
                                        .X_PF = {Mat3<double>::identity(), {side * 0.05, 0, 1}},
                                        .axis = {-side, 0, 0}}));
    builder.add_geom({.link = finger, .shape = {ShapeType::kBox, {0.005, 0.02, 0.02}}});
  }
  const LinkId block = builder.add_link("block", {.mass = 0.2, .inertia = {1e-4, 1e-4, 1e-4, 0, 0, 0}});
  builder.add_joint({.name = "free",
                     .type = JointType::kFloating,
                     .parent = builder.world(),
                     .child = block,
                     .initial = {0.004, 0, 1, 0, 0, 0, 1}});
  builder.add_geom({.link = block, .shape = {ShapeType::kBox, {0.02, 0.02, 0.02}}});
  const TendonId both = builder.add_tendon({.name = "both", .joints = {{slides[0], 0.5}, {slides[1], 0.5}}});
  const TendonId left = builder.add_tendon({.name = "left", .joints = {{slides[0], 1}}});
  const TendonId right = builder.add_tendon({.name = "right", .joints = {{slides[1], 1}}});
  builder.add_equality({.type = EqualityType::kTendon, .tendon_a = left, .tendon_b = right});
  builder.add_actuator({.name = "close", .tendon = both, .max_force = 30});
  World world(built(builder), kStep);
  world.set_ctrl(std::array{20.0});
  world.step(100);
  const double held = world.body_pose("block").p.z;
  world.step(1000);
  EXPECT_GT(held, 0.98);
  EXPECT_NEAR(world.body_pose("block").p.z, held, 1e-6);
  EXPECT_NEAR(world.tendon_lengths()[1], world.tendon_lengths()[2], 1e-6);
  EXPECT_NEAR(world.tendon_lengths()[0], 0.025, 1e-4);
}

/// A tree of all kinds of joints with tendons of all kinds, that falls on the ground.
ModelBuilder tendon_tree(std::uint64_t seed, const std::string& name, bool solid = true) {
  testing::Generator rng(seed);
  const JointType types[] = {JointType::kFloating, JointType::kRevolute,  JointType::kSpherical,
                             JointType::kRevolute, JointType::kPrismatic, JointType::kRevolute};
  ModelBuilder builder(name);
  std::vector<LinkId> links{builder.world()};
  std::vector<JointId> single;
  for (int i = 0; i < 6; ++i) {
    const LinkId link = builder.add_link(name + std::to_string(i), testing::random_inertial(rng));
    const JointId joint =
        builder.add_joint({.name = name + std::to_string(i),
                           .type = types[i],
                           .parent = i == 4 ? links[2] : links.back(),
                           .child = link,
                           .X_PF = {to_matrix(testing::random_rotation(rng)), testing::random_vector(rng, 0.4)},
                           .axis = testing::random_vector(rng, 1),
                           .damping = 0.2});
    if (velocity_size(types[i]) == 1) single.push_back(joint);
    if (solid) builder.add_geom({.link = link, .shape = {ShapeType::kSphere, {0.15, 0, 0}}});
    links.push_back(link);
  }
  const TendonId fixed = builder.add_tendon({.name = name + "fixed",
                                             .joints = {{single[0], 1}, {single[2], -0.7}, {single[3], 0.4}},
                                             .lower = -0.1,
                                             .upper = 0.1,
                                             .damping = 0.3,
                                             .friction = 0.2,
                                             .armature = 0.05});
  const auto point = [&](std::size_t link) { return TendonPoint{links[link], testing::random_vector(rng, 0.2)}; };
  const TendonId rope =
      builder.add_tendon({.name = name + "rope",
                          .branches = {{1, {point(0), point(2), point(6)}}, {2, {point(4), point(5)}}},
                          .upper = 1.2,
                          .friction = 0.4,
                          .stiffness = 60,
                          .spring_lower = 0.4,
                          .spring_upper = 0.8});
  const TendonId one = builder.add_tendon({.name = name + "one", .joints = {{single[1], 1}}});
  builder.add_equality({.type = EqualityType::kTendon,
                        .tendon_a = fixed,
                        .tendon_b = one,
                        .polynomial = {0.05, 0.5, 0.2, 0, 0},
                        .max_force = 20});
  builder.add_actuator(
      {.name = name + "servo", .type = ActuatorType::kPosition, .tendon = rope, .kp = 50, .kd = 2, .max_force = 8});
  builder.add_actuator({.name = name + "motor", .tendon = one, .gear = 0.5});
  return builder;
}

TEST(Tendons, LanesHaveTheBitsOfScalars) {
  ModelBuilder builder = tendon_tree(3, "t");
  builder.add_geom(
      {.link = builder.world(), .X_LG = {Mat3<double>::identity(), {0, 0, -1.5}}, .shape = {ShapeType::kPlane}});
  const auto model = built(builder);
  const auto states = [&](int lanes) {
    Batch batch(model, 20, kStep, {.num_threads = 1, .lanes = lanes});
    std::vector<float> damping(20), ctrl(40);
    for (std::size_t i = 0; i < damping.size(); ++i) damping[i] = static_cast<float>(i) * 0.05f;
    for (std::size_t i = 0; i < ctrl.size(); ++i) ctrl[i] = static_cast<float>(i % 7) * 0.3f - 1;
    batch.set_damping("t1", damping);
    batch.set_ctrl(ctrl);
    batch.step(400);
    return batch.q();
  };
  const std::vector<float> scalar = states(1);
  for (const int lanes : {4, 8, 16}) EXPECT_EQ(states(lanes), scalar) << lanes;
}

/// Float follows double for a while.
TEST(Tendons, FloatFollowsDouble) {
  const auto model = built(tendon_tree(5, "t"));
  World world(model, kStep);
  Batch batch(model, 1, kStep, {.num_threads = 1, .lanes = 1});
  world.step(50);
  batch.step(50);
  for (std::size_t i = 0; i < world.q().size(); ++i) EXPECT_NEAR(batch.q()[i], world.q()[i], 2e-4) << i;
}

/// A world that takes robots in one by one moves as one whose model has them from the start; what is removed takes its
/// tendons along.
TEST(Tendons, WorldsTakeThemIn) {
  const Model a = tendon_tree(1, "a", false).build(), b = tendon_tree(2, "b", false).build();
  World grown(kStep);
  grown.add(a);
  grown.add(b, {Mat3<double>::identity(), {5, 0, 0}});
  World again(grown.shared_model(), kStep);
  again.set_q(grown.q());
  const std::array ctrl{0.3, -0.2, 0.5, 0.1};
  for (World* const world : {&grown, &again}) {
    world->set_ctrl(ctrl);
    world->step(100);
  }
  EXPECT_TRUE(std::ranges::equal(grown.q(), again.q()));
  EXPECT_EQ(grown.tendon_lengths().size(), 6u);
  const std::vector<double> before(grown.q().begin(), grown.q().end());
  grown.remove("a0");
  EXPECT_EQ(grown.model().tendons().size(), 3u);
  EXPECT_EQ(grown.model().nu(), 2);
  grown.step(10);
  again.restore(again.snapshot());
  again.step(10);
  EXPECT_NEAR(grown.q()[0], again.q()[again.q().size() / 2], 1e-9);
}

TEST(Tendons, NameWhatIsWrong) {
  ModelBuilder builder = two_blocks();
  const auto refused = [&](Tendon tendon) { EXPECT_THROW(builder.add_tendon(std::move(tendon)), ModelError); };
  refused({.name = "", .joints = {{JointId(0), 1}}});
  refused({.name = "t"});
  refused({.name = "t", .joints = {{JointId(7), 1}}});
  refused({.name = "t", .joints = {{JointId(0), 0}}});
  refused({.name = "t", .branches = {{1, {{LinkId(0), {}}}}}});
  refused({.name = "t", .branches = {{0, {{LinkId(0), {}}, {LinkId(1), {}}}}}});
  refused({.name = "t", .joints = {{JointId(0), 1}}, .lower = 1, .upper = 0});
  refused({.name = "t", .joints = {{JointId(0), 1}}, .stiffness = -1});
  builder.add_tendon({.name = "t", .joints = {{JointId(0), 1}}});
  refused({.name = "t", .joints = {{JointId(0), 1}}});
  EXPECT_THROW(builder.add_actuator({.name = "m", .joint = JointId(0), .tendon = TendonId(0)}), ModelError);
  EXPECT_THROW(builder.add_actuator({.name = "m", .tendon = TendonId(3)}), ModelError);
  EXPECT_THROW(builder.add_equality({.type = EqualityType::kTendon, .tendon_a = TendonId(0), .tendon_b = TendonId(0)}),
               ModelError);
}

}  // namespace
}  // namespace manyhands
