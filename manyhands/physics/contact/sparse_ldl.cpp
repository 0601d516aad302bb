#include "manyhands/physics/contact/sparse_ldl.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace manyhands::internal {

namespace {

/// Pivots smaller than this, relative to what they are the difference of, are rounding.
constexpr double kLeastPivot = 64 * std::numeric_limits<double>::epsilon();

}  // namespace

void SparseLdl::set_pattern(int n, std::span<const Entry> entries, std::vector<std::size_t>& slots) {
  n_ = n;
  gather_columns(entries, slots);
  find_tree();
  D_.resize(index(n));
  y_.assign(index(n), 0);
  path_.resize(index(n));
}

void SparseLdl::gather_columns(std::span<const Entry> entries, std::vector<std::size_t>& slots) {
  const std::size_t n = index(n_);
  const auto column = [](const Entry& entry) { return index(std::max(entry.row, entry.column)); };
  std::vector<std::size_t>& end = L_end_;
  end.assign(n + 1, 0);
  for (const Entry& entry : entries) ++end[column(entry) + 1];
  for (std::size_t k = 0; k < n; ++k) end[k + 1] += end[k];
  by_column_.resize(entries.size());
  for (std::size_t e = 0; e < entries.size(); ++e) by_column_[end[column(entries[e])]++] = e;

  // In each column, a row's first entry makes its place.
  constexpr auto kNowhere = static_cast<std::size_t>(-1);
  std::vector<std::size_t>& place = L_begin_;
  place.assign(n, kNowhere);
  begin_.assign(1, 0);
  rows_.clear();
  slots.resize(entries.size());
  for (std::size_t k = 0, i = 0; k < n; ++k) {
    for (; i < end[k]; ++i) {
      const Entry& entry = entries[by_column_[i]];
      const int row = std::min(entry.row, entry.column);
      std::size_t& slot = place[index(row)];
      if (slot == kNowhere || slot < begin_[k]) {
        slot = rows_.size();
        rows_.push_back(row);
      }
      slots[by_column_[i]] = slot;
    }
    begin_.push_back(rows_.size());
  }
  values_.assign(rows_.size(), 0);
}

void SparseLdl::find_tree() {
  const std::size_t n = index(n_);
  parent_.assign(n, -1);
  mark_.assign(n, -1);
  L_begin_.assign(n + 1, 0);
  for (int k = 0; k < n_; ++k) {
    mark_[index(k)] = k;
    for (std::size_t p = begin_[index(k)]; p < begin_[index(k) + 1]; ++p) {
      for (int i = rows_[p]; mark_[index(i)] != k; i = parent_[index(i)]) {
        if (parent_[index(i)] < 0) parent_[index(i)] = k;
        ++L_begin_[index(i) + 1];
        mark_[index(i)] = k;
      }
    }
  }
  for (std::size_t k = 0; k < n; ++k) L_begin_[k + 1] += L_begin_[k];
  L_rows_.resize(L_begin_.back());
  L_.resize(L_rows_.size());
}

/// The columns in which row k of L has entries, as they must be eliminated: path_ from the result to its end. Column k
/// of the upper triangle into y_.
std::size_t SparseLdl::find_row(int k) {
  std::size_t top = path_.size();
  mark_[index(k)] = k;
  for (std::size_t p = begin_[index(k)]; p < begin_[index(k) + 1]; ++p) {
    int i = rows_[p];
    y_[index(i)] = values_[p];
    std::size_t count = 0;
    for (; mark_[index(i)] != k; i = parent_[index(i)]) {
      path_[count++] = i;
      mark_[index(i)] = k;
    }
    while (count > 0) path_[--top] = path_[--count];
  }
  return top;
}

bool SparseLdl::factor() {
  mark_.assign(index(n_), -1);
  L_end_.assign(L_begin_.begin(), L_begin_.end());
  for (int k = 0; k < n_; ++k) {
    const std::size_t top = find_row(k);
    double D = std::exchange(y_[index(k)], 0), size = std::abs(D);
    for (std::size_t step = top; step < path_.size(); ++step) {
      const auto i = index(path_[step]);
      const double y = std::exchange(y_[i], 0);
      for (std::size_t p = L_begin_[i]; p < L_end_[i]; ++p) {
        double& to = y_[index(L_rows_[p])];
        to = std::fma(-L_[p], y, to);
      }
      const double l = y / D_[i];
      D = std::fma(-l, y, D);
      size += std::abs(l * y);
      L_rows_[L_end_[i]] = k;
      L_[L_end_[i]++] = l;
    }
    if (!(std::abs(D) > kLeastPivot * size) || !std::isfinite(size)) return false;
    D_[index(k)] = D;
  }
  return true;
}

void SparseLdl::solve(std::span<double> x) const {
  const std::size_t n = index(n_);
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t p = L_begin_[k]; p < L_begin_[k + 1]; ++p) {
      double& to = x[index(L_rows_[p])];
      to = std::fma(-L_[p], x[k], to);
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    double sum = x[k] / D_[k];
    for (std::size_t p = L_begin_[k]; p < L_begin_[k + 1]; ++p) sum = std::fma(-L_[p], x[index(L_rows_[p])], sum);
    x[k] = sum;
  }
}

}  // namespace manyhands::internal
