// The reference solvers themselves: closed forms, and agreement of three methods that share only the problem's
// statement.
#include <gtest/gtest.h>

#include "tests/physics/contact/reference/admm.h"
#include "tests/physics/contact/reference/newton.h"
#include "tests/physics/contact/reference/scenes.h"

namespace manyhands::testing {
namespace {

struct NamedSolver {
  const char* name;
  ReferenceSolution (*solve)(const ReferenceProblem&);
};

constexpr std::array kSolvers{
    NamedSolver{"Gauss-Seidel", [](const ReferenceProblem& p) { return solve_gauss_seidel(p); }},
    NamedSolver{"ADMM", [](const ReferenceProblem& p) { return solve_admm(p); }},
    NamedSolver{"Newton", [](const ReferenceProblem& p) { return solve_newton(p); }},
};

class EverySolver : public ::testing::TestWithParam<NamedSolver> {
 protected:
  [[nodiscard]] static ReferenceSolution solve(const ReferenceProblem& problem) { return GetParam().solve(problem); }
};

INSTANTIATE_TEST_SUITE_P(Reference, EverySolver, ::testing::ValuesIn(kSolvers), [](const auto& solver) {
  std::string name = solver.param.name;
  std::erase(name, '-');
  return name;
});

/// A cube of 1 kg and 0.1 m at rest on a slope that falls by `slope` towards `heading`; before the step's gravity.
ReferenceProblem cube_on_slope(double slope, double heading, double mu) {
  const Eigen::Matrix3d R =
      (Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(slope, Eigen::Vector3d::UnitY()))
          .toRotationMatrix();
  ProblemBuilder scene;
  const int cube =
      scene.add_body(1, box_inertia(1, Eigen::Vector3d::Constant(0.1)), R * Eigen::Vector3d(0, 0, 0.05), R);
  scene.add_patch(ProblemBuilder::kWorld, cube, Eigen::Vector3d::Zero(), 0.05 * R.col(0), 0.05 * R.col(1), mu);
  return scene.build();
}

TEST_P(EverySolver, HoldsACubeOnASlopeBelowTheAngleOfFriction) {
  for (const double heading : {0.0, 0.4, 2.0}) {
    const ReferenceSolution x = solve(cube_on_slope(std::atan(0.5) - 0.01, heading, 0.5));
    EXPECT_LE(x.v.lpNorm<Eigen::Infinity>(), 1e-10) << "heading " << heading;
  }
}

/// v = h g (sin a - mu cos a) down the slope, whichever way it falls (a cone, not a pyramid), and nothing else: sliding
/// neither lifts nor turns the cube.
TEST_P(EverySolver, LetsACubeSlideDownASteeperSlope) {
  const double angle = std::atan(0.5) + 0.05;
  for (const double heading : {0.0, 0.4, 2.0}) {
    const ReferenceSolution x = solve(cube_on_slope(angle, heading, 0.5));
    const double speed = kStep * kGravity * (std::sin(angle) - 0.5 * std::cos(angle));
    const Eigen::Vector3d down(std::cos(heading) * std::cos(angle), std::sin(heading) * std::cos(angle),
                               -std::sin(angle));
    EXPECT_LE(x.v.head<3>().norm(), 1e-9) << "heading " << heading;
    EXPECT_LE((x.v.tail<3>() - speed * down).norm(), 1e-11) << "heading " << heading;
  }
}

/// A ball of 2 kg and radius 0.1 m thrown along the ground at `speed`.
ReferenceProblem thrown_ball(double speed, double mu) {
  ProblemBuilder scene;
  const double inertia = 0.4 * 2 * 0.01;
  const Eigen::Vector3d velocity = speed * Eigen::Vector3d(0.6, 0.8, 0);
  const int ball =
      scene.add_body(2, Eigen::Vector3d::Constant(inertia), {0, 0, 0.1}, Eigen::Matrix3d::Identity(), velocity);
  scene.add_contact(ProblemBuilder::kWorld, ball, {0, 0, 0}, Eigen::Vector3d::UnitZ(), mu);
  return scene.build();
}

TEST_P(EverySolver, SlowsASlidingBallAndSpinsIt) {
  const ReferenceSolution x = solve(thrown_ball(1, 0.5));
  const double change = 0.5 * kStep * kGravity;
  EXPECT_NEAR(x.v[3], 0.6 * (1 - change), 1e-12);
  EXPECT_NEAR(x.v[4], 0.8 * (1 - change), 1e-12);
  EXPECT_NEAR(x.v[5], 0, 1e-12);
  EXPECT_NEAR(x.v[0], -0.8 * 2.5 * change / 0.1, 1e-10);  // m r dv = 2/5 m r^2 dw
  EXPECT_NEAR(x.v[1], 0.6 * 2.5 * change / 0.1, 1e-10);
}

/// A ball that friction can bring to rolling within the step keeps 5/7 of its speed.
TEST_P(EverySolver, BringsASlowBallToRolling) {
  const ReferenceSolution x = solve(thrown_ball(0.01, 0.5));
  EXPECT_NEAR(x.v[3], 0.6 * 0.01 * 5 / 7, 1e-13);
  EXPECT_NEAR(x.v[4], 0.8 * 0.01 * 5 / 7, 1e-13);
}

/// Two balls meet head on: they part at e times the speed of approach, and the momentum stays.
TEST_P(EverySolver, ObeysNewtonsLawOfImpact) {
  for (const double ratio : {1e-4, 0.3, 1.0, 1e4}) {
    ProblemBuilder scene;
    const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), inertia = Eigen::Vector3d::Ones();
    const int left = scene.add_body(1, inertia, -0.1 * x, Eigen::Matrix3d::Identity(), 2 * x);
    const int right = scene.add_body(ratio, ratio * inertia, 0.1 * x, Eigen::Matrix3d::Identity(), -3 * x);
    scene.add_contact(left, right, Eigen::Vector3d::Zero(), x, 0.4);
    ReferenceProblem problem = scene.build();
    problem.b[0] = 0.7 * 5;
    const ReferenceSolution after = solve(problem);
    EXPECT_NEAR(after.v[9] - after.v[3], 3.5, 1e-9) << "ratio " << ratio;
    EXPECT_NEAR(after.v[3] + ratio * after.v[9], 2 - 3 * ratio, 1e-10 * (1 + ratio)) << "ratio " << ratio;
  }
}

TEST_P(EverySolver, LetsGoOfWhatParts) {
  ReferenceProblem problem = thrown_ball(1, 0.5);
  problem.free_velocity[5] = 0.3;
  const ReferenceSolution x = solve(problem);
  EXPECT_EQ(x.lambda.norm(), 0);
  EXPECT_EQ((x.v - problem.free_velocity).norm(), 0);
}

/// Who carries what within a layer is not determined, but each layer carries all that stands above it.
TEST_P(EverySolver, CarriesTheWeightOfATower) {
  const ReferenceProblem problem = tower({1, 2, 0.5});
  const ReferenceSolution x = solve(problem);
  EXPECT_LE(x.v.lpNorm<Eigen::Infinity>(), 1e-9);
  double above = 3.5;
  for (int layer = 0; layer < 3; ++layer) {
    double carried = 0;
    for (int i = 4 * layer; i < 4 * layer + 4; ++i) carried += x.lambda[3 * i];
    EXPECT_NEAR(carried, above * kStep * kGravity, 1e-9) << "layer " << layer;
    above -= std::array{1, 2, 0}[static_cast<std::size_t>(layer)];
  }
}

TEST_P(EverySolver, ObeysTheLawInEveryScene) {
  const std::vector<std::pair<const char*, ReferenceProblem>> scenes{
      {"box spinning", box_on_ground({0.1, 0, 0}, {0, 0, 5})},
      {"box sliding", box_on_ground({1, 0.3, 0}, {0, 0, 0})},
      {"slide grasp", slide_grasp()},
      {"hinge grasp", hinge_grasp()},
      {"peg", peg_jam()},
      {"spheres", sphere_pile(3)},
  };
  for (const auto& [name, problem] : scenes) {
    const ContactResiduals r = residuals(problem, solve(problem));
    EXPECT_LE(r.law, 1e-10 * problem.scale) << name;
    EXPECT_LE(r.signorini, 1e-10 * problem.scale) << name;
    EXPECT_LE(r.cone, 1e-10 * problem.scale) << name;
    EXPECT_LE(r.dissipation, 1e-9 * problem.scale) << name;
    EXPECT_LE(r.consistency, 1e-10 * problem.scale) << name;
  }
}

/// With independent contacts and little friction there is one solution: all methods must find it.
TEST(Reference, MethodsAgreeWhereTheSolutionIsUnique) {
  int touching = 0, sliding = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const ReferenceProblem problem = random_problem(seed, 18, 5, 100, 0.2);
    const Eigen::VectorXd first = kSolvers[0].solve(problem).lambda;
    for (const NamedSolver& solver : {kSolvers[1], kSolvers[2]}) {
      const Eigen::VectorXd other = solver.solve(problem).lambda;
      EXPECT_LE((other - first).norm(), 1e-8 * (1 + first.norm())) << solver.name << ", seed " << seed;
    }
    for (int i = 0; i < problem.contacts(); ++i) {
      touching += first[3 * i] > 0;
      sliding += first[3 * i] > 0 && first.segment<2>(3 * i + 1).norm() > 0.999 * problem.mu[i] * first[3 * i];
    }
  }
  EXPECT_GT(touching, 60);
  EXPECT_GT(sliding, 30);
}

