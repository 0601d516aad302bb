// What the solver derives from the problem and an active set: the inverse of the mass matrix of what may move, and the
// responses of all rows under it.
//
// A dof is free where its state prescribes the impulse (saturated) or where it yields: a held dof in a constrained tree
// gives way like a penalty, impulse = multiplier + penalty (dv_held - dv), and so does every held tendon. A = (M +
// penalty)^-1 over the free dofs, where a tendon's penalty is J^T penalty J.
// A = B B^T with B = L^-1 D^-1/2 of M + penalty = L^T D L, so that Y = J B.
#pragma once

#include "manyhands/physics/contact/delassus.h"
#include "manyhands/physics/contact/iterate.h"

namespace manyhands {

template <Number T>
struct Factors {
  explicit Factors(const Tree<real_t<T>>& tree)
      : L(tree.M_size, constant<T>(0)),
        sqrt_D_inverse(index(tree.nv)),
        penalty(index(tree.num_laws())),
        multiplier(penalty),
        free(penalty),
        held_dv(penalty),
        is_free(sqrt_D_inverse.size()),
        free_parent(sqrt_D_inverse.size()),
        length_change(tree.lengths.empty() ? 0 : sqrt_D_inverse.size()),
        Y_by_dof(sqrt_D_inverse.size()),
        K(tree.equality_rows * tree.equality_rows),
        K_pivot_inverse(tree.equality_rows),
        K_immovable(tree.equality_rows),
        K_damped(K.size()),
        K_damped_pivot_inverse(tree.equality_rows),
        damping(tree.equality_rows),
        closing(tree.equality_rows) {
    free_dofs.reserve(sqrt_D_inverse.size());
  }

  // Of the active set.
  std::vector<T> L;                   ///< (M_size) factors of M + penalty among the free dofs, 1 / D on the diagonal
  std::vector<T> sqrt_D_inverse;      ///< (nv)
  std::vector<T> penalty;             ///< (laws) [kg or kg m^2]; 0 where the dof is rigid or saturated
  std::vector<T> multiplier;          ///< (laws) [N s or N m s]
  std::vector<T> free;                ///< (laws) 1 where the dof is free, else 0
  std::vector<T> held_dv;             ///< (laws) dv where it is not, else 0
  std::vector<std::uint8_t> is_free;  ///< (nv) whether the dof is free in some lane
  std::vector<int> free_parent;       ///< (nv) the next dof towards the root that is free in some lane, or -1
  std::vector<int> free_dofs;         ///< those dofs, leaves first
  std::vector<T> length_change;       ///< (nv) scratch

  // Of the rows.
  std::vector<Vec3<T>> Y;                 ///< half responses of all rows; RowBlock::Y says where
  std::vector<Vec3<T>> Y_by_dof;          ///< (nv) scratch: Y of one block
  std::vector<PatchResponse<T>> patches;  ///< (patches)
  std::vector<DelassusBlock<T>> points;   ///< (points)
  std::vector<Vec3<T>> offsets;  ///< (points) J v less what their laws ask for: a velocity is offset + J dv [m/s]
  std::vector<DelassusBlock<T>> torsions;  ///< (torsions) of rolling alone: spinning is solved apart
  std::vector<T> spin_inverse;             ///< (torsions) [kg m^2]
  std::vector<T> mobility;                 ///< (patches) at their origins, while nothing holds the joints [1/kg]

