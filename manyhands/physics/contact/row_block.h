// Three rows of a Jacobian between two bodies, and what an impulse along them does to the velocities.
#pragma once

#include "manyhands/math/spatial.h"
#include "manyhands/physics/dynamics/ltdl.h"
#include "manyhands/physics/dynamics/workspace.h"

namespace manyhands {

/// Where the three rows of one contact or loop lie: J over the dofs that move body B against body A, A M^-1 J^T over
/// all dofs of their trees. Uniform.
struct RowBlock {
  std::size_t body_a{}, body_b{};
  int common = -1;         ///< the last dof that moves both bodies alike, or -1
  std::size_t J{};         ///< first of its entries: A's dofs from the last to the root, then B's
  std::size_t W{};         ///< first of its entries: A's tree's dofs, then B's tree's if it is another
  int begin_a{}, end_a{};  ///< dofs of A's tree; empty for the world
  int begin_b{}, end_b{};  ///< dofs of B's tree where it is another
};

/// Storage of the rows of many blocks: each entry holds the three rows' numbers of one dof.
template <Number T>
struct RowStore {
  std::vector<Vec3<T>> J, W;
  std::vector<Vec3<T>> x;  ///< (nv) scratch
};

/// The rows' topology, with room for their numbers at the end of the store.
template <Number T>
MANYHANDS_INLINE RowBlock add_row_block(const Tree<real_t<T>>& tree, std::size_t body_a, std::size_t body_b,
                                        RowStore<T>& store) {
  const auto parent = [&](int i) { return tree.dof_parent[static_cast<std::size_t>(i)]; };
  RowBlock rows{.body_a = body_a, .body_b = body_b, .J = store.J.size(), .W = store.W.size()};
  const int last_a = tree.last_dof[body_a], last_b = tree.last_dof[body_b];
  int a = last_a, b = last_b;
  while (a != b) (a > b ? a : b) = parent(a > b ? a : b);
  rows.common = a;
  std::size_t entries = 0;
  for (int i = last_a; i != rows.common; i = parent(i)) ++entries;
  for (int i = last_b; i != rows.common; i = parent(i)) ++entries;
  store.J.resize(store.J.size() + entries);
  if (last_a >= 0) {
    rows.begin_a = tree.cluster_begin[static_cast<std::size_t>(last_a)];
    rows.end_a = tree.cluster_end[static_cast<std::size_t>(last_a)];
  }
  if (last_b >= 0 && (last_a < 0 || tree.cluster_begin[static_cast<std::size_t>(last_b)] != rows.begin_a)) {
    rows.begin_b = tree.cluster_begin[static_cast<std::size_t>(last_b)];
    rows.end_b = tree.cluster_end[static_cast<std::size_t>(last_b)];
  }
  store.W.resize(store.W.size() + static_cast<std::size_t>(rows.end_a - rows.begin_a + rows.end_b - rows.begin_b));
  return rows;
}

/// Calls body(entry of J, dof, sign) for every dof of the rows: sign -1 where it moves A, +1 where it moves B.
template <Number T, class Body>
MANYHANDS_INLINE void visit_rows(const Tree<real_t<T>>& tree, const RowBlock& rows, Body&& body) {
  std::size_t entry = rows.J;
  for (int i = tree.last_dof[rows.body_a]; i != rows.common; i = tree.dof_parent[static_cast<std::size_t>(i)])
    body(entry++, static_cast<std::size_t>(i), real_t<T>(-1));
  for (int i = tree.last_dof[rows.body_b]; i != rows.common; i = tree.dof_parent[static_cast<std::size_t>(i)])
    body(entry++, static_cast<std::size_t>(i), real_t<T>(1));
}

/// J x, for x over the dofs.
template <Number T>
MANYHANDS_INLINE Vec3<T> multiply_rows(const Tree<real_t<T>>& tree, const RowBlock& rows, const RowStore<T>& store,
                                       const T* x) {
  Vec3<T> u = Vec3<T>::zero();
  visit_rows<T>(tree, rows, [&](std::size_t entry, std::size_t i, real_t<T>) { u = fma(x[i], store.J[entry], u); });
  return u;
}

/// y += J^T impulse.
template <Number T>
MANYHANDS_INLINE void add_row_impulse(const Tree<real_t<T>>& tree, const RowBlock& rows, const RowStore<T>& store,
                                      const Vec3<T>& impulse, T* y) {
  visit_rows<T>(tree, rows, [&](std::size_t entry, std::size_t i, real_t<T>) { y[i] += dot(store.J[entry], impulse); });
}

/// dv += W impulse: what the velocities gain by it.
template <Number T>
MANYHANDS_INLINE void apply_row_impulse(const RowBlock& rows, const RowStore<T>& store, const Vec3<T>& impulse, T* dv) {
  const Vec3<T>* W = &store.W[rows.W];
  const auto apply = [&](int begin, int end) {
    for (int i = begin; i < end; ++i, ++W)
      dv[i] = fma(W->x, impulse.x, fma(W->y, impulse.y, fma(W->z, impulse.z, dv[i])));
  };
  apply(rows.begin_a, rows.end_a);
  apply(rows.begin_b, rows.end_b);
}

/// Rows 2 and 3 turned by the angle of (c, s): (e_1, e_2) := (c e_1 + s e_2, c e_2 - s e_1).
template <Number T>
MANYHANDS_INLINE Vec3<T> turned_rows(const Vec3<T>& a, T c, T s) {
  return {a.x, fma(c, a.y, s * a.z), fma(c, a.z, -(s * a.y))};
}

/// Multiplies: G = J W by its columns, where store.x has W by dof.
template <Number T>
MANYHANDS_INLINE Mat3<T> multiply_response(const Tree<real_t<T>>& tree, const RowBlock& rows,
                                           const RowStore<T>& store) {
  Mat3<T> G{Vec3<T>::zero(), Vec3<T>::zero(), Vec3<T>::zero()};
  visit_rows<T>(tree, rows, [&](std::size_t k, std::size_t i, real_t<T>) {
    const Vec3<T>& w = store.x[i];
    G = {fma(w.x, store.J[k], G.x), fma(w.y, store.J[k], G.y), fma(w.z, store.J[k], G.z)};
  });
  return G;
}

/// Writes W from store.x, with rows 2 and 3 turned, in the worlds of the mask.
template <Number T>
MANYHANDS_INLINE void keep_response(const RowBlock& rows, mask_t<T> where, T c, T s, RowStore<T>& store) {
  Vec3<T>* W = &store.W[rows.W];
  const auto keep = [&](int begin, int end) {
    for (int i = begin; i < end; ++i, ++W)
      *W = select(where, turned_rows(store.x[static_cast<std::size_t>(i)], c, s), *W);
  };
  keep(rows.begin_a, rows.end_a);
  keep(rows.begin_b, rows.end_b);
}

/// W = A J^T by dof into store.x, with the factors ws.L, in which all dofs of the two clusters take part.
template <Number T>
MANYHANDS_INLINE void respond(const Tree<real_t<T>>& tree, const RowBlock& rows, const Workspace<T>& ws,
                              RowStore<T>& store) {
  const auto solve = [&](int begin, int end) {
    if (begin == end) return;
    const std::span<const int> dofs(tree.dofs_from_leaves);
    solve_ltdl(dofs.subspan(static_cast<std::size_t>(tree.nv - end), static_cast<std::size_t>(end - begin)),
               tree.dof_parent.data(), tree.M_row.data(), ws.L.data(), store.x.data());
  };
  for (int i = rows.begin_a; i < rows.end_a; ++i) store.x[static_cast<std::size_t>(i)] = Vec3<T>::zero();
  for (int i = rows.begin_b; i < rows.end_b; ++i) store.x[static_cast<std::size_t>(i)] = Vec3<T>::zero();
  visit_rows<T>(tree, rows, [&](std::size_t entry, std::size_t i, real_t<T>) { store.x[i] = store.J[entry]; });
  solve(rows.begin_a, rows.end_a);
  solve(rows.begin_b, rows.end_b);
}

/// J of one block times what another block's impulse does, `response` by dof: one Vec3 per row of this block, over the
/// three impulses of the other.
template <Number T>
MANYHANDS_INLINE std::array<Vec3<T>, 3> multiply_shared_rows(const Tree<real_t<T>>& tree, const RowBlock& rows,
                                                             const RowStore<T>& store, const RowBlock& other,
                                                             const std::vector<Vec3<T>>& response) {
  std::array<Vec3<T>, 3> product{Vec3<T>::zero(), Vec3<T>::zero(), Vec3<T>::zero()};
  const auto covered = [&](std::size_t dof) {
    const int i = static_cast<int>(dof);
    return (i >= other.begin_a && i < other.end_a) || (i >= other.begin_b && i < other.end_b);
  };
  visit_rows<T>(tree, rows, [&](std::size_t entry, std::size_t i, real_t<T>) {
    if (!covered(i)) return;
    const Vec3<T>& J = store.J[entry];
    product = {fma(J.x, response[i], product[0]), fma(J.y, response[i], product[1]), fma(J.z, response[i], product[2])};
  });
  return product;
}

template <Number T>
MANYHANDS_INLINE void turn_rows(const Tree<real_t<T>>& tree, const RowBlock& rows, T c, T s, RowStore<T>& store) {
  visit_rows<T>(tree, rows, [&](std::size_t k, std::size_t, real_t<T>) { store.J[k] = turned_rows(store.J[k], c, s); });
}

}  // namespace manyhands
