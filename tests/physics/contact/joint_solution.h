// The joint solver on random joint problems.
#pragma once

#include <span>
#include <type_traits>
#include <vector>

#include "manyhands/physics/contact/joint_solver.h"
#include "tests/physics/contact/joint_problem.h"

namespace manyhands::testing {

template <Real R>
struct JointSolution {
  std::vector<double> dv, impulse;
  std::vector<R> active_set;
};

/// The joints of a problem, assembled from a copy of its state: with the active set given or, if none is, the state's.
template <Real R>
struct JointSolver {
  explicit JointSolver(const JointProblem<R>& p, std::span<const R> active_set = {})
      : dynamics(p.tree), problem(p.tree, {}), factors(p.tree), iterate(p.tree.nv), next_state(index(p.tree.nv)) {
    StateStorage<R> state = p.state;
    std::copy(active_set.begin(), active_set.end(), state.active_set());
    bias_and_mass_matrix(p.tree, p.params, state.q(), state.v(), dynamics);
    problem.tree = &p.tree;
    problem.dynamics = &dynamics;
    const auto free_change = [&](std::vector<R>& dv) { internal::unconstrained_change(problem, factors, dv); };
    assemble_joint_laws(p.tree, p.params, p.h, state, dynamics, problem.free_dv, [] {}, free_change, problem.joints);
    iterate.active_set = problem.joints.first_state;
    iterate.rhs = problem.joints.smooth;
  }

  Workspace<R> dynamics;
  ContactProblem<R> problem;
  Factors<R> factors;
  Iterate<R> iterate;
  std::vector<R> next_state;
};

template <Real R>
JointSolution<R> solution_of(const JointProblem<R>& p, std::type_identity_t<std::span<const R>> active_set = {}) {
  JointSolver<R> solver(p, active_set);
  solve_joints(solver.problem, solver.factors, solver.iterate, solver.next_state);
  const Iterate<R>& found = solver.iterate;
  return {
      {found.dv.begin(), found.dv.end()}, {found.joint_impulse.begin(), found.joint_impulse.end()}, found.active_set};
}

}  // namespace manyhands::testing
