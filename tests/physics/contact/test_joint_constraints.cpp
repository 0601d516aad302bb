#include <gtest/gtest.h>

#include <iostream>
#include <map>

#include "tests/physics/contact/joint_solution.h"

namespace manyhands {
namespace {

using testing::Generator;
using testing::JointLaw;
using testing::JointProblem;
using testing::JointSolution;
using testing::JointSolver;
using testing::solution_of;

double worst_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(a[i] - b[i]) / (1 + std::abs(b[i])));
  return worst;
}

constexpr int kTrees = 1500;

TEST(JointConstraints, ObeyTheirLawInDouble) {
  for (std::uint64_t seed = 0; seed < kTrees; ++seed) {
    const JointProblem<double> p(seed, 1 + static_cast<int>(seed % 12));
    const JointSolution<double> found = solution_of(p);
    EXPECT_LE(JointLaw(p).residual(found.dv, 1e-11), 1e-10) << "seed " << seed << ", nv " << p.tree.nv;
  }
}

/// Speeds and impulses to 5e-4: float's 1e-7 times the ratio of inertias in a tree, which reaches thousands here.
TEST(JointConstraints, ObeyTheirLawInFloat) {
  for (std::uint64_t seed = 0; seed < kTrees; ++seed) {
    const JointProblem<float> p(seed, 1 + static_cast<int>(seed % 12));
    EXPECT_LE(JointLaw(p).residual(solution_of(p).dv, 5e-4), 5e-4) << "seed " << seed << ", nv " << p.tree.nv;
  }
}

TEST(JointConstraints, ReportTheImpulseThatTheSolutionNeeds) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const JointProblem<double> p(seed, 8);
    const JointLaw law(p);
    const JointSolution<double> found = solution_of(p);
    for (std::size_t i = 0; i < law.n; ++i) {
      double impulse = -law.rhs[i], scale = std::abs(law.rhs[i]) + law.F[i];
      for (std::size_t j = 0; j < law.n; ++j) {
        impulse += law.M[i * law.n + j] * found.dv[j];
        scale += std::abs(law.M[i * law.n + j] * found.dv[j]);
      }
      EXPECT_NEAR(found.impulse[i], impulse, 1e-12 * scale) << "seed " << seed << ", dof " << i;
    }
  }
}

TEST(JointConstraints, EqualGaussSeidelRunToConvergence) {
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    const JointProblem<double> p(seed, 1 + static_cast<int>(seed % 6));
    const JointLaw law(p);
    const std::vector<double> slow = law.by_gauss_seidel(200000);
    ASSERT_LE(law.residual(slow, 1e-8), 1e-7) << "Gauss-Seidel has not converged, seed " << seed;
    EXPECT_LE(worst_difference(solution_of(p).dv, slow), 1e-7) << "seed " << seed << ", nv " << p.tree.nv;
  }
}

/// The solution is unique; where the search begins may show in its rounding only.
TEST(JointConstraints, DoNotDependOnTheirWarmStart) {
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const JointProblem<double> p(seed, 10);
    const JointLaw law(p);
    const JointSolution<double> cold = solution_of(p);
    Generator rng(seed);
    for (int start = 0; start < 5; ++start) {
      std::vector<double> states(p.size());
      for (std::size_t i = 0; i < states.size(); ++i) {
        const bool low = p.tree.dof_limited[i] && std::isfinite(law.lower[i]),
                   high = p.tree.dof_limited[i] && std::isfinite(law.upper[i]);
        const int state = static_cast<int>(rng() % 5) - 2;
        states[i] =
            (state == JointConstraintState::kAtLower && !low) || (state == JointConstraintState::kAtUpper && !high)
                ? 0
                : state;
      }
      EXPECT_LE(worst_difference(solution_of<double>(p, states).dv, cold.dv), 1e-9)
          << "seed " << seed << ", start " << start;
    }
    const JointSolution<double> again = solution_of<double>(p, cold.active_set);
    EXPECT_EQ(again.active_set, cold.active_set) << "seed " << seed;
    EXPECT_LE(worst_difference(again.dv, cold.dv), 1e-9) << "seed " << seed;
  }
}

