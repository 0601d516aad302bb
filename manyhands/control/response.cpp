#include "manyhands/control/response.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

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

std::complex<double> value(std::span<const double> polynomial, std::complex<double> s) {
  std::complex<double> y = 0;
  for (const double c : polynomial) y = y * s + c;
  return y;
}

/// The loop's frequency response; the polynomials begin with a coefficient that is not 0.
struct Loop {
  std::span<const double> numerator, denominator;
  double delay;

  [[nodiscard]] std::complex<double> at(double frequency) const {
    const std::complex<double> s(0, frequency);
    return undelayed(frequency) * std::exp(-s * delay);
  }
  [[nodiscard]] std::complex<double> undelayed(double frequency) const {
    const std::complex<double> s(0, frequency);
    return value(numerator, s) / value(denominator, s);
  }
  /// Without the delay, at frequencies without end.
  [[nodiscard]] double at_infinity() const {
    if (numerator.size() > denominator.size()) return kInfinity;
    return numerator.size() < denominator.size() ? 0 : numerator.front() / denominator.front();
  }
};

struct GainCrossover {
  double frequency;
  bool falls;  ///< below 1 as the frequency grows
};

struct Sweep {
  double low, step;
  int count;
};

/// By what angle a polynomial turns as s goes from j a to j b [rad]; NaN if a root lies there, to rounding.
double turn(std::span<const double> polynomial, double a, double b) {
  const std::complex<double> from = value(polynomial, {0, a}), to = value(polynomial, {0, b});
  if (std::abs(from) == 0 || std::abs(to) == 0) return std::numeric_limits<double>::quiet_NaN();
  const double angle = std::arg(to / from), middle = a + (b - a) / 2;
  if (std::abs(angle) < 1) return angle;
  if (middle <= a || middle >= b) return std::numeric_limits<double>::quiet_NaN();
  return turn(polynomial, a, middle) + turn(polynomial, middle, b);
}

std::span<const double> without_leading_zeros(std::span<const double> polynomial) {
  const auto first = std::ranges::find_if(polynomial, [](double c) { return c != 0; });
  return polynomial.subspan(static_cast<std::size_t>(first - polynomial.begin()));
}

std::vector<double> sum_of(std::span<const double> a, std::span<const double> b) {
  if (a.size() < b.size()) std::swap(a, b);
  std::vector<double> sum(a.begin(), a.end());
  for (std::size_t i = 0; i < b.size(); ++i) sum[a.size() - b.size() + i] += b[i];
  return sum;
}

/// How many of a polynomial's roots lie right of the imaginary axis; NaN if some lie on it.
double right_roots(std::span<const double> polynomial, const Sweep& sweep) {
  if (polynomial.empty()) return std::numeric_limits<double>::quiet_NaN();
  double angle = turn(polynomial, 0, sweep.low), a = sweep.low;
  for (int i = 0; i < sweep.count; ++i, a *= sweep.step) angle += turn(polynomial, a, a * sweep.step);
  return std::round(static_cast<double>(polynomial.size() - 1) / 2 - angle / std::numbers::pi);
}

bool closed_loop_is_stable(const Loop& loop, std::span<const GainCrossover> crossovers, const Sweep& sweep) {
  const std::vector<double> closed = sum_of(loop.numerator, loop.denominator);
  double unstable = right_roots(without_leading_zeros(closed), sweep);
  if (loop.delay == 0) return unstable == 0;
  if (!(std::abs(loop.at_infinity()) < 1)) return false;  // a delay then has unstable poles without end
  constexpr double kTurn = 2 * std::numbers::pi;
  for (const auto& [frequency, falls] : crossovers) {
    double lag = std::arg(loop.undelayed(frequency)) + std::numbers::pi;  // in [0, 2 pi], until a pair is on the axis
    if (lag >= kTurn) lag -= kTurn;
    const double pairs = std::floor((loop.delay * frequency - lag) / kTurn) + 1;
    unstable += falls ? 2 * pairs : -2 * pairs;
  }
  return unstable == 0;
}

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

