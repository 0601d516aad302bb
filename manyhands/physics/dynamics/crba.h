// The joint-space inertia matrix: the composite-rigid-body algorithm (Featherstone 2008, table 6.2), and the bias force
// that an inward pass yields beside it.
#pragma once

#include "manyhands/physics/dynamics/rnea.h"

namespace manyhands {

namespace internal {

/// Rows of M for the dofs of body b, whose I is its subtree's already.
template <Number T, Number P>
MANYHANDS_INLINE void mass_matrix_rows(const Tree<real_t<T>>& tree, const Params<P>& params, std::size_t b,
                                       Workspace<T>& ws) {
  const TreeBody<real_t<T>>& body = tree.bodies[b];
  for (int k = body.iv; k < body.iv + body.nv; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const Force<T> F = ws.I[b] * ws.S[i];
    T* row = ws.M.data() + tree.M_row[i];
    row[i] = dot(ws.S[i], F) + broadcast<T>(params.armature[i]);
    for (int j = tree.dof_parent[i]; j >= 0; j = tree.dof_parent[static_cast<std::size_t>(j)]) {
      row[j] = dot(ws.S[static_cast<std::size_t>(j)], F);
    }
  }
}

}  // namespace internal

/// Clears what tendons alone fill in M.
template <Number T>
MANYHANDS_INLINE void clear_joined(const Tree<real_t<T>>& tree, Workspace<T>& ws) {
  for (const std::size_t entry : tree.M_joined) ws.M[entry] = T(real_t<T>(0));
}

/// ws.M (lower triangle; 0 between dofs of different branches) at q (nq), armature of joints included.
template <Number T, Number P>
void crba(const Tree<real_t<T>>& tree, const Params<P>& params, const T* q, Workspace<T>& ws) {
  MANYHANDS_ASSERT(internal::fit(tree, params, ws));
  for (std::size_t b = 1; b < tree.bodies.size(); ++b) {
    place(tree, b, q, ws);
    internal::place_inertia(b, params, ws);
  }
  clear_joined(tree, ws);
  for (std::size_t b = tree.bodies.size() - 1; b > 0; --b) {
    internal::mass_matrix_rows(tree, params, b, ws);
    const auto parent = static_cast<std::size_t>(tree.bodies[b].parent);
    if (parent != 0) ws.I[parent] = ws.I[parent] + ws.I[b];
  }
}

/// ws.M as from `crba` and ws.bias = C v + g as from `rnea` with a = 0, in one pass out and one pass in: what a step
/// needs of the dynamics.
template <Number T, Number P>
void bias_and_mass_matrix(const Tree<real_t<T>>& tree, const Params<P>& params, const T* q, const T* v,
                          Workspace<T>& ws) {
  internal::newton_euler_pass<T>(tree, params, q, v, nullptr, ws);
  clear_joined(tree, ws);
  for (std::size_t b = tree.bodies.size() - 1; b > 0; --b) {
    const TreeBody<real_t<T>>& body = tree.bodies[b];
    for (int k = body.iv; k < body.iv + body.nv; ++k) {
      ws.bias[static_cast<std::size_t>(k)] = dot(ws.S[static_cast<std::size_t>(k)], ws.F[b]);
    }
    internal::mass_matrix_rows(tree, params, b, ws);
    const auto parent = static_cast<std::size_t>(body.parent);
    if (parent != 0) {
      ws.F[parent] = ws.F[parent] + ws.F[b];
      ws.I[parent] = ws.I[parent] + ws.I[b];
    }
  }
}

}  // namespace manyhands
