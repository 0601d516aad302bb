// Inverse dynamics: the recursive Newton-Euler algorithm (Featherstone 2008, table 5.1), about O in world axes.
#pragma once

#include "manyhands/physics/dynamics/kinematics.h"

namespace manyhands {

namespace internal {

/// Acceleration of the world that stands in for gravity: bodies then need no gravity force.
template <Number T, Number P>
MANYHANDS_INLINE Motion<T> minus_gravity(const Params<P>& params) {
  return {Vec3<T>::zero(), -broadcast<T>(params.gravity[0])};
}

/// The body's inertia about O in world axes.
template <Number T, Number P>
MANYHANDS_INLINE void place_inertia(std::size_t b, const Params<P>& params, Workspace<T>& ws) {
  ws.I[b] = transformed(Transform<T>{ws.R_WB[b], ws.p_OB[b]}, broadcast<T>(params.inertia[b]));
}

/// The force that moves the body as V and A say: d/dt (I V).
template <Number T>
MANYHANDS_INLINE void newton_euler(std::size_t b, Workspace<T>& ws) {
  ws.F[b] = ws.I[b] * ws.A[b] + cross(ws.V[b], ws.I[b] * ws.V[b]);
}

/// The outward pass of `rnea`: places and moves every body, and finds the force it needs, at the acceleration a (nv),
/// or at none where `a` is null.
template <Number T, Number P>
MANYHANDS_INLINE void newton_euler_pass(const Tree<real_t<T>>& tree, const Params<P>& params, const T* q, const T* v,
                                        const T* a, Workspace<T>& ws) {
  MANYHANDS_ASSERT(fit(tree, params, ws));
  ws.A[0] = minus_gravity<T>(params);
  for (std::size_t b = 1; b < tree.bodies.size(); ++b) {
    const TreeBody<real_t<T>>& body = tree.bodies[b];
    place(tree, b, q, ws);
    const Motion<T> c = move(tree, b, v, ws);
    Motion<T> A = ws.A[static_cast<std::size_t>(body.parent)] + c;
    if (a != nullptr) {
      for (int k = body.iv; k < body.iv + body.nv; ++k) A = fma(a[k], ws.S[static_cast<std::size_t>(k)], A);
    }
    ws.A[b] = A;
    place_inertia(b, params, ws);
    newton_euler(b, ws);
  }
}

}  // namespace internal

/// tau (nv) that gives the acceleration a (nv) in the state q (nq), v (nv): M a + C v + g, with the rotors' armature
/// and without damping.
template <Number T, Number P>
void rnea(const Tree<real_t<T>>& tree, const Params<P>& params, const T* q, const T* v, const T* a, T* tau,
          Workspace<T>& ws) {
  internal::newton_euler_pass(tree, params, q, v, a, ws);
  for (std::size_t b = tree.bodies.size() - 1; b > 0; --b) {
    const TreeBody<real_t<T>>& body = tree.bodies[b];
    for (int k = body.iv; k < body.iv + body.nv; ++k) {
      const auto i = static_cast<std::size_t>(k);
      tau[i] = fma(broadcast<T>(params.armature[i]), a[i], dot(ws.S[i], ws.F[b]));
    }
    if (body.parent != 0) {
      Force<T>& F = ws.F[static_cast<std::size_t>(body.parent)];
      F = F + ws.F[b];
    }
  }
}

}  // namespace manyhands
