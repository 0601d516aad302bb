// Small systems without symmetry against Eigen's.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>
#include <random>

#include "manyhands/physics/contact/newton/dense_lu.h"

namespace manyhands {
namespace {

using Random = std::mt19937_64;

bool solve(const Eigen::MatrixXd& A, Eigen::VectorXd& x, internal::DenseLu& lu) {
  lu.reset(static_cast<int>(A.cols()));
  for (int i = 0; i < A.rows(); ++i)
    for (int j = 0; j < A.cols(); ++j) lu.at(i, j) = A(i, j);
  return lu.solve({x.data(), static_cast<std::size_t>(x.size())});
}

/// Full and banded ones, of all sizes in the same memory; in a third of them the diagonal is empty.
TEST(DenseLu, SolvesAsEigenDoes) {
  Random random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  internal::DenseLu lu;
  for (int run = 0; run < 300; ++run) {
    const int n = 2 + static_cast<int>(random() % 60), band = run % 2 == 0 ? n : 4;
    const Eigen::MatrixXd A = Eigen::MatrixXd::NullaryExpr(n, n, [&](Eigen::Index i, Eigen::Index j) {
      return std::abs(i - j) > band || (run % 3 == 0 && i == j) ? 0.0 : uniform(random);
    });
    const Eigen::FullPivLU<Eigen::MatrixXd> truth(A);
    if (truth.rcond() < 1e-6) continue;
    const Eigen::VectorXd b = Eigen::VectorXd::NullaryExpr(n, [&] { return uniform(random); }),
                          x_truth = truth.solve(b);
    Eigen::VectorXd x = b;
    ASSERT_TRUE(solve(A, x, lu)) << "run " << run;
    EXPECT_LT((x - x_truth).norm(), 1e-8 * x_truth.norm()) << "run " << run;
  }
}

TEST(DenseLu, RefusesWhatIsSingular) {
  Random random(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  internal::DenseLu lu;
  for (int n = 2; n < 40; ++n) {
    Eigen::MatrixXd A = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return uniform(random); });
    Eigen::VectorXd x = Eigen::VectorXd::Ones(n);
    EXPECT_TRUE(solve(A, x, lu)) << n;
    Eigen::MatrixXd same = A;
    same.row(n - 1) = same.row(0);
    EXPECT_FALSE(solve(same, x, lu)) << n;
    A.col(n / 2).setZero();
    EXPECT_FALSE(solve(A, x, lu)) << n;
    A(0, n / 2) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(solve(A, x, lu)) << n;
  }
}

}  // namespace
}  // namespace manyhands
