// The classic Runge-Kutta method of fourth order on a tree's configurations, for motion without motors and limits.
#pragma once

#include <array>

#include "manyhands/physics/dynamics/aba.h"
#include "manyhands/physics/dynamics/drag.h"
#include "manyhands/physics/dynamics/gravity_compensation.h"
#include "manyhands/physics/dynamics/springs.h"
#include "manyhands/physics/step/step.h"

namespace manyhands {

/// Scratch of `runge_kutta_step`; one row per dof.
template <Number T>
struct RungeKutta {
  explicit RungeKutta(const Tree<real_t<T>>& tree)
      : dynamics(tree),
        q(static_cast<std::size_t>(tree.nq)),
        v(static_cast<std::size_t>(tree.nv)),
        phi(v),
        d_phi(v),
        d_v(v),
        sum_phi(v),
        sum_v(v),
        tau(v) {}

  Workspace<T> dynamics;
  std::vector<T> q, v;            ///< at a stage
  std::vector<T> phi;             ///< the way from the step's first q to the stage's
  std::vector<T> d_phi, d_v;      ///< rates at a stage
  std::vector<T> sum_phi, sum_v;  ///< weighted rates so far
  std::vector<T> tau;             ///< applied, and passive
};

namespace internal {

/// The rate of a rotation vector phi whose rotation exp(phi) turns with omega: dexp^-1_phi(omega), to the order that a
/// method of fourth order needs (Munthe-Kaas 1999; Hairer, Lubich and Wanner 2006, eq. III.4.11).
template <Number T>
MANYHANDS_INLINE void rotation_vector_rate(const T* phi, const T* omega, T* rate) {
  using R = real_t<T>;
  const Vec3<T> p{phi[0], phi[1], phi[2]}, w{omega[0], omega[1], omega[2]};
  const Vec3<T> pw = cross(p, w);
  const Vec3<T> r = fma(T(R(1.0 / 12)), cross(p, pw), fma(T(R(-0.5)), pw, w));
  rate[0] = r.x;
  rate[1] = r.y;
  rate[2] = r.z;
}

}  // namespace internal

/// Advances the state by h [s] under its tau and passive forces: damping, springs, gravity compensation. Joint motors
/// and limits do not act.
template <Number T, Number P>
void runge_kutta_step(const Tree<real_t<T>>& tree, const Params<P>& params, real_t<T> h, State<T>& state,
                      RungeKutta<T>& rk) {
  using R = real_t<T>;
  const auto nq = static_cast<std::size_t>(tree.nq), nv = static_cast<std::size_t>(tree.nv);
  constexpr std::array<double, 4> kReach{0.0, 0.5, 0.5, 1.0}, kWeight{1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
  place_mocap(tree, state.mocap(), rk.dynamics);
  for (std::size_t stage = 0; stage < 4; ++stage) {
    const T reach(static_cast<R>(kReach[stage]) * h), weight(static_cast<R>(kWeight[stage]));
    for (std::size_t i = 0; i < nq; ++i) rk.q[i] = state.q()[i];
    for (std::size_t i = 0; i < nv; ++i) {
      rk.phi[i] = stage == 0 ? T(R(0)) : reach * rk.d_phi[i];
      rk.v[i] = stage == 0 ? state.v()[i] : fma(reach, rk.d_v[i], state.v()[i]);
      rk.tau[i] = fma(T(-params.damping[i]), rk.v[i], state.tau()[i]);
    }
    integrate_configuration(tree, rk.phi.data(), T(R(1)), rk.q.data(), state.q_rest());
    if (!tree.lifted_bodies.empty()) {
      forward_kinematics(tree, rk.q.data(), rk.dynamics);
      visit_gravity_compensation(tree, params, rk.dynamics, [&](std::size_t i, T force) { rk.tau[i] += force; });
    }
    if (!tree.drags.empty()) {
      for (std::size_t b = 1; b < tree.bodies.size(); ++b) {
        place(tree, b, rk.q.data(), rk.dynamics);
        move(tree, b, rk.v.data(), rk.dynamics);
      }
      visit_drag(tree, rk.dynamics, [&](std::size_t i, T force) { rk.tau[i] += force; });
    }
    visit_springs<T>(tree, params, rk.q.data(),
                     [&](std::size_t i, T stiffness, T stretch) { rk.tau[i] = fma(-stiffness, stretch, rk.tau[i]); });
    aba(tree, params, rk.q.data(), rk.v.data(), rk.tau.data(), rk.d_v.data(), rk.dynamics);
    rk.d_phi = rk.v;
    for (const TreeBody<R>& body : tree.bodies) {
      if (body.type != JointType::kSpherical && body.type != JointType::kFloating) continue;
      const auto iv = static_cast<std::size_t>(body.iv);
      internal::rotation_vector_rate(&rk.phi[iv], &rk.v[iv], &rk.d_phi[iv]);
    }
    for (std::size_t i = 0; i < nv; ++i) {
      rk.sum_phi[i] = stage == 0 ? weight * rk.d_phi[i] : fma(weight, rk.d_phi[i], rk.sum_phi[i]);
      rk.sum_v[i] = stage == 0 ? weight * rk.d_v[i] : fma(weight, rk.d_v[i], rk.sum_v[i]);
    }
  }
  for (std::size_t i = 0; i < nv; ++i) state.v()[i] = fma(T(h), rk.sum_v[i], state.v()[i]);
  integrate_configuration(tree, rk.sum_phi.data(), T(h), state.q(), state.q_rest());
}

}  // namespace manyhands
