#include "manyhands/planning/trajectory.h"

#include <algorithm>
#include <utility>

#include "manyhands/base/assert.h"
#include "manyhands/planning/checks.h"

namespace manyhands {

Trajectory::Trajectory(std::vector<double> breaks, std::vector<double> coefficients, std::size_t width)
    : width_(width), breaks_(std::move(breaks)), coefficients_(std::move(coefficients)) {
  require_times("breaks", breaks_);
  const std::size_t row = pieces() * width_;
  if (row == 0 || coefficients_.empty() || coefficients_.size() % row != 0) {
    throw std::invalid_argument("there are " + std::to_string(coefficients_.size()) +
                                " coefficients; expected (pieces, order, width), which are " +
                                std::to_string(pieces()) + ", 1 or more, and " + std::to_string(width_));
  }
  require_finite("coefficients", coefficients_, width_);
}

std::span<const double> Trajectory::piece(std::size_t k) const {
  const std::size_t numbers = order() * width_;
  return std::span(coefficients_).subspan(k * numbers, numbers);
}

std::size_t Trajectory::piece_at(double t) const {
  const auto inner = std::span(breaks_).subspan(1, pieces() - 1);
  return static_cast<std::size_t>(std::ranges::upper_bound(inner, t) - inner.begin());
}

void Trajectory::sample_piece(std::size_t k, double since, double* q, double* v, double* a) const {
  const std::span<const double> c = piece(k);
  for (std::size_t i = 0; i < width_; ++i) {
    double value = 0, slope = 0, half_curvature = 0;  // Horner's scheme, three times at once
    for (std::size_t j = order(); j-- > 0;) {
      half_curvature = half_curvature * since + slope;
      slope = slope * since + value;
      value = value * since + c[j * width_ + i];
    }
    q[i] = value, v[i] = slope, a[i] = 2 * half_curvature;
  }
}

void Trajectory::sample(std::span<const double> t, std::span<double> q, std::span<double> v,
                        std::span<double> a) const {
  MANYHANDS_ASSERT(q.size() == t.size() * width_ && v.size() == q.size() && a.size() == q.size());
  for (std::size_t n = 0; n < t.size(); ++n) {
    const double time = std::clamp(t[n], 0.0, duration());
    const std::size_t k = piece_at(time), at = n * width_;
    sample_piece(k, time - breaks_[k], &q[at], &v[at], &a[at]);
    if (time == t[n]) continue;
    std::fill_n(&v[at], width_, 0.0);
    std::fill_n(&a[at], width_, 0.0);
  }
}

}  // namespace manyhands
