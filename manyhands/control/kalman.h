// The Kalman filter: the state of a linear system, from what is known of its motion and what is measured (Kalman, A new
// approach to linear filtering and prediction problems, ASME J. Basic Engineering 82, 1960).
//
// Matrices are by rows; P, Q and R are symmetric. All memory is the caller's.
#pragma once

#include <cstddef>

#include "manyhands/math/lanes.h"

namespace manyhands {

namespace internal {

/// C (n, m) = A (n, k) B^T with B (m, k).
template <Number T>
MANYHANDS_INLINE void multiply_transposed(std::size_t n, std::size_t k, std::size_t m, const T* A, const T* B, T* C) {
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < m; ++j) {
      T sum = constant<T>(0);
      for (std::size_t l = 0; l < k; ++l) sum = fma(A[i * k + l], B[j * k + l], sum);
      C[i * m + j] = sum;
    }
  }
}

/// L of S (m, m) = L L^T, in its lower triangle. S is positive definite, as a covariance plus a noise is.
template <Number T>
MANYHANDS_INLINE void factor_cholesky(std::size_t m, T* S) {
  for (std::size_t j = 0; j < m; ++j) {
    for (std::size_t k = 0; k < j; ++k) S[j * m + j] = fma(-S[j * m + k], S[j * m + k], S[j * m + j]);
    S[j * m + j] = sqrt(S[j * m + j]);
    const T inverse = constant<T>(1) / S[j * m + j];
    for (std::size_t i = j + 1; i < m; ++i) {
      for (std::size_t k = 0; k < j; ++k) S[i * m + j] = fma(-S[i * m + k], S[j * m + k], S[i * m + j]);
      S[i * m + j] = S[i * m + j] * inverse;
    }
  }
}

/// x := L^-1 x.
template <Number T>
MANYHANDS_INLINE void solve_lower(std::size_t m, const T* L, T* x) {
  for (std::size_t i = 0; i < m; ++i) {
    for (std::size_t k = 0; k < i; ++k) x[i] = fma(-L[i * m + k], x[k], x[i]);
    x[i] = x[i] / L[i * m + i];
  }
}

}  // namespace internal

/// How many numbers both functions need as scratch, for a state of n numbers of which m are measured.
[[nodiscard]] constexpr std::size_t kalman_scratch(std::size_t n, std::size_t m) { return n * n + n * m + m * m + m; }

/// What the motion x := F x + ... does to the uncertainty of x: P (n, n) := F P F^T + Q. Moving x itself is left to the
/// caller, who may know better than F.
template <Number T>
void kalman_predict(std::size_t n, const T* F, const T* Q, T* P, T* scratch) {
  internal::multiply_transposed(n, n, n, F, P, scratch);  // P is symmetric
  internal::multiply_transposed(n, n, n, scratch, F, P);
  for (std::size_t i = 0; i < n; ++i) {  // rounding must not make it oblique
    for (std::size_t j = 0; j <= i; ++j) P[i * n + j] = P[j * n + i] = P[i * n + j] + Q[i * n + j];
  }
}

/// Takes in a measurement z (m) = H x + noise of covariance R (m, m): x (n) += K (z - H x) and P := (1 - K H) P, with
/// K = P H^T (H P H^T + R)^-1.
template <Number T>
void kalman_update(std::size_t n, std::size_t m, const T* H, const T* R, const T* z, T* x, T* P, T* scratch) {
  T* const PHt = scratch;           // (n, m)
  T* const S = PHt + n * m;         // (m, m)
  T* const innovation = S + m * m;  // (m)
  internal::multiply_transposed(n, n, m, P, H, PHt);
  for (std::size_t i = 0; i < m; ++i) {
    innovation[i] = z[i];
    for (std::size_t k = 0; k < n; ++k) innovation[i] = fma(-H[i * n + k], x[k], innovation[i]);
    for (std::size_t j = 0; j < m; ++j) {
      T sum = R[i * m + j];
      for (std::size_t k = 0; k < n; ++k) sum = fma(H[i * n + k], PHt[k * m + j], sum);
      S[i * m + j] = sum;
    }
  }
  // With S = L L^T and W = P H^T L^-T: x += W L^-1 innovation, P -= W W^T.
  internal::factor_cholesky(m, S);
  internal::solve_lower(m, S, innovation);
  for (std::size_t i = 0; i < n; ++i) {
    internal::solve_lower(m, S, PHt + i * m);
    for (std::size_t k = 0; k < m; ++k) x[i] = fma(PHt[i * m + k], innovation[k], x[i]);
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      T sum = P[i * n + j];
      for (std::size_t k = 0; k < m; ++k) sum = fma(-PHt[i * m + k], PHt[j * m + k], sum);
      P[i * n + j] = P[j * n + i] = sum;
    }
  }
}

}  // namespace manyhands
