#include "manyhands/planning/spline.h"

#include <algorithm>

#include "manyhands/planning/checks.h"

namespace manyhands {

namespace {

using Numbers = std::vector<double>;

/// The knots of a spline with the control points 0 to knots.size() - degree - 2.
struct Knots {
  Numbers t;
  std::size_t degree;

  [[nodiscard]] std::size_t control_points() const { return t.size() - degree - 1; }

  /// The last i with t[i] <= time, that has a span of some length.
  [[nodiscard]] std::size_t span_of(double time) const {
    const auto inner = std::span(t).subspan(degree + 1, t.size() - 2 * (degree + 1));
    return degree + static_cast<std::size_t>(std::ranges::upper_bound(inner, time) - inner.begin());
  }

  /// What the control points span - degree to span weigh in a derivative at `time`: the recurrence of de Boor and Cox,
  /// and for derivatives differences of control points (chapter X, equations 12 to 15).
  [[nodiscard]] Numbers weights(std::size_t span, double time, std::size_t derivative) const {
    Numbers w{1.0};
    for (std::size_t p = 1; p <= degree; ++p) {
      Numbers next(p + 1, 0.0);
      for (std::size_t j = 0; j < p; ++j) {
        const std::size_t i = span - p + 1 + j;
        const double length = t[i + p] - t[i];
        const bool value = p <= degree - derivative;
        const double up = value ? (time - t[i]) / length : static_cast<double>(p) / length;
        next[j + 1] += up * w[j];
        next[j] += (value ? 1 - up : -up) * w[j];
      }
      w = std::move(next);
    }
    return w;
  }
};

Knots knots_of(std::span<const double> times, std::size_t degree, std::size_t fixed) {
  const std::size_t left_out = (degree - 1) / 2 - fixed;
  Numbers t(degree + 1, times.front());
  t.insert(t.end(), times.begin() + 1 + static_cast<std::ptrdiff_t>(left_out),
           times.end() - 1 - static_cast<std::ptrdiff_t>(left_out));
  t.insert(t.end(), degree + 1, times.back());
  return {std::move(t), degree};
}

/// A x = b with all entries of A at most `band` beside its diagonal, and totally positive: no pivots are needed.
struct BandedSystem {
  std::size_t band, columns;
  Numbers A, b;  ///< (rows, 2 band + 1), (rows, columns)

  BandedSystem(std::size_t rows, std::size_t band_, std::size_t columns_)
      : band(band_), columns(columns_), A(rows * (2 * band_ + 1), 0.0), b(rows * columns_, 0.0) {}

  [[nodiscard]] std::size_t rows() const { return b.size() / columns; }
  double& at(std::size_t row, std::size_t column) { return A[row * (2 * band + 1) + column + band - row]; }

  void solve() {
    for (std::size_t i = 0; i < rows(); ++i) {
      const std::size_t last = std::min(i + band, rows() - 1);
      for (std::size_t r = i + 1; r <= last; ++r) {
        const double factor = at(r, i) / at(i, i);
        for (std::size_t c = i; c <= last; ++c) at(r, c) -= factor * at(i, c);
        for (std::size_t k = 0; k < columns; ++k) b[r * columns + k] -= factor * b[i * columns + k];
      }
    }
    for (std::size_t i = rows(); i-- > 0;) {
      for (std::size_t k = 0; k < columns; ++k) {
        double& x = b[i * columns + k];
        for (std::size_t c = i + 1; c <= std::min(i + band, rows() - 1); ++c) x -= at(i, c) * b[c * columns + k];
        x /= at(i, i);
      }
    }
  }
};

/// Control points (n, width). Rows stand in the order of time; at the end the highest derivative comes first.
Numbers control_points(const Knots& knots, std::span<const double> times, const Waypoints& waypoints,
                       std::span<const double> ends, std::size_t fixed) {
  const std::size_t n = waypoints.width, degree = knots.degree, last = times.size() - 1;
  BandedSystem system(knots.control_points(), degree, n);
  std::size_t row = 0;
  const auto demand = [&](double time, std::size_t derivative, std::span<const double> value) {
    const std::size_t span = knots.span_of(time);
    const Numbers w = knots.weights(span, time, derivative);
    for (std::size_t j = 0; j <= degree; ++j) {
      if (w[j] != 0) system.at(row, span - degree + j) = w[j];
    }
    std::ranges::copy(value, system.b.begin() + static_cast<std::ptrdiff_t>(row * n));
    ++row;
  };
  demand(times[0], 0, waypoints.row(0));
  for (std::size_t d = 1; d <= fixed; ++d) demand(times[0], d, ends.subspan((d - 1) * n, n));
  for (std::size_t i = 1; i < last; ++i) demand(times[i], 0, waypoints.row(i));
  for (std::size_t d = fixed; d > 0; --d) demand(times[last], d, ends.subspan((fixed + d - 1) * n, n));
  demand(times[last], 0, waypoints.row(last));
  system.solve();
  return std::move(system.b);
}

/// The same spline as polynomials: between two knots, its derivatives at the first over their factorials.
Trajectory as_polynomials(const Knots& knots, const Numbers& points, std::size_t n) {
  const std::size_t degree = knots.degree;
  Numbers breaks(knots.t.begin() + static_cast<std::ptrdiff_t>(degree),
                 knots.t.end() - static_cast<std::ptrdiff_t>(degree));
  Numbers c((breaks.size() - 1) * (degree + 1) * n, 0.0);
  double* at = c.data();
  for (std::size_t span = degree; span + degree + 1 < knots.t.size(); ++span) {
    double factorial = 1;
    for (std::size_t d = 0; d <= degree; ++d, at += n) {
      if (d > 0) factorial *= static_cast<double>(d);
      const Numbers w = knots.weights(span, knots.t[span], d);
      for (std::size_t j = 0; j <= degree; ++j) {
        for (std::size_t i = 0; i < n; ++i) at[i] += w[j] / factorial * points[(span - degree + j) * n + i];
      }
    }
  }
  return {std::move(breaks), std::move(c), n};
}

}  // namespace

Trajectory spline(std::span<const double> times, const Waypoints& waypoints, std::size_t degree,
                  std::span<const double> ends) {
  require_times("times", times);
  require_rows("waypoints", waypoints.rows, times.size(), waypoints.width);
  if (degree % 2 == 0 || degree > 7) {
    throw std::invalid_argument("degree is " + std::to_string(degree) + "; expected 1, 3, 5 or 7");
  }
  const std::size_t fixed = ends.size() / (2 * waypoints.width);
  if (2 * fixed + 1 > degree) {
    throw std::invalid_argument("ends fixes " + std::to_string(fixed) + " derivatives; a spline of degree " +
                                std::to_string(degree) + " has room for " + std::to_string((degree - 1) / 2));
  }
  require_rows("ends", ends, 2 * fixed, waypoints.width);
  const std::size_t needed = degree + 1 - 2 * fixed;
  if (times.size() < needed) {
    throw std::invalid_argument("a spline of degree " + std::to_string(degree) + " needs " + std::to_string(needed) +
                                " waypoints, not " + std::to_string(times.size()) +
                                "; give more of them, a lower degree, or derivatives at the ends");
  }
  const Knots knots = knots_of(times, degree, fixed);
  return as_polynomials(knots, control_points(knots, times, waypoints, ends, fixed), waypoints.width);
}

}  // namespace manyhands
