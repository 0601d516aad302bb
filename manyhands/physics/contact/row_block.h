// Three rows of a Jacobian between two bodies, and what an impulse along them does to the velocities.
//
// With A = (M + springs)^-1 = B B^T of the factors in ws.L (B = L^-1 D^-1/2), an impulse f changes velocities by
// dv = B y, y = Y^T f, where Y = J B: in the coordinates y inertia is 1, so that Y alone says what velocities do to the
// rows and what the rows do to velocities, J A J^T = Y Y^T, and Y is no fuller than J but for common ancestors.
#pragma once

#include "manyhands/math/spatial.h"
#include "manyhands/physics/contact/joint_constraints.h"

namespace manyhands {

/// Where the three rows of one contact or loop lie: J over the dofs that move body B against body A, Y over all that
/// answer. Uniform; valid while the tree lives.
struct RowBlock {
  std::size_t body_a{}, body_b{};
  int common = -1;                              ///< the last dof that moves both bodies alike, or -1
  int begin_a{}, end_a{};                       ///< dofs of A's cluster of trees; empty for the world
  int begin_b{}, end_b{};                       ///< dofs of B's cluster where it is another
  std::size_t num_J{};                          ///< entries of J
  std::size_t J{};                              ///< first of them: A's dofs from the last to the root, then B's
  std::size_t Y{};                              ///< first of its entries
  std::span<const int> answer_a{}, answer_b{};  ///< Y's dofs, leaves first
  bool single{};                                ///< whether rows 2 and 3 are zero
};

/// Storage of the rows of many blocks: each entry holds the three rows' numbers of one dof. What is past the used
/// entries is left from earlier steps.
template <Number T>
struct RowStore {
  explicit RowStore(int nv) : x(static_cast<std::size_t>(nv)), y(x.size()) {}

  void clear() { used_J = used_Y = 0; }

