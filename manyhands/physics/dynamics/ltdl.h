// M = L^T D L of a tree's inertia matrix without fill-in but where tendons join branches (Featherstone 2008,
// section 6.5).
//
// The functions take the dofs to treat, leaves first, and for each the next such dof towards the root: all of a tree's,
// or a subset, whose rows and columns then stand alone.
#pragma once

#include <span>

#include "manyhands/physics/dynamics/workspace.h"

namespace manyhands {

/// Row i of a packed lower triangle: entry (i, j) is row[j], for j from the tree's first dof to i.
template <Real R, class T>
[[nodiscard]] MANYHANDS_INLINE T* tree_row(const Tree<R>& tree, T* triangle, std::size_t i) {
  return triangle + tree.M_row[i];
}

/// Factors the packed lower triangle `L` in place: L below the diagonal, 1 / D on it.
template <Number T>
MANYHANDS_INLINE void factor_ltdl(std::span<const int> dofs_from_leaves, const int* parent, const std::ptrdiff_t* rows,
                                  T* L) {
  for (const int k : dofs_from_leaves) {
    T* row_k = L + rows[k];
    const T D_inverse = T(real_t<T>(1)) / row_k[k];
    for (int i = parent[k]; i >= 0; i = parent[i]) {
      const T a = row_k[i] * D_inverse;
      T* row_i = L + rows[i];
      for (int j = i; j >= 0; j = parent[j]) row_i[j] = fma(-a, row_k[j], row_i[j]);
      row_k[i] = a;
    }
    row_k[k] = D_inverse;
  }
}

/// x := L^-T x, the first half of a solution. X is T, or Vec3<T> for three right-hand sides at once. A dof and its
/// parent go together: that halves the stores.
template <Number T, class X>
MANYHANDS_INLINE void solve_to_root(std::span<const int> dofs_from_leaves, const int* parent,
                                    const std::ptrdiff_t* rows, const T* L, X* x) {
  for (std::size_t n = 0; n < dofs_from_leaves.size(); ++n) {
    const int k = dofs_from_leaves[n], next = parent[k];
    if (next < 0) continue;
    const T* row = L + rows[k];
    const X x_k = x[k], x_next = fma(-row[next], x_k, x[next]);
    x[next] = x_next;
    if (n + 1 < dofs_from_leaves.size() && dofs_from_leaves[n + 1] == next) {
      const T* next_row = L + rows[next];
      for (int i = parent[next]; i >= 0; i = parent[i]) x[i] = fma(-next_row[i], x_next, fma(-row[i], x_k, x[i]));
      ++n;
    } else {
      for (int i = parent[next]; i >= 0; i = parent[i]) x[i] = fma(-row[i], x_k, x[i]);
    }
  }
}

/// x := L^-1 diag(scale) x, the other half, with scale(k) of dof k.
template <Number T, class X, class Scale>
MANYHANDS_INLINE void solve_to_leaves(std::span<const int> dofs_from_leaves, const int* parent,
                                      const std::ptrdiff_t* rows, const T* L, X* x, Scale&& scale) {
  for (std::size_t n = dofs_from_leaves.size(); n-- > 0;) {
    const int k = dofs_from_leaves[n];
    const T* row = L + rows[k];
    X y = x[k] * scale(k);
    for (int i = parent[k]; i >= 0; i = parent[i]) y = fma(-row[i], x[i], y);
    x[k] = y;
  }
}

/// x := M^-1 x (nv) with the factors of `factor_ltdl`.
template <Number T, class X>
MANYHANDS_INLINE void solve_ltdl(std::span<const int> dofs_from_leaves, const int* parent, const std::ptrdiff_t* rows,
                                 const T* L, X* x) {
  solve_to_root(dofs_from_leaves, parent, rows, L, x);
  solve_to_leaves(dofs_from_leaves, parent, rows, L, x, [&](int k) { return (L + rows[k])[k]; });
}

/// y (nv) = M x (nv), with the packed lower triangle M of a tree.
template <Number T>
MANYHANDS_INLINE void multiply_tree_matrix(const Tree<real_t<T>>& tree, const T* M, const T* x, T* y) {
  const int* parent = tree.M_parent.data();
  for (int k = 0; k < tree.nv; ++k) {
    const T* row = M + tree.M_row[static_cast<std::size_t>(k)];
    T sum = row[k] * x[k];
    for (int i = parent[k]; i >= 0; i = parent[i]) {
      sum = fma(row[i], x[i], sum);
      y[i] = fma(row[i], x[k], y[i]);
    }
    y[k] = sum;
  }
}

/// y (nv) += column k of M times x.
template <Number T>
MANYHANDS_INLINE void add_tree_column(const Tree<real_t<T>>& tree, const T* M, int k, T x, T* y) {
  const T* row = M + tree.M_row[static_cast<std::size_t>(k)];
  for (int i = k; i >= 0; i = tree.M_parent[static_cast<std::size_t>(i)]) y[i] = fma(row[i], x, y[i]);
  const int root = tree.root_dof[static_cast<std::size_t>(k)];
  for (int i = k + 1; i < tree.nv && tree.root_dof[static_cast<std::size_t>(i)] == root; ++i)
    y[i] = fma(M[static_cast<std::size_t>(tree.M_row[static_cast<std::size_t>(i)] + k)], x, y[i]);
}

}  // namespace manyhands
