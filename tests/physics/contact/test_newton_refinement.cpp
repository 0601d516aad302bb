// Where iterations alone do not converge: stacks, heavy on light, and an arm that presses with all it has. The law is
// checked on the reference's own problem, made from masses, points and normals alone.
#include <gtest/gtest.h>

#include <limits>
#include <numeric>
#include <random>
#include <utility>

#include "manyhands/model/model_builder.h"
#include "manyhands/physics/contact/newton/law_residual.h"
#include "manyhands/physics/contact/newton/newton_refinement.h"
#include "manyhands/physics/step/step.h"
#include "tests/physics/contact/reference/newton.h"
#include "tests/physics/contact/reference/scenes.h"

namespace manyhands {
namespace {

using testing::kGravity;
using testing::kStep;

constexpr double kHalf = 0.05;     // of a cube [m]
constexpr double kFriction = 0.3;  // of every surface, and of two together (geometric mean)
constexpr double kHeavyRatio = 100;

/// Relative to the velocities of a free step. Where stacks slide, some runs stall at a residual of 1e-7 m/s.
constexpr double kLawTolerance = 1e-6, kSlidingTolerance = 1e-5;

Eigen::Vector3d eigen(const Vec3<double>& a) { return {a.x, a.y, a.z}; }

void add_geom(ModelBuilder& builder, LinkId link, const Shape& shape, const Vec3<double>& p = Vec3<double>::zero()) {
  Geom geom;
  geom.link = link;
  geom.shape = shape;
  geom.X_LG = {Mat3<double>::identity(), p};
  geom.surface.lateral_friction = kFriction;
  builder.add_geom(geom);
}

/// Cubes on the ground, the first at the bottom; more is added by the test.
ModelBuilder stack_of(const std::vector<double>& masses) {
  ModelBuilder builder("stack");
  add_geom(builder, builder.world(), {ShapeType::kPlane});
  for (std::size_t i = 0; i < masses.size(); ++i) {
    const std::string name = "cube" + std::to_string(i);
    const double moment = masses[i] / 1.5 * kHalf * kHalf;
    const LinkId link = builder.add_link(name, {.mass = masses[i], .inertia = {moment, moment, moment, 0, 0, 0}});
    builder.add_joint({.name = name,
                       .type = JointType::kFloating,
                       .parent = builder.world(),
                       .child = link,
                       .X_PF = {Mat3<double>::identity(), {0, 0, kHalf * (1 + 2 * static_cast<double>(i))}}});
    add_geom(builder, link, {ShapeType::kBox, {kHalf, kHalf, kHalf}});
  }
  return builder;
}

struct Simulation {
  explicit Simulation(Model what)
      : model(std::move(what)), system(model), params(model), state(model, system.contact_numbers()), ws(system) {}
  void advance() { step(system, params, kStep, state, ws); }

  [[nodiscard]] const ContactPatch<double>& patch(std::size_t i) const {
    return ws.contact.problem.patches[ws.contact.problem.points[i].patch];
  }
  [[nodiscard]] Eigen::Vector3d impulse(std::size_t i) const {
    const Vec3<double>& y = ws.contact.iterate.points[i].impulse;
    return eigen(y.x * patch(i).normal + y.y * patch(i).e_1 + y.z * patch(i).e_2);
  }
  [[nodiscard]] std::size_t num_points() const { return ws.contact.problem.points.size(); }
  /// What the ground bears [N].
  [[nodiscard]] double weight_on_ground() const {
    double sum = 0;
    for (std::size_t i = 0; i < num_points(); ++i)
      if (patch(i).body_a() == 0 || patch(i).body_b() == 0) sum += std::abs(impulse(i)[2]) / kStep;
    return sum;
  }
  [[nodiscard]] double deepest() const {
    double depth = 0;
    for (const ContactPoint<double>& point : ws.contact.problem.points) depth = std::max(depth, -point.phi);
    return depth;
  }

