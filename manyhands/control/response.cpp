#include "manyhands/control/response.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

namespace manyhands {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

void require_samples(std::span<const double> time, std::span<const double> response) {
  if (time.empty() || time.size() != response.size())
    throw std::invalid_argument("time holds " + std::to_string(time.size()) + " numbers and response " +
                                std::to_string(response.size()) + "; expected as many, and one at least");
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (!std::isfinite(time[i]) || !std::isfinite(response[i]) || (i > 0 && time[i] <= time[i - 1]))
      throw std::invalid_argument("time and response must be finite and time must rise; look at index " +
                                  std::to_string(i));
  }
}

/// The loop's frequency response.
struct Loop {
  std::span<const double> numerator, denominator;
  double delay;

  static std::complex<double> value(std::span<const double> polynomial, std::complex<double> s) {
    std::complex<double> y = 0;
    for (const double c : polynomial) y = y * s + c;
    return y;
  }
  [[nodiscard]] std::complex<double> at(double frequency) const {
    const std::complex<double> s(0, frequency);
    return value(numerator, s) / value(denominator, s) * std::exp(-s * delay);
  }
};

/// Widens [low, high] to hold the sizes of all roots but 0 of the polynomial: |root| lies between the least and the
/// largest ratio of neighbouring coefficients, by a factor of its degree at most (after Cauchy's bound).
void take_corners(std::span<const double> polynomial, double& low, double& high) {
  double last = 0;
  std::size_t gap = 0;
  for (const double c : polynomial) {
    ++gap;
    if (c == 0) continue;
    if (last != 0) {
      const double corner = std::pow(std::abs(c / last), 1.0 / static_cast<double>(gap));
      const auto degree = static_cast<double>(polynomial.size());
      low = std::min(low, corner / degree);
      high = std::max(high, corner * degree);
    }
    last = c;
    gap = 0;
  }
}

/// Where `crosses` changes its sign between a and b, which it does.
template <class F>
double bisect(double a, double b, const F& crosses) {
  const bool sign = crosses(a) > 0;
  for (int i = 0; i < 100; ++i) {
    const double middle = std::sqrt(a * b);
    (((crosses(middle) > 0) == sign) ? a : b) = middle;
  }
  return std::sqrt(a * b);
}

void require_polynomial(const char* name, std::span<const double> polynomial) {
  const bool finite = std::ranges::all_of(polynomial, [](double c) { return std::isfinite(c); });
  if (!finite || std::ranges::all_of(polynomial, [](double c) { return c == 0; }))
    throw std::invalid_argument(std::string(name) + " must have finite coefficients, not all of them 0");
}

}  // namespace

StepResponse step_response(std::span<const double> time, std::span<const double> response, double set_point,
                           double start, double tolerance) {
  require_samples(time, response);
  const double way = set_point - start, sign = way < 0 ? -1 : 1;
  const auto reached = [&](double share) {
    const double level = sign * (start + share * way);
    const auto at = std::ranges::find_if(response, [&](double x) { return sign * x >= level; });
    return at == response.end() ? kInfinity : time[static_cast<std::size_t>(at - response.begin())];
  };
  const double ten = reached(0.1), ninety = reached(0.9);
  StepResponse found{.rise_time = ninety == kInfinity ? kInfinity : ninety - ten,
                     .settling_time = kInfinity,
                     .peak = 0,
                     .peak_time = 0,
                     .overshoot = 0,
                     .steady_state_error = response.back() - set_point};
  for (std::size_t i = response.size(); i-- > 0;) {
    if (std::abs(response[i] - set_point) > std::abs(way) * tolerance) break;
    found.settling_time = time[i];
  }
  const auto farthest = std::ranges::max_element(response, {}, [&](double x) { return sign * x; });
  found.peak = *farthest;
  found.peak_time = time[static_cast<std::size_t>(farthest - response.begin())];
  if (way != 0) found.overshoot = std::max(0.0, (found.peak - set_point) / way);
  return found;
}

StabilityMargins stability_margins(std::span<const double> numerator, std::span<const double> denominator,
                                   double delay) {
  require_polynomial("numerator", numerator);
  require_polynomial("denominator", denominator);
  if (!(delay >= 0) || !std::isfinite(delay)) throw std::invalid_argument("delay must be 0 or more");
  const Loop loop{numerator, denominator, delay};
  double low = kInfinity, high = 0;
  take_corners(numerator, low, high);
  take_corners(denominator, low, high);
  if (delay > 0) low = std::min(low, 0.1 / delay), high = std::max(high, 10 / delay);
  if (high == 0) low = high = 1;
  // A gain far from 1 crosses it far from the corners.
  const double gain = std::abs(loop.at(low)) + 1 / std::abs(loop.at(high)) + 1;
  const double range = std::isfinite(gain) ? std::min(1e12, 100 * gain) : 1e12;
  low /= range, high *= range;

  constexpr int kFrequencies = 10'000;
  const double step = std::pow(high / low, 1.0 / kFrequencies);
  const auto phase_crosses = [&](double w) { return loop.at(w).imag(); };
  const auto gain_crosses = [&](double w) { return std::abs(loop.at(w)) - 1; };
  StabilityMargins found{kInfinity, kInfinity, kInfinity, kInfinity};
  double a = low;
  for (int i = 0; i < kFrequencies; ++i) {
    const double b = a * step;
    if ((phase_crosses(a) > 0) != (phase_crosses(b) > 0)) {
      const double w = bisect(a, b, phase_crosses), margin = 1 / std::abs(loop.at(w));
      if (loop.at(w).real() < 0 && std::abs(std::log(margin)) < std::abs(std::log(found.gain)))
        found.gain = margin, found.gain_frequency = w;
    }
    if ((gain_crosses(a) > 0) != (gain_crosses(b) > 0)) {
      const double w = bisect(a, b, gain_crosses);
      double margin = std::arg(loop.at(w)) + std::numbers::pi;  // in [0, 2 pi]
      if (margin > std::numbers::pi) margin -= 2 * std::numbers::pi;
      if (std::abs(margin) < std::abs(found.phase)) found.phase = margin, found.phase_frequency = w;
    }
    a = b;
  }
  return found;
}

}  // namespace manyhands
