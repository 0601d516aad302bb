// Lengths under their laws, beside the joints: a held length yields by a penalty about a multiplier, as held dofs of
// constrained trees do, and M gains J^T penalty J. Where nothing touches its trees, the multiplier follows the impulse
// until the length is as good as rigid (the method of multipliers).
#pragma once

#include "manyhands/physics/contact/factors.h"

namespace manyhands::internal {

/// Whether length i - nv is held rigidly: not by a drive, which gives way by its own law, and where nothing touches its
/// trees.
template <Number T>
MANYHANDS_INLINE mask_t<T> is_rigid_length(const ContactProblem<T>& problem, const Factors<T>& factors, T state,
                                           std::size_t i) {
  const std::vector<int>& dofs = problem.tree->lengths[i - index(problem.tree->nv)].dofs;
  if (dofs.empty()) return mask_t<T>(false);
  const bool drive = problem.tree->dof_drive[i] >= 0;
  const T zero = constant<T>(0);
  return (factors.penalty[i] > zero) & !law_piece(drive, state, i, problem.joints).sloped &
         (problem.joints.constrained[index(dofs.front())] == zero);
}

/// What length k's law gives where it changes by `change`.
template <Number T>
MANYHANDS_INLINE T length_impulse(const ContactProblem<T>& problem, const Factors<T>& factors, T state, std::size_t i,
                                  T change) {
  const T zero = constant<T>(0);
  const LawPiece<T> piece = law_piece(problem.tree->dof_drive[i] >= 0, state, i, problem.joints);
  const T yielding = fma(factors.penalty[i], piece.held_dv - change, factors.multiplier[i]);
  return select(factors.penalty[i] > zero, yielding, select(piece.saturated, piece.impulse, zero));
}

/// How each length behaves in its state: its penalty is scaled by the dofs that are free.
template <Number T>
MANYHANDS_INLINE void prescribe_lengths(const ContactProblem<T>& problem, const std::vector<T>& active_set,
                                        Factors<T>& factors) {
  const Tree<real_t<T>>& tree = *problem.tree;
  const Workspace<T>& ws = *problem.dynamics;
  const T zero = constant<T>(0), stiff = constant<T>(contact_settings::kPenalty);
  for (std::size_t k = 0; k < tree.lengths.size(); ++k) {
    const std::size_t i = index(tree.nv) + k;
    const T inertia =
        length_inertia(tree, ws, k, ws.length_inertia[k], [&](std::size_t dof) { return factors.free[dof]; });
    const LawPiece<T> piece = law_piece(tree.dof_drive[i] >= 0, active_set[i], i, problem.joints);
    const T held = select(piece.sloped, problem.joints.slope[i], stiff * inertia);
    factors.penalty[i] = select(piece.saturated, zero, held);
    factors.multiplier[i] = select(piece.sloped, piece.impulse, zero);
    factors.held_dv[i] = along_length(tree, ws, k, factors.held_dv.data());
  }
}

/// Takes what lengths pull where the held dofs alone move off joint_impulse.
template <Number T>
MANYHANDS_INLINE void begin_lengths(const ContactProblem<T>& problem, Factors<T>& factors, Iterate<T>& iterate) {
  const Tree<real_t<T>>& tree = *problem.tree;
  prescribe_lengths(problem, iterate.active_set, factors);
  for (std::size_t k = 0; k < tree.lengths.size(); ++k) {
    const std::size_t i = index(tree.nv) + k;
    iterate.dv[i] = factors.held_dv[i];
    iterate.joint_impulse[i] = length_impulse(problem, factors, iterate.active_set[i], i, iterate.dv[i]);
    add_along_length(tree, *problem.dynamics, k, -iterate.joint_impulse[i], iterate.joint_impulse.data());
  }
}

/// L += J^T penalty J among the free dofs, before it is factored.
template <Number T>
MANYHANDS_INLINE void add_length_penalties(const ContactProblem<T>& problem, Factors<T>& factors) {
  const Tree<real_t<T>>& tree = *problem.tree;
  for (std::size_t k = 0; k < tree.lengths.size(); ++k) {
    const T penalty = factors.penalty[index(tree.nv) + k];
    if (none(penalty > constant<T>(0))) continue;
    add_length_square(tree, *problem.dynamics, k, penalty, factors.L.data(),
                      [&](std::size_t dof) { return factors.free[dof]; });
  }
}

/// dv of lengths, whose free dofs have found theirs.
template <Number T>
MANYHANDS_INLINE void measure_lengths(const ContactProblem<T>& problem, const Factors<T>& factors,
                                      Iterate<T>& iterate) {
  const Tree<real_t<T>>& tree = *problem.tree;
  for (std::size_t k = 0; k < tree.lengths.size(); ++k) {
    const std::size_t i = index(tree.nv) + k;
    iterate.dv[i] = factors.held_dv[i] + along_length(tree, *problem.dynamics, k, iterate.dv.data());
  }
}

/// One pass of the method of multipliers.
template <Number T>
MANYHANDS_INLINE void refine_lengths(const ContactProblem<T>& problem, Factors<T>& factors, Iterate<T>& iterate) {
  const Tree<real_t<T>>& tree = *problem.tree;
  const T zero = constant<T>(0);
  std::vector<T>& change = factors.length_change;
  for (T& x : change) x = zero;
  for (std::size_t k = 0; k < tree.lengths.size(); ++k) {
    const std::size_t i = index(tree.nv) + k;
    const T state = iterate.active_set[i];
    const T missing = law_piece(tree.dof_drive[i] >= 0, state, i, problem.joints).held_dv - iterate.dv[i];
    const T push = select(is_rigid_length(problem, factors, state, i), factors.penalty[i] * missing, zero);
    factors.multiplier[i] += push;
    add_along_length(tree, *problem.dynamics, k, push, change.data());
  }
  for (const int i : factors.free_dofs) change[index(i)] = change[index(i)] * factors.free[index(i)];
  solve_ltdl(std::span<const int>(factors.free_dofs), factors.free_parent.data(), tree.M_row.data(), factors.L.data(),
             change.data());
  for (const int i : factors.free_dofs) iterate.dv[index(i)] += change[index(i)];
  measure_lengths(problem, factors, iterate);
}

/// Makes held lengths rigid, once dv of the free dofs is found.
template <Number T>
MANYHANDS_INLINE void finish_lengths(const ContactProblem<T>& problem, Factors<T>& factors, Iterate<T>& iterate) {
  const Tree<real_t<T>>& tree = *problem.tree;
  if (tree.lengths.empty()) return;
  measure_lengths(problem, factors, iterate);
  mask_t<T> refines(false);
  for (std::size_t i = index(tree.nv); i < iterate.dv.size(); ++i)
    refines = refines | is_rigid_length(problem, factors, iterate.active_set[i], i);
  for (int pass = 0; any(refines) && pass < SolverTraits<real_t<T>>::kLengthPasses; ++pass)
    refine_lengths(problem, factors, iterate);
  for (std::size_t k = 0; k < tree.lengths.size(); ++k) {
    const std::size_t i = index(tree.nv) + k;
    const T before = iterate.joint_impulse[i];
    iterate.joint_impulse[i] = length_impulse(problem, factors, iterate.active_set[i], i, iterate.dv[i]);
    add_along_length(tree, *problem.dynamics, k, before - iterate.joint_impulse[i], iterate.joint_impulse.data());
  }
}

/// J dv of lengths, where contacts have changed dv.
template <Number T>
MANYHANDS_INLINE void follow_lengths(const ContactProblem<T>& problem, Iterate<T>& iterate) {
  const Tree<real_t<T>>& tree = *problem.tree;
  for (std::size_t k = 0; k < tree.lengths.size(); ++k)
    iterate.dv[index(tree.nv) + k] = along_length(tree, *problem.dynamics, k, iterate.dv.data());
}

}  // namespace manyhands::internal