  Model model;
  System<double> system;
  ParamsStorage<double> params;
  StateStorage<double> state;
  StepWorkspace<double> ws;
};

struct Judged {
  double law, consistency;  ///< relative to the problem's scale
};

/// The first step of a stack whose cubes have been pushed about, as the reference sees it.
Judged judge_first_step(const std::vector<double>& masses, unsigned seed, int newton_steps) {
  Simulation sim(stack_of(masses).build());
  sim.system.solver.newton_steps = newton_steps;
  sim.system.solver.newton_tolerance = 1e-8;
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> push(-0.05, 0.05);
  testing::ProblemBuilder scene;
  for (std::size_t i = 0; i < masses.size(); ++i) {
    const Eigen::Vector3d velocity = seed == 0 ? Eigen::Vector3d::Zero() : Eigen::Vector3d(push(rng), push(rng), 0);
    for (int k = 0; k < 3; ++k) sim.state.v()[6 * static_cast<int>(i) + 3 + k] = velocity[k];
    const double side = 2 * kHalf;
    scene.add_body(masses[i], testing::box_inertia(masses[i], {side, side, side}),
                   {0, 0, kHalf * (1 + 2 * static_cast<double>(i))}, Eigen::Matrix3d::Identity(), velocity);
  }
  sim.advance();
  Eigen::VectorXd lambda(3 * static_cast<Eigen::Index>(sim.num_points())), v(sim.model.nv());
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < sim.num_points(); ++i) {
    const ContactPoint<double>& point = sim.ws.contact.problem.points[i];
    const ContactPatch<double>& patch = sim.patch(i);
    const Eigen::Vector3d n = eigen(patch.normal), impulse = sim.impulse(i);
    EXPECT_LT(std::abs(point.phi), 1e-6);
    scene.add_contact(static_cast<int>(patch.body_a()) - 1, static_cast<int>(patch.body_b()) - 1, eigen(point.p), n,
                      kFriction);
    const Eigen::Vector3d t = n.unitOrthogonal();
    lambda.segment<3>(row) << n.dot(impulse), t.dot(impulse), n.cross(t).dot(impulse);
    row += 3;
  }
  for (Eigen::Index i = 0; i < v.size(); ++i) v[i] = sim.state.v()[i];
  const testing::ReferenceProblem problem = scene.build();
  const testing::ContactResiduals found = testing::residuals(problem, {v, lambda});
  return {found.law / problem.scale, found.consistency / problem.scale};
}

std::vector<double> card_of_ten() {
  std::vector<double> masses(10, 1.0);
  masses.back() = kHeavyRatio;
  return masses;
}

TEST(NewtonRefinement, ObeysTheLawOnTowersAtRest) {
  for (const std::size_t cubes : {5, 10}) {
    const Judged found = judge_first_step(std::vector<double>(cubes, 1.0), 0, 10);
    EXPECT_LT(found.law, kLawTolerance) << cubes << " cubes";
    EXPECT_LT(found.consistency, 1e-9) << cubes << " cubes";
  }
}

TEST(NewtonRefinement, ObeysTheLawWhereStacksSlide) {
  for (const std::vector<double>& masses : {std::vector<double>{1, 1}, {1, 1, 1}, {1, kHeavyRatio}, {10, 1, 10}}) {
    for (unsigned seed = 1; seed < 9; ++seed) {
      const Judged found = judge_first_step(masses, seed, 20);
      EXPECT_LT(found.law, kSlidingTolerance) << masses.size() << " cubes, seed " << seed;
      EXPECT_LT(found.consistency, 1e-9) << masses.size() << " cubes, seed " << seed;
    }
  }
}

TEST(NewtonRefinement, IsNeededThere) {
  EXPECT_GT(judge_first_step(std::vector<double>(10, 1.0), 0, 0).law, 1e-5);
  EXPECT_GT(judge_first_step(card_of_ten(), 0, 0).law, 1e-3);
}

TEST(NewtonRefinement, TowerOfTenStands) {
  Simulation sim(stack_of(std::vector<double>(10, 1.0)).build());
  const std::vector<double> before(sim.state.q(), sim.state.q() + sim.model.nq());
  int newton_steps = 0;
  for (int n = 0; n < 1000; ++n) {
    sim.advance();
    newton_steps += sim.ws.contact.newton.steps();
  }
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_NEAR(sim.state.q()[i], before[i], 2e-5) << "coordinate " << i;
  EXPECT_GT(newton_steps, 0);
}

TEST(NewtonRefinement, HeavyRestsOnLight) {
  for (const std::vector<double>& masses : {std::vector<double>{1.0, kHeavyRatio}, card_of_ten()}) {
    Simulation sim(stack_of(masses).build());
    double deepest = 0;
    for (int n = 0; n < 500; ++n) {
      sim.advance();
      deepest = std::max(deepest, sim.deepest());
    }
    const double weight = kGravity * std::accumulate(masses.begin(), masses.end(), 0.0);
    EXPECT_NEAR(sim.weight_on_ground(), weight, 1e-3 * weight);
    EXPECT_LT(deepest, 1e-5);
  }
}

TEST(NewtonRefinement, SaturatedArmPressesAStack) {
  constexpr double kReach = 0.5, kTip = 0.05, kTorque = 50, kArmMass = 1;
  const std::vector<double> masses(5, 1.0);
  const double height = 10 * kHalf + kTip;
  ModelBuilder builder = stack_of(masses);
  const LinkId arm =
      builder.add_link("arm", {.mass = kArmMass, .com = {kReach, 0, 0}, .inertia = {0.001, 0.001, 0.001, 0, 0, 0}});
  builder.add_joint({.name = "shoulder",
                     .type = JointType::kRevolute,
                     .parent = builder.world(),
                     .child = arm,
                     .X_PF = {Mat3<double>::identity(), {-kReach, 0, height}},
                     .axis = {0, 1, 0}});
  add_geom(builder, arm, {ShapeType::kSphere, {kTip, 0, 0}}, {kReach, 0, 0});
  Simulation sim(builder.build());
  const int shoulder = sim.model.nv() - 1;
  sim.params.motor_kd[static_cast<std::size_t>(shoulder)] = 1;
  sim.params.motor_max_force[static_cast<std::size_t>(shoulder)] = kTorque;
  sim.state.target_v()[shoulder] = 1;  // downwards at the tip
  for (int n = 0; n < 500; ++n) sim.advance();
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  double moment = 0;
  for (std::size_t i = 0; i < sim.num_points(); ++i) {
    const ContactPoint<double>& point = sim.ws.contact.problem.points[i];
    const bool is_a = sim.patch(i).body_a() == masses.size() + 1, is_b = sim.patch(i).body_b() == masses.size() + 1;
    if (!is_a && !is_b) continue;
    const Eigen::Vector3d on_arm = (is_b ? 1 : -1) / kStep * sim.impulse(i);
    const Eigen::Vector3d r = eigen(point.p) - Eigen::Vector3d(-kReach, 0, height);
    force += on_arm;
    moment += r.cross(on_arm)[1];
  }
  const double asked = kTorque + kReach * kArmMass * kGravity;
  EXPECT_NEAR(moment, -asked, 1e-4 * asked);
  EXPECT_NEAR(sim.weight_on_ground(), 5 * kGravity + force[2], 1e-4 * force[2]);
}

/// An outer step that ends in such impulses is not kept.
TEST(NewtonRefinement, ImpulsesThatAreNoNumbersBreakTheLaw) {
  Simulation sim(stack_of({1, 1}).build());
  sim.advance();
  const NewtonContext context{sim.ws.contact.problem, sim.ws.contact.factors, sim.ws.contact.iterate};
  EXPECT_LT(internal::law_residual(context), 1e-6);
  for (PointImpulse<double>& point : context.iterate.points) {
    for (double* component : {&point.impulse.x, &point.impulse.y, &point.impulse.z}) {
      const double kept = std::exchange(*component, std::numeric_limits<double>::quiet_NaN());
      EXPECT_EQ(internal::law_residual(context), std::numeric_limits<double>::infinity());
      *component = kept;
    }
  }
}

}  // namespace
}  // namespace manyhands
