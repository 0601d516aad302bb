// What gravity compensation does to joints: it carries a share of a body's weight, as MuJoCo's gravcomp does.
#pragma once

#include "manyhands/physics/dynamics/kinematics.h"

namespace manyhands {

/// Calls visit(dof, force) with what compensation adds to every dof that moves a body it carries. After the bodies and
/// axes are placed in `ws`.
template <Number T, Number P, class Visit>
MANYHANDS_INLINE void visit_gravity_compensation(const Tree<real_t<T>>& tree, const Params<P>& params,
                                                 const Workspace<T>& ws, Visit&& visit) {
  const Vec3<T> gravity = broadcast<T>(params.gravity[0]);
  for (std::size_t i = 0; i < tree.lifted_bodies.size(); ++i) {
    const std::size_t b = tree.lifted_bodies[i];
    const T mass = broadcast<T>(params.lifted_mass[i]);
    const Vec3<T> moment = fma(mass, ws.p_OB[b], ws.R_WB[b] * broadcast<T>(params.lifted_moment[i]));
    const Force<T> F{cross(gravity, moment), -mass * gravity};
    for (int k = tree.last_dof[b]; k >= 0; k = tree.dof_parent[static_cast<std::size_t>(k)]) {
      visit(static_cast<std::size_t>(k), dot(ws.S[static_cast<std::size_t>(k)], F));
    }
  }
}

}  // namespace manyhands
