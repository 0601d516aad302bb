// Three rows of the constraint Jacobian J between two bodies, and their products.
//
// With A = B B^T the inverse of the mass matrix of what may move (see factors.h), an impulse f along the rows changes
// the velocities by dv = B y, y = Y^T f, where Y = J B. In the coordinates y inertia is 1: Y alone says what velocities
// do to the rows and what the rows do to velocities, J A J^T = Y Y^T, and Y is no fuller than J but for common
// ancestors.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "manyhands/base/index.h"
#include "manyhands/math/spatial.h"
#include "manyhands/physics/dynamics/tree.h"

namespace manyhands {

/// Where three rows lie: J over the dofs that move body B against body A, Y over all that respond. Uniform; valid while
/// the tree lives.
struct RowBlock {
  std::size_t body_a{}, body_b{};
  int common = -1;                                  ///< the last dof that moves both bodies alike, or -1
  int begin_a{}, end_a{};                           ///< dofs of A's cluster of trees; empty for the world
  int begin_b{}, end_b{};                           ///< dofs of B's cluster where it is another
  std::size_t num_J{};                              ///< entries of J
  std::size_t J{};                                  ///< first of them: A's dofs from the last to the root, then B's
  std::size_t Y{};                                  ///< first entry of Y
  std::span<const int> response_a{}, response_b{};  ///< Y's dofs, leaves first
  bool single{};                                    ///< whether rows 2 and 3 are zero

  [[nodiscard]] std::size_t num_Y() const { return response_a.size() + response_b.size(); }
};

/// Entries of all rows of a step; each holds the three rows' numbers of one dof. What lies past the used entries is
/// left from earlier steps.
template <Number T>
struct RowEntries {
  std::vector<Vec3<T>> J;
  std::size_t used_J{}, used_Y{};