/// Ten cubes, 100 kg on nine of 1 kg, and a dry arch: where iterations alone do not converge.
TEST(Reference, NewtonSolvesWhatIterationsCannot) {
  std::vector<double> topped(10, 1.0);
  topped.back() = 100;
  for (const ReferenceProblem& problem : {tower(std::vector<double>(10, 1.0)), tower(topped), arch(9)}) {
    const auto after = [&](const ReferenceSolution& x) { return residuals(problem, x).law / problem.scale; };
    EXPECT_LE(after(solve_newton(problem, {.tolerance = 1e-9})), 1e-9);
    EXPECT_GE(after(solve_gauss_seidel(problem, {.max_sweeps = 100})), 1e-4);
  }
}

/// One contact by itself, for friction and inertias beyond all that is sensible.
TEST(Reference, SolvesOneContactExactly) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 20000; ++k) {
    const double mu = std::array{0.01, 0.5, 1.5, 5.0}[static_cast<std::size_t>(k % 4)];
    const auto sample = [&] { return normal(random); };
    const Eigen::Matrix3d Q =
        Eigen::HouseholderQR<Eigen::Matrix3d>(Eigen::Matrix3d::NullaryExpr(sample)).householderQ();
    const Eigen::Vector3d sizes = Eigen::Vector3d::NullaryExpr([&] { return std::pow(10.0, normal(random)); });
    const Eigen::Matrix3d G = Q * sizes.asDiagonal() * Q.transpose();
    // Every second velocity comes from an impulse that lies a little outside the cone, down to 1e-10 of itself.
    Eigen::Vector3d free = 2 * Eigen::Vector3d::NullaryExpr(sample);
    if (k % 2 == 0) {
      const double angle = normal(random), outside = 1 + std::pow(10.0, -10 * std::abs(std::sin(3 * angle)));
      free = -G * Eigen::Vector3d(1, mu * outside * std::cos(angle), mu * outside * std::sin(angle));
    }
    const ReferenceProblem problem(G.inverse().sparseView(), free, SparseRows(Eigen::Matrix3d::Identity().sparseView()),
                                   Eigen::VectorXd::Constant(1, mu), Eigen::VectorXd::Zero(1));
    Eigen::Matrix2d turn;
    const LocalContact contact = make_local_contact(G, mu, turn);
    Eigen::Vector3d w = problem.free_velocity;
    w.tail<2>() = (turn.transpose() * w.tail<2>()).eval();
    Eigen::Vector3d lambda = solve_local(contact, w);
    lambda.tail<2>() = (turn * lambda.tail<2>()).eval();
    const Eigen::Vector3d u = problem.free_velocity + G * lambda;
    EXPECT_LE(residuals(problem, {u, lambda}).law, 1e-9 * problem.scale) << "case " << k << ", mu " << mu;
  }
}