  // Of the equality constraints, which contacts see through: their response to a contact is taken off its Y.
  std::vector<T> K;                ///< (rows, rows) lower triangle of J_e A J_e^T: its factor L, K = L D L^T
  std::vector<T> K_pivot_inverse;  ///< (rows) 1 / D; 0 where a row says what others have said, or no joint moves it
  std::vector<T> K_immovable;      ///< (rows) mobility that counts as none
  std::vector<T> K_damped, K_damped_pivot_inverse;  ///< the same of K + R
  std::vector<T> damping;                           ///< (rows) R
  std::vector<T> closing;  ///< (rows) as much of the closing velocities as joints can do [m/s or rad/s]
  std::vector<Vec3<T>> Z;  ///< (rows of patches, rows) impulses of equality constraints per impulse of a patch
};

namespace internal {

/// How fast point i shall open at most [m/s]: what its law asks for.
template <Number T>
MANYHANDS_INLINE T asked_opening(const ContactProblem<T>& problem, const Factors<T>& factors, std::size_t i) {
  return problem.points[i].offset.x - factors.offsets[i].x;
}

/// M^-1 smooth: what the velocities gain without contacts, motors and limits. Uses L as scratch.
template <Number T>
MANYHANDS_INLINE void unconstrained_change(const ContactProblem<T>& problem, Factors<T>& factors, std::vector<T>& dv) {
  const Tree<real_t<T>>& tree = *problem.tree;
  factors.L = problem.dynamics->M;
  dv = problem.joints.smooth;
  factor_ltdl(tree.dofs_from_leaves, tree.M_parent.data(), tree.M_row.data(), factors.L.data());
  solve_ltdl(tree.dofs_from_leaves, tree.M_parent.data(), tree.M_row.data(), factors.L.data(), dv.data());
}

/// dv += B y over free dofs in the order of Factors::free_dofs, whole trees of them.
template <Number T>
MANYHANDS_INLINE void add_change(const ContactProblem<T>& problem, const Factors<T>& factors,
                                 std::span<const int> free_dofs, Iterate<T>& iterate) {
  solve_to_leaves(free_dofs, factors.free_parent.data(), problem.tree->M_row.data(), factors.L.data(), iterate.y.data(),
                  [&](int k) { return factors.sqrt_D_inverse[index(k)]; });
  for (const int k : free_dofs) iterate.dv[index(k)] += iterate.y[index(k)];
}

/// dv += B y, and y = 0. Over the dofs of which there are factors: what else lies there is of other steps, and even
/// times 0 it would spread what is not finite.
template <Number T>
MANYHANDS_INLINE void apply_change(const ContactProblem<T>& problem, const Factors<T>& factors, Iterate<T>& iterate) {
  add_change(problem, factors, std::span<const int>(factors.free_dofs), iterate);
  for (T& y : iterate.y) y = constant<T>(0);
}

template <Number T>
MANYHANDS_INLINE void compute_sqrt_D_inverse(const Tree<real_t<T>>& tree, Factors<T>& factors) {
  for (std::size_t i = 0; i < factors.sqrt_D_inverse.size(); ++i)
    factors.sqrt_D_inverse[i] = sqrt(max(tree_row(tree, factors.L.data(), i)[i], constant<T>(0)));
}

/// Y = J B of one block, by dof into Y_by_dof. All dofs of its two clusters must be free.
template <Number T>
MANYHANDS_INLINE void compute_Y(const ContactProblem<T>& problem, const RowBlock& rows, Factors<T>& factors) {
  const Tree<real_t<T>>& tree = *problem.tree;
  Vec3<T>* x = factors.Y_by_dof.data();
  const Vec3<T>* J = problem.rows.J.data();
  visit_Y(rows, [&](std::size_t, std::size_t i) { x[i] = Vec3<T>::zero(); });
  visit_J(tree, rows, [&](std::size_t entry, std::size_t i, real_t<T>) { x[i] = J[entry]; });
  for (const std::span<const int> dofs : {rows.response_a, rows.response_b})
    solve_to_root(dofs, tree.M_parent.data(), tree.M_row.data(), factors.L.data(), x);
  visit_Y(rows, [&](std::size_t, std::size_t i) { x[i] = factors.sqrt_D_inverse[i] * x[i]; });
}

/// Keeps the Y in Y_by_dof; Y Y^T.
template <Number T>
MANYHANDS_INLINE Mat3<T> store_Y(const RowBlock& rows, Factors<T>& factors) {
  Mat3<T> G{Vec3<T>::zero(), Vec3<T>::zero(), Vec3<T>::zero()};
  visit_Y(rows, [&](std::size_t entry, std::size_t i) {
    const Vec3<T> Y = factors.Y[entry] = factors.Y_by_dof[i];
    G.x = fma(Y.x, Y, G.x);
    G.y.y = fma(Y.y, Y.y, G.y.y);
    G.y.z = fma(Y.y, Y.z, G.y.z);
    G.z.z = fma(Y.z, Y.z, G.z.z);
  });
  G.y.x = G.x.y;
  G.z.x = G.x.z;
  G.z.y = G.y.z;
  return G;
}

}  // namespace internal

}  // namespace manyhands
