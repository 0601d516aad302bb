// What actuators make of their commands: activations, and the force that follows.
#pragma once

#include "manyhands/math/functions.h"
#include "manyhands/physics/dynamics/params.h"
#include "manyhands/physics/dynamics/state.h"

namespace manyhands {

/// The activation at the end of a step of h [s], from that at its beginning and ctrl.
template <Number T>
[[nodiscard]] MANYHANDS_INLINE T next_activation(const TreeActuator<real_t<T>>& actuator, real_t<T> h, T act, T ctrl) {
  using R = real_t<T>;
  const R tau = max(actuator.time_constant, R(1e-15));  // MuJoCo's mjMINVAL
  T next = act;
  switch (actuator.activation) {
    case ActivationType::kNone:
      break;
    case ActivationType::kIntegrator:
      next = fma(T(h), ctrl, act);
      break;
    case ActivationType::kFilter:
      next = fma(T(h / tau), ctrl - act, act);
      break;
    case ActivationType::kFilterExact:
      next = fma(T(R(1) - exp(-h / tau)), ctrl - act, act);
      break;
  }
  return clamp(next, T(actuator.least_act), T(actuator.most_act));
}

/// Takes all activations to the end of a step of h [s].
template <Number T>
MANYHANDS_INLINE void advance_activations(const Tree<real_t<T>>& tree, real_t<T> h, State<T>& state) {
  for (std::size_t k = 0; k < tree.actuators.size(); ++k) {
    const TreeActuator<real_t<T>>& actuator = tree.actuators[k];
    if (actuator.act >= 0)
      state.act()[actuator.act] = next_activation(actuator, h, state.act()[actuator.act], state.ctrl()[k]);
  }
}

/// What stands where the law of actuator k says ctrl.
template <Number T>
[[nodiscard]] MANYHANDS_INLINE T command(const Tree<real_t<T>>& tree, real_t<T> h, const State<T>& state,
                                         std::size_t k) {
  const TreeActuator<real_t<T>>& actuator = tree.actuators[k];
  T ctrl = state.ctrl()[k];
  if (actuator.act >= 0) {
    const T act = state.act()[actuator.act];
    ctrl = actuator.early ? next_activation(actuator, h, act, ctrl) : act;
  }
  return actuator.is_scaled() ? fma(T(actuator.scale), ctrl, T(actuator.offset)) : ctrl;
}

/// The force of a drive at a joint, gear (pull - stiffness gear (q+ - q) - damping gear v+), where q and v+ are of the
/// dof or length. Neither stiffness nor damping is below 0: what would be is in pull.
template <Number T>
struct DriveLaw {
  T gear, pull, stiffness, damping;
};

/// Of actuator k, which is no force, at `measured` (q) and `rate` (v) of its dof or length.
template <Number T, Number P>
[[nodiscard]] MANYHANDS_INLINE DriveLaw<T> drive_law(const TreeActuator<real_t<T>>& actuator, const Params<P>& params,
                                                     std::size_t k, T ctrl, T measured, T rate) {
  const T gear = broadcast<T>(params.gear[k]), zero = constant<T>(0);
  if (actuator.type == ActuatorType::kAffine) {
    const auto number = [&](std::size_t i) { return fma(T(actuator.gain[i]), ctrl, T(actuator.bias[i])); };
    const T by_q = number(1), by_v = number(2);
    const T pull = fma(by_q, gear * measured, fma(max(by_v, zero), gear * rate, number(0)));
    return {gear, pull, max(-by_q, zero), max(-by_v, zero)};
  }
  const T kp = broadcast<T>(params.drive_kp[k]), kd = broadcast<T>(params.drive_kd[k]);
  if (actuator.type == ActuatorType::kVelocity) return {gear, kd * ctrl, kp, kd};
  T error = ctrl - gear * measured;
  if (actuator.period > 0) {
    const T period(actuator.period), turns = error - T(actuator.offset);
    error -= period * round(turns / period);
  }
  return {gear, kp * error, kp, kd};
}

}  // namespace manyhands
