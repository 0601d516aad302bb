// The problem of one step: what joints, contacts and equality constraints ask for.
#pragma once

#include "manyhands/physics/contact/assemble_contacts.h"
#include "manyhands/physics/contact/assemble_equalities.h"
#include "manyhands/physics/contact/contact_solver.h"
#include "manyhands/physics/contact/yielding_equalities.h"

namespace manyhands {

/// Begins solver.problem with what joints ask for, after bias_and_mass_matrix; adds what is implicit in the velocity to
/// M. Uses the solver's factors as scratch.
template <Number T, Number P>
MANYHANDS_INLINE void assemble_joints(const Tree<real_t<T>>& tree, const Params<P>& params, real_t<T> h,
                                      const State<T>& state, Workspace<T>& dynamics, ContactSolver<T>& solver) {
  ContactProblem<T>& problem = solver.problem;
  problem.tree = &tree;
  problem.dynamics = &dynamics;
  problem.v = state.v();
  const auto yield = [&] { assemble_yielding_equalities(state, h, dynamics, problem); };
  const auto free_change = [&](std::vector<T>& dv) { internal::unconstrained_change(problem, solver.factors, dv); };
  assemble_joint_laws(tree, params, h, state, dynamics, problem.free_dv, yield, free_change, problem.joints);
}

/// The rest of solver.problem: contacts and equality constraints. `pairs`: those that the touches refer to.
template <Number T, Number P>
MANYHANDS_INLINE void assemble_constraints(const Colliders<real_t<T>>& colliders, std::span<const ColliderPair> pairs,
                                           const Params<P>& params, real_t<T> h, const State<T>& state,
                                           const CollisionWorkspace<T>& collision, const Workspace<T>& dynamics,
                                           ContactSolver<T>& solver) {
  ContactProblem<T>& problem = solver.problem;
  problem.clear_constraints();
  const auto free_change = [&](std::vector<T>& dv) { internal::unconstrained_change(problem, solver.factors, dv); };
  assemble_contacts(colliders, pairs, params, h, collision, dynamics, free_change, problem);
  assemble_equalities(state, h, dynamics, problem);
}

/// Both.
template <Number T, Number P>
MANYHANDS_INLINE void assemble(const Tree<real_t<T>>& tree, const Colliders<real_t<T>>& colliders,
                               std::span<const ColliderPair> pairs, const Params<P>& params, real_t<T> h,
                               const State<T>& state, const CollisionWorkspace<T>& collision, Workspace<T>& dynamics,
                               ContactSolver<T>& solver) {
  assemble_joints(tree, params, h, state, dynamics, solver);
  assemble_constraints(colliders, pairs, params, h, state, collision, dynamics, solver);
}

}  // namespace manyhands
