// One step of one world, or of one block of worlds.
#pragma once

#include "manyhands/physics/contact/joint_constraints.h"
#include "manyhands/physics/dynamics/aba.h"
#include "manyhands/physics/dynamics/crba.h"

namespace manyhands {

/// All that a step derives: allocated once, never saved.
template <Number T>
struct StepWorkspace {
  explicit StepWorkspace(const Tree<real_t<T>>& tree) : dynamics(tree), joints(tree.nv) {}
  Workspace<T> dynamics;
  JointConstraints<T> joints;
};

/// q := q moved by the velocity v (nv) for `time` [s].
template <Number T>
MANYHANDS_INLINE void integrate_configuration(const Tree<real_t<T>>& tree, const T* v, T time, T* q) {
  for (std::size_t b = 1; b < tree.bodies.size(); ++b) {
    const TreeBody<real_t<T>>& body = tree.bodies[b];
    const T* vj = v + body.iv;
    T* qj = q + body.iq;
    switch (body.type) {
      case JointType::kSpherical:
      case JointType::kFloating: {
        if (body.type == JointType::kFloating) {
          for (int k = 0; k < 3; ++k) qj[k] = fma(time, vj[3 + k], qj[k]);
          qj += 3;
        }
        const Quat<T> r = integrate(Quat<T>{qj[0], qj[1], qj[2], qj[3]}, Vec3<T>{vj[0], vj[1], vj[2]}, time);
        qj[0] = r.x;
        qj[1] = r.y;
        qj[2] = r.z;
        qj[3] = r.w;
        break;
      }
      default:
        for (int k = 0; k < body.nv; ++k) qj[k] = fma(time, vj[k], qj[k]);
        break;
    }
  }
}

/// v := v + dv, which the state keeps.
template <Number T>
MANYHANDS_INLINE void add_velocity_change(const std::vector<T>& dv, State<T>& state) {
  for (std::size_t i = 0; i < dv.size(); ++i) {
    state.v()[i] += dv[i];
    state.dv()[i] = dv[i];
  }
}

/// Advances the state by h [s]: semi-implicit Euler at the velocity level, with implicit damping, motors and limits.
template <Number T, Number P>
MANYHANDS_INLINE void step(const Tree<real_t<T>>& tree, const Params<P>& params, real_t<T> h, State<T>& state,
                           StepWorkspace<T>& ws) {
  bias_and_mass_matrix(tree, params, state.q(), state.v(), ws.dynamics);      // 1 kinematics, bias and inertia
  prepare_joint_constraints(tree, params, h, state, ws.dynamics, ws.joints);  // 2 what motors and limits want
  solve_joint_constraints(tree, state, ws.dynamics, ws.joints);               // 3 what they get
  add_velocity_change(ws.joints.dv, state);                                   // 4 velocities
  integrate_configuration(tree, state.v(), T(h), state.q());                  // 5 positions
}

}  // namespace manyhands
