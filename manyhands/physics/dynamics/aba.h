// Forward dynamics: the articulated-body algorithm (Featherstone 2008, table 7.1), about O in world axes.
//
// A joint of several dofs is eliminated dof by dof, which is the block elimination of the book written as a chain.
#pragma once

#include "manyhands/physics/dynamics/rnea.h"

namespace manyhands {

/// qdd (nv) under the joint forces tau (nv) in the state q (nq), v (nv): M^-1 (tau - C v - g), armature included,
/// without damping.
template <Number T, Number P>
void aba(const Tree<real_t<T>>& tree, const Params<P>& params, const T* q, const T* v, const T* tau, T* qdd,
         Workspace<T>& ws) {
  MANYHANDS_ASSERT(internal::fit(tree, params, ws));
  const std::size_t nb = tree.bodies.size();

  // Outward: velocities, inertias, and the force p_A that the velocities call for. F holds
  // p_A, and A holds c until the last pass.
  for (std::size_t b = 1; b < nb; ++b) {
    place(tree, b, q, ws);
    ws.A[b] = move(tree, b, v, ws);
    internal::place_inertia(b, params, ws);
    ws.I_A[b] = articulated(ws.I[b]);
    ws.F[b] = cross(ws.V[b], ws.I[b] * ws.V[b]);
  }

  // Inward: each joint leaves its parent the inertia and the force that it cannot give way to.
  for (std::size_t b = nb - 1; b > 0; --b) {
    const TreeBody<real_t<T>>& body = tree.bodies[b];
    ArticulatedInertia<T> I_A = ws.I_A[b];
    Force<T> p_A = ws.F[b] + I_A * ws.A[b];
    for (int k = body.iv + body.nv - 1; k >= body.iv; --k) {
      const auto i = static_cast<std::size_t>(k);
      ws.U[i] = I_A * ws.S[i];
      const T D = dot(ws.S[i], ws.U[i]) + broadcast<T>(params.armature[i]);
      ws.D_inverse[i] = T(real_t<T>(1)) / D;
      ws.u[i] = tau[i] - dot(ws.S[i], p_A);
      I_A = project(I_A, ws.U[i], ws.D_inverse[i]);
      p_A = fma(ws.u[i] * ws.D_inverse[i], ws.U[i], p_A);
    }
    const auto parent = static_cast<std::size_t>(body.parent);
    if (parent != 0) {
      ws.I_A[parent] += I_A;
      ws.F[parent] = ws.F[parent] + p_A;
    }
  }

  // Outward: accelerations.
  ws.A[0] = internal::minus_gravity<T>(params);
  for (std::size_t b = 1; b < nb; ++b) {
    const TreeBody<real_t<T>>& body = tree.bodies[b];
    Motion<T> A = ws.A[static_cast<std::size_t>(body.parent)];
    for (int k = body.iv; k < body.iv + body.nv; ++k) {
      const auto i = static_cast<std::size_t>(k);
      qdd[i] = (ws.u[i] - dot(A, ws.U[i])) * ws.D_inverse[i];
      A = fma(qdd[i], ws.S[i], A);
    }
    ws.A[b] = A + ws.A[b];
  }
}

}  // namespace manyhands
