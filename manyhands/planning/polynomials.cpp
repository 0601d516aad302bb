#include "manyhands/planning/polynomials.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "manyhands/planning/checks.h"

namespace manyhands {

namespace {

void require_waypoints(std::span<const double> times, const Waypoints& waypoints) {
  require_times("times", times);
  require_rows("waypoints", waypoints.rows, times.size(), waypoints.width);
}

std::vector<double> copy_of(std::span<const double> numbers) { return {numbers.begin(), numbers.end()}; }

/// The highest speed or acceleration along the line d that keeps every joint within its limit, per length of d.
double along(std::span<const double> d, std::span<const double> limits) {
  double most = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < d.size(); ++i) {
    if (d[i] != 0) most = std::min(most, limits[i] / std::abs(d[i]));
  }
  return most;
}

/// Appends a piece q + d (s + speed t + acceleration t^2 / 2) that takes `time`.
struct LineWriter {
  std::vector<double> breaks{0.0}, coefficients;

  void append(std::span<const double> q, std::span<const double> d, double s, double speed, double acceleration,
              double time) {
    breaks.push_back(breaks.back() + time);
    for (std::size_t i = 0; i < q.size(); ++i) coefficients.push_back(q[i] + s * d[i]);
    for (const double x : d) coefficients.push_back(speed * x);
    for (const double x : d) coefficients.push_back(0.5 * acceleration * x);
  }
};

}  // namespace

Trajectory cubic(std::span<const double> times, const Waypoints& waypoints, std::span<const double> velocity) {
  require_waypoints(times, waypoints);
  const std::size_t n = waypoints.width;
  require_rows("velocity", velocity, times.size(), n);
  std::vector<double> c;
  for (std::size_t k = 0; k + 1 < times.size(); ++k) {
    const double h = times[k + 1] - times[k];
    const auto q = waypoints.row(k), next = waypoints.row(k + 1);
    const auto v = velocity.subspan(k * n, n), v_next = velocity.subspan((k + 1) * n, n);
    c.insert(c.end(), q.begin(), q.end());
    c.insert(c.end(), v.begin(), v.end());
    for (std::size_t i = 0; i < n; ++i) c.push_back((3 * (next[i] - q[i]) / h - 2 * v[i] - v_next[i]) / h);
    for (std::size_t i = 0; i < n; ++i) c.push_back((v[i] + v_next[i] - 2 * (next[i] - q[i]) / h) / (h * h));
  }
  return {copy_of(times), std::move(c), n};
}

Trajectory quintic(std::span<const double> times, const Waypoints& waypoints, std::span<const double> velocity,
                   std::span<const double> acceleration) {
  require_waypoints(times, waypoints);
  const std::size_t n = waypoints.width, order = 6;
  require_rows("velocity", velocity, times.size(), n);
  require_rows("acceleration", acceleration, times.size(), n);
  std::vector<double> c((times.size() - 1) * order * n);
  for (std::size_t k = 0; k + 1 < times.size(); ++k) {
    const double h = times[k + 1] - times[k];
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t from = k * n + i, to = from + n;
      const double d = waypoints.rows[to] - waypoints.rows[from];
      const double v = velocity[from] * h, w = velocity[to] * h;  // in units of h: all terms are lengths
      const double a = acceleration[from] * h * h, b = acceleration[to] * h * h;
      double* const at = &c[k * order * n + i];
      at[0] = waypoints.rows[from];
      at[n] = velocity[from];
      at[2 * n] = 0.5 * acceleration[from];
      at[3 * n] = (20 * d - 8 * w - 12 * v - 3 * a + b) / (2 * h * h * h);
      at[4 * n] = (-30 * d + 14 * w + 16 * v + 3 * a - 2 * b) / (2 * h * h * h * h);
      at[5 * n] = (12 * d - 6 * w - 6 * v - a + b) / (2 * h * h * h * h * h);
    }
  }
  return {copy_of(times), std::move(c), n};
}

Trajectory trapezoid(const Waypoints& waypoints, std::span<const double> velocity,
                     std::span<const double> acceleration) {
  const std::size_t n = waypoints.width, count = waypoints.count();
  if (count < 2) throw std::invalid_argument("waypoints has fewer than two rows");
  require_rows("waypoints", waypoints.rows, count, n);
  require_limits("velocity", velocity, n);
  require_limits("acceleration", acceleration, n);
  LineWriter line;
  for (std::size_t k = 0; k + 1 < count; ++k) {
    const auto q = waypoints.row(k), next = waypoints.row(k + 1);
    std::vector<double> d(n);
    for (std::size_t i = 0; i < n; ++i) d[i] = next[i] - q[i];
    const double a = along(d, acceleration), speed = std::min(along(d, velocity), std::sqrt(a));
    if (!std::isfinite(a)) {
      const bool still = std::ranges::all_of(d, [](double x) { return x == 0; });
      throw std::invalid_argument(
          "between waypoints " + std::to_string(k) + " and " + std::to_string(k + 1) +
          (still ? " nothing moves; leave one of them out" : " no joint that moves has an acceleration limit"));
    }
    const double ramp = speed / a, ramp_length = 0.5 * speed * ramp, cruise = (1 - 2 * ramp_length) / speed;
    line.append(q, d, 0, 0, a, ramp);
    if (cruise > 1e-12 * ramp) line.append(q, d, ramp_length, speed, 0, cruise);
    line.append(q, d, 1 - ramp_length, speed, -a, ramp);
  }
  return {std::move(line.breaks), std::move(line.coefficients), n};
}

}  // namespace manyhands
