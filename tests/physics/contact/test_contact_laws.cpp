// Contact against closed forms: slopes, impacts, rolling, spinning, pinching, closed loops and drives, in double.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "manyhands/physics/dynamics/energy.h"
#include "manyhands/physics/step/step.h"
#include "tests/physics/contact/contact_scenes.h"

namespace manyhands {
namespace {

using testing::SceneBuilder;

/// A world of double with its parts at hand.
struct Bench {
  explicit Bench(const Model& model_, double h_ = 0.002)
      : model(model_), system(model), params(model), state(model, system.contact_numbers()), ws(system), h(h_) {}

  void run(double time) {
    for (int n = static_cast<int>(std::lround(time / h)); n > 0; --n) step(system, params, h, state, ws);
  }
  /// (omega, v) and position of free body b, b = 1 being the first.
  [[nodiscard]] double* v(std::size_t b) { return state.v() + model.bodies()[b].iv; }
  [[nodiscard]] double* q(std::size_t b) { return state.q() + model.bodies()[b].iq; }
  [[nodiscard]] double total_energy() {
    Workspace<double> scratch(system.tree);
    const Energy<double> e = energy(system.tree, params, state.q(), state.v(), scratch);
    return e.kinetic + e.potential;
  }

  Model model;
  System<double> system;
  ParamsStorage<double> params;
  StateStorage<double> state;
  StepWorkspace<double> ws;
  double h;
};

/// Gravity turned instead of the ground: a slope of `angle` in the direction `heading`.
Vec3<double> slope_gravity(double angle, double heading) {
  return {9.81 * std::sin(angle) * std::cos(heading), 9.81 * std::sin(angle) * std::sin(heading),
          -9.81 * std::cos(angle)};
}

constexpr Shape kCube{ShapeType::kBox, {0.02, 0.02, 0.02}};

TEST(ContactLaws, ABoxSticksBelowTheAngleOfFrictionAndSlidesAboveItInEveryDirection) {
  for (const double mu : {0.1, 0.5, 1.0, 1.5}) {
    for (const double heading : {0.0, 0.4, std::numbers::pi / 4, 2.0}) {
      for (const double beyond : {-0.1, 0.1}) {
        SceneBuilder s("slope");
        // Flat, so that it does not topple at mu = 1.5.
        const Shape slab{ShapeType::kBox, {0.05, 0.05, 0.005}};
        s.add_geom(s.builder.world(), {ShapeType::kPlane}, Transform<double>::identity(), {.lateral_friction = mu});
        s.add("box", slab, 1, {0, 0, 0.005}, {.lateral_friction = mu});
        const double angle = std::atan(mu) + beyond * std::numbers::pi / 180;
        s.builder.set_gravity(slope_gravity(angle, heading));
        Bench world(s.builder.build());
        world.run(1);
        const double a = 9.81 * (std::sin(angle) - mu * std::cos(angle));
        const double* v = world.v(1);
        const double speed = std::hypot(v[3], v[4]);
        if (beyond < 0) {
          EXPECT_LT(speed, 1e-9) << "mu " << mu << ", heading " << heading;
        } else {
          EXPECT_NEAR(speed, a, 0.01 * a) << "mu " << mu << ", heading " << heading;
          EXPECT_NEAR(std::atan2(v[4], v[3]), heading, 1e-6);
        }
      }
    }
  }
}

TEST(ContactLaws, TwoSpheresKeepMomentumAndObeyRestitution) {
  for (const double e : {0.0, 0.3, 0.7, 1.0}) {
    for (const double ratio : {1e-4, 1e-2, 1.0, 1e2, 1e4}) {
      SceneBuilder s("impact");
      const Shape ball{ShapeType::kSphere, {0.1, 0, 0}};
      s.add("a", ball, 1, {0, 0, 0}, {.lateral_friction = 0, .restitution = e});
      s.add("b", ball, ratio, {0.2001, 0, 0}, {.lateral_friction = 0, .restitution = e});
      s.builder.set_gravity({0, 0, 0});
      Bench world(s.builder.build(), 0.001);
      world.v(1)[3] = 1;
      world.run(0.01);
      const double a = world.v(1)[3], b = world.v(2)[3];
      EXPECT_NEAR(a + ratio * b, 1, 1e-12 * (1 + ratio)) << "e " << e << ", ratio " << ratio;
      EXPECT_NEAR(b - a, e, 1e-6) << "e " << e << ", ratio " << ratio;
    }
  }
}

TEST(ContactLaws, AnElasticBallKeepsItsEnergy) {
  SceneBuilder s("bounce");
  s.add_geom(s.builder.world(), {ShapeType::kPlane});
  s.add("ball", {ShapeType::kSphere, {0.1, 0, 0}}, 10, {0, 0, 5}, {.restitution = 1});
  Bench world(s.builder.build());
  const double before = world.total_energy();
  world.run(20);
  EXPECT_NEAR(world.total_energy(), before, 1e-6);
}

TEST(ContactLaws, ABallRollsWithoutSlipAndRollingFrictionStopsIt) {
  SceneBuilder s("roll");
  const double r = 0.1, rolling = 0.004;
  s.add_geom(s.builder.world(), {ShapeType::kPlane});
  s.add("ball", {ShapeType::kSphere, {r, 0, 0}}, 2, {0, 0, r}, {.rolling_friction = rolling});
  Bench world(s.builder.build());
  world.v(1)[3] = 1;
  world.v(1)[1] = 1 / r;
  const double I = world.model.link(LinkId(1)).inertial.inertia.xx;
  // m r a = -rolling m g r / (r (1 + I / (m r^2))), by balance about the contact.
  const double a = rolling * 9.81 / (r * (1 + I / (2 * r * r))), stop = 1 / a;
  world.run(0.5 * stop);
  EXPECT_NEAR(world.v(1)[3], 0.5, 0.01);
  EXPECT_NEAR(world.v(1)[3], r * world.v(1)[1], 1e-6);
  world.run(0.48 * stop);
  EXPECT_GT(world.v(1)[3], 0.005);
  world.run(0.06 * stop);
  EXPECT_LT(std::abs(world.v(1)[3]), 1e-6);
}

TEST(ContactLaws, TorsionalFrictionStopsASpinningBall) {
  SceneBuilder s("spin");
  const double spinning = 0.01;
  s.add_geom(s.builder.world(), {ShapeType::kPlane});
  s.add("ball", {ShapeType::kSphere, {0.1, 0, 0}}, 2, {0, 0, 0.1}, {.spinning_friction = spinning});
  Bench world(s.builder.build());
  world.v(1)[2] = 10;
  const double stop = 10 * world.model.link(LinkId(1)).inertial.inertia.zz / (spinning * 2 * 9.81);
  world.run(0.98 * stop);
  EXPECT_GT(world.v(1)[2], 0.05);
  world.run(0.04 * stop);
  EXPECT_LT(std::abs(world.v(1)[2]), 1e-6);
}

TEST(ContactLaws, AnisotropicFrictionSlidesFarAlongTheSmoothAxis) {
  SceneBuilder s("grooves");
  s.add_geom(s.builder.world(), {ShapeType::kPlane}, Transform<double>::identity(), {.lateral_friction = 0.5});
  s.add("box", kCube, 1, {0, 0, 0.02}, {.lateral_friction = 0.5, .friction_y = 0.02});
  Bench world(s.builder.build());
  const double mu_x = 0.5, mu_y = std::sqrt(0.02 * 0.5);  // of the two geoms, by the geometric mean
  world.v(1)[3] = 0.5;
  world.run(0.05);
  EXPECT_NEAR(world.v(1)[3], 0.5 - mu_x * 9.81 * 0.05, 0.01);
  world.v(1)[3] = 0;
  world.v(1)[4] = 0.5;
  world.run(0.05);
  EXPECT_NEAR(world.v(1)[4], 0.5 - mu_y * 9.81 * 0.05, 0.01);
}

TEST(ContactLaws, APinchedCapsuleDoesNotCreep) {
  for (const double h : {0.002, 0.004}) {
    Bench world(testing::contact_scene(1), h);
    for (int u = 0; u < 2; ++u) world.state.ctrl()[u] = 0.008;
    world.run(2);
    const double before = world.q(1)[2];
    world.run(10);
    EXPECT_LT(std::abs(world.q(1)[2] - before) / 10, 1e-9) << "m/s at h " << h;
    EXPECT_GT(before, -0.01);
  }
}

TEST(ContactLaws, ThreeCubesStandStill) {
  Bench world(testing::contact_scene(0));
  world.run(1);
  const double before = world.q(3)[0];
  world.run(4);
  EXPECT_NEAR(world.q(3)[0], before, 1e-6);
  EXPECT_NEAR(world.q(3)[2] + world.model.bodies()[3].X_PF.p.z, 0.1 + 0.02 + 2 * 0.04, 1e-4);
}

TEST(ContactLaws, ASoftSurfaceSinksInByItsStiffness) {
  SceneBuilder s("soft");
  s.add_geom(s.builder.world(), {ShapeType::kPlane});
  s.add("ball", {ShapeType::kSphere, {0.1, 0, 0}}, 2, {0, 0, 0.1}, {.stiffness = 1e4, .damping = 200});
  Bench world(s.builder.build());
  world.run(3);
  EXPECT_NEAR(world.q(1)[2], -2 * 9.81 / 1e4, 1e-6);
}

TEST(ContactLaws, DeepOverlapComesApartSlowly) {
  SceneBuilder s("deep");
  s.add("a", kCube, 1, {0, 0, 0});
  s.add("b", kCube, 1, {0.005, 0, 0});
  s.builder.set_gravity({0, 0, 0});
  Bench world(s.builder.build());
  double fastest = 0;
  for (int n = 0; n < 500; ++n) {
    world.run(0.002);
    for (std::size_t b = 1; b <= 2; ++b) fastest = std::max(fastest, std::hypot(world.v(b)[3], world.v(b)[4]));
  }
  EXPECT_LT(fastest, 0.6);
  EXPECT_GT(std::abs(world.q(1)[0] - world.q(2)[0] - 0.005) + std::abs(world.q(1)[1] - world.q(2)[1]), 0.02);
}

/// How far the pin of the four-bar linkage is from its hole.
double pin_error(Bench& world) {
  bias_and_mass_matrix(world.system.tree, world.params, world.state.q(), world.state.v(), world.ws.dynamics);
  const TreeEquality<double>& loop = world.system.tree.equalities[0];
  const Workspace<double>& ws = world.ws.dynamics;
  const auto place = [&](std::size_t b, const Vec3<double>& p) { return ws.R_WB[b] * p + ws.p_OB[b] + ws.p_WO[b]; };
  return norm(place(loop.body_a, loop.X_BA.p) - place(loop.body_b, loop.X_BB.p));
}

TEST(ContactLaws, AFourBarLinkageStaysClosed) {
  Bench world(testing::contact_scene(4), 0.001);
  // A parallelogram: the bar keeps its heading.
  world.v(1)[0] = 3;
  world.v(2)[0] = -3;
  world.v(3)[0] = 3;
  double worst = 0;
  for (int n = 0; n < 3000; ++n) {
    world.run(0.001);
    worst = std::max(worst, pin_error(world));
  }
  EXPECT_LT(worst, 1e-6);
}

TEST(ContactLaws, AGearTurnsItsJointsTogetherAndSlipsAtItsLimit) {
  for (const double limit : {std::numeric_limits<double>::infinity(), 0.5}) {
    SceneBuilder s("gear");
    s.builder.set_gravity({0, 0, 0});
    s.add_hinge("a", s.builder.world(), {0, 0, 1}, 0.1, 1);
    s.add_hinge("b", s.builder.world(), {1, 0, 1}, 0.1, 1);
    s.builder.add_equality({.name = "gear",
                            .type = EqualityType::kGear,
                            .joint_a = JointId(0),
                            .joint_b = JointId(1),
                            .ratio = -2,
                            .max_force = limit});
    Bench world(s.builder.build());
    world.state.tau()[0] = 3;
    world.run(0.2);
    const double I = 1 * 0.01 + world.model.link(LinkId(1)).inertial.inertia.yy;
    if (limit > 1) {
      EXPECT_NEAR(world.state.v()[1], -2 * world.state.v()[0], 1e-9);
      EXPECT_NEAR(world.state.v()[0], 3 * 0.2 / (I + 4 * I), 1e-6);
    } else {
      EXPECT_NEAR(world.state.v()[1], -0.5 * 0.2 / I, 1e-6);
    }
  }
}

TEST(ContactLaws, APositionDriveIsAStiffSpringAtAnyStep) {
  SceneBuilder s("drive");
  const LinkId link = s.add_slide("mass", kCube, 2, {0, 0, 1}, {0, 0, 1});
  static_cast<void>(link);
  s.builder.add_actuator(
      {.name = "drive", .type = ActuatorType::kPosition, .joint = JointId(0), .kp = 5000, .kd = 50, .max_force = 60});
  for (const double h : {0.001, 0.01, 0.1}) {
    Bench world(s.builder.build(), h);
    world.state.ctrl()[0] = 0.1;
    world.run(6);
    EXPECT_NEAR(world.state.q()[0], 0.1 - 2 * 9.81 / 5000, 1e-6) << "h " << h;
  }
  Bench weak(s.builder.build());
  weak.params.drive_max_force[0] = 10;
  weak.run(0.5);
  EXPECT_NEAR(weak.state.v()[0], -(9.81 - 5) * 0.5, 0.05);  // less what it takes to press the spring
}

TEST(ContactLaws, DryJointFrictionHoldsUpToItsForce) {
  SceneBuilder s("dry");
  s.add_slide("mass", kCube, 2, {0, 0, 1}, {0, 0, 1});
  s.builder.joint(JointId(0)).friction = 15;
  Bench world(s.builder.build());
  world.run(0.5);
  EXPECT_NEAR(world.state.v()[0], -(9.81 - 7.5) * 0.5, 1e-9);
  world.params.friction[0] = 25;
  world.run(1);
  EXPECT_NEAR(world.state.v()[0], 0, 1e-12);
}

}  // namespace
}  // namespace manyhands
