// Products of small dense matrices, in tiles that stay in registers, with what follows them in a network fused in.
//
// C = then(A B), column-major C (rows, columns). A tile of C is a few registers of rows by a few columns; it walks
// along A's columns and B's rows once. (Goto, van de Geijn, "Anatomy of high-performance matrix multiplication", 2008,
// without the blocking for caches: networks of a few hundred units fit.) Sums run in one order, so results depend on
// nothing but the operands. README.md says how this compares with Eigen.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "manyhands/math/instantiate.h"

namespace manyhands::learn {

/// A matrix or its transpose in memory: element (i, k) lies at data[i * row_stride + k * column_stride].
template <class S>
struct Operand {
  const S* data{};
  std::ptrdiff_t row_stride{}, column_stride{};

  [[nodiscard]] const S* at(std::ptrdiff_t i, std::ptrdiff_t k) const {
    return data + i * row_stride + k * column_stride;
  }
};

/// What becomes of each element of a product before it is stored.
struct AsIs {
  template <class T>
  MANYHANDS_INLINE T operator()(T product, std::ptrdiff_t /*row*/, std::ptrdiff_t /*at*/) const {
    return product;
  }
};
/// product + bias[row], and no less than `least` if that is asked for.
template <class S, bool kRelu>
struct AddBias {
  const S* bias{};

  template <class T>
  MANYHANDS_INLINE T operator()(T product, std::ptrdiff_t row, std::ptrdiff_t /*at*/) const {
    const T sum = product + load<T>(bias + row);
    return kRelu ? max(sum, T(S(0))) : sum;
  }
};
/// The product where the activation, laid out as C, is positive; elsewhere 0: what relu lets through.
template <class S>
struct GateByRelu {
  const S* activation{};

  template <class T>
  MANYHANDS_INLINE T operator()(T product, std::ptrdiff_t /*row*/, std::ptrdiff_t at) const {
    return select(load<T>(activation + at) > T(S(0)), product, T(S(0)));
  }
};

namespace internal {

/// Registers of rows and columns of a tile: products at a time that hide the latency of fma, and fit the registers of
/// the instruction set (32 with AVX-512 and NEON, 16 with AVX2).
inline constexpr int kTileRows = width_v<NativeLanes> == 8 ? 2 : 4;
inline constexpr int kTileColumns = 6;

/// What `float` is computed in; any other number is computed one at a time.
template <class S>
using VectorFor = std::conditional_t<std::is_same_v<S, float>, NativeLanes, S>;

/// One tile of N columns: `a` points to K columns of R registers of consecutive rows, `a_stride` apart.
template <class T, int R, int N, class S>
MANYHANDS_INLINE std::array<std::array<T, R>, N> tile(const S* a, std::ptrdiff_t a_stride, Operand<S> b, int depth) {
  std::array<std::array<T, R>, N> sum;
#pragma GCC unroll 8
  for (int j = 0; j < N; ++j) {
#pragma GCC unroll 4
    for (int r = 0; r < R; ++r) sum[j][r] = T(S(0));
  }
  for (int k = 0; k < depth; ++k, a += a_stride) {
    std::array<T, R> column;
#pragma GCC unroll 4
    for (int r = 0; r < R; ++r) column[r] = load<T>(a + r * width_v<T>);
#pragma GCC unroll 8
    for (int j = 0; j < N; ++j) {
      const T factor(*b.at(k, j));
#pragma GCC unroll 4
      for (int r = 0; r < R; ++r) sum[j][r] = fma(column[r], factor, sum[j][r]);
    }
  }
  return sum;
}

/// C's columns from `first` on, N at a time, in the rows of one panel of R registers, of which `valid` rows exist.
template <class T, int R, int N, class S, class Then>
void panel_columns(const S* a, std::ptrdiff_t a_stride, const Operand<S>& b, int depth, int row, int valid, int first,
                   int last, S* c, std::ptrdiff_t c_stride, const Then& then) {
  constexpr int kWidth = width_v<T>;
  for (int column = first; column + N <= last; column += N) {
    const auto sums = tile<T, R, N>(a, a_stride, {b.at(0, column), b.row_stride, b.column_stride}, depth);
    for (int j = 0; j < N; ++j) {
      const std::ptrdiff_t at = row + (column + j) * c_stride;
      if (valid == R * kWidth) {
        for (int r = 0; r < R; ++r) store(c + at + r * kWidth, then(sums[j][r], row + r * kWidth, at + r * kWidth));
      } else {
        for (int i = 0; i < valid; ++i) c[at + i] = then(lane(sums[j][i / kWidth], i % kWidth), row + i, at + i);
      }
    }
  }
  if constexpr (N > 1) {
    const int done = first + (last - first) / N * N;
    if (done < last) panel_columns<T, R, N - 1>(a, a_stride, b, depth, row, valid, done, last, c, c_stride, then);
  }
}

}  // namespace internal

/// C (rows, columns; a column is c_stride long) = then(A (rows, depth) B (depth, columns)). C overlaps neither. A is
/// copied, panel by panel, into `panel` where its rows are not consecutive in memory or do not fill a register.
template <class S, class Then>
void multiply(int rows, int columns, int depth, const Operand<S>& a, const Operand<S>& b, S* c, std::ptrdiff_t c_stride,
              const Then& then, std::vector<S>& panel) {
  using T = internal::VectorFor<S>;
  constexpr int kWidth = width_v<T>, kWide = internal::kTileRows * kWidth;
  for (int row = 0; row < rows;) {
    const bool wide = row + kWide <= rows;
    const int height = wide ? kWide : kWidth, valid = std::min(height, rows - row);
    const S* from = a.at(row, 0);
    std::ptrdiff_t stride = a.column_stride;
    if (a.row_stride != 1 || valid < height) {
      const std::size_t size = static_cast<std::size_t>(height) * static_cast<std::size_t>(depth);
      valid < height ? panel.assign(size, S(0)) : panel.resize(size);
      for (int begin = 0; begin < valid; begin += kWidth) {  // a register's rows at a time: whole lines are written
        const int end = std::min(begin + kWidth, valid);
        for (int k = 0; k < depth; ++k) {
          for (int i = begin; i < end; ++i) panel[static_cast<std::size_t>(k * height + i)] = *a.at(row + i, k);
        }
      }
      from = panel.data();
      stride = height;
    }
    if (wide) {
      internal::panel_columns<T, internal::kTileRows, internal::kTileColumns>(from, stride, b, depth, row, valid, 0,
                                                                              columns, c, c_stride, then);
    } else {
      internal::panel_columns<T, 1, internal::kTileColumns>(from, stride, b, depth, row, valid, 0, columns, c, c_stride,
                                                            then);
    }
    row += height;
  }
}

}  // namespace manyhands::learn
