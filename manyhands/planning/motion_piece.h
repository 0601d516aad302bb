// A short motion of planned coordinates: polynomials of t from 0 to 1.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "manyhands/math/number.h"

namespace manyhands {

/// Planned coordinates as q(t) = start + linear t + square t^2 for t in [0, 1]; spans of n.
struct MotionPiece {
  std::span<const float> start, linear, square;
};

/// Coordinate k at t, in any number type.
template <Number T>
[[nodiscard]] MANYHANDS_INLINE T coordinate_at(const MotionPiece& motion, std::size_t k, const T& t) {
  return fma(t, fma(t, T(motion.square[k]), T(motion.linear[k])), T(motion.start[k]));
}

/// How fast coordinate k changes at most, per unit of t.
[[nodiscard]] inline float greatest_speed(const MotionPiece& motion, std::size_t k) {
  return std::max(std::abs(motion.linear[k]), std::abs(motion.linear[k] + 2 * motion.square[k]));
}

/// Of its second derivative, the most.
[[nodiscard]] inline float greatest_bend(const MotionPiece& motion, std::size_t k) {
  return std::abs(2 * motion.square[k]);
}

}  // namespace manyhands
