// Contacts, equality constraints, joint motors and limits of a step, solved together: block Gauss-Seidel over exact
// contact points, inside the search for the joints' states. See README.md in this folder.
#pragma once

#include <variant>

#include "manyhands/physics/contact/active_set_search.h"
#include "manyhands/physics/contact/energy_bound.h"
#include "manyhands/physics/contact/gauss_seidel.h"
#include "manyhands/physics/contact/newton/newton_refinement.h"
#include "manyhands/physics/contact/recovery.h"
#include "manyhands/physics/contact/runaway.h"

namespace manyhands {

/// The problem of the last step, its solution, and the scratch of finding it: allocated once, never saved.
template <Number T>
struct ContactSolver {
  using R = real_t<T>;

  ContactSolver(const Tree<R>& tree, const Colliders<R>& colliders)
      : problem(tree, colliders),
        iterate(tree.num_laws()),
        factors(tree),
        search(tree.num_laws()),
        recovery(tree.nv),
        energy(tree.nv),
        kept(tree.num_laws()),
        free_dv(index(tree.nv)) {}

  ContactProblem<T> problem;
  Iterate<T> iterate;
  Factors<T> factors;
  ActiveSetSearch<T> search;
  std::vector<T> equality_scratch;  ///< (equality rows)
  std::conditional_t<SolverTraits<R>::kRefines, NewtonRefinement, std::monostate> newton;
  Recovery<T> recovery;
  EnergyBound<T> energy;
  Iterate<T> kept;         ///< scratch: a solution of which some worlds are kept
  std::vector<T> free_dv;  ///< (nv) scratch: what the velocities gain without constraints
  int iterations = 0;      ///< of Gauss-Seidel, over all worlds of the block
  T unsettled{};           ///< by how much the last of them changed a contact's velocity [m/s]
};

namespace internal {

/// Responses of everything under the active set, and the equality constraints closed where that has changed.
template <Number T>
MANYHANDS_INLINE void factor(ContactSolver<T>& solver) {
  const ContactProblem<T>& problem = solver.problem;
  if (solver.factors.Y.size() < problem.rows.used_Y) solver.factors.Y.resize(2 * problem.rows.used_Y);
  compute_sqrt_D_inverse(*problem.tree, solver.factors);
  factor_equalities(problem, solver.search.changed, solver.equality_scratch, solver.factors);
  factor_contacts(problem, solver.factors);
  when(solver.recovery.asked, [&] { limit_opening(problem, solver.recovery, solver.factors); });
  for (std::size_t k = 0; k < problem.patches.size(); ++k)
    solver.iterate.patches[k].at_closing = patch_force(problem, solver.iterate, problem.patches[k]);
  close_equalities(problem, solver.factors, solver.search.changed, solver.equality_scratch, solver.iterate);
  if constexpr (SolverTraits<real_t<T>>::kRefines) solver.newton.look_anew();
}

/// A batch of Gauss-Seidel iterations, and in double what Newton's method adds: the worlds that have converged.
/// `change` is by how much the last iteration changed a contact's velocity [m/s].
template <Number T>
MANYHANDS_INLINE mask_t<T> iterate_and_refine(const SolverSettings& settings, ContactSolver<T>& solver, T& change) {
  ActiveSetSearch<T>& search = solver.search;
  const T zero = constant<T>(0), tolerance = constant<T>(settings.tolerance);
  const T allowed = select(search.active, min(search.batch, search.iterations_left), zero);
  T budget = allowed;
  solver.iterations += iterate_contacts(solver.problem, solver.factors, tolerance, budget, solver.iterate, change);
  mask_t<T> converged = change <= tolerance;  // NOLINT(misc-const-correctness): Newton's method converges in double
  if constexpr (SolverTraits<real_t<T>>::kRefines) {
    if (!converged)
      converged = solver.newton.refine(settings, {solver.problem, solver.factors, solver.iterate}, solver.iterations);
  }
  search.iterations_left -= allowed - budget;
  solver.iterate.iterations += allowed - budget;
  return converged;
}

/// The impulses of motors, limits and tendons at the present dv, in constrained trees: there every dof is saturated or
/// yields.
template <Number T>
MANYHANDS_INLINE void find_joint_impulses(const ContactProblem<T>& problem, const Factors<T>& factors,
                                          Iterate<T>& iterate) {
  const T zero = constant<T>(0);
  follow_lengths(problem, iterate);
  for (std::size_t i = 0; i < iterate.dv.size(); ++i) {
    const bool is_drive = problem.tree->dof_drive[i] >= 0;
    const LawPiece<T> piece = law_piece(is_drive, iterate.active_set[i], i, problem.joints);
    const T yielding = fma(factors.penalty[i], piece.held_dv - iterate.dv[i], factors.multiplier[i]);
    const T held = select(factors.penalty[i] > zero, yielding, iterate.joint_impulse[i]);
    const T impulse = select(piece.saturated, piece.impulse, held);
    iterate.joint_impulse[i] = select(problem.joints.constrained[i] > zero, impulse, iterate.joint_impulse[i]);
  }
}

/// Contacts and equality constraints, inside the search for the joints' states: the worlds that are near a solution.
template <Number T>
MANYHANDS_INLINE mask_t<T> solve_exactly(const SolverSettings& settings, ContactSolver<T>& solver) {
  const ContactProblem<T>& problem = solver.problem;
  ActiveSetSearch<T>& search = solver.search;
  begin_search(settings, solver.iterate, search);
  if constexpr (SolverTraits<real_t<T>>::kRefines) solver.newton.begin();
  begin_offsets(problem, solver.recovery, solver.factors);
  begin_closing(solver.factors);
  factor(solver);
  mask_t<T> near(false);
  for (;;) {
    T change;
    const auto converged = iterate_and_refine(settings, solver, change);
    follow_contacts(problem, solver.factors, solver.iterate);
    find_joint_impulses(problem, solver.factors, solver.iterate);
    solver.unsettled = select(search.active, select(converged, constant<T>(0), change), solver.unsettled);
    const T unsettled = min(change, constant<T>(SolverTraits<real_t<T>>::kStateNoise));
    const auto wrong = check_joints(problem, solver.iterate, unsettled, search.next_state) > constant<T>(0);
    search.changed = search.active & wrong & (search.looks < constant<T>(contact_settings::kMaxLooks));
    const auto slow = converged | (change <= constant<T>(contact_settings::kSlowCorrection));
    near = (search.active & slow & (!wrong)) | ((!search.active) & near);
    search.active = search.changed | (search.active & (!converged) & (search.iterations_left > constant<T>(0)));
    if (none(search.active)) return near;
    if (none(search.changed)) continue;
    change_active_set(problem, change, search, solver.iterate);
    solve_changed(problem, solver.factors, search, solver.iterate);
    factor(solver);
  }
}

/// Those of the worlds asked for whose iterate has more energy than there can be.
template <Number T>
MANYHANDS_INLINE mask_t<T> find_runaways(mask_t<T> asked, ContactSolver<T>& solver) {
  if (none(asked)) return asked;
  const auto free_change = [&]() -> const std::vector<T>& {
    unconstrained_change(solver.problem, solver.factors, solver.free_dv);
    return solver.free_dv;
  };
  return asked & exceeds_energy(solver.problem, solver.factors, solver.iterate.dv, free_change, solver.energy);
}

/// The worlds in which something is much faster than anything was.
template <Number T>
MANYHANDS_INLINE mask_t<T> is_flung(const ContactProblem<T>& problem, const std::vector<T>& dv) {
  T before = constant<T>(1), after = constant<T>(0);
  for (std::size_t i = 0; i < index(problem.tree->nv); ++i) {
    before = max(before, abs(problem.v[i]));
    after = max(after, abs(problem.v[i] + dv[i]));
  }
  return !(after <= constant<T>(contact_settings::kSuspicious) * before);
}

/// Those that may have run away. Where what was demanded has found no solution, nothing will be for a while.
template <Number T>
MANYHANDS_INLINE mask_t<T> find_suspects(mask_t<T> near, ContactSolver<T>& solver) {
  const auto demands = demands_much(solver.problem, solver.recovery, solver.factors);
  calm_down(demands & !near, solver.iterate);
  return demands | is_pushed(solver.problem) | is_flung(solver.problem, solver.iterate.dv) | !near;
}

/// Begins anew in the worlds of the mask, which have run away: see runaway.h.
template <Number T>
MANYHANDS_INLINE void begin_calmly(mask_t<T> asked, ContactSolver<T>& solver) {
  calm_down(asked, solver.iterate);
  solver.kept = solver.iterate;
  demand_nothing(asked, solver.problem);
  for (T& impulse : solver.problem.joints.last_impulse) impulse = select(asked, constant<T>(0), impulse);
  solve_alone(solver.problem, solver.factors, solver.search.next_state, solver.iterate);
}

/// Brings the worlds of the mask to rest.
template <Number T>
MANYHANDS_INLINE void give_up(mask_t<T> asked, ContactSolver<T>& solver) {
  solver.kept = solver.iterate;
  stand_still(solver.problem, solver.iterate);
  keep_others(asked, solver.kept, solver.iterate);
}

}  // namespace internal

/// Solves the problem from the iterate that `warm_start` made: dv of all dofs, and all impulses.
template <Number T>
MANYHANDS_INLINE void solve(const SolverSettings& settings, ContactSolver<T>& solver) {
  solver.iterations = 0;
  solver.iterate.iterations = solver.unsettled = constant<T>(0);
  internal::stay_calm(solver.problem, solver.iterate);
  solve_joints(solver.problem, solver.factors, solver.iterate, solver.search.next_state);
  if (solver.problem.only_joints()) return;
  internal::find_mobility(solver.problem, solver.factors);
  mask_t<T> runs_away(true);
  for (bool again = false;; again = true) {
    const auto near = internal::solve_exactly(settings, solver);
    if (again) internal::keep_others(runs_away, solver.kept, solver.iterate);
    runs_away = internal::find_runaways(again ? runs_away : internal::find_suspects(near, solver), solver);
    if (none(runs_away)) return;
    if (again) return internal::give_up(runs_away, solver);
    internal::begin_calmly(runs_away, solver);
  }
}

}  // namespace manyhands
