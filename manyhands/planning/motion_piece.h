// A short motion of planned coordinates: polynomials of t from 0 to 1.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "manyhands/math/number.h"

namespace manyhands {

/// Planned coordinates as q(t) = start + linear t + square t^2 + ... for t in [0, 1]; spans of n.
struct MotionPiece {
  std::span<const float> start, linear, square;
  std::span<const float> higher{};  ///< rows of n: of t^3, t^4 and so on
};

/// Coordinate k at t, in any number type.
template <Number T>
[[nodiscard]] MANYHANDS_INLINE T coordinate_at(const MotionPiece& motion, std::size_t k, const T& t) {
  const std::size_t n = motion.start.size();
  T x(motion.square[k]);
  if (!motion.higher.empty()) {
    std::size_t i = motion.higher.size() - n + k;
    T rest(motion.higher[i]);
    for (; i >= n; i -= n) rest = fma(t, rest, T(motion.higher[i - n]));
    x = fma(t, rest, x);
  }
  return fma(t, fma(t, x, T(motion.linear[k])), T(motion.start[k]));
}

namespace internal {

/// Calls visit(b) for the Bernstein coefficients of a polynomial on [0, 1], between which it lies. coefficient(j) is of
/// t^j.
template <Real R, class Coefficient, class Visit>
void visit_bernstein(std::size_t degree, const Coefficient& coefficient, const Visit& visit) {
  for (std::size_t i = 0; i <= degree; ++i) {
    R sum = 0, share = 1;
    for (std::size_t j = 0; j <= i; ++j) {
      sum += share * coefficient(j);
      if (j < i) share *= static_cast<R>(i - j) / static_cast<R>(degree - j);
    }
    visit(sum);
  }
}

/// No value of the polynomial on [0, 1] is larger.
template <class Coefficient>
[[nodiscard]] float bernstein_bound(std::size_t degree, const Coefficient& coefficient) {
  float most = 0;
  visit_bernstein<float>(degree, coefficient, [&](float b) { most = std::max(most, std::abs(b)); });
  return most;
}

[[nodiscard]] inline float power_coefficient(const MotionPiece& motion, std::size_t k, std::size_t power) {
  return power == 1   ? motion.linear[k]
         : power == 2 ? motion.square[k]
                      : motion.higher[(power - 3) * motion.start.size() + k];
}

}  // namespace internal

/// How fast coordinate k changes at most, per unit of t.
[[nodiscard]] inline float greatest_speed(const MotionPiece& motion, std::size_t k) {
  if (motion.higher.empty())
    return std::max(std::abs(motion.linear[k]), std::abs(motion.linear[k] + 2 * motion.square[k]));
  const std::size_t degree = 2 + motion.higher.size() / motion.start.size();
  return internal::bernstein_bound(degree - 1, [&](std::size_t j) {
    return static_cast<float>(j + 1) * internal::power_coefficient(motion, k, j + 1);
  });
}

/// Of its second derivative, the most.
[[nodiscard]] inline float greatest_bend(const MotionPiece& motion, std::size_t k) {
  if (motion.higher.empty()) return std::abs(2 * motion.square[k]);
  const std::size_t degree = 2 + motion.higher.size() / motion.start.size();
  return internal::bernstein_bound(degree - 2, [&](std::size_t j) {
    return static_cast<float>((j + 1) * (j + 2)) * internal::power_coefficient(motion, k, j + 2);
  });
}

}  // namespace manyhands
