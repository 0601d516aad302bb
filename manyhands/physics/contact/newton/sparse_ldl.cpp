#include "manyhands/physics/contact/newton/sparse_ldl.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace manyhands::internal {

namespace {

/// Pivots smaller than this, relative to what they are the difference of, are rounding.
constexpr double kLeastPivot = 64 * std::numeric_limits<double>::epsilon();

/// to -= a from, (kSeveral) each.
void subtract(double a, const double* __restrict from, double* __restrict to) {
  for (std::size_t j = 0; j < SparseLdl::kSeveral; ++j) to[j] = std::fma(-a, from[j], to[j]);
}

}  // namespace

void SparseLdl::set_pattern(int n, std::span<const Entry> entries, std::vector<std::size_t>& slots) {
  n_ = n;
  gather_columns(entries, slots);
  find_tree();
  D_.resize(index(n));
  y_.assign(index(n), 0);
  path_.resize(index(n));
}

double SparseLdl::work() const noexcept {
  double sum = 0;
  for (std::size_t k = 0; k + 1 < L_begin_.size(); ++k) {
    const auto count = static_cast<double>(L_begin_[k + 1] - L_begin_[k]);
    sum += 0.5 * count * count;
  }
  return sum;
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
  const auto count = [&](std::size_t k) { return L_begin_[k + 1] - L_begin_[k]; };
  joined_.assign(n, false);
  for (std::size_t k = 0; k + 1 < n; ++k) joined_[k] = index(parent_[k]) == k + 1 && count(k) == count(k + 1) + 1;
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

void SparseLdl::append(std::size_t i, double y, Row& row) {
  const double l = y / D_[i];
  row.D = std::fma(-l, y, row.D);
  row.size += std::abs(l * y);
  L_rows_[L_end_[i]] = row.k;
  L_[L_end_[i]++] = l;
}

void SparseLdl::eliminate(std::size_t i, Row& row) {
  const double y_i = take(i);
  for (std::size_t p = L_begin_[i]; p < L_end_[i]; ++p) {
    double& y = y_[index(L_rows_[p])];
    y = std::fma(-L_[p], y_i, y);
  }
  append(i, y_i, row);
}

void SparseLdl::eliminate_three(std::size_t i, Row& row) {
  const double *L_0 = &L_[L_begin_[i]], *L_1 = &L_[L_begin_[i + 1]], *L_2 = &L_[L_begin_[i + 2]];
  const double y_0 = take(i), y_1 = std::fma(-L_0[0], y_0, take(i + 1));
  const double y_2 = std::fma(-L_1[0], y_1, std::fma(-L_0[1], y_0, take(i + 2)));
  const int* rows = &L_rows_[L_begin_[i + 2]];
  const std::size_t count = L_end_[i + 2] - L_begin_[i + 2];
  for (std::size_t p = 0; p < count; ++p) {
    double& y = y_[index(rows[p])];
    y = std::fma(-L_2[p], y_2, std::fma(-L_1[p + 1], y_1, std::fma(-L_0[p + 2], y_0, y)));
  }
  append(i, y_0, row);
  append(i + 1, y_1, row);
  append(i + 2, y_2, row);
}

/// Whether the next three columns of the path follow each other and have the same rows below.
bool SparseLdl::are_alike(std::size_t step) const {
  if (step + 2 >= path_.size()) return false;
  const int i = path_[step];
  return path_[step + 1] == i + 1 && path_[step + 2] == i + 2 && joined_[index(i)] && joined_[index(i) + 1];
}

bool SparseLdl::factor() {
  mark_.assign(index(n_), -1);
  L_end_.assign(L_begin_.begin(), L_begin_.end());
  for (int k = 0; k < n_; ++k) {
    std::size_t step = find_row(k);
    const double diagonal = take(index(k));
    Row row{k, diagonal, std::abs(diagonal)};
    while (step < path_.size()) {
      const bool alike = are_alike(step);
      const std::size_t i = index(path_[step]);
      alike ? eliminate_three(i, row) : eliminate(i, row);
      step += alike ? 3 : 1;
    }
    if (!(std::abs(row.D) > kLeastPivot * row.size) || !std::isfinite(row.size)) return false;
    D_[index(k)] = row.D;
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

void SparseLdl::solve_several(std::span<double> X) const {
  const std::size_t n = index(n_);
  const auto row = [&](std::size_t k) { return &X[k * kSeveral]; };
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t p = L_begin_[k]; p < L_begin_[k + 1]; ++p) subtract(L_[p], row(k), row(index(L_rows_[p])));
  for (std::size_t k = n; k-- > 0;) {
    double* const x = row(k);
    for (std::size_t j = 0; j < kSeveral; ++j) x[j] /= D_[k];
    for (std::size_t p = L_begin_[k]; p < L_begin_[k + 1]; ++p) subtract(L_[p], row(index(L_rows_[p])), x);
  }
}

}  // namespace manyhands::internal
