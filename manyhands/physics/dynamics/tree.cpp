#include "manyhands/physics/dynamics/tree.h"

#include "manyhands/math/instantiate.h"

namespace manyhands {

namespace {

bool is_identity(const Mat3<double>& m) {
  return m.x.x == 1 && m.y.y == 1 && m.z.z == 1 && m.x.y == 0 && m.x.z == 0 && m.y.x == 0 && m.y.z == 0 &&
         m.z.x == 0 && m.z.y == 0;
}

template <Number T>
std::vector<T> broadcast_all(std::span<const double> values) {
  std::vector<T> result;
  for (const double value : values) result.push_back(T(static_cast<real_t<T>>(value)));
  return result;
}

}  // namespace

template <Real R>
Tree<R>::Tree(const Model& model)
    : nb(model.num_bodies()),
      nq(model.nq()),
      nv(model.nv()),
      dof_parent(model.dof_parent().begin(), model.dof_parent().end()),
      dof_q(model.dof_q().begin(), model.dof_q().end()) {
  for (const Body& body : model.bodies()) {
    bodies.push_back({.parent = body.parent.value(),
                      .type = body.type,
                      .iq = body.iq,
                      .iv = body.iv,
                      .nv = body.nv,
                      .aligned = is_identity(body.X_PF.R),
                      .X_PF = {{{R(body.X_PF.R.x.x), R(body.X_PF.R.x.y), R(body.X_PF.R.x.z)},
                                {R(body.X_PF.R.y.x), R(body.X_PF.R.y.y), R(body.X_PF.R.y.z)},
                                {R(body.X_PF.R.z.x), R(body.X_PF.R.z.y), R(body.X_PF.R.z.z)}},
                               {R(body.X_PF.p.x), R(body.X_PF.p.y), R(body.X_PF.p.z)}}});
  }
  for (const JointLimits& limits : model.dof_limits()) {
    dof_limited.push_back(is_finite(limits.lower) || is_finite(limits.upper));
  }
}

template <Number T>
Params<T>::Params(const Model& model)
    : gravity(broadcast<T>(model.gravity())),
      damping(broadcast_all<T>(model.dof_damping())),
      armature(broadcast_all<T>(model.dof_armature())),
      motor_kp(static_cast<std::size_t>(model.nv()), T(real_t<T>(0))),
      motor_kd(motor_kp),
      motor_max_force(motor_kp) {
  for (const Body& body : model.bodies()) inertia.push_back(broadcast<T>(body.inertia));
  for (const JointLimits& limits : model.dof_limits()) {
    lower.push_back(T(static_cast<real_t<T>>(limits.lower)));
    upper.push_back(T(static_cast<real_t<T>>(limits.upper)));
  }
}

template struct Tree<double>;
template struct Tree<float>;

#define MANYHANDS_INSTANTIATE(T) template struct Params<T>;
MANYHANDS_FOR_EACH_NUMBER(MANYHANDS_INSTANTIATE)

}  // namespace manyhands
