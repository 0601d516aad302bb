// M = L^T D L of a tree's inertia matrix without fill-in (Featherstone 2008, section 6.5).
#pragma once

#include "manyhands/physics/dynamics/tree.h"

namespace manyhands {

/// Factors the lower triangle `L` (nv, nv, row-major) in place: L below the diagonal, 1 / D on it.
template <Number T>
MANYHANDS_INLINE void factor_ltdl(const Tree<real_t<T>>& tree, T* L) {
  const int nv = tree.nv;
  const int* parent = tree.dof_parent.data();
  for (int k = nv - 1; k >= 0; --k) {
    T* row_k = L + k * nv;
    const T D_inverse = T(real_t<T>(1)) / row_k[k];
    for (int i = parent[k]; i >= 0; i = parent[i]) {
      const T a = row_k[i] * D_inverse;
      T* row_i = L + i * nv;
      for (int j = i; j >= 0; j = parent[j]) row_i[j] = fma(-a, row_k[j], row_i[j]);
      row_k[i] = a;
    }
    row_k[k] = D_inverse;
  }
}

/// x := M^-1 x (nv) with the factors of `factor_ltdl`.
template <Number T>
MANYHANDS_INLINE void solve_ltdl(const Tree<real_t<T>>& tree, const T* L, T* x) {
  const int nv = tree.nv;
  const int* parent = tree.dof_parent.data();
  for (int k = nv - 1; k >= 0; --k) {
    for (int i = parent[k]; i >= 0; i = parent[i]) x[i] = fma(-L[k * nv + i], x[k], x[i]);
  }
  for (int k = 0; k < nv; ++k) {
    T y = x[k] * L[k * nv + k];
    for (int i = parent[k]; i >= 0; i = parent[i]) y = fma(-L[k * nv + i], x[i], y);
    x[k] = y;
  }
}

/// y (nv) = M x (nv), with M's lower triangle (nv, nv) of a tree.
template <Number T>
MANYHANDS_INLINE void multiply_tree_matrix(const Tree<real_t<T>>& tree, const T* M, const T* x, T* y) {
  const int nv = tree.nv;
  for (int k = 0; k < nv; ++k) {
    T sum = M[k * nv + k] * x[k];
    for (int i = tree.dof_parent[static_cast<std::size_t>(k)]; i >= 0; i = tree.dof_parent[static_cast<std::size_t>(i)]) {
      sum = fma(M[k * nv + i], x[i], sum);
      y[i] = fma(M[k * nv + i], x[k], y[i]);
    }
    y[k] = sum;
  }
}

}  // namespace manyhands
