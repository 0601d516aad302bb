// Everything the dynamics derives from a state, and scratch: allocated once, never saved.
#pragma once

#include <vector>

#include "manyhands/physics/dynamics/articulated_inertia.h"
#include "manyhands/physics/dynamics/tree.h"

namespace manyhands {

/// Quantities of a body or dof are in world axes about O, the origin of the first body of its tree: for a robot far
/// from the world's origin, single precision loses nothing. Motions and forces of one tree add without transforms.
template <Number T>
struct Workspace {
  explicit Workspace(const Tree<real_t<T>>& tree)
      : R_WB(size(tree.nb), Mat3<T>::identity()),
        p_OB(size(tree.nb), Vec3<T>::zero()),
        p_WO(size(tree.nb), Vec3<T>::zero()),
        V(size(tree.nb), Motion<T>::zero()),
        A(size(tree.nb), Motion<T>::zero()),
        F(size(tree.nb), Force<T>::zero()),
        I(size(tree.nb), RigidInertia<T>::zero()),
        I_A(size(tree.nb)),
        S(size(tree.nv), Motion<T>::zero()),
        U(size(tree.nv), Force<T>::zero()),
        D_inverse(size(tree.nv)),
        u(size(tree.nv)),
        bias(size(tree.nv)),
        M(tree.M_size, T(real_t<T>(0))),
        length(tree.lengths.size()),
        length_rate(length),
        length_bend(length),
        length_inertia(length),
        spring_inertia(length),
        length_J(tree.length_entries) {
    take_mocap(tree);
  }

  /// As many of everything as the tree has now; what is new is not placed.
  void resize(const Tree<real_t<T>>& tree) {
    const auto all = [](std::size_t n, auto&... lists) { (lists.resize(n), ...); };
    all(size(tree.nb), R_WB, p_OB, p_WO, V, A, F, I, I_A);
    all(size(tree.nv), S, U, D_inverse, u, bias);
    all(tree.M_size, M);
    all(tree.lengths.size(), length, length_rate, length_bend, length_inertia, spring_inertia);
    all(tree.length_entries, length_J);
  }

  std::vector<Mat3<T>> R_WB;               ///< (nb)
  std::vector<Vec3<T>> p_OB;               ///< (nb) body origin from its tree's origin O [m]
  std::vector<Vec3<T>> p_WO;               ///< (nb) the tree's origin in the world [m]
  std::vector<Motion<T>> V;                ///< (nb) velocity
  std::vector<Motion<T>> A;                ///< (nb) acceleration
  std::vector<Force<T>> F;                 ///< (nb) force on, or bias force of, the subtree
  std::vector<RigidInertia<T>> I;          ///< (nb) of the body; of the subtree after crba
  std::vector<ArticulatedInertia<T>> I_A;  ///< (nb)
  std::vector<Motion<T>> S;                ///< (nv) joint axes
  std::vector<Force<T>> U;                 ///< (nv) I_A S
  std::vector<T> D_inverse, u;             ///< (nv)
  std::vector<T> bias;                     ///< (nv) C(q, v) v + g(q) [N m or N]
  std::vector<T> M;                        ///< (nv, nv) lower triangle of each tree, packed by rows (see Tree::M_row)
  std::vector<T> length, length_rate;      ///< (lengths) of tendons [m or rad], and what couples them
  std::vector<T> length_bend;              ///< (lengths) dJ/dt v
  std::vector<T> length_inertia;           ///< (lengths) 1 / (J diag(M)^-1 J^T): against which laws are judged
  std::vector<T> spring_inertia;           ///< (lengths) by which a step meets a tendon's spring [kg or kg m^2]
  std::vector<T> length_J;                 ///< rows of J by TreeLength::dofs

 private:
  void take_mocap(const Tree<real_t<T>>& tree) {
    for (const std::size_t b : tree.mocap_bodies) {
      R_WB[b] = broadcast<T>(tree.bodies[b].X_PF.R);
      p_WO[b] = broadcast<T>(tree.bodies[b].X_PF.p);
    }
  }
  static std::size_t size(int n) { return static_cast<std::size_t>(n); }
};

/// Entry (i, j <= i) of M; 0 between trees.
template <Number T>
[[nodiscard]] T mass_matrix_entry(const Tree<real_t<T>>& tree, const Workspace<T>& ws, std::size_t i, std::size_t j) {
  if (static_cast<int>(j) < tree.root_dof[i]) return T(real_t<T>(0));
  return ws.M[static_cast<std::size_t>(tree.M_row[i] + static_cast<std::ptrdiff_t>(j))];
}

}  // namespace manyhands
