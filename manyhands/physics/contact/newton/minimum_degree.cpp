#include "manyhands/physics/contact/newton/minimum_degree.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "manyhands/base/index.h"

namespace manyhands::internal {

namespace {

constexpr std::size_t kBits = 64;
constexpr int kEliminated = std::numeric_limits<int>::max();

std::uint64_t bit(int node) { return std::uint64_t{1} << (index(node) % kBits); }

}  // namespace

std::span<std::uint64_t> MinimumDegree::neighbours(int node) {
  return std::span(bits_).subspan(index(node) * words_, words_);
}

void MinimumDegree::reset(int nodes) {
  words_ = (index(nodes) + kBits - 1) / kBits;
  bits_.assign(index(nodes) * words_, 0);
  degree_.resize(index(nodes));
}

void MinimumDegree::connect(int a, int b) {
  if (a == b) return;
  neighbours(a)[index(b) / kBits] |= bit(b);
  neighbours(b)[index(a) / kBits] |= bit(a);
}

std::span<const int> MinimumDegree::find_order() {
  const auto count = [&](int node) {
    int sum = 0;
    for (const std::uint64_t word : neighbours(node)) sum += std::popcount(word);
    return sum;
  };
  const int nodes = static_cast<int>(degree_.size());
  for (int i = 0; i < nodes; ++i) degree_[index(i)] = count(i);
  order_.clear();
  for (int k = 0; k < nodes; ++k) {
    const int next = static_cast<int>(std::min_element(degree_.begin(), degree_.end()) - degree_.begin());
    order_.push_back(next);
    degree_[index(next)] = kEliminated;
    const std::span<const std::uint64_t> left = neighbours(next);
    for (std::size_t w = 0; w < words_; ++w) {
      for (std::uint64_t word = left[w]; word != 0; word &= word - 1) {
        const int other = static_cast<int>(w * kBits) + std::countr_zero(word);
        const std::span<std::uint64_t> row = neighbours(other);
        for (std::size_t i = 0; i < words_; ++i) row[i] |= left[i];
        row[index(other) / kBits] &= ~bit(other);
        row[index(next) / kBits] &= ~bit(next);
        degree_[index(other)] = count(other);
      }
    }
  }
  return order_;
}

}  // namespace manyhands::internal
