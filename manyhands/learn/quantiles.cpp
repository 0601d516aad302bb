#include "manyhands/learn/quantiles.h"

#include <algorithm>

namespace manyhands::learn {

/// With d = target - quantile: |d|'s Huber loss, times tau where the target is above and 1 - tau where it is below.
template <class S>
double quantile_loss(const Matrix<S>& quantile, const Matrix<S>& target, Matrix<S>& gradient) {
  const Eigen::Index k = quantile.rows(), m = target.rows();
  const S share = S(1) / static_cast<S>(k * m);
  double loss = 0;
  for (Eigen::Index i = 0; i < quantile.cols(); ++i) {
    for (Eigen::Index j = 0; j < k; ++j) {
      const S tau = (static_cast<S>(j) + S(0.5)) / static_cast<S>(k), theta = quantile(j, i);
      S sum = 0, slope = 0;
      for (Eigen::Index t = 0; t < m; ++t) {
        const S d = target(t, i) - theta, bounded = std::clamp(d, S(-1), S(1));
        const S weight = d < S(0) ? S(1) - tau : tau;
        sum += weight * bounded * (d - bounded / 2);  // d^2 / 2 within 1, |d| - 1/2 beyond
        slope -= weight * bounded;
      }
      gradient(j, i) = slope * share;
      loss += static_cast<double>(sum * share);
    }
  }
  return loss;
}

void keep_lowest(Matrix<float>& atoms, Matrix<float>& kept) {
  const auto m = atoms.rows(), most = kept.rows();
  for (Eigen::Index i = 0; i < atoms.cols(); ++i) {
    float* column = atoms.col(i).data();
    std::sort(column, column + m);
    std::copy_n(column, most, kept.col(i).data());
  }
}

template double quantile_loss<float>(const Matrix<float>&, const Matrix<float>&, Matrix<float>&);
template double quantile_loss<double>(const Matrix<double>&, const Matrix<double>&, Matrix<double>&);

}  // namespace manyhands::learn
