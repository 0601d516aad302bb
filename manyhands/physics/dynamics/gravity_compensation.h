// What gravity compensation does to joints: it carries a share of a body's weight, as MuJoCo's gravcomp does.
#pragma once

#include "manyhands/physics/dynamics/kinematics.h"

namespace manyhands {

/// Calls visit(dof, force) with what compensation adds to every dof that moves a body it carries. After the bodies and
/// axes are placed in `ws`.
template <Number T, Number P, class Visit>
MANYHANDS_INLINE void visit_gravity_compensation(const Tree<real_t<T>>& tree, const Params<P>& params,
                                                 const Workspace<T>& ws, Visit&& visit) {
  for (const TreeLift<real_t<T>>& lift : tree.lifts) {
    const std::size_t b = lift.body;
    const T mass = T(tree.bodies[b].lifted) * broadcast<T>(params.inertia[b].m);
    const Vec3<T> f = -mass * broadcast<T>(params.gravity[0]);
    const Force<T> F{cross(ws.R_WB[b] * broadcast<T>(lift.p_BC) + ws.p_OB[b], f), f};
    for (int k = tree.last_dof[b]; k >= 0; k = tree.dof_parent[static_cast<std::size_t>(k)]) {
      visit(static_cast<std::size_t>(k), dot(ws.S[static_cast<std::size_t>(k)], F));
    }
  }
}

}  // namespace manyhands