/// The residuals see each way of breaking the law.
TEST(Reference, ResidualsTellWhatIsBroken) {
  const ReferenceProblem problem = thrown_ball(1, 0.5);
  const Eigen::VectorXd right = solve_gauss_seidel(problem).lambda;
  const auto with = [&](const Eigen::Vector3d& impulse) { return residuals(problem, problem.solution_of(impulse)); };
  EXPECT_LE(with(right).law, 1e-12);

  const Eigen::Vector3d nothing(0, 0, 0), pressed(2 * right[0], right[1], right[2]);
  EXPECT_NEAR(with(nothing).dual, kStep * kGravity, 1e-12);
  EXPECT_GT(with(pressed).signorini, 1e-3);
  EXPECT_GT(with({right[0], 2 * right[1], 2 * right[2]}).cone, 1e-3);
  EXPECT_GT(with({right[0], right[2], -right[1]}).dissipation, 0.5);
  EXPECT_GT(with({right[0], 0.5 * right[1], 0.5 * right[2]}).dissipation, 0.4);
  for (const Eigen::Vector3d& wrong : {nothing, pressed, Eigen::Vector3d(right[0], right[2], -right[1])}) {
    EXPECT_GT(with(wrong).law, 1e-3);
  }
  ReferenceSolution inconsistent = problem.solution_of(right);
  inconsistent.v[3] += 0.1;
  EXPECT_NEAR(residuals(problem, inconsistent).consistency, 0.1, 1e-12);
}

}  // namespace
}  // namespace manyhands::testing
