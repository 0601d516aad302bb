// A manifold acts between its two bodies by one wrench: six rows that its points share.
#pragma once

#include "manyhands/physics/contact/row_block.h"

namespace manyhands {

/// The rows of one manifold: velocities along (normal, e_1, e_2) at its origin and rotation about (normal, t_1, t_2),
/// where e_i = friction_i t_i. Motions of B against A, and forces between them, are in these axes about that origin.
template <Number T>
struct ContactPatch {
  ContactPatch() {}  // NOLINT: to add a patch shall not clear what is written next

  std::size_t first{}, count{};  ///< of its points
  RowBlock linear{}, angular{};
  bool turns{};  ///< whether it has the angular rows: a lone point, which lies at the origin, needs none
  Vec3<T> origin;
  T friction_1, friction_2;
  Mat3<T> G_vf, G_wf, G_wn;  ///< what forces and moments do to velocity and rotation; G_vn = G_wf^T
  Motion<T> start;           ///< J dv when a sweep begins
  Force<T> closed_at;        ///< the impulse at which the loops were closed
};

/// The velocity, along (normal, e_1, e_2), of a point of the patch. `lever`: from its origin, in its axes.
template <Number T>
MANYHANDS_INLINE Vec3<T> velocity_at(const ContactPatch<T>& patch, const Vec3<T>& lever, const Motion<T>& motion) {
  const Vec3<T> turning = cross(motion.w, lever);
  return {motion.v.x + turning.x, fma(patch.friction_1, turning.y, motion.v.y),
          fma(patch.friction_2, turning.z, motion.v.z)};
}

/// What an impulse along (normal, e_1, e_2) at a point is to the patch.
template <Number T>
MANYHANDS_INLINE Force<T> force_at(const ContactPatch<T>& patch, const Vec3<T>& lever, const Vec3<T>& impulse) {
  return {cross(lever, Vec3<T>{impulse.x, patch.friction_1 * impulse.y, patch.friction_2 * impulse.z}), impulse};
}

/// J x, for x over the dofs.
template <Number T>
MANYHANDS_INLINE Motion<T> patch_motion(const Tree<real_t<T>>& tree, const ContactPatch<T>& patch,
                                        const RowStore<T>& store, const T* x) {
  return {patch.turns ? multiply_rows(tree, patch.angular, store, x) : Vec3<T>::zero(),
          multiply_rows(tree, patch.linear, store, x)};
}

/// y += J^T force.
template <Number T>
MANYHANDS_INLINE void add_patch_force(const Tree<real_t<T>>& tree, const ContactPatch<T>& patch,
                                      const RowStore<T>& store, const Force<T>& force, T* y) {
  add_row_impulse(tree, patch.linear, store, force.f, y);
  if (patch.turns) add_row_impulse(tree, patch.angular, store, force.n, y);
}

/// Y y, for that in store.y.
template <Number T>
MANYHANDS_INLINE Motion<T> answered_motion(const ContactPatch<T>& patch, const RowStore<T>& store) {
  return {patch.turns ? answered_velocity(patch.angular, store) : Vec3<T>::zero(),
          answered_velocity(patch.linear, store)};
}

/// store.y += Y^T force.
template <Number T>
MANYHANDS_INLINE void apply_patch_force(const ContactPatch<T>& patch, const Force<T>& force, RowStore<T>& store) {
  apply_row_impulse(patch.linear, force.f, store);
  if (patch.turns) apply_row_impulse(patch.angular, force.n, store);
}

/// What a force between the bodies does to the patch itself.
template <Number T>
MANYHANDS_INLINE Motion<T> own_answer(const ContactPatch<T>& patch, const Force<T>& force) {
  Motion<T> motion{Vec3<T>::zero(), patch.G_vf * force.f};
  if (!patch.turns) return motion;
  motion.w = patch.G_wf * force.f + patch.G_wn * force.n;
  motion.v += transpose_times(patch.G_wf, force.n);
  return motion;
}

/// J A J^T of a point's own three rows.
template <Number T>
MANYHANDS_INLINE Mat3<T> point_answer(const ContactPatch<T>& patch, const Vec3<T>& lever) {
  Mat3<T> G = patch.G_vf;
  if (!patch.turns) return G;
  // The moment of each unit impulse; half of what it turns counts once for either side.
  const T zero(real_t<T>(0)), half(real_t<T>(0.5));
  const Vec3<T> n_x{zero, lever.z, -lever.y}, n_y = patch.friction_1 * Vec3<T>{-lever.z, zero, lever.x},
                                              n_z = patch.friction_2 * Vec3<T>{lever.y, -lever.x, zero};
  const Vec3<T> w_x = fma(half, patch.G_wn * n_x, patch.G_wf.x), w_y = fma(half, patch.G_wn * n_y, patch.G_wf.y),
                w_z = fma(half, patch.G_wn * n_z, patch.G_wf.z);
  G.x.x += dot(n_x, w_x) + dot(n_x, w_x);
  G.x.y += dot(n_x, w_y) + dot(n_y, w_x);
  G.x.z += dot(n_x, w_z) + dot(n_z, w_x);
  G.y.y += dot(n_y, w_y) + dot(n_y, w_y);
  G.y.z += dot(n_y, w_z) + dot(n_z, w_y);
  G.z.z += dot(n_z, w_z) + dot(n_z, w_z);
  return {G.x, {G.x.y, G.y.y, G.y.z}, {G.x.z, G.y.z, G.z.z}};
}

}  // namespace manyhands