  std::vector<Vec3<T>> J, Y;
  std::size_t used_J{}, used_Y{};
  std::vector<Vec3<T>> x;  ///< (nv) scratch: Y of one block
  std::vector<T> y;        ///< (nv) change of the velocities, in the coordinates of Y
};

/// The topology of rows between two bodies, without numbers.
template <Number T>
MANYHANDS_INLINE RowBlock rows_between(const Tree<real_t<T>>& tree, std::size_t body_a, std::size_t body_b) {
  const auto path = [&](std::size_t body) {
    const std::size_t begin = tree.path_begin[body];
    return std::span<const int>(tree.path).subspan(begin, tree.path_begin[body + 1] - begin);
  };
  const auto all = [&](int begin, int end) {
    return std::span<const int>(tree.dofs_from_leaves)
        .subspan(static_cast<std::size_t>(tree.nv - end), static_cast<std::size_t>(end - begin));
  };
  RowBlock rows{.body_a = body_a, .body_b = body_b, .answer_a = path(body_a), .answer_b = path(body_b)};
  rows.num_J = rows.answer_a.size() + rows.answer_b.size();
  int a = tree.last_dof[body_a], b = tree.last_dof[body_b];
  if (a >= 0) {
    rows.begin_a = tree.cluster_begin[static_cast<std::size_t>(a)];
    rows.end_a = tree.cluster_end[static_cast<std::size_t>(a)];
  }
  const bool joined = a >= 0 && b >= 0 && tree.cluster_begin[static_cast<std::size_t>(b)] == rows.begin_a;
  if (b >= 0 && !joined) {
    rows.begin_b = tree.cluster_begin[static_cast<std::size_t>(b)];
    rows.end_b = tree.cluster_end[static_cast<std::size_t>(b)];
  }
  if (joined) {
    for (rows.num_J = 0; a != b; ++rows.num_J) {
      int& later = a > b ? a : b;
      later = tree.dof_parent[static_cast<std::size_t>(later)];
    }
    rows.common = a;
  }
  // What both bodies share answers too, and loops spread an impulse over their whole cluster.
  if (joined || !tree.equalities.empty()) {
    rows.answer_a = all(rows.begin_a, rows.end_a);
    rows.answer_b = all(rows.begin_b, rows.end_b);
  }
  return rows;
}

/// The same rows with room for numbers at the end of the store.
template <Number T>
MANYHANDS_INLINE RowBlock add_row_block(RowBlock rows, RowStore<T>& store) {
  const auto take = [](std::vector<Vec3<T>>& entries, std::size_t& used, std::size_t count) {
    const std::size_t first = used;
    used += count;
    if (entries.size() < used) entries.resize(2 * used);
    return first;
  };
  rows.J = take(store.J, store.used_J, rows.num_J);
  rows.Y = take(store.Y, store.used_Y, rows.answer_a.size() + rows.answer_b.size());
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

/// Calls body(entry of Y, dof).
template <class Body>
MANYHANDS_INLINE void visit_answer(const RowBlock& rows, Body&& body) {
  std::size_t entry = rows.Y;
  for (const int i : rows.answer_a) body(entry++, static_cast<std::size_t>(i));
  for (const int i : rows.answer_b) body(entry++, static_cast<std::size_t>(i));
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

/// Y y: the rows' velocity by that in store.y.
template <Number T>
MANYHANDS_INLINE Vec3<T> answered_velocity(const RowBlock& rows, const RowStore<T>& store) {
  Vec3<T> u = Vec3<T>::zero();
  const Vec3<T>* Y = store.Y.data();
  const T* y = store.y.data();
  visit_answer(rows, [&](std::size_t entry, std::size_t i) { u = fma(y[i], Y[entry], u); });
  return u;
}

/// store.y += Y^T impulse: what the velocities gain by it.
template <Number T>
MANYHANDS_INLINE void apply_row_impulse(const RowBlock& rows, const Vec3<T>& impulse, RowStore<T>& store) {
  const Vec3<T>* Y = store.Y.data();
  T* y = store.y.data();
  visit_answer(rows, [&](std::size_t entry, std::size_t i) {
    y[i] = fma(Y[entry].x, impulse.x, fma(Y[entry].y, impulse.y, fma(Y[entry].z, impulse.z, y[i])));
  });
}

/// Before the first `apply_row_impulse`.
template <Number T>
MANYHANDS_INLINE void begin_change(RowStore<T>& store) {
  for (T& y : store.y) y = T(real_t<T>(0));
}

/// dv += B y with the impulses applied since `begin_change`, over the dofs of which ws.L has factors: what else lies
/// there is of other steps, and even times 0 it would spread what is not finite.
template <Number T>
MANYHANDS_INLINE void end_change(const Tree<real_t<T>>& tree, const Workspace<T>& ws, RowStore<T>& store,
                                 JointConstraints<T>& jc) {
  solve_to_leaves(std::span<const int>(jc.forced_dofs), jc.forced_parent.data(), tree.M_row.data(), ws.L.data(),
                  store.y.data(), [&](int k) { return ws.root[static_cast<std::size_t>(k)]; });
  for (const int k : jc.forced_dofs) jc.dv[static_cast<std::size_t>(k)] += store.y[static_cast<std::size_t>(k)];
}

/// ws.root of the factors in ws.L.
template <Number T>
MANYHANDS_INLINE void find_roots(const Tree<real_t<T>>& tree, Workspace<T>& ws) {
  for (std::size_t i = 0; i < ws.root.size(); ++i)
    ws.root[i] = sqrt(max((ws.L.data() + tree.M_row[i])[i], T(real_t<T>(0))));
}

/// Y = J B by dof into store.x, with the factors in ws.L, in which all dofs of the two clusters take part.
template <Number T>
MANYHANDS_INLINE void find_answer(const Tree<real_t<T>>& tree, const RowBlock& rows, const Workspace<T>& ws,
                                  RowStore<T>& store) {
  Vec3<T>* x = store.x.data();
  const Vec3<T>* J = store.J.data();
  const T* root = ws.root.data();
  visit_answer(rows, [&](std::size_t, std::size_t i) { x[i] = Vec3<T>::zero(); });
  visit_rows<T>(tree, rows, [&](std::size_t entry, std::size_t i, real_t<T>) { x[i] = J[entry]; });
  for (const std::span<const int> dofs : {rows.answer_a, rows.answer_b})
    solve_to_root(dofs, tree.dof_parent.data(), tree.M_row.data(), ws.L.data(), x);
  visit_answer(rows, [&](std::size_t, std::size_t i) { x[i] = root[i] * x[i]; });
}

/// Keeps the Y that store.x has by dof; Y Y^T.
template <Number T>
MANYHANDS_INLINE Mat3<T> keep_answer(const RowBlock& rows, RowStore<T>& store) {
  Mat3<T> G{Vec3<T>::zero(), Vec3<T>::zero(), Vec3<T>::zero()};
  const Vec3<T>* x = store.x.data();
  Vec3<T>* kept = store.Y.data();
  visit_answer(rows, [&](std::size_t entry, std::size_t i) {
    const Vec3<T> Y = kept[entry] = x[i];
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

/// Y of one block times Y^T of another, `answer` by dof: one Vec3 per row of this block, over the three of the other.
/// Only the first row where the block has no more.
template <Number T>
MANYHANDS_INLINE std::array<Vec3<T>, 3> multiply_answers(const RowBlock& rows, const RowStore<T>& store,
                                                         const RowBlock& other, const std::vector<Vec3<T>>& answer) {
  std::array<Vec3<T>, 3> product{Vec3<T>::zero(), Vec3<T>::zero(), Vec3<T>::zero()};
  visit_answer(rows, [&](std::size_t entry, std::size_t dof) {
    const int i = static_cast<int>(dof);
    const bool shared = (i >= other.begin_a && i < other.end_a) || (i >= other.begin_b && i < other.end_b);
    if (!shared) return;
    const Vec3<T>&Y = store.Y[entry], &x = answer[dof];
    product[0] = fma(Y.x, x, product[0]);
    if (rows.single) return;
    product[1] = fma(Y.y, x, product[1]);
    product[2] = fma(Y.z, x, product[2]);
  });
  return product;
}

}  // namespace manyhands