/// The frequencies in which all happens: 10,000 over all corners of the loop.
Sweep sweep_of(const Loop& loop) {
  double low = kInfinity, high = 0;
  take_corners(loop.numerator, low, high);
  take_corners(loop.denominator, low, high);
  if (loop.delay > 0) low = std::min(low, 0.1 / loop.delay), high = std::max(high, 10 / loop.delay);
  if (high == 0) low = high = 1;
  // A gain far from 1 crosses it far from the corners.
  const double gain = std::abs(loop.at(low)) + 1 / std::abs(loop.at(high)) + 1;
  const double range = std::isfinite(gain) ? std::min(1e12, 100 * gain) : 1e12;
  constexpr int kFrequencies = 10'000;
  return {low / range, std::pow(high / low * range * range, 1.0 / kFrequencies), kFrequencies};
}

/// The crossovers that leave least.
class Margins {
 public:
  explicit Margins(const Loop& loop) : loop_(loop) {}

  /// At a frequency where the loop is real.
  void take_phase_crossover(double frequency, double loop) {
    if (!(loop < 0) || !std::isfinite(loop)) return;
    const double factor = -1 / loop;
    if (factor >= 1 && factor < upper_) upper_ = factor, upper_frequency_ = frequency;
    if (factor < 1 && factor > lower_) lower_ = factor, lower_frequency_ = frequency;
  }
  void take_gain_crossover(double frequency) {
    double margin = std::arg(loop_.at(frequency)) + std::numbers::pi;  // in [0, 2 pi]
    if (margin > std::numbers::pi) margin -= 2 * std::numbers::pi;
    if (std::abs(margin) < std::abs(phase_)) phase_ = margin, phase_frequency_ = frequency;
  }
  [[nodiscard]] StabilityMargins of(bool stable) const {
    const bool fall = !stable && lower_ * upper_ > 1;  // a smaller change than to grow
    return {.gain = fall ? lower_ : upper_,
            .gain_frequency = fall ? lower_frequency_ : upper_frequency_,
            .phase = phase_,
            .phase_frequency = phase_frequency_,
            .stable = stable,
            .lower_gain = lower_,
            .lower_gain_frequency = lower_frequency_};
  }

 private:
  const Loop& loop_;
  double upper_ = kInfinity, upper_frequency_ = kInfinity, lower_ = 0, lower_frequency_ = kInfinity;
  double phase_ = kInfinity, phase_frequency_ = kInfinity;
};

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
  const Loop loop{without_leading_zeros(numerator), without_leading_zeros(denominator), delay};
  const Sweep sweep = sweep_of(loop);
  Margins margins(loop);
  margins.take_phase_crossover(0, loop.at(0).real());
  if (delay == 0) margins.take_phase_crossover(kInfinity, loop.at_infinity());
  std::vector<GainCrossover> crossovers;
  const auto phase_crosses = [&](double w) { return loop.at(w).imag(); };
  const auto gain_crosses = [&](double w) { return std::abs(loop.at(w)) - 1; };
  double a = sweep.low;
  for (int i = 0; i < sweep.count; ++i) {
    const double b = a * sweep.step;
    if ((phase_crosses(a) > 0) != (phase_crosses(b) > 0)) {
      const double w = bisect(a, b, phase_crosses);
      margins.take_phase_crossover(w, std::copysign(std::abs(loop.at(w)), loop.at(w).real()));
    }
    if ((gain_crosses(a) > 0) != (gain_crosses(b) > 0)) {
      crossovers.push_back({bisect(a, b, gain_crosses), gain_crosses(a) > 0});
      margins.take_gain_crossover(crossovers.back().frequency);
    }
    a = b;
  }
  return margins.of(closed_loop_is_stable(loop, crossovers, sweep));
}

}  // namespace manyhands
