// Rows that give way by their compliance: MuJoCo's law of soft constraints, as a force that is implicit in the
// velocity. Few models have any: what calls these is kept out of line, or it would slow the steps of all others.
#pragma once

#include "manyhands/math/functions.h"
#include "manyhands/math/number.h"
#include "manyhands/model/compliance.h"

namespace manyhands {

/// A Compliance as kernels read it.
template <Real R>
struct TreeCompliance {
  R stiffness{}, damping{};                ///< over d_max^2 and d_max: what the error and its rate are multiplied by
  R impedance{}, growth{};                 ///< at no error, and what comes to it at `width`
  R inverse_width{}, midpoint{}, power{};  ///< of the growth
  R rises{}, falls{};                      ///< midpoint^(1 - power) and (1 - midpoint)^(1 - power)
};

template <Real R>
[[nodiscard]] TreeCompliance<R> tree_compliance(const Compliance& compliance);

/// With a time constant of two steps at least, as MuJoCo has it.
template <Real R>
[[nodiscard]] MANYHANDS_INLINE TreeCompliance<R> slowed(TreeCompliance<R> c, R h) {
  const R most = c.impedance + c.growth;
  const R too_fast = max(R(1), h * most * max(R(2) * sqrt(c.stiffness), c.damping));
  c.stiffness /= too_fast * too_fast;
  c.damping /= too_fast;
  return c;
}

/// The impedance at the error r, between 0 and 1.
template <Number T>
MANYHANDS_INLINE T impedance_at(const TreeCompliance<real_t<T>>& c, T r) {
  const T one = constant<T>(1), zero = constant<T>(0), x = min(abs(r) * T(c.inverse_width), one);
  const auto power = [&](T base) {
    if (c.power == 1) return base;
    if (c.power == 2) return base * base;
    return select(base > zero, exp(T(c.power) * log(max(base, constant<T>(1e-30)))), zero);
  };
  const T growth = select(x <= T(c.midpoint), T(c.rises) * power(x), fma(-T(c.falls), power(one - x), one));
  return fma(T(c.growth), growth, T(c.impedance));
}

/// The impulse of a row in a step, pull - slope J dv, where J dv is how its velocity changes.
template <Number T>
struct YieldingRow {
  T slope;  ///< [kg or kg m^2]
  T pull;   ///< [N s or N m s]
};

/// What a row with an error gives in a step h, as springs and dampers do: damping at the velocity of the step's end,
/// the spring in the middle of the change. So it is stable however stiff it is. `mobility`: W [1/kg or 1/(kg m^2)];
/// `least`: what the row yields at least by an impulse, for W may be 0; `bend`: dJ/dt v.
template <Number T>
MANYHANDS_INLINE YieldingRow<T> yielding_row(const TreeCompliance<real_t<T>>& c, real_t<T> h, T impedance, T mobility,
                                             T least, T error, T rate, T bend = constant<T>(0)) {
  using R = real_t<T>;
  const T one = constant<T>(1), step(h), stiffness = T(c.stiffness) * impedance, damping(c.damping);
  const T inertia = one / max((one - impedance) / impedance * mobility, least);
  const T slope = inertia * fma(step, damping, fma(T(R(0.25) * h * h), stiffness, one));
  return {slope, -(step * inertia) * fma(damping, rate, fma(stiffness, error, bend))};
}

/// The same of a row that pushes one way alone: at the velocity and error that the step begins with, as MuJoCo's, and
/// slowed. An implicit spring would let it be left again with what it was met with.
template <Number T>
MANYHANDS_INLINE YieldingRow<T> pushing_row(const TreeCompliance<real_t<T>>& compliance, real_t<T> h, T mobility,
                                            T least, T error, T rate) {
  const TreeCompliance<real_t<T>> c = slowed(compliance, h);
  const T one = constant<T>(1), impedance = impedance_at(c, error);
  const T inertia = one / max((one - impedance) / impedance * mobility, least);
  return {inertia, -(T(h) * inertia) * fma(T(c.damping), rate, T(c.stiffness) * impedance * error)};
}

}  // namespace manyhands
