// A manifold acts between its two bodies by one wrench: six rows that its points share.
#pragma once

#include "manyhands/physics/contact/rows.h"

namespace manyhands {

/// The rows of one manifold: velocities along (normal, e_1, e_2) at its origin and rotation about (normal, t_1, t_2),
/// where e_i = friction_i t_i: the cone is |y| <= n whatever the friction. Motions of B against A, and forces between
/// them, are in these axes about that origin.
template <Number T>
struct ContactPatch {
  ContactPatch() {}  // NOLINT: to add a patch shall not clear what is written next

  std::size_t pair{}, manifold{};  ///< which colliders touch, and where their warm start is kept
  std::size_t first{}, count{};    ///< of its points
  RowBlock linear{}, angular{};
  bool turns{};      ///< whether it has the angular rows: a lone point, which lies at the origin, needs none
  Vec3<T> origin;    ///< in the world [m]
  Vec3<T> normal;    ///< from A to B
  Vec3<T> t_1, t_2;  ///< unit tangents
  Vec3<T> e_1, e_2;  ///< as long as friction along them is strong
  T friction_1, friction_2;
  T spinning, rolling;  ///< moment per normal force [m]

  [[nodiscard]] std::size_t body_a() const { return linear.body_a; }
  [[nodiscard]] std::size_t body_b() const { return linear.body_b; }
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

/// J x, for x (nv).
template <Number T>
MANYHANDS_INLINE Motion<T> patch_motion(const Tree<real_t<T>>& tree, const ContactPatch<T>& patch,
                                        const RowEntries<T>& entries, const T* x) {
  return {patch.turns ? multiply_J(tree, patch.angular, entries, x) : Vec3<T>::zero(),
          multiply_J(tree, patch.linear, entries, x)};
}

/// x += J^T force, for x (nv).
template <Number T>
MANYHANDS_INLINE void add_patch_JT(const Tree<real_t<T>>& tree, const ContactPatch<T>& patch,
                                   const RowEntries<T>& entries, const Force<T>& force, T* x) {
  add_JT(tree, patch.linear, entries, force.f, x);
  if (patch.turns) add_JT(tree, patch.angular, entries, force.n, x);
}

/// Y y, for y (nv).
template <Number T>
MANYHANDS_INLINE Motion<T> multiply_patch_Y(const ContactPatch<T>& patch, const Vec3<T>* Y, const T* y) {
  return {patch.turns ? multiply_Y(patch.angular, Y, y) : Vec3<T>::zero(), multiply_Y(patch.linear, Y, y)};
}

/// y += Y^T force, for y (nv).
template <Number T>
MANYHANDS_INLINE void add_patch_YT(const ContactPatch<T>& patch, const Vec3<T>* Y, const Force<T>& force, T* y) {
  add_YT(patch.linear, Y, force.f, y);
  if (patch.turns) add_YT(patch.angular, Y, force.n, y);
}

/// A patch's own block of the Delassus operator: what forces and moments do to velocity and rotation; G_vn = G_wf^T.
template <Number T>
struct PatchResponse {
  PatchResponse() {}  // NOLINT: as above

  Mat3<T> G_vf, G_wf, G_wn;
};

/// What a force between the bodies does to the patch itself.
template <Number T>
MANYHANDS_INLINE Motion<T> respond(const ContactPatch<T>& patch, const PatchResponse<T>& G, const Force<T>& force) {
  Motion<T> motion{Vec3<T>::zero(), G.G_vf * force.f};
  if (!patch.turns) return motion;
  motion.w = G.G_wf * force.f + G.G_wn * force.n;
  motion.v += transpose_times(G.G_wf, force.n);
  return motion;
}

/// J A J^T of a point's own three rows.
template <Number T>
MANYHANDS_INLINE Mat3<T> point_response(const ContactPatch<T>& patch, const PatchResponse<T>& response,
                                        const Vec3<T>& lever) {
  Mat3<T> G = response.G_vf;
  if (!patch.turns) return G;
  // The moment of each unit impulse; half of what it turns counts once for either side.
  const T zero = constant<T>(0), half = constant<T>(0.5);
  const Mat3<T>&G_wf = response.G_wf, &G_wn = response.G_wn;
  const Vec3<T> n_x{zero, lever.z, -lever.y}, n_y = patch.friction_1 * Vec3<T>{-lever.z, zero, lever.x},
                                              n_z = patch.friction_2 * Vec3<T>{lever.y, -lever.x, zero};
  const Vec3<T> w_x = fma(half, G_wn * n_x, G_wf.x), w_y = fma(half, G_wn * n_y, G_wf.y),
                w_z = fma(half, G_wn * n_z, G_wf.z);
  G.x.x += dot(n_x, w_x) + dot(n_x, w_x);
  G.x.y += dot(n_x, w_y) + dot(n_y, w_x);
  G.x.z += dot(n_x, w_z) + dot(n_z, w_x);
  G.y.y += dot(n_y, w_y) + dot(n_y, w_y);
  G.y.z += dot(n_y, w_z) + dot(n_z, w_y);
  G.z.z += dot(n_z, w_z) + dot(n_z, w_z);
  return {G.x, {G.x.y, G.y.y, G.y.z}, {G.x.z, G.y.z, G.z.z}};
}

}  // namespace manyhands
