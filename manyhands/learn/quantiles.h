// Values as quantiles: the loss whose minimum they are, and targets without the most hopeful ones.
//
// Dabney et al., "Distributional reinforcement learning with quantile regression", 2018, equation 10.
// Kuznetsov et al., "Controlling overestimation bias with truncated mixture of continuous distributional quantile
// critics" (TQC), 2020.
#pragma once

#include "manyhands/learn/mlp.h"

namespace manyhands::learn {

/// The mean over targets and quantiles of the quantile Huber loss (with its knee at 1) of every column, summed, and its
/// gradient by the quantiles.
/// `quantile` (k, n) stands for the quantiles (j + 1/2) / k; `target` (m, n); `gradient` (k, n) is overwritten.
template <class S>
double quantile_loss(const Matrix<S>& quantile, const Matrix<S>& target, Matrix<S>& gradient);

/// Sorts every column of `atoms` (m, n) ascending and keeps the lowest `kept.rows()` of it.
void keep_lowest(Matrix<float>& atoms, Matrix<float>& kept);

extern template double quantile_loss<float>(const Matrix<float>&, const Matrix<float>&, Matrix<float>&);
extern template double quantile_loss<double>(const Matrix<double>&, const Matrix<double>&, Matrix<double>&);

}  // namespace manyhands::learn
