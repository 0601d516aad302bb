// Rows of plain numbers, as many at once as there are lanes.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "manyhands/math/instantiate.h"

namespace manyhands::internal {

/// An array (n, columns).
template <class R>
struct Rows {
  R* data;
  std::size_t columns;
};

/// Takes rows through lanes, width_v<T> of them at a time; the last block is filled up with copies of the last row.
template <Number T>
class RowBlocks {
  using R = real_t<T>;
  static constexpr std::size_t kWidth = width_v<T>;

 public:
  /// With room for so many columns of all inputs together, and of all outputs.
  RowBlocks(std::size_t inputs, std::size_t outputs) : in_(inputs, T(R(0))), out_(outputs, T(R(0))) {}

  /// Calls body(in, out) for every block: the columns of each input, and where those of each output go. An array may be
  /// both, as its rows are read before they are written.
  template <std::size_t I, std::size_t O, class Body>
  void for_each(std::size_t n, const std::array<Rows<const R>, I>& inputs, const std::array<Rows<R>, O>& outputs,
                Body&& body) {
    std::array<T*, I> in;
    std::array<T*, O> out;
    T* next = in_.data();
    for (std::size_t i = 0; i < I; ++i) {
      in[i] = next;
      next += inputs[i].columns;
    }
    next = out_.data();
    for (std::size_t i = 0; i < O; ++i) {
      out[i] = next;
      next += outputs[i].columns;
    }
    for (std::size_t first = 0; first < n; first += kWidth) {
      const std::size_t count = std::min(kWidth, n - first);
      for (std::size_t i = 0; i < I; ++i) load_rows(inputs[i], first, count, in[i]);
      body(in, out);
      for (std::size_t i = 0; i < O; ++i) store_rows(out[i], first, count, outputs[i]);
    }
  }

 private:
  static void load_rows(const Rows<const R>& rows, std::size_t first, std::size_t count, T* to) {
    for (std::size_t k = 0; k < kWidth; ++k) {
      const R* row = rows.data + (first + std::min(k, count - 1)) * rows.columns;
      for (std::size_t c = 0; c < rows.columns; ++c) set_lane(to[c], static_cast<int>(k), row[c]);
    }
  }

  static void store_rows(const T* from, std::size_t first, std::size_t count, const Rows<R>& rows) {
    for (std::size_t k = 0; k < count; ++k) {
      R* row = rows.data + (first + k) * rows.columns;
      for (std::size_t c = 0; c < rows.columns; ++c) row[c] = lane(from[c], static_cast<int>(k));
    }
  }

  std::vector<T> in_, out_;  // one block
};

}  // namespace manyhands::internal
