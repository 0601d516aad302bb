// Small symmetric positive definite systems of six equations.
#pragma once

#include <array>

#include "manyhands/math/spatial.h"

namespace manyhands {

/// A symmetric 6 x 6 matrix, lower triangle by rows, angular part first.
template <Number T>
struct SymMat6 {
  std::array<T, 21> a;

  static MANYHANDS_INLINE SymMat6 diagonal(T value) {
    SymMat6 m;
    m.a.fill(T(real_t<T>(0)));
    for (std::size_t i = 0; i < 6; ++i) m.a[at(i, i)] = value;
    return m;
  }

  /// += m m^T.
  MANYHANDS_INLINE void add_outer_product(const Motion<T>& m) {
    const std::array<T, 6> x{m.w.x, m.w.y, m.w.z, m.v.x, m.v.y, m.v.z};
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t j = 0; j <= i; ++j) a[at(i, j)] = fma(x[i], x[j], a[at(i, j)]);
    }
  }

  /// y with (this) y = b, by L D L^T. The matrix must be positive definite; it is factored in place.
  MANYHANDS_INLINE Motion<T> solve(const Motion<T>& b) {
    std::array<T, 6> y{b.w.x, b.w.y, b.w.z, b.v.x, b.v.y, b.v.z};
    for (std::size_t k = 0; k < 6; ++k) {
      const T d_inverse = T(real_t<T>(1)) / a[at(k, k)];
      for (std::size_t i = k + 1; i < 6; ++i) {
        const T l = a[at(i, k)] * d_inverse;
        for (std::size_t j = k + 1; j <= i; ++j) a[at(i, j)] = fma(-l, a[at(j, k)], a[at(i, j)]);
        y[i] = fma(-l, y[k], y[i]);
      }
      a[at(k, k)] = d_inverse;
    }
    for (std::size_t k = 6; k-- > 0;) {
      y[k] = y[k] * a[at(k, k)];
      for (std::size_t i = 0; i < k; ++i) y[i] = fma(-a[at(k, i)], y[k], y[i]);
    }
    return {{y[0], y[1], y[2]}, {y[3], y[4], y[5]}};
  }

 private:
  static constexpr std::size_t at(std::size_t i, std::size_t j) { return i * (i + 1) / 2 + j; }
};

}  // namespace manyhands
