#include "manyhands/physics/contact/newton/dense_lu.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "manyhands/base/index.h"

namespace manyhands::internal {

namespace {

/// Pivots smaller than this, relative to the largest entry of their column, are rounding.
constexpr double kLeastPivot = 64 * std::numeric_limits<double>::epsilon();

/// to -= a from, in whole blocks: of a length that the compiler knows, and so in vectors.
void subtract(const double* __restrict from, double a, std::size_t begin, std::size_t end, double* __restrict to) {
  for (std::size_t block = begin / DenseLu::kBlock * DenseLu::kBlock; block < end; block += DenseLu::kBlock) {
    for (std::size_t i = block; i < block + DenseLu::kBlock; ++i) to[i] = std::fma(-a, from[i], to[i]);
  }
}

}  // namespace

void DenseLu::reset(int n) {
  n_ = n;
  stride_ = (index(n) + kBlock - 1) / kBlock * kBlock;
  A_.assign(index(n) * stride_, 0);
  least_.assign(index(n), 0);
  end_.resize(index(n));
}

bool DenseLu::choose_pivot(int k, std::span<double> x) {
  int best = k;
  for (int i = k + 1; i < n_; ++i)
    if (std::abs(at(i, k)) > std::abs(at(best, k))) best = i;
  if (best != k) {
    std::swap_ranges(&at(k, 0), &at(k, 0) + stride_, &at(best, 0));
    std::swap(end_[index(k)], end_[index(best)]);
    std::swap(x[index(k)], x[index(best)]);
  }
  return std::abs(at(k, k)) > least_[index(k)];
}

bool DenseLu::solve(std::span<double> x) {
  for (int i = 0; i < n_; ++i) {
    for (int j = 0; j < n_; ++j) {
      const double size = std::abs(at(i, j));
      least_[index(j)] = std::max(least_[index(j)], kLeastPivot * size);
      if (size > 0) end_[index(i)] = j + 1;
    }
  }
  for (int k = 0; k < n_; ++k) {
    if (!choose_pivot(k, x)) return false;
    const double inverse = 1 / at(k, k);
    const int end = end_[index(k)];
    for (int i = k + 1; i < n_; ++i) {
      const double a = at(i, k) * inverse;
      if (a == 0) continue;
      subtract(&at(k, 0), a, index(k) + 1, index(end), &at(i, 0));
      x[index(i)] -= a * x[index(k)];
      end_[index(i)] = std::max(end_[index(i)], end);
    }
  }
  for (int k = n_; k-- > 0;) {
    double sum = x[index(k)];
    for (int j = k + 1; j < end_[index(k)]; ++j) sum -= at(k, j) * x[index(j)];
    x[index(k)] = sum / at(k, k);
    if (!std::isfinite(x[index(k)])) return false;
  }
  return true;
}

}  // namespace manyhands::internal
