// Inverse dynamics with a reference velocity beside the true one: M a_r + C(q, v) v_r + g, with the C for which
// dM/dt - 2 C is skew-symmetric. Controllers whose stability rests on energy need it.
//
// In spatial terms a body's force is I A_r + B(V) V_r, where B(V) V = V x* I V and dI/dt - 2 B(V) is skew:
//     B(V) V_r = (V x* I V_r + V_r x* I V - I (V x V_r)) / 2
// (Niemeyer, Slotine, Performance in adaptive manipulator control, Int. J. Robotics Research 10(2), 1991).
#pragma once

#include "manyhands/control/joint_control.h"

namespace manyhands {

/// What this adds to the dynamics' scratch: velocities of bodies about O, as Workspace::V.
template <Number T>
struct ReferenceWorkspace {
  explicit ReferenceWorkspace(const Tree<real_t<T>>& tree)
      : V_r(static_cast<std::size_t>(tree.nb), Motion<T>::zero()),
        V_s(V_r),
        v_r(static_cast<std::size_t>(tree.nv)),
        a_r(v_r),
        s(v_r) {}

  std::vector<Motion<T>> V_r;  ///< (nb) under the reference velocity
  std::vector<Motion<T>> V_s;  ///< (nb) under the sliding variable
  std::vector<T> v_r, a_r, s;  ///< (nv)
};

/// Places and moves all bodies by q and v, and by reference.v_r and a_r: sets ws.V, ws.A (of the reference, gravity
/// included) and reference.V_r, and with them V_s of reference.s.
template <Number T, Number P>
void move_reference(const Tree<real_t<T>>& tree, const Params<P>& params, const T* q, const T* v,
                    ReferenceWorkspace<T>& reference, Workspace<T>& ws) {
  ws.A[0] = internal::minus_gravity<T>(params);
  for (std::size_t b = 1; b < tree.bodies.size(); ++b) {
    const TreeBody<real_t<T>>& body = tree.bodies[b];
    const auto parent = static_cast<std::size_t>(body.parent);
    place(tree, b, q, ws);
    (void)move(tree, b, v, ws);
    reference.V_r[b] = reference.V_r[parent];
    reference.V_s[b] = reference.V_s[parent];
    ws.A[b] = ws.A[parent];
    if (body.nv == 0) continue;
    const auto i = static_cast<std::size_t>(body.iv);
    const Motion<T> step = reference.v_r[i] * ws.S[i];
    reference.V_r[b] = reference.V_r[b] + step;
    reference.V_s[b] = fma(reference.s[i], ws.S[i], reference.V_s[b]);
    ws.A[b] = ws.A[b] + fma(reference.a_r[i], ws.S[i], cross(ws.V[b], step));
  }
}

/// tau (nv) = M a_r + C(q, v) v_r + g, armature included; after `move_reference`. `inertia` (nb) is of the bodies,
/// about their origins in their axes.
template <Number T, class Inertia, Number P>
void reference_force(const Tree<real_t<T>>& tree, const Params<P>& params, const Inertia& inertia,
                     const ReferenceWorkspace<T>& reference, T* tau, Workspace<T>& ws) {
  const T half = constant<T>(0.5);
  for (std::size_t b = 1; b < tree.bodies.size(); ++b) {
    ws.I[b] = transformed(Transform<T>{ws.R_WB[b], ws.p_OB[b]}, broadcast<T>(inertia[b]));
    const RigidInertia<T>& I = ws.I[b];
    const Motion<T>&V = ws.V[b], &V_r = reference.V_r[b];
    ws.F[b] = I * fma(-half, cross(V, V_r), ws.A[b]) + half * (cross(V, I * V_r) + cross(V_r, I * V));
  }
  for (std::size_t b = tree.bodies.size() - 1; b > 0; --b) {
    const TreeBody<real_t<T>>& body = tree.bodies[b];
    for (int k = body.iv; k < body.iv + body.nv; ++k) {
      const auto i = static_cast<std::size_t>(k);
      tau[i] = fma(broadcast<T>(params.armature[i]), reference.a_r[i], dot(ws.S[i], ws.F[b]));
    }
    if (body.parent != 0) {
      Force<T>& F = ws.F[static_cast<std::size_t>(body.parent)];
      F = F + ws.F[b];
    }
  }
}

}  // namespace manyhands
