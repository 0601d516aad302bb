#include "manyhands/perception/principal_axes.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace manyhands {

namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

/// Turns `a`, which is symmetric, until it is diagonal, and returns the turns: a = v diag v^T.
Matrix diagonalise(Matrix& a) {
  Matrix v{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  constexpr int kSweeps = 30;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (std::size_t p = 0; p < 2; ++p) {
      for (std::size_t q = p + 1; q < 3; ++q) {
        if (a[p][q] == 0) continue;
        const double zeta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const double t = std::copysign(1.0, zeta) / (std::abs(zeta) + std::hypot(zeta, 1.0));
        const double c = 1 / std::hypot(t, 1.0), s = c * t;
        for (std::size_t k = 0; k < 3; ++k) {
          const double x = a[k][p], y = a[k][q];
          a[k][p] = c * x - s * y, a[k][q] = s * x + c * y;
        }
        for (std::size_t k = 0; k < 3; ++k) {
          const double x = a[p][k], y = a[q][k];
          a[p][k] = c * x - s * y, a[q][k] = s * x + c * y;
          const double vx = v[k][p], vy = v[k][q];
          v[k][p] = c * vx - s * vy, v[k][q] = s * vx + c * vy;
        }
      }
    }
  }
  return v;
}

}  // namespace

PrincipalAxes principal_axes(std::span<const Point> points) {
  Point mean{0, 0, 0};
  double count = 0;
  for (const Point& p : points) {
    if (is_finite_point(p)) mean = mean + p, ++count;
  }
  mean = (1 / count) * mean;
  Matrix a{};
  for (const Point& p : points) {
    if (!is_finite_point(p)) continue;
    const std::array<double, 3> d{p.x - mean.x, p.y - mean.y, p.z - mean.z};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) a[i][j] += d[i] * d[j] / count;
    }
  }
  const Matrix v = diagonalise(a);
  std::array<std::size_t, 3> order{0, 1, 2};
  std::ranges::sort(order, [&](std::size_t i, std::size_t j) { return a[i][i] > a[j][j]; });
  const auto column = [&](std::size_t k) { return Point{v[0][k], v[1][k], v[2][k]}; };
  const Point x = column(order[0]), y = column(order[1]);
  return {mean, {x, y, cross(x, y)}, {a[order[0]][order[0]], a[order[1]][order[1]], a[order[2]][order[2]]}};
}

}  // namespace manyhands
