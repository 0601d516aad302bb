// Small systems of equations without symmetry.
#pragma once

#include <span>
#include <vector>

namespace manyhands::internal {

/// Gaussian elimination with partial pivoting, which leaves out what is zero in a band. Nothing is allocated for
/// systems no larger than one before.
class DenseLu {
 public:
  /// A := 0 (n, n).
  void reset(int n);

  [[nodiscard]] double& at(int row, int column) noexcept {
    return A_[static_cast<std::size_t>(row) * stride_ + static_cast<std::size_t>(column)];
  }

  /// A row, which goes on with zeros to a whole number of blocks.
  static constexpr std::size_t kBlock = 8;
  [[nodiscard]] std::span<double> row(int i) noexcept { return {&at(i, 0), stride_}; }

  /// x := A^-1 x (n); A is used up by it. False if A is singular to rounding; then x says nothing.
  [[nodiscard]] bool solve(std::span<double> x);

 private:
  bool choose_pivot(int k, std::span<double> x);

  int n_ = 0;
  std::size_t stride_ = 0;     ///< of the rows, whole blocks
  std::vector<double> A_;      ///< by rows
  std::vector<double> least_;  ///< (n) pivots of a column must be larger
  std::vector<int> end_;       ///< (n) of a row's entries
};

}  // namespace manyhands::internal
