// What contacts do to links: the sum of the forces at the points that a step found.
#pragma once

#include "manyhands/physics/step/step.h"
#include "manyhands/physics/world/contact_report.h"

namespace manyhands {

/// The forces on B at one point.
template <Number T>
struct PointForces {
  Vec3<T> normal, friction;
};

/// Of an impulse along a patch's axes, in the step 1 / inverse_h; 0 where it does not `act`.
template <Number T>
[[nodiscard]] PointForces<T> point_forces(const ContactPatch<T>& patch, const Vec3<T>& impulse, T inverse_h,
                                          mask_t<T> acts) {
  const T zero = constant<T>(0);
  const T n = inverse_h * select(acts, impulse.x, zero);
  const T y_1 = inverse_h * select(acts, impulse.y, zero);
  const T y_2 = inverse_h * select(acts, impulse.z, zero);
  return {n * patch.normal, fma(y_1, patch.e_1, y_2 * patch.e_2)};
}

/// The moment on B of spinning and rolling friction.
template <Number T>
[[nodiscard]] Vec3<T> torsion_moment(const ContactPatch<T>& patch, const Vec3<T>& impulse, T inverse_h,
                                     mask_t<T> acts) {
  const Vec3<T> y = select(acts, inverse_h * impulse, Vec3<T>::zero());
  return fma(y.x, patch.normal, fma(y.y, patch.t_1, y.z * patch.t_2));
}

/// Adds the forces at a point that lies at `arm` from the link's origin; `sign` is 1 for B, -1 for A.
template <Number T>
MANYHANDS_INLINE void add_forces(const PointForces<T>& forces, const Vec3<T>& arm, real_t<T> sign,
                                 ContactForces<T>& sum) {
  sum.normal = fma(T(sign), Force<T>{cross(arm, forces.normal), forces.normal}, sum.normal);
  sum.friction = fma(T(sign), Force<T>{cross(arm, forces.friction), forces.friction}, sum.friction);
}

/// Calls visit(collider, sign) for A (-1) and B (1) of a pair.
template <Real R, class Visit>
void visit_sides(const ColliderPair& pair, Visit&& visit) {
  visit(pair.a, R(-1));
  visit(pair.b, R(1));
}

/// The origin of a link in the world, before the step that `ws` tells of.
template <Number T>
[[nodiscard]] Vec3<T> link_origin(const Frame& link, const Workspace<T>& ws) {
  const std::size_t b = link.body.index();
  return ws.R_WB[b] * broadcast<T>(broadcast<real_t<T>>(link.X_BF.p)) + ws.p_OB[b] + ws.p_WO[b];
}

}  // namespace manyhands
