#include "manyhands/physics/dynamics/yielding.h"

#include <cmath>

namespace manyhands {

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
          .rises = static_cast<R>(std::pow(c.midpoint, 1 - c.power)),
          .falls = static_cast<R>(std::pow(1 - c.midpoint, 1 - c.power))};
}

template TreeCompliance<double> tree_compliance(const Compliance&);
template TreeCompliance<float> tree_compliance(const Compliance&);

}  // namespace manyhands
