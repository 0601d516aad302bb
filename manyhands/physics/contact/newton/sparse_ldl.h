// A = L D L^T of sparse symmetric matrices, one after another in the same memory.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "manyhands/base/index.h"

namespace manyhands::internal {

/// The up-looking factorisation along the elimination tree (Davis, "Algorithm 849: a concise sparse Cholesky
/// factorization package", ACM TOMS 2005), three columns at once where they have the same rows, as a body's have. It
/// does not pivot: for definite and quasi-definite matrices. All its memory stays: nothing is allocated for patterns no
/// larger than one before.
class SparseLdl {
 public:
  /// A place (row, column) of the matrix; it stands for (column, row) too.
  struct Entry {
    int row, column;
  };

  /// The pattern of a matrix (n, n) by its entries, in any order, repeated ones too. Unknowns are eliminated from
  /// the first to the last. slots (entries): which of `values` each entry is; entries at the same place, or at one and
  /// its mirror image, share theirs.
  void set_pattern(int n, std::span<const Entry> entries, std::vector<std::size_t>& slots);

  [[nodiscard]] std::span<double> values() noexcept { return values_; }

  /// Calls body(row, column, value) for every place of the upper triangle, row <= column.
  template <class Body>
  void visit(Body&& body) const {
    for (int k = 0; k < n_; ++k)
      for (std::size_t p = begin_[index(k)]; p < begin_[index(k) + 1]; ++p) body(rows_[p], k, values_[p]);
  }

  /// False if the matrix is singular to rounding; then there is nothing to solve with.
  [[nodiscard]] bool factor();

  /// x := A^-1 x (n), after `factor`.
  void solve(std::span<double> x) const;

  /// How many right-hand sides `solve_several` takes.
  static constexpr std::size_t kSeveral = 8;

  /// X := A^-1 X (n, kSeveral), by rows, after `factor`: each of its columns as `solve` has it, to the bit.
  void solve_several(std::span<double> X) const;

  /// Multiplications of a factorisation, about.
  [[nodiscard]] double work() const noexcept;

  /// Entries of L below its diagonal.
  [[nodiscard]] std::size_t fill() const noexcept { return L_rows_.size(); }

 private:
  void gather_columns(std::span<const Entry> entries, std::vector<std::size_t>& slots);
  void find_tree();

  /// Column k of the upper triangle into y_, and path_, from the result to its end: the columns in which row k of L has
  /// entries, as they must be eliminated.
  std::size_t find_row(int k);

  /// A row of L as it grows: its pivot, and the sum of what that is the difference of.
  struct Row {
    int k;
    double D, size;
  };
  void eliminate(std::size_t i, Row& row);
  void eliminate_three(std::size_t i, Row& row);
  bool are_alike(std::size_t step) const;
  void append(std::size_t i, double y, Row& row);
  double take(std::size_t i) { return std::exchange(y_[i], 0); }

  int n_ = 0;
  std::vector<std::size_t> begin_;  ///< (n + 1) of the upper triangle's columns
  std::vector<int> rows_;
  std::vector<double> values_;

  std::vector<int> parent_;           ///< (n) in the elimination tree, or -1
  std::vector<std::size_t> L_begin_;  ///< (n + 1) of L's columns
  std::vector<std::size_t> L_end_;    ///< (n + 1) scratch: of those entries that are there already
  std::vector<int> L_rows_;
  std::vector<double> L_, D_;
  std::vector<bool> joined_;  ///< (n) whether the next column has the same rows below

  std::vector<int> mark_, path_;        ///< (n) scratch
  std::vector<std::size_t> by_column_;  ///< (entries) scratch
  std::vector<double> y_;               ///< (n) scratch
};

}  // namespace manyhands::internal