/// A motor that pushed down and is then switched off leaves its state behind.
TEST(JointConstraints, ForgetAMotorThatWasSwitchedOff) {
  JointProblem<double> p(5, 6);
  for (std::size_t i = 0; i < p.size(); ++i) {
    p.tree.dof_limited[i] = p.tree.dof_stops[i] = false;
    p.params.motor_max_force[i] = 0;
  }
  const std::vector<double> cold = solution_of(p).dv;
  for (const double state : {-1.0, 0.0, 1.0}) {
    const std::vector<double> left(p.size(), state);
    EXPECT_LE(worst_difference(solution_of<double>(p, left).dv, cold), 1e-12) << "state " << state;
  }
}

/// A law that holds but for what contacts leave unsettled is no reason to change a state, in trees that they touch.
TEST(JointConstraints, KeepTheirStatesWithinWhatContactsLeaveUnsettled) {
  constexpr double kUnsettled = 1e-9, kLittle = 0.5 * kUnsettled;  // [m/s or rad/s]
  double wrong = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const JointProblem<double> p(seed, 6);
    JointSolver<double> solver(p);
    JointLaws<double>& laws = solver.problem.joints;
    Iterate<double>& iterate = solver.iterate;
    solve_joints(solver.problem, solver.factors, iterate, solver.next_state);
    for (std::size_t i = 0; i < p.size(); ++i) {  // just beyond where each state ends
      const double state = iterate.active_set[i], most = laws.max_held[i], inertia = law_inertia(solver.problem, i);
      if (std::abs(state) == 1 && std::isfinite(laws.target[i])) iterate.dv[i] = laws.target[i] + state * kLittle;
      if (state == 0 && std::isfinite(most)) iterate.joint_impulse[i] = most + kLittle * inertia;
    }
    std::ranges::fill(laws.constrained, 1.0);
    EXPECT_EQ(internal::check_joints(solver.problem, iterate, kUnsettled, solver.next_state), 0) << "seed " << seed;
    std::ranges::fill(laws.constrained, 0.0);
    wrong += internal::check_joints(solver.problem, iterate, kUnsettled, solver.next_state);
  }
  EXPECT_GT(wrong, 50);
}

/// How many linear systems the search solves: `solve_joints` with a counter.
template <Real R>
int count_pivots(const JointProblem<R>& p) {
  JointSolver<R> solver(p);
  Iterate<R>& iterate = solver.iterate;
  int fewest = p.tree.nv + 1, patience = 0;
  for (int pivot = 1; pivot <= contact_settings::kMaxStateChanges; ++pivot) {
    internal::solve_active_set(solver.problem, solver.factors, iterate);
    const int wrong = static_cast<int>(internal::check_joints(solver.problem, iterate, R(0), solver.next_state));
    if (wrong == 0) return pivot;
    patience = wrong < fewest ? contact_settings::kPatience : patience - 1;
    fewest = std::min(wrong, fewest);
    for (std::size_t i = 0, moved = 0; i < p.size() && (patience >= 0 || moved == 0); ++i) {
      moved += solver.next_state[i] != iterate.active_set[i];
      iterate.active_set[i] = solver.next_state[i];
    }
  }
  return contact_settings::kMaxStateChanges + 1;
}

template <Real R>
void expect_few_pivots(const char* number, int links, double mean) {
  constexpr int kProblems = 600;
  std::map<int, int> histogram;
  int sum = 0;
  for (std::uint64_t seed = 0; seed < kProblems; ++seed) {
    const int pivots = count_pivots(JointProblem<R>(seed, links));
    ++histogram[pivots];
    sum += pivots;
    EXPECT_LE(pivots, contact_settings::kMaxStateChanges)
        << "no solution, " << number << ", " << links << " links, seed " << seed;
  }
  std::cout << number << ", " << links << " links, pivots x problems:";
  for (const auto& [pivots, count] : histogram) std::cout << ' ' << pivots << 'x' << count;
  std::cout << '\n';
  EXPECT_LE(sum, mean * kProblems);
}

TEST(JointConstraints, NeedFewPivots) {
  expect_few_pivots<double>("double", 3, 4);  // from a cold start, every dof with a motor or limit of its own kind
  expect_few_pivots<float>("float", 3, 4);
  expect_few_pivots<double>("double", 12, 8);
  expect_few_pivots<float>("float", 12, 8);
  expect_few_pivots<double>("double", 40, 12);
}

}  // namespace
}  // namespace manyhands
