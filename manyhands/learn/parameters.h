// Parameters and optimisers: in archives, and in the two parts that two threads move.
#pragma once

#include <span>
#include <utility>

#include "manyhands/learn/archive.h"
#include "manyhands/learn/mlp.h"

namespace manyhands::learn {

/// Part 0 or 1 of n parameters, split at a multiple of a cache line.
[[nodiscard]] inline std::pair<int, int> part_of(int n, int part) {
  const int middle = n / 2 / 16 * 16;
  return part == 0 ? std::pair(0, middle) : std::pair(middle, n);
}

/// A vector's or matrix's numbers in memory's order.
template <class M>
[[nodiscard]] auto floats(M& matrix) {
  return std::span(matrix.data(), static_cast<std::size_t>(matrix.size()));
}

/// Its moments and the number of its steps.
inline void save_optimiser(const Adam<float>& adam, ArchiveWriter& out) {
  out.value(adam.step_count());
  out.array(floats(adam.first_moment()));
  out.array(floats(adam.second_moment()));
}

/// What save_optimiser wrote.
inline void load_optimiser(Adam<float>& adam, ArchiveReader& in) {
  adam.set_step_count(in.value<std::int64_t>());
  in.array(floats(adam.first_moment()));
  in.array(floats(adam.second_moment()));
}

}  // namespace manyhands::learn
