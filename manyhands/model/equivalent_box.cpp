#include "manyhands/model/equivalent_box.h"

#include <algorithm>
#include <cmath>

#include "manyhands/model/principal_axes.h"

namespace manyhands {

EquivalentBox equivalent_box(const Inertial& inertial) {
  const auto [R, m] = principal_axes(inertial.inertia);
  // Of a box I_x = m (y^2 + z^2) / 12.
  const auto length = [&](double across) { return std::sqrt(6 * std::max(across, 0.0) / inertial.mass); };
  return {{R, inertial.com}, {length(m.y + m.z - m.x), length(m.x + m.z - m.y), length(m.x + m.y - m.z)}};
}

}  // namespace manyhands