  void clear() { used_J = used_Y = 0; }
};

/// The topology of rows between two bodies, without numbers.
template <Number T>
MANYHANDS_INLINE RowBlock rows_between(const Tree<real_t<T>>& tree, std::size_t body_a, std::size_t body_b) {
  const auto all = [&](int begin, int end) {
    return std::span<const int>(tree.dofs_from_leaves).subspan(index(tree.nv - end), index(end - begin));
  };
  RowBlock rows{
      .body_a = body_a,
      .body_b = body_b,
  };
  rows.response_a = tree.path_of(body_a);
  rows.response_b = tree.path_of(body_b);
  rows.num_J = rows.num_Y();
  int a = tree.last_dof[body_a], b = tree.last_dof[body_b];
  if (a >= 0) {
    rows.begin_a = tree.cluster_begin[index(a)];
    rows.end_a = tree.cluster_end[index(a)];
  }
  const bool joined = a >= 0 && b >= 0 && tree.cluster_begin[index(b)] == rows.begin_a;
  if (b >= 0 && !joined) {
    rows.begin_b = tree.cluster_begin[index(b)];
    rows.end_b = tree.cluster_end[index(b)];
  }
  if (joined) {
    for (rows.num_J = 0; a != b; ++rows.num_J) {
      int& later = a > b ? a : b;
      later = tree.dof_parent[index(later)];
    }
    rows.common = a;
  }
  // What both bodies share responds too; equality constraints and tendons spread an impulse over their whole cluster.
  if (joined || !tree.equalities.empty() || !tree.lengths.empty()) {
    rows.response_a = all(rows.begin_a, rows.end_a);
    rows.response_b = all(rows.begin_b, rows.end_b);
  }
  return rows;
}

/// The same rows with room for their numbers.
template <Number T>
MANYHANDS_INLINE RowBlock add_rows(RowBlock rows, RowEntries<T>& entries) {
  rows.J = entries.used_J;
  rows.Y = entries.used_Y;
  entries.used_J += rows.num_J;
  entries.used_Y += rows.num_Y();
  if (entries.J.size() < entries.used_J) entries.J.resize(2 * entries.used_J);
  return rows;
}

/// Calls body(entry of J, dof, sign) for every dof of the rows: sign -1 where it moves A, +1 where it moves B.
template <Real R, class Body>
MANYHANDS_INLINE void visit_J(const Tree<R>& tree, const RowBlock& rows, Body&& body) {
  std::size_t entry = rows.J;
  for (int i = tree.last_dof[rows.body_a]; i != rows.common; i = tree.dof_parent[index(i)])
    body(entry++, index(i), R(-1));
  for (int i = tree.last_dof[rows.body_b]; i != rows.common; i = tree.dof_parent[index(i)])
    body(entry++, index(i), R(1));
}

/// Calls body(entry of Y, dof).
template <class Body>
MANYHANDS_INLINE void visit_Y(const RowBlock& rows, Body&& body) {
  std::size_t entry = rows.Y;
  for (const int i : rows.response_a) body(entry++, index(i));
  for (const int i : rows.response_b) body(entry++, index(i));
}

/// J x, for x (nv).
template <Number T>
MANYHANDS_INLINE Vec3<T> multiply_J(const Tree<real_t<T>>& tree, const RowBlock& rows, const RowEntries<T>& entries,
                                    const T* x) {
  Vec3<T> u = Vec3<T>::zero();
  visit_J(tree, rows, [&](std::size_t entry, std::size_t i, real_t<T>) { u = fma(x[i], entries.J[entry], u); });
  return u;
}

/// x += J^T impulse, for x (nv).
template <Number T>
MANYHANDS_INLINE void add_JT(const Tree<real_t<T>>& tree, const RowBlock& rows, const RowEntries<T>& entries,
                             const Vec3<T>& impulse, T* x) {
  visit_J(tree, rows, [&](std::size_t entry, std::size_t i, real_t<T>) { x[i] += dot(entries.J[entry], impulse); });
}

/// Y y, for y (nv): the rows' velocity.
template <Number T>
MANYHANDS_INLINE Vec3<T> multiply_Y(const RowBlock& rows, const Vec3<T>* Y, const T* y) {
  Vec3<T> u = Vec3<T>::zero();
  visit_Y(rows, [&](std::size_t entry, std::size_t i) { u = fma(y[i], Y[entry], u); });
  return u;
}

/// y += Y^T impulse, for y (nv): what the velocities gain.
template <Number T>
MANYHANDS_INLINE void add_YT(const RowBlock& rows, const Vec3<T>* Y, const Vec3<T>& impulse, T* y) {
  visit_Y(rows, [&](std::size_t entry, std::size_t i) {
    y[i] = fma(Y[entry].x, impulse.x, fma(Y[entry].y, impulse.y, fma(Y[entry].z, impulse.z, y[i])));
  });
}

/// Y of one block times Y^T of another, the latter given by dof (nv): one Vec3 per row of this block, over the three of
/// the other. Only the first row where the block has no more.
template <Number T>
MANYHANDS_INLINE std::array<Vec3<T>, 3> multiply_YYT(const RowBlock& rows, const Vec3<T>* Y, const RowBlock& other,
                                                     const Vec3<T>* other_by_dof) {
  std::array<Vec3<T>, 3> product{Vec3<T>::zero(), Vec3<T>::zero(), Vec3<T>::zero()};
  visit_Y(rows, [&](std::size_t entry, std::size_t dof) {
    const int i = static_cast<int>(dof);
    const bool shared = (i >= other.begin_a && i < other.end_a) || (i >= other.begin_b && i < other.end_b);
    if (!shared) return;
    const Vec3<T>&own = Y[entry], &x = other_by_dof[dof];
    product[0] = fma(own.x, x, product[0]);
    if (rows.single) return;
    product[1] = fma(own.y, x, product[1]);
    product[2] = fma(own.z, x, product[2]);
  });
  return product;
}

}  // namespace manyhands
