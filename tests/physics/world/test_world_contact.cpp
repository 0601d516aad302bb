// A world whose parts touch: forces, reactions, snapshots in the middle of contact, parts that come and go.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "manyhands/math/quaternion.h"
#include "manyhands/physics/contact/contact_solver.h"
#include "tests/physics/world/world_scenes.h"

namespace manyhands {
namespace {

using testing::panda_and_cube;
using testing::stack;

constexpr double kGravity = 9.81;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

double weight_of(const World& world, std::string_view link) { return world.mass(link) * kGravity; }

TEST(WorldContact, AStackRestsOnItsWeight) {
  World world(stack(3));
  world.step(1500);
  const Force<double> lowest = world.contact_wrench("cube0").total();
  EXPECT_NEAR(lowest.f.z, weight_of(world, "cube0"), 1e-6);
  const Force<double> from_floor = world.contact_wrench("cube0", "world").total();
  EXPECT_NEAR(from_floor.f.z, 3 * weight_of(world, "cube0"), 1e-6);
  const Force<double> on_floor = world.contact_wrench("world").total();
  EXPECT_NEAR(on_floor.f.z, -from_floor.f.z, 1e-9);
  EXPECT_NEAR(world.contact_wrench("cube0", "cube1").total().f.z, -2 * weight_of(world, "cube1"), 1e-6);
  EXPECT_LT(world.max_penetration(), 1e-4);
  EXPECT_GE(world.solver_iterations(), 1);
}

/// Splits each force anew, from its normal alone, and keeps it within the cone of friction 0.5.
TEST(WorldContact, ContactsSplitIntoNormalAndFriction) {
  World world(stack(2));
  world.step(50);
  ASSERT_FALSE(world.contacts().empty());
  for (const Contact& contact : world.contacts()) {
    EXPECT_NEAR(norm(contact.normal), 1, 1e-12);
    const double along = dot(contact.force, contact.normal);
    EXPECT_NEAR(contact.normal_force, along, 1e-9 * (1 + along));
    const Vec3<double> across = contact.force - along * contact.normal;
    EXPECT_NEAR(norm(contact.friction_force - across), 0, 1e-9 * (1 + along));
    EXPECT_GE(along, 0);
    EXPECT_LE(norm(across), 0.5 * along + 1e-9);
    EXPECT_NEAR(norm(world.time_step() * contact.force - contact.impulse), 0, 1e-12);
  }
}

TEST(WorldContact, ABodyOnASlopeKeepsTheLawToItsTolerance) {
  ModelBuilder builder;
  testing::add_floor(builder);
  testing::add_cube(builder, "cube", {0, 0, 0.02});
  builder.set_gravity({6, 0, -8});  // steeper than friction holds
  World world(std::make_shared<const Model>(builder.build()));
  world.set_solver({.max_iterations = 500, .tolerance = 1e-13});
  world.step(100);
  const ContactResiduals residuals = world.residuals();
  EXPECT_LT(residuals.signorini, 1e-10);
  EXPECT_LT(residuals.penetration_rate, 1e-10);
  EXPECT_LT(residuals.cone, 1e-12);
  EXPECT_LT(residuals.dissipation, 1e-10);
  // Sliding: a = g_x - mu g_z.
  EXPECT_NEAR(world.body_velocity("cube").v.x, 0.2 * (6 - 0.5 * 8), 1e-6);
}

TEST(WorldContact, ContinuesInTheMiddleOfContactWithTheSameBits) {
  for (const auto& model : {stack(4), panda_and_cube()}) {
    World world(model);
    std::vector<double> tau(static_cast<std::size_t>(model->nv()), 0.01);
    world.set_tau(tau);
    world.set_friction(model->geoms().back().name, 0.7);
    world.set_mass(model->links().back().name, 0.2);
    world.step(40);
    ASSERT_FALSE(world.contacts().empty());
    world.apply_force(model->links().back().name, {0.1, 0.2, 0.3});
    const std::vector<std::uint8_t> snapshot = world.snapshot();
    World copy = world;
    world.step(60);
    World other(model);
    other.step(3);
    other.restore(snapshot);
    EXPECT_TRUE(other.contacts().empty());
    other.step(60);
    copy.step(60);
    EXPECT_EQ(other.state_hash(), world.state_hash()) << model->name();
    EXPECT_EQ(copy.state_hash(), world.state_hash()) << model->name();
  }
}

/// After `forget` a world goes on as one that was put there.
TEST(WorldContact, ForgetsWhatCameBefore) {
  const auto model = panda_and_cube();
  World world(model);
  world.step(300);
  World other(model);
  other.set_q(world.q());
  other.set_v(world.v());
  world.forget();
  EXPECT_EQ(world.time(), 0);
  EXPECT_EQ(world.state_hash(), other.state_hash());
  world.step(50);
  other.step(50);
  EXPECT_FALSE(world.contacts().empty());
  EXPECT_EQ(world.state_hash(), other.state_hash());
}

TEST(WorldContact, ContinuesWhereABroadPhaseFindsThePairs) {
  const auto model = stack(70);
  World world(model);
  world.step(30);
  ASSERT_FALSE(world.contacts().empty());
  EXPECT_GT(world.contact_wrench("cube0", "world").total().f.z, 0);
  const std::vector<std::uint8_t> snapshot = world.snapshot();
  world.step(20);
  World other(model);
  other.restore(snapshot);
  other.step(20);
  EXPECT_EQ(other.state_hash(), world.state_hash());
}

TEST(WorldForces, AForceActsForOneStepAndMovesTheCentreOfMass) {
  ModelBuilder builder;
  testing::add_cube(builder, "cube", {1, 2, 3}, 0.5);
  builder.set_gravity({0, 0, 0});
  World world(std::make_shared<const Model>(builder.build()), 0.01);
  world.apply_force("cube", {5, 0, 0});
  world.step();
  EXPECT_NEAR(world.body_velocity("cube").v.x, 5 * 0.01 / 0.5, 1e-12);
  EXPECT_NEAR(norm(world.body_velocity("cube").w), 0, 1e-15);
  world.step();
  EXPECT_NEAR(world.body_velocity("cube").v.x, 5 * 0.01 / 0.5, 1e-12);
  // Off the centre it turns the body as well: I w = h r x f.
  const double I = 0.5 / 12 * 2 * 0.04 * 0.04;
  const Vec3<double> p = world.body_pose("cube").p;
  world.set_body_velocity("cube", Motion<double>::zero());
  world.apply_force("cube", {0, 1, 0}, {0, 0, 0}, p + Vec3<double>{0.02, 0, 0});
  world.step();
  EXPECT_NEAR(world.body_velocity("cube").w.z, 0.01 * 0.02 / I, 1e-10);
}

TEST(WorldForces, AHeldRobotFeelsTheWeightOfWhatHangsOnEachJoint) {
  const LoadedModel panda = load_urdf(asset_path("panda/panda.urdf"));
  World world(std::make_shared<const Model>(panda.model));
  const std::vector<double> nothing(world.q().size(), 0.0), strong(world.q().size(), 1e6), one(world.q().size(), 1.0);
  world.set_motors({.target_q = world.q(), .target_v = nothing, .kp = nothing, .kd = one, .max_force = strong});
  world.step(50);
  const Model& model = world.model();
  for (const Joint& joint : model.joints()) {
    double mass = 0;
    Vec3<double> moment = Vec3<double>::zero();
    const Vec3<double> origin = world.body_pose(model.link(joint.child).name).p;
    for (const Link& link : model.links()) {
      bool hangs = false;
      for (LinkId id = model.link_id(link.name); id.is_valid(); id = model.link(id).parent)
        hangs = hangs || id == joint.child;
      if (!hangs) continue;
      mass += link.inertial.mass;
      const Vec3<double> com = world.body_pose(link.name) * link.inertial.com - origin;
      moment = moment + cross(com, Vec3<double>{0, 0, -link.inertial.mass * kGravity});
    }
    const Force<double> wrench = world.joint_wrench(joint.name);
    EXPECT_NEAR(wrench.f.z, mass * kGravity, 1e-6) << joint.name;
    EXPECT_NEAR(norm(wrench.n + moment), 0, 1e-6) << joint.name;
  }
}

/// A push on the last link goes through a fixed joint too; so does what the floor carries.
TEST(WorldForces, AJointTransmitsPushesAndContacts) {
  ModelBuilder builder;
  testing::add_floor(builder);
  const LinkId arm = builder.add_link("arm", {.mass = 2, .com = {0, 0, -0.2}, .inertia = {0.1, 0.1, 0.1, 0, 0, 0}});
  const LinkId foot = builder.add_link("foot", {.mass = 1, .inertia = {0.01, 0.01, 0.01, 0, 0, 0}});
  builder.add_joint({.name = "slide",
                     .type = JointType::kPrismatic,
                     .parent = builder.world(),
                     .child = arm,
                     .X_PF = {Mat3<double>::identity(), {0, 0, 0.549}}});
  builder.add_joint({.name = "ankle", .parent = arm, .child = foot, .X_PF = {Mat3<double>::identity(), {0, 0, -0.5}}});
  builder.add_geom({.link = foot, .shape = {.type = ShapeType::kSphere, .size = {0.05, 0, 0}}});
  World world(std::make_shared<const Model>(builder.build()));
  world.step(1000);
  EXPECT_NEAR(world.contact_wrench("foot").total().f.z, 3 * kGravity, 1e-5);
  EXPECT_NEAR(world.joint_wrench("slide").f.z, 0, 1e-5);
  EXPECT_NEAR(world.joint_wrench("ankle").f.z, -2 * kGravity, 1e-5);
  world.apply_force("foot", {0, 0, -7});
  world.step();
  EXPECT_NEAR(world.contact_wrench("foot").total().f.z, 3 * kGravity + 7, 1e-5);
  EXPECT_NEAR(world.joint_wrench("ankle").f.z, -2 * kGravity, 1e-5);
  world.apply_force("foot", {3, 0, 0});
  world.step();
  EXPECT_NEAR(world.joint_wrench("slide").f.x + 3 + world.contact_wrench("foot").friction.f.x, 0, 1e-9);
}

// In a world that grows there is room between q and v: what turns elsewhere is not taken for the arm's motion.
TEST(WorldContact, WrenchesOfAWorldThatGrewAreItsOwn) {
  const auto hinged = [](double mass) {
    ModelBuilder builder("hinged");
    const LinkId link =
        builder.add_link("link", {.mass = mass, .com = {0.3, 0, 0}, .inertia = {0.1, 0.1, 0.1, 0, 0, 0}});
    builder.add_joint({.name = "hinge", .type = JointType::kContinuous, .parent = builder.world(), .child = link});
    return builder.build();
  };
  World world;
  for (int i = 0; i < 12; ++i) {
    world.add(hinged(2), Transform<double>::identity(), "wheel" + std::to_string(i));
    std::vector<double> v(world.v().size(), 10);
    v.back() = 0;
    world.set_v(v);
    world.step();
    const Force<double> wrench = world.joint_wrench("wheel" + std::to_string(i) + "/hinge");
    EXPECT_NEAR(norm(wrench.f - Vec3<double>{0, 0, 2 * kGravity}), 0, 1e-9) << i;
    EXPECT_NEAR(norm(wrench.n - Vec3<double>{0, -0.6 * kGravity, 0}), 0, 1e-9) << i;
  }
}

TEST(WorldBodies, AreSetAndRead) {
  World world(stack(2));
  const Quat<double> turn = quat_from_rotation_vector(Vec3<double>{0.1, -0.4, 0.7});
  world.set_body_pose("cube1", {to_matrix(turn), {1, 2, 3}});
  world.set_body_velocity("cube1", {{1, 2, 3}, {4, 5, 6}});
  const Transform<double> X = world.body_pose("cube1");
  EXPECT_NEAR(norm(X.p - Vec3<double>{1, 2, 3}), 0, 1e-14);
  EXPECT_NEAR(norm(X.R.x - to_matrix(turn).x), 0, 1e-12);
  const Motion<double> V = world.body_velocity("cube1");
  EXPECT_NEAR(norm(V.w - Vec3<double>{1, 2, 3}), 0, 1e-12);
  EXPECT_NEAR(norm(V.v - Vec3<double>{4, 5, 6}), 0, 1e-12);
  EXPECT_THROW(world.set_body_pose("world", Transform<double>::identity()), std::invalid_argument);
  EXPECT_THROW((void)world.body_pose("nobody"), std::out_of_range);
}

TEST(WorldErrors, AStepThatFailsLeavesContactsAsTheyWereWhereverTheyAreFrom) {
  World world(stack(2));
  world.step(20);
  const auto fails_and_returns = [&] {
    const std::uint64_t hash = world.state_hash();
    world.apply_force("cube1", {1e308, 0, 0});
    EXPECT_THROW(world.step(), SimulationError);
    EXPECT_EQ(world.state_hash(), hash);
  };
  fails_and_returns();  // contacts of the last step
  fails_and_returns();  // of the step before one that failed
  world.step();
  world.restore(world.snapshot());
  fails_and_returns();  // of a snapshot
  world.step();
  world.set_collision("cube0", "cube1", false);
  fails_and_returns();  // of pairs that were others
  world.step(20);
}

TEST(WorldErrors, NumbersBeyondReasonEndInAnErrorThatNamesTheJoint) {
  World world(stack(2));
  world.step(20);
  const std::uint64_t hash = world.state_hash();
  world.apply_force("cube1", {1e308, 0, 0});
  try {
    world.step();
    FAIL() << "no error";
  } catch (const SimulationError& error) {
    EXPECT_NE(std::string(error.what()).find("'cube1_free'"), std::string::npos) << error.what();
  }
  EXPECT_EQ(world.state_hash(), hash);  // but for the force, which is gone
  world.step(20);
  EXPECT_THROW(world.apply_force("cube1", {kNaN, 0, 0}), std::invalid_argument);
  EXPECT_THROW(world.set_mass("cube1", 0), std::invalid_argument);
  EXPECT_THROW(world.set_mass("world", 1), std::invalid_argument);
  EXPECT_THROW(world.set_friction("cube1", -1), std::invalid_argument);
  EXPECT_THROW(world.set_geom_size("cube1", {0.1, -0.1, 0.1}), std::invalid_argument);
  EXPECT_THROW(world.set_geom_size("floor", {0.1, 0.1, 0.1}), std::invalid_argument);
  EXPECT_THROW(world.set_gravity({kNaN, 0, 0}), std::invalid_argument);
  EXPECT_THROW(world.set_solver({.max_iterations = 0}), std::invalid_argument);
}

TEST(WorldErrors, HarshScenesStayFinite) {
  for (const double time_step : {0.0001, 0.05, 1.0}) {
    World world(stack(3), time_step);
    world.set_mass("cube2", 1e5);  // a million times the others
    world.step(50);
    for (const double x : world.q()) EXPECT_LT(std::abs(x), 1e4) << time_step;
  }
  ModelBuilder builder;  // all in one place
  testing::add_floor(builder);
  for (int i = 0; i < 5; ++i) testing::add_cube(builder, "cube" + std::to_string(i), {0, 0, 0});
  World world(std::make_shared<const Model>(builder.build()));
  world.step(500);
  for (const double v : world.v()) EXPECT_LT(std::abs(v), 10);
}

}  // namespace
}  // namespace manyhands
