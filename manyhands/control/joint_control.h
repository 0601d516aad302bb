// Control of joints along a desired motion, with the model's dynamics: gravity compensation, feedforward, computed
// torque (Siciliano, Sciavicco, Villani, Oriolo, Robotics, 2009, chapter 8).
//
// Errors are differences of q, so all joints are of one degree of freedom (`require_single_joints`).
#pragma once

#include "manyhands/control/pid.h"
#include "manyhands/physics/dynamics/rnea.h"

namespace manyhands {

/// Throws ModelError, which names it, if a joint has not exactly one degree of freedom. Fixed joints are none.
void require_single_joints(const Model& model);

/// A desired motion, (nv) each.
template <Number T>
struct JointMotion {
  const T* q;
  const T* v;
  const T* a;
};

/// Of every dof, (nv) each, the same in all lanes.
template <Real R>
struct JointGains {
  const R* kp;
  const R* kd;
};

namespace internal {

template <Number T>
MANYHANDS_INLINE T pd_of_dof(const JointGains<real_t<T>>& gains, std::size_t i, const T* q, const T* v,
                             const JointMotion<T>& desired) {
  return pd(T(gains.kp[i]), T(gains.kd[i]), desired.q[i] - q[i], desired.v[i] - v[i]);
}

}  // namespace internal

/// tau (nv) = g(q): what holds the arm at rest.
template <Number T, Number P>
void gravity_torque(const Tree<real_t<T>>& tree, const Params<P>& params, const T* q, T* tau, Workspace<T>& ws) {
  for (T& zero : ws.u) zero = constant<T>(0);
  rnea(tree, params, q, ws.u.data(), ws.u.data(), tau, ws);
}

/// tau (nv) = kp (q_d - q) + kd (v_d - v) + g(q), which reaches any q_d without a steady error if v_d = 0 (Takegaki,
/// Arimoto, ASME J. Dyn. Sys. Meas. Control 103, 1981).
template <Number T, Number P>
void pd_gravity(const Tree<real_t<T>>& tree, const Params<P>& params, const JointGains<real_t<T>>& gains, const T* q,
                const T* v, const JointMotion<T>& desired, T* tau, Workspace<T>& ws) {
  gravity_torque(tree, params, q, tau, ws);
  for (std::size_t i = 0; i < ws.u.size(); ++i) tau[i] = tau[i] + internal::pd_of_dof(gains, i, q, v, desired);
}

/// tau (nv) = M(q_d) a_d + C(q_d, v_d) v_d + g(q_d) + kp (q_d - q) + kd (v_d - v): the model looks at the desired
/// motion only, so that its part can be computed beforehand.
template <Number T, Number P>
void pd_feedforward(const Tree<real_t<T>>& tree, const Params<P>& params, const JointGains<real_t<T>>& gains,
                    const T* q, const T* v, const JointMotion<T>& desired, T* tau, Workspace<T>& ws) {
  rnea(tree, params, desired.q, desired.v, desired.a, tau, ws);
  for (std::size_t i = 0; i < ws.u.size(); ++i) tau[i] = tau[i] + internal::pd_of_dof(gains, i, q, v, desired);
}

/// tau (nv) = M(q) (a_d + kp (q_d - q) + kd (v_d - v) + ki integral) + C(q, v) v + g(q): each joint follows as a linear
/// system of its own, e'' + kd e' + kp e = 0 (Luh, Walker, Paul, IEEE Trans. Automatic Control 25, 1980). Gains are of
/// accelerations [1/s^2, 1/s]. `ki` and `integral` (nv) may be null; the caller advances the integral.
template <Number T, Number P>
void computed_torque(const Tree<real_t<T>>& tree, const Params<P>& params, const JointGains<real_t<T>>& gains,
                     const T* q, const T* v, const JointMotion<T>& desired, const real_t<T>* ki, const T* integral,
                     T* tau, Workspace<T>& ws) {
  for (std::size_t i = 0; i < ws.u.size(); ++i) {
    ws.u[i] = desired.a[i] + internal::pd_of_dof(gains, i, q, v, desired);
    if (ki != nullptr) ws.u[i] = fma(T(ki[i]), integral[i], ws.u[i]);
  }
  rnea(tree, params, q, v, ws.u.data(), tau, ws);
}

}  // namespace manyhands
