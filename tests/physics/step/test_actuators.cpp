// Actuators: closed forms of laws and activations, the bits of lanes, and worlds that take them in.
#include <gtest/gtest.h>

#include <cmath>

#include "manyhands/model/model_builder.h"
#include "manyhands/physics/world/batch.h"
#include "manyhands/physics/world/world.h"
#include "tests/physics/dynamics/random_tree.h"

namespace manyhands {
namespace {

constexpr double kStep = 0.002, kMass = 2;

/// A block on a slide along x, without gravity.
ModelBuilder block() {
  ModelBuilder builder("block");
  builder.set_gravity({});
  const LinkId link = builder.add_link("block", {.mass = kMass, .com = {}, .inertia = {1, 1, 1, 0, 0, 0}});
  builder.add_joint(
      {.name = "x", .type = JointType::kPrismatic, .parent = builder.world(), .child = link, .axis = {1, 0, 0}});
  return builder;
}

World world_of(const ModelBuilder& builder) { return World(std::make_shared<const Model>(builder.build()), kStep); }

Actuator on_slide(Actuator actuator) {
  actuator.joint = JointId(0);
  return actuator;
}

/// m dv = h gear (pull - (h k + d) gear (v + dv)): stiffness and damping are implicit, whatever of them is the gain's.
TEST(Actuators, AffineLawsAreImplicitWhereTheyHold) {
  ModelBuilder builder = block();
  const double gear = -1.5, ctrl = 0.8, q = 0.3, v = -0.7;
  builder.add_actuator(on_slide(
      {.name = "a", .type = ActuatorType::kAffine, .gear = gear, .gain = {2, -900, -30}, .bias = {0.4, 100, 4}}));
  World world = world_of(builder);
  world.set_q(std::array{q});
  world.set_v(std::array{v});
  world.set_ctrl(std::array{ctrl});
  world.step();
  const double k = 900 * ctrl - 100, d = 30 * ctrl - 4, pull = 2 * ctrl + 0.4 - k * gear * q;
  const double v_next = (kMass * v + kStep * gear * pull) / (kMass + kStep * gear * gear * (kStep * k + d));
  EXPECT_NEAR(world.v()[0], v_next, 1e-12);
}

/// What pushes away has no implicit form.
TEST(Actuators, AffineLawsAreExplicitWhereTheyPushAway) {
  ModelBuilder builder = block();
  builder.add_actuator(on_slide({.name = "a", .type = ActuatorType::kAffine, .bias = {0.4, 30, 5}, .max_force = 6}));
  World world = world_of(builder);
  world.set_q(std::array{0.1});
  world.set_v(std::array{0.2});
  world.step();
  EXPECT_NEAR(world.v()[0], 0.2 + kStep / kMass * (0.4 + 30 * 0.1 + 5 * 0.2), 1e-14);
  world.set_q(std::array{10.0});
  const double before = world.v()[0];
  world.step();
  EXPECT_NEAR(world.v()[0], before + kStep / kMass * 6, 1e-14);
}

TEST(Actuators, BoundsMayDiffer) {
  for (const bool is_servo : {false, true}) {
    ModelBuilder builder = block();
    builder.add_actuator(on_slide({.name = "a",
                                   .type = is_servo ? ActuatorType::kPosition : ActuatorType::kForce,
                                   .gear = -2,
                                   .kp = 1e4,
                                   .kd = 10,
                                   .max_force = 5,
                                   .min_force = -1}));
    for (const double ctrl : {-100.0, 100.0}) {
      World world = world_of(builder);
      world.set_ctrl(std::array{ctrl});
      world.step(10);
      EXPECT_NEAR(world.v()[0], 10 * kStep / kMass * (ctrl < 0 ? 5 : -1), 1e-12) << is_servo;
    }
  }
}

/// One at its bound leaves the other its own.
TEST(Actuators, ServosOfOneJointKeepTheirOwnBounds) {
  ModelBuilder builder = block();
  builder.add_actuator(on_slide({.name = "weak", .type = ActuatorType::kPosition, .kp = 1e4, .max_force = 1}));
  builder.add_actuator(on_slide({.name = "brake", .type = ActuatorType::kVelocity, .kd = 50, .max_force = 100}));
  World world = world_of(builder);
  world.set_ctrl(std::array{1e3, 0.0});
  world.step(2000);
  EXPECT_NEAR(world.v()[0], 1.0 / 50, 1e-9);
}

TEST(Actuators, ActivationsFollowTheirEquations) {
  ModelBuilder builder = block();
  const double tau = 0.05;
  for (const ActivationType type :
       {ActivationType::kIntegrator, ActivationType::kFilter, ActivationType::kFilterExact}) {
    builder.add_actuator(on_slide({.name = "a" + std::to_string(builder.actuators().size()),
                                   .activation = {.type = type, .time_constant = tau, .upper = 0.5}}));
  }
  World world = world_of(builder);
  ASSERT_EQ(world.model().na(), 3);
  world.set_ctrl(std::array{2.0, 0.4, 0.4});
  double v = 0;
  for (int n = 1; n <= 300; ++n) {
    for (const double act : world.act()) v += kStep / kMass * act;
    world.step();
    ASSERT_NEAR(world.v()[0], v, 1e-10);
    ASSERT_NEAR(world.act()[0], std::min(0.5, 2 * kStep * n), 1e-12);
    ASSERT_NEAR(world.act()[1], 0.4 * (1 - std::pow(1 - kStep / tau, n)), 1e-12);
    ASSERT_NEAR(world.act()[2], 0.4 * (1 - std::exp(-kStep * n / tau)), 1e-12);
  }
}

/// A force at a site of a free body, in the site's axes: nothing but it, and the torque about the centre of mass.
TEST(Actuators, SitesPushBodies) {
  ModelBuilder builder("body");
  builder.set_gravity({});
  const LinkId link = builder.add_link("body", {.mass = kMass, .com = {}, .inertia = {1, 2, 3, 0, 0, 0}});
  builder.add_joint({.name = "free", .type = JointType::kFloating, .parent = builder.world(), .child = link});
  const Mat3<double> R = rotation_from_rpy(Vec3<double>{0.3, -0.5, 0.7});
  const Vec3<double> p{0.1, 0.2, -0.3}, force{1, 2, 3}, torque{-0.3, 0.1, 0.2};
  builder.add_actuator(
      {.name = "a", .site = ActuatorSite{.link = link, .X_LS = {R, p}, .force = force, .torque = torque}});
  World world = world_of(builder);
  world.set_ctrl(std::array{2.0});
  world.step();
  const Vec3<double> f = R * force, n = R * torque + cross(p, f);
  const std::array expected{n.x / 1, n.y / 2, n.z / 3, f.x / kMass, f.y / kMass, f.z / kMass};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(world.v()[i], 2 * kStep * expected[i], 1e-14) << i;
}

/// Between two bodies it is a force and its reaction: momentum stays.
TEST(Actuators, SitesPullAgainstTheirReferences) {
  ModelBuilder builder("two");
  builder.set_gravity({});
  std::vector<LinkId> links;
  for (const char* name : {"a", "b"}) {
    links.push_back(builder.add_link(name, {.mass = kMass, .com = {}, .inertia = {1, 1, 1, 0, 0, 0}}));
    builder.add_joint({.name = name, .type = JointType::kFloating, .parent = builder.world(), .child = links.back()});
  }
  builder.add_actuator({.name = "servo",
                        .type = ActuatorType::kPosition,
                        .site = ActuatorSite{.link = links[0], .reference = links[1], .force = {1, 0, 0}},
                        .kp = 50,
                        .kd = 10});
  World world = world_of(builder);
  world.set_ctrl(std::array{0.4});
  world.step(5000);
  EXPECT_NEAR(world.q()[0] - world.q()[7], 0.4, 1e-9);
  EXPECT_NEAR(world.q()[0] + world.q()[7], 0, 1e-9);
}

/// A tree of all kinds of joints with actuators of all kinds.
ModelBuilder driven_tree(std::uint64_t seed, const std::string& name) {
  testing::Generator rng(seed);
  const JointType types[] = {JointType::kFloating, JointType::kRevolute, JointType::kSpherical, JointType::kPrismatic};
  ModelBuilder builder(name);
  std::vector<LinkId> links{builder.world()};
  for (int i = 0; i < 4; ++i) {
    const LinkId link = builder.add_link(name + std::to_string(i), testing::random_inertial(rng));
    builder.add_joint({.name = name + std::to_string(i),
                       .type = types[i],
                       .parent = links.back(),
                       .child = link,
                       .X_PF = {to_matrix(testing::random_rotation(rng)), testing::random_vector(rng, 0.4)},
                       .axis = testing::random_vector(rng, 1),
                       .damping = 0.2});
    links.push_back(link);
  }
  const auto site = [&](std::size_t link, LinkId reference) {
    return ActuatorSite{.link = links[link],
                        .X_LS = {to_matrix(testing::random_rotation(rng)), testing::random_vector(rng, 0.2)},
                        .reference = reference,
                        .force = testing::random_vector(rng, 1),
                        .torque = testing::random_vector(rng, 0.2)};
  };
  const auto activation = [](ActivationType type, bool early) {
    return Activation{.type = type, .time_constant = 0.05, .lower = -0.8, .upper = 0.8, .early = early};
  };
  builder.add_actuator({.name = name + "site",
                        .type = ActuatorType::kPosition,
                        .site = site(4, links[1]),
                        .kp = 20,
                        .kd = 1,
                        .activation = activation(ActivationType::kFilterExact, false)});
  builder.add_actuator({.name = name + "push",
                        .site = site(3, {}),
                        .activation = activation(ActivationType::kIntegrator, false),
                        .max_force = 3,
                        .min_force = -1});
  builder.add_actuator({.name = name + "affine",
                        .type = ActuatorType::kAffine,
                        .joint = JointId(1),
                        .gain = {1, -2, -0.5},
                        .bias = {0.2, 0.5, -0.3},
                        .activation = activation(ActivationType::kFilter, true)});
  builder.add_actuator(
      {.name = name + "servo", .type = ActuatorType::kPosition, .joint = JointId(3), .kp = 50, .max_force = 4});
  builder.add_actuator(
      {.name = name + "brake", .type = ActuatorType::kVelocity, .joint = JointId(3), .kd = 5, .max_force = 2});
  return builder;
}

TEST(Actuators, LanesHaveTheBitsOfScalars) {
  const auto model = std::make_shared<const Model>(driven_tree(3, "t").build());
  const auto states = [&](int lanes) {
    Batch batch(model, 20, kStep, {.num_threads = 1, .lanes = lanes});
    std::vector<float> ctrl(100), act(60);
    for (std::size_t i = 0; i < ctrl.size(); ++i) ctrl[i] = static_cast<float>(i % 7) * 0.3f - 1;
    for (std::size_t i = 0; i < act.size(); ++i) act[i] = static_cast<float>(i % 5) * 0.2f - 0.5f;
    batch.set_ctrl(ctrl);
    batch.set_act(act);
    batch.step(400);
    std::vector<float> numbers = batch.q();
    for (const float x : batch.act()) numbers.push_back(x);
    return numbers;
  };
  const std::vector<float> scalar = states(1);
  for (const int lanes : {4, 8, 16}) EXPECT_EQ(states(lanes), scalar) << lanes;
}

TEST(Actuators, FloatFollowsDouble) {
  const auto model = std::make_shared<const Model>(driven_tree(5, "t").build());
  World world(model, kStep);
  Batch batch(model, 1, kStep, {.num_threads = 1, .lanes = 1});
  world.set_ctrl(std::array{0.5, -0.3, 0.4, 0.2, 0.1});
  batch.set_ctrl(std::array{0.5f, -0.3f, 0.4f, 0.2f, 0.1f});
  world.step(50);
  batch.step(50);
  for (std::size_t i = 0; i < world.q().size(); ++i) EXPECT_NEAR(batch.q()[i], world.q()[i], 2e-4) << i;
}

/// A world that takes robots in moves as one that has them from the start; what is removed takes its activations along.
TEST(Actuators, WorldsTakeThemIn) {
  const Model a = driven_tree(1, "a").build(), b = driven_tree(2, "b").build();
  World grown(kStep);
  grown.add(a);
  grown.add(b, {Mat3<double>::identity(), {5, 0, 0}});
  World again(grown.shared_model(), kStep);
  again.set_q(grown.q());
  const std::array ctrl{0.3, -0.2, 0.5, 0.1, 0.2, -0.4, 0.3, 0.2, 0.6, -0.1};
  const std::array act{0.1, 0.2, 0.3, 0.4, 0.5, 0.6};
  for (World* const world : {&grown, &again}) {
    world->set_ctrl(ctrl);
    world->set_act(act);
    world->step(100);
  }
  EXPECT_TRUE(std::ranges::equal(grown.q(), again.q()));
  EXPECT_TRUE(std::ranges::equal(grown.act(), again.act()));
  const std::vector<double> before(grown.act().begin(), grown.act().end());
  grown.remove("a0");
  EXPECT_EQ(std::vector<double>(grown.act().begin(), grown.act().end()),
            std::vector<double>(before.begin() + 3, before.end()));
  EXPECT_EQ(grown.model().nu(), 5);
  EXPECT_EQ(std::vector<double>(grown.act().begin(), grown.act().end()),
            std::vector<double>(before.begin() + 3, before.end()));
  grown.step(10);
  again.step(10);
  EXPECT_NEAR(grown.q()[0], again.q()[again.q().size() / 2], 1e-9);
}

TEST(Actuators, NameWhatIsWrong) {
  ModelBuilder builder = block();
  const auto refused = [&](Actuator actuator) {
    EXPECT_THROW(builder.add_actuator(on_slide(std::move(actuator))), ModelError);
  };
  refused({.name = "a", .site = ActuatorSite{.link = LinkId(1)}});
  refused({.name = "a", .bias = {0, std::nan(""), 0}});
  refused({.name = "a", .activation = {.time_constant = -1}});
  refused({.name = "a", .activation = {.lower = 1, .upper = 0}});
  refused({.name = "a", .max_force = 1, .min_force = 2});
  refused({.name = "a", .min_force = -2});
  EXPECT_THROW(builder.add_actuator({.name = "a", .site = ActuatorSite{.link = LinkId(9)}}), ModelError);
  EXPECT_THROW(builder.add_sensor({.name = "s", .type = SensorType::kGyro}), ModelError);
  EXPECT_THROW(builder.add_sensor({.name = "s", .type = SensorType::kBallQuaternion, .joint = JointId(0)}), ModelError);
  EXPECT_THROW(builder.add_sensor({.type = SensorType::kClock}), ModelError);
  builder.add_actuator(on_slide({.name = "a", .type = ActuatorType::kAffine}));
  World world = world_of(builder);
  EXPECT_THROW(world.set_gains("a", 1, 1), std::invalid_argument);
  EXPECT_THROW(world.set_activation("a", 1), std::invalid_argument);
  EXPECT_THROW(world.set_act(std::array{1.0}), std::invalid_argument);
}

}  // namespace
}  // namespace manyhands
