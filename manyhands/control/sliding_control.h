// Control on a sliding surface: robust against a wrong model, and adaptive to it (Slotine, Li, Applied Nonlinear
// Control, 1991, sections 7.1 and 9.2).
//
// With e = q_d - q the sliding variable is s = e' + lambda e, and the reference velocity v_r = v_d + lambda e = v + s.
// Where s stays 0, e decays as exp(-lambda t).
#pragma once

#include "manyhands/control/reference_dynamics.h"

namespace manyhands {

/// Of every dof, (nv) each, the same in all lanes.
template <Real R>
struct SlidingGains {
  const R* slope;     ///< lambda [1/s]
  const R* kd;        ///< of s [N m s/rad or N s/m]
  const R* robust;    ///< force against what the model does not know [N m or N]; of `sliding_mode`
  const R* boundary;  ///< |s| below which that force falls in proportion, above 0 [rad/s or m/s]; likewise
};

/// Unknown numbers of a body: its RigidInertia, in the order m, h (3), I (xx, yy, zz, xy, xz, yz).
inline constexpr std::size_t kBodyParameters = 10;

namespace internal {

/// Sets v_r, a_r and s of the reference, and moves all bodies.
template <Number T, Number P>
void follow_reference(const Tree<real_t<T>>& tree, const Params<P>& params, const SlidingGains<real_t<T>>& gains,
                      const T* q, const T* v, const JointMotion<T>& desired, ReferenceWorkspace<T>& reference,
                      Workspace<T>& ws) {
  for (std::size_t i = 0; i < reference.s.size(); ++i) {
    const T lambda(gains.slope[i]), rate = desired.v[i] - v[i];
    reference.v_r[i] = fma(lambda, desired.q[i] - q[i], desired.v[i]);
    reference.a_r[i] = fma(lambda, rate, desired.a[i]);
    reference.s[i] = reference.v_r[i] - v[i];
  }
  move_reference(tree, params, q, v, reference, ws);
}

/// The motion, about O, as one about body b's origin in b's axes.
template <Number T>
MANYHANDS_INLINE Motion<T> in_body(const Motion<T>& m, std::size_t b, const Workspace<T>& ws) {
  const Motion<T> there = at_point(m, ws.p_OB[b]);
  return {transpose_times(ws.R_WB[b], there.w), transpose_times(ws.R_WB[b], there.v)};
}

/// derivative += scale d(a . I b)/dI: the power of a on the momentum of b is linear in the ten numbers of I.
template <Number T>
MANYHANDS_INLINE void add_derivative(T scale, const Motion<T>& a, const Motion<T>& b,
                                     std::array<T, kBodyParameters>& derivative) {
  const Vec3<T> h = cross(b.v, a.w) + cross(a.v, b.w);
  const std::array<T, kBodyParameters> terms{dot(a.v, b.v),
                                             h.x,
                                             h.y,
                                             h.z,
                                             a.w.x * b.w.x,
                                             a.w.y * b.w.y,
                                             a.w.z * b.w.z,
                                             fma(a.w.x, b.w.y, a.w.y * b.w.x),
                                             fma(a.w.x, b.w.z, a.w.z * b.w.x),
                                             fma(a.w.y, b.w.z, a.w.z * b.w.y)};
  for (std::size_t i = 0; i < kBodyParameters; ++i) derivative[i] = fma(scale, terms[i], derivative[i]);
}

}  // namespace internal

/// tau (nv) = M a_r + C v_r + g + kd s + robust sat(s / boundary). If `robust` is at least what the model is wrong by,
/// s reaches its boundary layer, and |e| ends below boundary / lambda.
template <Number T, Number P>
void sliding_mode(const Tree<real_t<T>>& tree, const Params<P>& params, const SlidingGains<real_t<T>>& gains,
                  const T* q, const T* v, const JointMotion<T>& desired, T* tau, ReferenceWorkspace<T>& reference,
                  Workspace<T>& ws) {
  internal::follow_reference(tree, params, gains, q, v, desired, reference, ws);
  reference_force(tree, params, params.inertia, reference, tau, ws);
  for (std::size_t i = 0; i < reference.s.size(); ++i) {
    const T& s = reference.s[i];
    tau[i] = fma(T(gains.robust[i]), limited(s / T(gains.boundary[i]), constant<T>(1)), fma(T(gains.kd[i]), s, tau[i]));
  }
}

/// tau (nv) = Y theta + kd s, where Y theta = M a_r + C v_r + g with the bodies' inertias `theta` (nb - 1, 10) in place
/// of the model's; and over the step h they follow d theta/dt = rate Y^T s, which makes s vanish whatever they begin
/// with (Slotine, Li, On the adaptive control of robot manipulators, Int. J. Robotics Research 6(3), 1987). `rate` (10)
/// is how fast each of the ten is learned, 0 for not at all. The estimates need not become the true ones, nor possible
/// ones.
template <Number T, Number P>
void adaptive(const Tree<real_t<T>>& tree, const Params<P>& params, const SlidingGains<real_t<T>>& gains,
              const real_t<T>* rate, real_t<T> h, const T* q, const T* v, const JointMotion<T>& desired, T* theta,
              T* tau, ReferenceWorkspace<T>& reference, Workspace<T>& ws) {
  internal::follow_reference(tree, params, gains, q, v, desired, reference, ws);
  const T half = constant<T>(0.5);
  for (std::size_t b = 1; b < tree.bodies.size(); ++b) {
    const Motion<T>&V = ws.V[b], &V_r = reference.V_r[b], &V_s = reference.V_s[b];
    const auto here = [&](const Motion<T>& m) { return internal::in_body(m, b, ws); };
    // V_s . (I A' + (V x* I V_r + V_r x* I V) / 2), with u . (V x* f) = -(V x u) . f
    std::array<T, kBodyParameters> slope{};
    slope.fill(constant<T>(0));
    internal::add_derivative(constant<T>(1), here(V_s), here(fma(-half, cross(V, V_r), ws.A[b])), slope);
    internal::add_derivative(-half, here(cross(V, V_s)), here(V_r), slope);
    internal::add_derivative(-half, here(cross(V_r, V_s)), here(V), slope);
    T* const p = theta + (b - 1) * kBodyParameters;
    for (std::size_t i = 0; i < kBodyParameters; ++i) p[i] = fma(T(h * rate[i]), slope[i], p[i]);
  }
  const auto estimate = [theta](std::size_t b) {
    const T* const p = theta + (b - 1) * kBodyParameters;
    return RigidInertia<T>{p[0], {p[1], p[2], p[3]}, {p[4], p[5], p[6], p[7], p[8], p[9]}};
  };
  struct Estimates {
    const decltype(estimate)& of;
    RigidInertia<T> operator[](std::size_t b) const { return of(b); }
  };
  reference_force(tree, params, Estimates{estimate}, reference, tau, ws);
  for (std::size_t i = 0; i < reference.s.size(); ++i) tau[i] = fma(T(gains.kd[i]), reference.s[i], tau[i]);
}

}  // namespace manyhands
