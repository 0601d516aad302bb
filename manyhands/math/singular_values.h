// Singular values of matrices with few rows, in lanes or scalar.
#pragma once

#include <array>
#include <limits>

#include "manyhands/math/control_flow.h"

namespace manyhands {

namespace internal {

inline constexpr int kMostSweeps = 20;  ///< over all pairs of rows; six rows take five or six, convergence is quadratic

/// (a, b) := (c a - s b, s a + c b) where the mask holds.
template <Number T>
MANYHANDS_INLINE void rotate_pair(const mask_t<T>& m, T c, T s, T& a, T& b) {
  const T turned = fma(c, a, -(s * b)), other = fma(s, a, c * b);
  a = select(m, turned, a);
  b = select(m, other, b);
}

}  // namespace internal

/// Of A (m, n) by rows, m up to 6: the singular values `lengths` (m), falling, and the left singular vectors as the
/// columns of `axes` (m, m) by rows, so that A = axes diag(lengths) V^T. Rows of A are turned in place until they are
/// orthogonal: one-sided Jacobi, which finds small values to full relative precision (Demmel, Veselic, SIAM J. Matrix
/// Anal. Appl. 13, 1992).
template <Number T>
MANYHANDS_INLINE void singular_values(T* A, std::size_t m, std::size_t n, T* lengths, T* axes) {
  const T zero = constant<T>(0), one = constant<T>(1);
  for (std::size_t i = 0; i < m * m; ++i) axes[i] = i % (m + 1) == 0 ? one : zero;
  const auto product = [&](std::size_t i, std::size_t j) {
    T sum = zero;
    for (std::size_t k = 0; k < n; ++k) sum = fma(A[i * n + k], A[j * n + k], sum);
    return sum;
  };
  const auto exchange = [&](const mask_t<T>& mask, T c, T s, std::size_t i, std::size_t j) {
    for (std::size_t k = 0; k < n; ++k) internal::rotate_pair<T>(mask, c, s, A[i * n + k], A[j * n + k]);
    for (std::size_t k = 0; k < m; ++k) internal::rotate_pair<T>(mask, c, s, axes[k * m + i], axes[k * m + j]);
  };
  iterate(mask_t<T>(true), internal::kMostSweeps, [&](const mask_t<T>& active) {
    mask_t<T> turned(false);
    for (std::size_t i = 0; i + 1 < m; ++i) {
      for (std::size_t j = i + 1; j < m; ++j) {
        const T a = product(i, i), b = product(j, j), ab = product(i, j);
        const T epsilon = T(std::numeric_limits<real_t<T>>::epsilon());
        const mask_t<T> oblique = active & (abs(ab) > epsilon * sqrt(a) * sqrt(b));
        const T zeta = (b - a) / select(oblique, ab + ab, one);
        const T t = copysign(one, zeta) / (abs(zeta) + sqrt(fma(zeta, zeta, one)));
        const T c = one / sqrt(fma(t, t, one));
        exchange(oblique, c, c * t, i, j);
        turned = turned | oblique;
      }
    }
    return turned;
  });
  for (std::size_t i = 0; i < m; ++i) lengths[i] = sqrt(product(i, i));
  for (std::size_t i = 0; i + 1 < m; ++i) {
    for (std::size_t j = i + 1; j < m; ++j) {
      const mask_t<T> wrong = lengths[i] < lengths[j];
      const T shorter = lengths[i];
      lengths[i] = select(wrong, lengths[j], shorter);
      lengths[j] = select(wrong, shorter, lengths[j]);
      exchange(wrong, zero, one, i, j);
    }
  }
}

}  // namespace manyhands
