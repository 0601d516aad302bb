#include "manyhands/planning/trajectory.h"

#include <algorithm>
#include <cmath>
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

std::vector<double> Trajectory::piece_from(std::size_t k, double since) const {
  std::vector<double> c(piece(k).begin(), piece(k).end());
  for (std::size_t i = 0; i + 1 < order(); ++i) {  // Horner's scheme again and again: a derivative each time
    for (std::size_t j = order() - 1; j > i; --j) {
      for (std::size_t x = 0; x < width_; ++x) c[(j - 1) * width_ + x] += since * c[j * width_ + x];
    }
  }
  return c;
}

Trajectory Trajectory::part(double from, double to) const {
  if (!(to > from && std::isfinite(to - from)))
    throw std::invalid_argument("a part from " + as_text(from) + " to " + as_text(to) +
                                " s; expected the end to be later");
  constexpr double kShortest = 1e-12;  // [s] of a piece; shorter ones are rounding
  std::vector<double> breaks{0}, coefficients;
  const auto add = [&](double end, const std::vector<double>& piece) {
    if (end - from - breaks.back() < kShortest) return;
    breaks.push_back(end - from);
    coefficients.insert(coefficients.end(), piece.begin(), piece.end());
  };
  const auto stand = [&](double end, double time) {
    std::vector<double> q(order() * width_), v(width_), a(width_);
    const std::size_t k = piece_at(time);
    sample_piece(k, time - breaks_[k], q.data(), v.data(), a.data());
    add(end, q);
  };
  if (from < 0) stand(std::min(to, 0.0), 0);
  for (std::size_t k = piece_at(from); k < pieces() && breaks_[k] < to && from < duration(); ++k)
    add(std::min(to, breaks_[k + 1]), piece_from(k, std::max(from - breaks_[k], 0.0)));
  if (to > duration()) stand(to, duration());
  return {breaks, coefficients, width_};
}

Trajectory joined(std::span<const Trajectory> motions) {
  if (motions.empty()) throw std::invalid_argument("there are no trajectories to join");
  const std::size_t width = motions[0].width();
  std::size_t order = 0;
  for (const Trajectory& motion : motions) {
    order = std::max(order, motion.order());
    if (motion.width() != width)
      throw std::invalid_argument("trajectories of " + std::to_string(width) + " and " +
                                  std::to_string(motion.width()) + " joints cannot be joined");
  }
  std::vector<double> breaks{0}, coefficients;
  for (const Trajectory& motion : motions) {
    const double begin = breaks.back();
    for (std::size_t k = 0; k < motion.pieces(); ++k) {
      breaks.push_back(begin + motion.breaks()[k + 1]);
      const std::span<const double> piece = motion.piece(k);
      coefficients.insert(coefficients.end(), piece.begin(), piece.end());
      coefficients.resize(coefficients.size() + (order - motion.order()) * width, 0.0);
    }
  }
  return {breaks, coefficients, width};
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
