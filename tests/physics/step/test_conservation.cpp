// What free motion must keep, and what it must do by formula: the contact-free cases of accuracy.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "manyhands/model/model_builder.h"
#include "manyhands/physics/world/world.h"
#include "tests/physics/dynamics/random_tree.h"

namespace manyhands {
namespace {

using testing::Generator;

SymMat3<double> diagonal(double xx, double yy, double zz) { return {xx, yy, zz, 0, 0, 0}; }

/// A floating base and 12 hinges in four legs of three: 18 degrees of freedom.
std::shared_ptr<const Model> four_legs() {
  ModelBuilder builder("four legs");
  const LinkId base = builder.add_link("base", {.mass = 10, .inertia = diagonal(0.2, 0.4, 0.5)});
  builder.add_joint({.name = "root", .type = JointType::kFloating, .parent = builder.world(), .child = base});
  for (int leg = 0; leg < 4; ++leg) {
    LinkId parent = base;
    for (int k = 0; k < 3; ++k) {
      const std::string name = std::to_string(leg) + std::to_string(k);
      const LinkId child =
          builder.add_link("link" + name, {.mass = 1, .com = {0, 0, -0.15}, .inertia = diagonal(0.008, 0.008, 0.001)});
      const Vec3<double> hip{leg < 2 ? 0.3 : -0.3, leg % 2 == 0 ? 0.2 : -0.2, 0};
      builder.add_joint({.name = "joint" + name,
                         .type = JointType::kContinuous,
                         .parent = parent,
                         .child = child,
                         .X_PF = {Mat3<double>::identity(), k == 0 ? hip : Vec3<double>{0, 0, -0.3}},
                         .axis = k == 0 ? Vec3<double>{1, 0, 0} : Vec3<double>{0, 1, 0}});
      parent = child;
    }
  }
  return std::make_shared<const Model>(builder.build());
}

double total_energy(const World& world) { return world.energy().kinetic + world.energy().potential; }

struct FallErrors {
  double energy, momentum;  ///< squared, averaged over the flight [J^2], [(kg m/s)^2]
};

/// Thrown by a force and a moment on the base for 1 s, then 2 s of free flight under gravity.
FallErrors fall(double h) {
  World world(four_legs(), h, Integrator::kRungeKutta4);
  std::vector<double> tau(18, 0.0);
  tau[0] = 1.0;
  tau[1] = -0.5;
  tau[3] = 20.0;
  tau[5] = 250.0;
  world.set_tau(tau);
  world.step(static_cast<int>(std::lround(1 / h)));
  world.set_tau(std::vector<double>(18, 0.0));
  const double energy = total_energy(world);
  const Vec3<double> p = world.mass_properties().momentum.f;
  const double mass = world.mass_properties().mass, start = world.time();
  FallErrors sum{0, 0};
  const int steps = static_cast<int>(std::lround(2 / h));
  for (int i = 0; i < steps; ++i) {
    world.step();
    sum.energy += square(total_energy(world) - energy) / steps;
    const Vec3<double> expected = p + (world.time() - start) * mass * Vec3<double>{0, 0, -9.81};
    sum.momentum += squared_norm(world.mass_properties().momentum.f - expected) / steps;
  }
  return sum;
}

TEST(Conservation, FreeArticulatedFallKeepsEnergyAndMomentum) {
  const FallErrors errors = fall(0.0005);
  EXPECT_LE(errors.energy, 1e-20);
  EXPECT_LE(errors.momentum, 1e-20);
  RecordProperty("energy", std::to_string(std::log10(errors.energy)));
  RecordProperty("momentum", std::to_string(std::log10(errors.momentum)));
}

/// All types of joint: the error of RK4 falls 16 times for half the step, rotations by quaternion included.
TEST(Conservation, RungeKuttaIsOfFourthOrder) {
  for (const std::uint64_t seed : {3u, 11u, 29u}) {
    const auto model = std::make_shared<const Model>(testing::random_tree(seed, 7));
    Generator rng(seed);
    const std::vector<double> q = testing::random_configuration(*model, rng);
    std::vector<double> v = testing::random_numbers(static_cast<std::size_t>(model->nv()), rng);
    const auto run = [&](int steps) {
      World world(model, 0.1 / steps, Integrator::kRungeKutta4);
      world.set_q(q);
      world.set_v(v);
      world.step(steps);
      return std::vector<double>(world.q().begin(), world.q().end());
    };
    const std::vector<double> truth = run(1280);
    const auto error = [&](int steps) {
      const std::vector<double> found = run(steps);
      double sum = 0;
      for (std::size_t i = 0; i < found.size(); ++i) sum += square(found[i] - truth[i]);
      return std::sqrt(sum);
    };
    const double order = std::log2(error(20) / error(40));
    EXPECT_GT(order, 3.7) << "seed " << seed << ", error " << error(40);
  }
}

/// A body about its middle axis: Euler's equations have elliptic solutions (Landau and Lifshitz, Mechanics, section
/// 37).
TEST(Conservation, TorqueFreeSpinFlipsAtTheAnalyticPeriod) {
  const double A = 1.0, B = 2.0, C = 3.0;  // moments of inertia [kg m^2]
  ModelBuilder builder("spinner");
  builder.set_gravity(Vec3<double>::zero());
  const LinkId body = builder.add_link("body", {.mass = 1, .inertia = diagonal(A, B, C)});
  builder.add_joint({.name = "ball", .type = JointType::kSpherical, .parent = builder.world(), .child = body});
  const double h = 0.001;
  World world(std::make_shared<const Model>(builder.build()), h, Integrator::kRungeKutta4);
  const Vec3<double> spin{0.02, 5.0, 0.01};  // body axes = world axes at the start
  world.set_v(std::vector{spin.x, spin.y, spin.z});
  const Vec3<double> L0 = world.mass_properties().momentum.n;

  // With E and L: period 4 K(k) / sqrt((C - B)(L^2 - 2 E A) / (A B C)) if L^2 > 2 E B, A and C exchanged if not.
  const double twice_E = A * spin.x * spin.x + B * spin.y * spin.y + C * spin.z * spin.z;
  const double L2 = squared_norm(L0);
  const bool above = L2 > twice_E * B;
  const double a = above ? A : C, c = above ? C : A;
  const double rate = std::sqrt((c - B) * (L2 - twice_E * a) / (A * B * C));
  const double k2 = (B - a) * (twice_E * c - L2) / ((c - B) * (L2 - twice_E * a));
  const double period = 4 * std::comp_ellint_1(std::sqrt(k2)) / rate;

  // The spin about the middle axis, in the body, changes its sign every half period.
  const auto middle = [&] {
    const std::span<const double> q = world.q(), v = world.v();
    const Mat3<double> R = to_matrix(Quat<double>{q[0], q[1], q[2], q[3]});
    return dot(R.y, Vec3<double>{v[0], v[1], v[2]});
  };
  std::vector<double> flips;
  double worst = 0;
  while (flips.size() < 5 && world.time() < 60) {
    const double before = middle(), time = world.time();
    world.step();
    const double after = middle();
    if (before * after < 0) flips.push_back(time + h * before / (before - after));
    worst = std::max(worst, norm(world.mass_properties().momentum.n - L0));
  }
  ASSERT_EQ(flips.size(), 5u);
  for (std::size_t i = 1; i < flips.size(); ++i) EXPECT_NEAR(flips[i] - flips[i - 1], period / 2, 1e-6 * period);
  EXPECT_LE(worst, 1e-10 * norm(L0));
}

std::shared_ptr<const Model> pendulum(int links) {
  ModelBuilder builder("pendulum");
  LinkId parent = builder.world();
  for (int i = 0; i < links; ++i) {
    const LinkId rod = builder.add_link("rod" + std::to_string(i),
                                        {.mass = 1, .com = {0, 0, -0.5}, .inertia = diagonal(1.0 / 12, 1.0 / 12, 0)});
    builder.add_joint({.name = "hinge" + std::to_string(i),
                       .type = JointType::kContinuous,
                       .parent = parent,
                       .child = rod,
                       .X_PF = {Mat3<double>::identity(), {0, 0, i == 0 ? 0.0 : -1.0}},
                       .axis = {0, 1, 0}});
    parent = rod;
  }
  return std::make_shared<const Model>(builder.build());
}

TEST(Conservation, PendulumSwingsWithTheEllipticPeriod) {
  const double amplitude = 2.0, h = 0.0005;
  const double small_swing = std::sqrt(9.81 * 0.5 / (1.0 / 12 + 0.25));  // rod of 1 m and 1 kg about its end
  const double period = 4 * std::comp_ellint_1(std::sin(amplitude / 2)) / small_swing;
  World world(pendulum(1), h, Integrator::kRungeKutta4);
  world.set_q(std::vector{amplitude});
  std::vector<double> crossings;  // of the lowest point
  while (crossings.size() < 7) {
    const double before = world.q()[0], time = world.time();
    world.step();
    const double after = world.q()[0];
    if (before * after < 0) crossings.push_back(time + h * before / (before - after));
    ASSERT_LT(world.time(), 60);
  }
  EXPECT_NEAR((crossings[6] - crossings[0]) / 3, period, 1e-6 * period);
}

TEST(Conservation, DoublePendulumKeepsItsEnergy) {
  const auto drift = [](Integrator integrator, double h, double q0, double q1) {
    World world(pendulum(2), h, integrator);
    world.set_q(std::vector{q0, q1});
    const double energy = total_energy(world);
    double worst = 0;
    for (int i = 0; i < static_cast<int>(5 / h); ++i) {
      world.step();
      worst = std::max(worst, std::abs(total_energy(world) - energy));
    }
    return worst;
  };
  EXPECT_LT(drift(Integrator::kRungeKutta4, 0.001, 2.0, 1.0), 1e-6);
  // The semi-implicit step is of first order: half the step, half the error. Small swings, which are not chaotic.
  const double coarse = drift(Integrator::kSemiImplicit, 0.001, 0.3, 0.2);
  const double fine = drift(Integrator::kSemiImplicit, 0.0005, 0.3, 0.2);
  EXPECT_NEAR(std::log2(coarse / fine), 1.0, 0.1) << coarse << ' ' << fine;
}

TEST(Conservation, DampingIsImplicitAndRightInBothIntegrators) {
  ModelBuilder builder("slider");
  builder.set_gravity(Vec3<double>::zero());
  const LinkId body = builder.add_link("body", {.mass = 2});
  builder.add_joint(
      {.name = "slide", .type = JointType::kPrismatic, .parent = builder.world(), .child = body, .damping = 3});
  const auto model = std::make_shared<const Model>(builder.build());
  const double exact = std::exp(-1.5);  // v' = -(3 / 2) v, after 1 s
  World rk4(model, 0.01, Integrator::kRungeKutta4), euler(model, 0.01), coarse(model, 10.0);
  for (World* world : {&rk4, &euler, &coarse}) world->set_v(std::vector{1.0});
  rk4.step(100);
  euler.step(100);
  coarse.step();
  EXPECT_NEAR(rk4.v()[0], exact, 1e-9);
  EXPECT_NEAR(euler.v()[0], std::pow(1 + 0.015, -100), 1e-12);
  EXPECT_GT(coarse.v()[0], 0.0);  // an explicit step of this length would turn the motion round
}

}  // namespace
}  // namespace manyhands
