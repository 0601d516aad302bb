// Boxes along axes.
#pragma once

#include <algorithm>
#include <cmath>

#include "manyhands/math/vec3.h"

namespace manyhands::bullet {

struct Bounds {
  static constexpr double kHuge = 1e300;
  Vec3<double> low{kHuge, kHuge, kHuge}, high{-kHuge, -kHuge, -kHuge};  ///< empty

  /// Takes in the box that reaches so far from p.
  void widen(const Vec3<double>& p, const Vec3<double>& reach) {
    low = {std::min(low.x, p.x - reach.x), std::min(low.y, p.y - reach.y), std::min(low.z, p.z - reach.z)};
    high = {std::max(high.x, p.x + reach.x), std::max(high.y, p.y + reach.y), std::max(high.z, p.z + reach.z)};
  }
  /// Takes in a box that is turned.
  void widen(const Transform<double>& X, const Vec3<double>& centre, const Vec3<double>& half) {
    const auto reach = [&](double x, double y, double z) {
      return half.x * std::abs(x) + half.y * std::abs(y) + half.z * std::abs(z);
    };
    const Mat3<double>& R = X.R;
    widen(X * centre, {reach(R.x.x, R.y.x, R.z.x), reach(R.x.y, R.y.y, R.z.y), reach(R.x.z, R.y.z, R.z.z)});
  }
  [[nodiscard]] Vec3<double> centre() const { return 0.5 * (low + high); }
  [[nodiscard]] Vec3<double> half() const { return 0.5 * (high - low); }
  [[nodiscard]] bool meets(const Bounds& b) const {
    return low.x <= b.high.x && b.low.x <= high.x && low.y <= b.high.y && b.low.y <= high.y && low.z <= b.high.z &&
           b.low.z <= high.z;
  }
};

}  // namespace manyhands::bullet
