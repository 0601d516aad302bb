#include "manyhands/planning/path_spline.h"

#include <algorithm>
#include <cmath>

namespace manyhands {

namespace {

/// Of the four control points of a piece, by powers of u.
constexpr std::array<std::array<double, 4>, 4> kBasis{{{1.0 / 6, -1.0 / 2, 1.0 / 2, -1.0 / 6},
                                                       {2.0 / 3, 0, -1, 1.0 / 2},
                                                       {1.0 / 6, 1.0 / 2, 1.0 / 2, -1.0 / 2},
                                                       {0, 0, 0, 1.0 / 6}}};

/// Derivative `order` of a basis function at u.
double basis(std::size_t k, double u, std::size_t order) {
  double sum = 0;
  for (std::size_t j = 4; j-- > order;) {
    double falling = 1;
    for (std::size_t i = 0; i < order; ++i) falling *= static_cast<double>(j - i);
    sum = sum * u + falling * kBasis[k][j];
  }
  return sum;
}

/// Gauss's points and weights on [0, 1], exact up to degree 5: squares of derivatives have 4.
const double kGaussOff = std::sqrt(0.15);
const std::array<std::pair<double, double>, 3> kGauss{
    {{0.5 - kGaussOff, 5.0 / 18}, {0.5, 4.0 / 9}, {0.5 + kGaussOff, 5.0 / 18}}};

}  // namespace

PathSpline::PathSpline(std::size_t points, std::size_t looks, const SmoothnessWeights& weights)
    : points_(points), weights_(weights) {
  for (std::size_t piece = 0; piece <= points; ++piece) {
    for (std::size_t i = 0; i < looks; ++i)
      looks_.push_back(look(piece, (static_cast<double>(i) + 0.5) / static_cast<double>(looks), 0));
  }
  smoothness_.assign(points * points, 0.0);
  inverse_ = smoothness_;
  add_smoothness();
  invert();
}

/// The start, the goal and what is not bent there are folded in: the control point before the start is its mirror
/// image, of which the displacement is minus that of the first.
PathSpline::Look PathSpline::look(std::size_t piece, double u, std::size_t order) const {
  const std::size_t pieces = points_ + 1;
  const double scale = std::pow(static_cast<double>(pieces), static_cast<double>(order));
  const std::size_t first = std::max<std::size_t>(piece, 2) - 2, last = std::min(piece + 1, points_ - 1);
  Look found{(static_cast<double>(piece) + u) / static_cast<double>(pieces), first, last + 1 - first, {}};
  const auto end = static_cast<std::ptrdiff_t>(points_) + 1;
  for (std::size_t k = 0; k < 4; ++k) {
    std::ptrdiff_t control = static_cast<std::ptrdiff_t>(piece + k) - 1;  // 0 is the start
    double weight = scale * basis(k, u, order);
    if (control < 0 || control > end) {
      control = control < 0 ? 1 : end - 1;
      weight = -weight;
    }
    if (control > 0 && control < end) found.weight[static_cast<std::size_t>(control) - 1 - first] += weight;
  }
  return found;
}

void PathSpline::add_smoothness() {
  const std::array<double, 3> of_order{weights_.velocity, weights_.acceleration, weights_.jerk};
  for (std::size_t piece = 0; piece <= points_; ++piece) {
    for (std::size_t order = 1; order <= 3; ++order) {
      for (const auto& [u, share] : kGauss) {
        const Look at = look(piece, u, order);
        const double scale = of_order[order - 1] * share / static_cast<double>(points_ + 1);
        for (std::size_t i = 0; i < at.count; ++i) {
          for (std::size_t j = 0; j < at.count; ++j)
            smoothness_[(at.first + i) * points_ + at.first + j] += scale * at.weight[i] * at.weight[j];
        }
      }
    }
  }
}

/// Gauss and Jordan, without pivots: the matrix is positive definite.
void PathSpline::invert() {
  const std::size_t m = points_;
  std::vector<double> a = smoothness_;
  for (std::size_t i = 0; i < m; ++i) inverse_[i * m + i] = 1;
  for (std::size_t i = 0; i < m; ++i) {
    const double scale = 1 / a[i * m + i];
    for (std::size_t j = 0; j < m; ++j) {
      a[i * m + j] *= scale;
      inverse_[i * m + j] *= scale;
    }
    for (std::size_t row = 0; row < m; ++row) {
      const double factor = row == i ? 0 : a[row * m + i];
      for (std::size_t j = 0; j < m && factor != 0; ++j) {
        a[row * m + j] -= factor * a[i * m + j];
        inverse_[row * m + j] -= factor * inverse_[i * m + j];
      }
    }
  }
}

Trajectory PathSpline::path(std::span<const double> controls, double duration) const {
  const std::size_t pieces = points_ + 1, n = controls.size() / (pieces + 1);
  const double length = duration / static_cast<double>(pieces);
  const auto control = [&](std::ptrdiff_t i, std::size_t x) {
    const auto end = static_cast<std::ptrdiff_t>(pieces);
    const auto at = [&](std::ptrdiff_t k) { return controls[static_cast<std::size_t>(k) * n + x]; };
    return i < 0 ? 2 * at(0) - at(1) : i > end ? 2 * at(end) - at(end - 1) : at(i);
  };
  std::vector<double> breaks{0}, coefficients;
  for (std::size_t piece = 0; piece < pieces; ++piece) {
    breaks.push_back(duration * static_cast<double>(piece + 1) / static_cast<double>(pieces));
    for (std::size_t j = 0; j < 4; ++j) {
      for (std::size_t x = 0; x < n; ++x) {
        double sum = 0;
        for (std::size_t k = 0; k < 4; ++k)
          sum += kBasis[k][j] * control(static_cast<std::ptrdiff_t>(piece + k) - 1, x);
        coefficients.push_back(sum / std::pow(length, static_cast<double>(j)));
      }
    }
  }
  return {breaks, coefficients, n};
}

}  // namespace manyhands
