// How points and bodies move against each other, and the rows of J that say so.
#pragma once

#include "manyhands/physics/contact/rows.h"
#include "manyhands/physics/dynamics/lengths.h"

namespace manyhands::internal {

template <Number T>
MANYHANDS_INLINE PointMotion<T> point_motion(const Workspace<T>& ws, std::size_t body, const Vec3<T>& p) {
  return motion_at(ws, body, p - ws.p_WO[body]);
}

/// Of B's point at p (world) against A's.
template <Number T>
MANYHANDS_INLINE PointMotion<T> relative_motion(const Workspace<T>& ws, std::size_t a, std::size_t b,
                                                const Vec3<T>& p) {
  const PointMotion<T> of_A = point_motion(ws, a, p), of_B = point_motion(ws, b, p);
  return {of_B.velocity - of_A.velocity, of_B.acceleration - of_A.acceleration};
}

/// J of B's point p_B against A's point p_A (world) along the three directions d: what each dof adds to its velocity.
template <Number T>
MANYHANDS_INLINE void fill_point_rows(const Tree<real_t<T>>& tree, const Workspace<T>& ws, const RowBlock& rows,
                                      const Vec3<T>& p_A, const Vec3<T>& p_B, const std::array<Vec3<T>, 3>& d,
                                      RowEntries<T>& entries) {
  // d . (v + w x r) = d . v + (r x d) . w, the r being that of the tree the dof is in.
  std::array<Force<T>, 3> along_a, along_b;
  for (std::size_t k = 0; k < 3; ++k) {
    along_a[k] = {cross(d[k], p_A - ws.p_WO[rows.body_a]), -d[k]};
    along_b[k] = {cross(p_B - ws.p_WO[rows.body_b], d[k]), d[k]};
  }
  visit_J(tree, rows, [&](std::size_t entry, std::size_t i, real_t<T> sign) {
    const std::array<Force<T>, 3>& along = sign < 0 ? along_a : along_b;
    entries.J[entry] = {dot(ws.S[i], along[0]), dot(ws.S[i], along[1]), dot(ws.S[i], along[2])};
  });
}

/// The same of one point p that both bodies have.
template <Number T>
MANYHANDS_INLINE void fill_point_rows(const Tree<real_t<T>>& tree, const Workspace<T>& ws, const RowBlock& rows,
                                      const Vec3<T>& p, const std::array<Vec3<T>, 3>& d, RowEntries<T>& entries) {
  fill_point_rows(tree, ws, rows, p, p, d, entries);
}

/// J of the relative rotation about the three directions.
template <Number T>
MANYHANDS_INLINE void fill_rotation_rows(const Tree<real_t<T>>& tree, const Workspace<T>& ws, const RowBlock& rows,
                                         const std::array<Vec3<T>, 3>& d, RowEntries<T>& entries) {
  visit_J(tree, rows, [&](std::size_t entry, std::size_t i, real_t<T> sign) {
    const Vec3<T>& w = ws.S[i].w;
    const Vec3<T> column{dot(d[0], w), dot(d[1], w), dot(d[2], w)};
    entries.J[entry] = sign < 0 ? -column : column;
  });
}

/// Marks the trees on which rows act in the worlds of the mask.
template <Number T>
MANYHANDS_INLINE void mark_constrained(const RowBlock& rows, mask_t<T> where, std::vector<T>& constrained) {
  const T one = constant<T>(1);
  const auto mark = [&](int begin, int end) {
    for (std::size_t i = index(begin); i < index(end); ++i) constrained[i] = select(where, one, constrained[i]);
  };
  mark(rows.begin_a, rows.end_a);
  mark(rows.begin_b, rows.end_b);
}

}  // namespace manyhands::internal
