// What counts as no mobility: rows that no joint moves, of which rounding leaves a little.
//
// A row is never judged against itself, but against the scale of mobility: what the joints do at that point in any
// direction, there and as far from it as the body reaches: at the centre of a ball joint nothing moves. Its dofs add
// (|S|^2 + gyration |w|^2) / D each, with 1 / D of the factors, the inertia that a dof meets while those before it
// stand still and those after it are free. Held joints count little on both sides. What is asked of joints is judged
// against the mobility that they have while nothing holds them, each with the others at rest: 1 / M_ii.
#pragma once

#include "manyhands/physics/contact/factors.h"

namespace manyhands::internal {

/// Calls body(i, moving, terms) for the dofs of rows at p (world): what dof i moves there, squared, per inertia that it
/// meets, and of how large terms that is the sum.
template <Number T, class Body>
MANYHANDS_INLINE void visit_mobility_at(const ContactProblem<T>& problem, const RowBlock& rows, const Vec3<T>& p,
                                        Body&& body) {
  const Workspace<T>& dynamics = *problem.dynamics;
  visit_J(*problem.tree, rows, [&](std::size_t, std::size_t i, real_t<T> sign) {
    const real_t<T> gyration = problem.tree->bodies[sign < 0 ? rows.body_a : rows.body_b].gyration;
    const Motion<T>& S = dynamics.S[i];
    const Vec3<T> r = p - dynamics.p_WO[sign < 0 ? rows.body_a : rows.body_b];
    const T turning = squared_norm(S.w), terms = fma(squared_norm(r), turning, squared_norm(S.v));
    body(i, fma(T(gyration), turning, squared_norm(S.v + cross(S.w, r))), terms);
  });
}

/// The mobility [1/kg] at which a row at p (world) along any direction counts as immovable: a direction is off by so
/// little that no file gives its axes more exactly, or it is what rounding leaves of terms that cancel.
template <Number T>
MANYHANDS_INLINE T immovable_at(const ContactProblem<T>& problem, const Factors<T>& factors, const RowBlock& rows,
                                const Vec3<T>& p) {
  const T off = constant<T>(contact_settings::kImmovable), rounded(SolverTraits<real_t<T>>::kRounding);
  T least = constant<T>(0);
  visit_mobility_at(problem, rows, p, [&](std::size_t i, T moving, T terms) {
    least = fma(factors.sqrt_D_inverse[i] * factors.sqrt_D_inverse[i], fma(off, moving, rounded * terms), least);
  });
  return least;
}

/// The same of rotations [1/(kg m^2)].
template <Number T>
MANYHANDS_INLINE T immovable_rotation(const ContactProblem<T>& problem, const Factors<T>& factors,
                                      const RowBlock& rows) {
  T sum = constant<T>(0);
  visit_J(*problem.tree, rows, [&](std::size_t, std::size_t i, real_t<T>) {
    sum = fma(factors.sqrt_D_inverse[i] * factors.sqrt_D_inverse[i], squared_norm(problem.dynamics->S[i].w), sum);
  });
  return constant<T>(contact_settings::kImmovable) * sum;
}

/// Where an equality constraint holds points together (world).
template <Number T>
MANYHANDS_INLINE Vec3<T> held_point(const Workspace<T>& dynamics, const TreeEquality<real_t<T>>& equality) {
  const std::size_t b = equality.body_b;
  return dynamics.R_WB[b] * broadcast<T>(equality.X_BB.p) + dynamics.p_OB[b] + dynamics.p_WO[b];
}

/// Of the rows of an equality constraint. A coupling of joints has an exact J, and is judged by nothing.
template <Number T>
MANYHANDS_INLINE T immovable_equality(const ContactProblem<T>& problem, const Factors<T>& factors,
                                      const EqualityRows<T>& block) {
  const TreeEquality<real_t<T>>& equality = problem.tree->equalities[block.equality];
  if (block.rows.single) return constant<T>(0);
  if (block.cache != equality.row) return immovable_rotation(problem, factors, block.rows);
  return immovable_at(problem, factors, block.rows, held_point(*problem.dynamics, equality));
}

/// What the joints would do at p along any direction [1/kg] while nothing holds them.
template <Number T>
MANYHANDS_INLINE T mobility_at(const ContactProblem<T>& problem, const RowBlock& rows, const Vec3<T>& p) {
  T sum = constant<T>(0);
  visit_mobility_at(problem, rows, p,
                    [&](std::size_t i, T moving, T) { sum += moving / tree_row(*problem.tree, problem.M(), i)[i]; });
  return sum;
}

/// The same at every patch. M stays as it is for the whole step, whatever holds the joints.
template <Number T>
MANYHANDS_INLINE void find_mobility(const ContactProblem<T>& problem, Factors<T>& factors) {
  factors.mobility.clear();
  for (const ContactPatch<T>& patch : problem.patches)
    factors.mobility.push_back(mobility_at(problem, patch.linear, patch.origin));
}

/// The same for the rows of an equality constraint.
template <Number T>
MANYHANDS_INLINE T mobility_of(const ContactProblem<T>& problem, const EqualityRows<T>& block) {
  const TreeEquality<real_t<T>>& equality = problem.tree->equalities[block.equality];
  if (!block.rows.single && block.cache == equality.row)
    return mobility_at(problem, block.rows, held_point(*problem.dynamics, equality));
  T sum = constant<T>(0);
  visit_J(*problem.tree, block.rows, [&](std::size_t entry, std::size_t i, real_t<T>) {
    const T moving =
        block.rows.single ? problem.rows.J[entry].x * problem.rows.J[entry].x : squared_norm(problem.dynamics->S[i].w);
    sum += moving / tree_row(*problem.tree, problem.M(), i)[i];
  });
  return sum;
}

/// The diagonal of Y Y^T, for the Y in Y_by_dof.
template <Number T>
MANYHANDS_INLINE Vec3<T> mobility(const RowBlock& rows, const Factors<T>& factors) {
  Vec3<T> size = Vec3<T>::zero();
  visit_Y(rows, [&](std::size_t, std::size_t i) {
    const Vec3<T>& Y = factors.Y_by_dof[i];
    size = {fma(Y.x, Y.x, size.x), fma(Y.y, Y.y, size.y), fma(Y.z, Y.z, size.z)};
  });
  return size;
}

}  // namespace manyhands::internal
