#include "manyhands/model/principal_axes.h"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace manyhands {

namespace {

constexpr double kEqual = 1e-12;  // moments and products that do not differ, or are none, as parts of the trace

Quat<double> turn_about(std::size_t axis, double sine_of_half) {
  std::array<double, 3> part{};
  part[axis] = sine_of_half;
  return normalized(Quat<double>{part[0], part[1], part[2], std::sqrt(1 - sine_of_half * sine_of_half)});
}

/// Turns the largest product of inertia away; false if there is none.
bool turn_once(const SymMat3<double>& I, Quat<double>& r) {
  const SymMat3<double> D = rotated(transpose(to_matrix(r)), I);
  const std::array<double, 3> moment{D.xx, D.yy, D.zz}, product{D.yz, D.xz, D.xy};  // product[k] lies across axis k
  const auto size = [&](std::size_t k) { return std::abs(product[k]); };
  const std::size_t k = size(2) > size(1) && size(2) > size(0) ? 2 : size(1) > size(0) ? 1 : 0;
  if (size(k) < kEqual) return false;
  const std::size_t i = k == 0 ? 1 : 0, j = k == 2 ? 1 : 2;
  const double tau = (moment[j] - moment[i]) / (2 * product[k]);
  const double t = std::copysign(1 / (std::abs(tau) + std::sqrt(1 + tau * tau)), tau);
  const double cosine = 1 / std::sqrt(1 + t * t);
  const double sine = (k == 1 ? 1 : -1) * t * cosine / std::sqrt(2 * (1 + cosine));  // of half the angle
  r = normalized(r * turn_about(k, sine));
  return true;
}

}  // namespace

PrincipalAxes principal_axes(const SymMat3<double>& inertia) {
  constexpr int kMostTurns = 500;
  const double trace = inertia.xx + inertia.yy + inertia.zz;
  if (!(trace > 0)) return {};
  const SymMat3<double> I{inertia.xx / trace, inertia.yy / trace, inertia.zz / trace,
                          inertia.xy / trace, inertia.xz / trace, inertia.yz / trace};
  Quat<double> r = Quat<double>::identity();
  for (int turn = 0; turn < kMostTurns && turn_once(I, r); ++turn) {
  }
  const SymMat3<double> D = rotated(transpose(to_matrix(r)), I);
  std::array<double, 3> moment{D.xx, D.yy, D.zz};
  for (const std::size_t i : {std::size_t{0}, std::size_t{1}, std::size_t{0}}) {
    if (moment[i] + kEqual >= moment[i + 1]) continue;
    std::swap(moment[i], moment[i + 1]);
    r = normalized(r * turn_about((i + 2) % 3, 1 / std::numbers::sqrt2));
  }
  return {to_matrix(r), trace * Vec3<double>{moment[0], moment[1], moment[2]}};
}

}  // namespace manyhands
