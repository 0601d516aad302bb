// Energy, momentum and centre of mass: the invariants that tests watch.
#pragma once

#include "manyhands/physics/dynamics/lengths.h"
#include "manyhands/physics/dynamics/measures.h"
#include "manyhands/physics/dynamics/rnea.h"
#include "manyhands/physics/dynamics/springs.h"

namespace manyhands {

/// Total energy in the state q (nq), v (nv); springs and gravity compensation included.
template <Number T, Number P>
Energy<T> energy(const Tree<real_t<T>>& tree, const Params<P>& params, const T* q, const T* v, Workspace<T>& ws) {
  const T half(real_t<T>(0.5));
  Energy<T> sum{T(real_t<T>(0)), T(real_t<T>(0))};
  for (std::size_t b = 1; b < tree.bodies.size(); ++b) {
    if (tree.bodies[b].type == JointType::kMocap) continue;  // no dynamics moves it
    place(tree, b, q, ws);
    move(tree, b, v, ws);
    internal::place_inertia(b, params, ws);
    sum.kinetic = fma(half, dot(ws.V[b], ws.I[b] * ws.V[b]), sum.kinetic);
    const Vec3<T> first_moment = fma(ws.I[b].m, ws.p_WO[b], ws.I[b].h);
    sum.potential = sum.potential - dot(broadcast<T>(params.gravity[0]), first_moment);
  }
  for (std::size_t i = 0; i < tree.lifted_bodies.size(); ++i) {
    const std::size_t b = tree.lifted_bodies[i];
    if (tree.bodies[b].nv == 0) continue;
    const Vec3<T> moment = fma(broadcast<T>(params.lifted_mass[i]), ws.p_OB[b] + ws.p_WO[b],
                               ws.R_WB[b] * broadcast<T>(params.lifted_moment[i]));
    sum.potential = sum.potential + dot(broadcast<T>(params.gravity[0]), moment);
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(tree.nv); ++i) {
    sum.kinetic = fma(half * broadcast<T>(params.armature[i]), v[i] * v[i], sum.kinetic);
  }
  const auto add_spring = [&](std::size_t, T stiffness, T stretch) {
    sum.potential = fma(half * stiffness, stretch * stretch, sum.potential);
  };
  visit_springs<T>(tree, params, q, add_spring);
  place_lengths(tree, q, v, ws);
  visit_tendon_springs(params, ws, add_spring);
  for (std::size_t k = 0; k < params.tendon_armature.size(); ++k)
    sum.kinetic =
        fma(half * broadcast<T>(params.tendon_armature[k]), ws.length_rate[k] * ws.length_rate[k], sum.kinetic);
  return sum;
}

/// Mass, centre of mass and momentum of all moving bodies in the state q (nq), v (nv).
template <Number T, Number P>
MassProperties<T> mass_properties(const Tree<real_t<T>>& tree, const Params<P>& params, const T* q, const T* v,
                                  Workspace<T>& ws) {
  MassProperties<T> sum{T(real_t<T>(0)), Vec3<T>::zero(), Force<T>::zero()};
  for (std::size_t b = 1; b < tree.bodies.size(); ++b) {
    if (tree.bodies[b].type == JointType::kMocap) continue;  // no dynamics moves it
    place(tree, b, q, ws);
    move(tree, b, v, ws);
    internal::place_inertia(b, params, ws);
    const Force<T> momentum = ws.I[b] * ws.V[b];
    sum.mass += ws.I[b].m;
    sum.com += fma(ws.I[b].m, ws.p_WO[b], ws.I[b].h);
    sum.momentum = sum.momentum + Force<T>{momentum.n + cross(ws.p_WO[b], momentum.f), momentum.f};
  }
  sum.com = (T(real_t<T>(1)) / sum.mass) * sum.com;
  return sum;
}

}  // namespace manyhands
