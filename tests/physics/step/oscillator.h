// What a step makes of an oscillator, by formula.
#pragma once

#include <algorithm>
#include <cmath>

namespace manyhands::testing {

/// A mass on a spring, let go from 0.1 m at rest. The step's map turns the plane of q and v by phi, 2 tan(phi / 2) = h
/// omega: the trapezoidal rule's, but never by more than a right angle.
struct Oscillator {
  Oscillator(double stiffness, double mass, double h)
      : phi(2 * std::atan(std::min(0.5 * h * std::sqrt(stiffness / mass), 1.0))) {
    // q_0 = A cos(0), and q_1 follows from v_1 = -h k / (m + h^2 k / 4) A, or v_1 = -2 / h A.
    const double v_1 = -h * stiffness / std::max(mass + 0.25 * h * h * stiffness, 0.5 * h * h * stiffness) * kStart;
    sine = (kStart + h * v_1 - kStart * std::cos(phi)) / std::sin(phi);
  }

  [[nodiscard]] double at(int step) const { return kStart * std::cos(step * phi) + sine * std::sin(step * phi); }
  [[nodiscard]] double scale() const { return std::abs(sine) + kStart; }  ///< no position is farther out

  static constexpr double kStart = 0.1;
  double phi, sine{};
};

}  // namespace manyhands::testing
