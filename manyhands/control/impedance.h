// Impedance: a spring and a damper between a frame and its goal (Hogan, Impedance control, ASME J. Dyn. Sys. Meas.
// Control 107, 1985, without shaping of the inertia); and admittance, the motion that a force makes of a mass on such a
// spring.
#pragma once

#include <span>

#include "manyhands/kinematics/inverse_kinematics.h"

namespace manyhands {

/// The spring and damper between a frame and its goal.
struct Impedance {
  double stiffness = 1000;           ///< [N/m]
  double damping = 100;              ///< [N s/m]
  double rotational_stiffness = 50;  ///< [N m/rad]
  double rotational_damping = 2;     ///< [N m s/rad]
};

/// What spring and damper do to a frame at X_WF that moves with V: at its origin, in world axes. At rest the frame
/// yields by F / stiffness to a force F.
template <Number T>
[[nodiscard]] MANYHANDS_INLINE Force<T> impedance_force(const Impedance& impedance, const Transform<T>& goal,
                                                        const Transform<T>& X_WF, const Motion<T>& V) {
  const Motion<T> e = internal::pose_error(goal, X_WF);
  return {constant<T>(impedance.rotational_stiffness) * e.w - constant<T>(impedance.rotational_damping) * V.w,
          constant<T>(impedance.stiffness) * e.v - constant<T>(impedance.damping) * V.v};
}

/// tau += J^T F over the dofs, of a force at a frame's origin in world axes; p_OF as in `visit_jacobian`.
template <Number T>
MANYHANDS_INLINE void add_frame_force(std::span<const std::size_t> dofs, const Vec3<T>& p_OF, const Force<T>& F,
                                      const Workspace<T>& ws, T* tau) {
  for (const std::size_t i : dofs) tau[i] += dot(at_point(ws.S[i], p_OF), F);
}

/// A mass on a spring and a damper; along each axis and about it.
struct Admittance {
  double mass = 5;                  ///< [kg]
  double damping = 100;             ///< [N s/m]
  double stiffness = 0;             ///< [N/m]; with 0 it goes on where it is pushed
  double inertia = 0.1;             ///< [kg m^2]
  double rotational_damping = 2;    ///< [N m s/rad]
  double rotational_stiffness = 0;  ///< [N m/rad]
};

/// Lets a force F move the displacement x (rotation vector and position, small in turn) and its velocity V for a step
/// h: mass x'' + damping x' + stiffness x = F. Implicit Euler, stable for every h.
template <Number T>
MANYHANDS_INLINE void admit(const Admittance& admittance, real_t<T> h, const Force<T>& F, Motion<T>& x, Motion<T>& V) {
  const T step(h);
  const auto advance = [&](double mass, double damping, double stiffness, const Vec3<T>& f, Vec3<T>& at, Vec3<T>& v) {
    const T m = constant<T>(mass), d = constant<T>(damping), k = constant<T>(stiffness);
    const T scale = constant<T>(1) / fma(step, fma(step, k, d), m);
    v = scale * fma(step, fma(-k, at, f), m * v);
    at = fma(step, v, at);
  };
  advance(admittance.inertia, admittance.rotational_damping, admittance.rotational_stiffness, F.n, x.w, V.w);
  advance(admittance.mass, admittance.damping, admittance.stiffness, F.f, x.v, V.v);
}

}  // namespace manyhands
