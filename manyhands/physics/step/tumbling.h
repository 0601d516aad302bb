// Free bodies, and those on ball joints of their own, that tumble by half a radian or more in a step.
//
// A step turns their velocity by the gyroscopic torque of where it begins: along a tangent, so that the energy grows by
// a part of (h omega)^2, a step for a step. Where that is much, a couple keeps it as it is.
#pragma once

#include "manyhands/base/index.h"
#include "manyhands/math/control_flow.h"
#include "manyhands/physics/dynamics/workspace.h"

namespace manyhands {

namespace internal {

/// What turns less in a step keeps its bits [rad].
inline constexpr double kTumbling = 0.5;

/// The inertia about the centre of mass, or about the ball joint.
template <Number T>
MANYHANDS_INLINE SymMat3<T> turning_inertia(const RigidInertia<T>& I, bool floats) {
  if (!floats) return I.I;
  const Vec3<T> c = (constant<T>(1) / I.m) * I.h;
  const T xx = fma(-c.y, I.h.y, fma(-c.z, I.h.z, I.I.xx)), yy = fma(-c.x, I.h.x, fma(-c.z, I.h.z, I.I.yy));
  const T zz = fma(-c.x, I.h.x, fma(-c.y, I.h.y, I.I.zz));
  return {xx, yy, zz, fma(c.x, I.h.y, I.I.xy), fma(c.x, I.h.z, I.I.xz), fma(c.y, I.h.z, I.I.yz)};
}

/// I^-1 a; 0 where the body is too thin to tell.
template <Number T>
MANYHANDS_INLINE Vec3<T> solve(const SymMat3<T>& I, const Vec3<T>& a) {
  const T scale = constant<T>(1) / (I.xx + I.yy + I.zz), zero = constant<T>(0), one = constant<T>(1);
  const T xx = scale * I.xx, yy = scale * I.yy, zz = scale * I.zz;
  const T xy = scale * I.xy, xz = scale * I.xz, yz = scale * I.yz;
  const SymMat3<T> cofactors{fma(yy, zz, -yz * yz), fma(xx, zz, -xz * xz), fma(xx, yy, -xy * xy),
                             fma(xz, yz, -xy * zz), fma(xy, yz, -xz * yy), fma(xy, xz, -xx * yz)};
  const T det = fma(xx, cofactors.xx, fma(xy, cofactors.xy, xz * cofactors.xz));
  const auto told = det > T(real_t<T>(16) * std::numeric_limits<real_t<T>>::epsilon());
  return select(told, scale / select(told, det, one), zero) * (cofactors * a);
}

/// The couple against which a body of that inertia turns omega in a step, and neither gains nor loses.
template <Number T>
[[gnu::noinline]] Vec3<T> couple_of_tumbling(const SymMat3<T>& I, const Vec3<T>& omega, T h) {
  const Vec3<T> momentum = I * omega, torque = cross(omega, momentum), change = -h * solve(I, torque);
  const T twice = dot(omega, momentum), gains = -h * dot(change, torque);
  const T kept = sqrt(twice / (twice + max(gains, constant<T>(0))));
  return ((constant<T>(1) - kept) / h) * (I * (omega + change));
}

}  // namespace internal

/// Adds the couples to ws.bias, after `bias_and_mass_matrix`.
template <Number T>
MANYHANDS_INLINE void bound_tumbling(const Tree<real_t<T>>& tree, T h, Workspace<T>& ws) {
  const T far = constant<T>(internal::kTumbling * internal::kTumbling);
  for (std::size_t b = 1; b < tree.bodies.size(); ++b) {
    const TreeBody<real_t<T>>& body = tree.bodies[b];
    const bool floats = body.type == JointType::kFloating;
    if (body.parent != 0 || !(floats || body.type == JointType::kSpherical)) continue;
    if (tree.end_dof[index(body.iv)] != body.iv + body.nv) continue;
    const Vec3<T> omega = ws.V[b].w;
    const auto fast = h * h * squared_norm(omega) > far;
    when(fast, [&] {
      const Vec3<T> couple = internal::couple_of_tumbling(internal::turning_inertia(ws.I[b], floats), omega, h);
      for (std::size_t i = index(body.iv); i < index(body.iv) + 3; ++i)
        ws.bias[i] = select(fast, ws.bias[i] + dot(ws.S[i].w, couple), ws.bias[i]);
    });
  }
}

}  // namespace manyhands
