#include "manyhands/physics/dynamics/yielding.h"

#include "manyhands/math/functions.h"

namespace manyhands {

namespace {

/// base^(1 - power), as impedance_at() raises to powers: the same bits with every C library.
double falling_power(double base, double power) {
  if (power == 1) return 1;
  if (power == 2) return 1 / base;
  return exp((1 - power) * log(base));
}

}  // namespace

template <Real R>
TreeCompliance<R> tree_compliance(const Compliance& compliance) {
  constexpr double kNarrow = 1e-15;  // MuJoCo's mjMINVAL
  const Compliance& c = compliance;
  const double most = c.largest_impedance, mean = 0.5 * (c.impedance + most);
  const bool grows = c.width > kNarrow;
  return {.stiffness = static_cast<R>(c.stiffness / (most * most)),
          .damping = static_cast<R>(c.damping / most),
          .impedance = static_cast<R>(grows ? c.impedance : mean),
          .growth = static_cast<R>(grows ? most - c.impedance : 0),
          .inverse_width = static_cast<R>(grows ? 1 / c.width : 0),
          .midpoint = static_cast<R>(c.midpoint),
          .power = static_cast<R>(c.power),
          .rises = static_cast<R>(falling_power(c.midpoint, c.power)),
          .falls = static_cast<R>(falling_power(1 - c.midpoint, c.power))};
}

template TreeCompliance<double> tree_compliance(const Compliance&);
template TreeCompliance<float> tree_compliance(const Compliance&);

}  // namespace manyhands
