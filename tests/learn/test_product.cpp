// Products of every shape against Eigen in double, with what is fused into them.
#include <gtest/gtest.h>

#include "manyhands/learn/mlp.h"
#include "manyhands/learn/product.h"
#include "manyhands/learn/random.h"

namespace manyhands::learn {
namespace {

Matrix<float> random_matrix(Eigen::Index rows, Eigen::Index columns, std::uint64_t seed) {
  Random random(seed, Purpose::kSampling, 0);
  return Matrix<float>::NullaryExpr(rows, columns, [&] { return random.normal(); });
}

struct Shape {
  int rows, columns, depth;
};

class Product : public testing::TestWithParam<Shape> {
 protected:
  const int rows_ = GetParam().rows, columns_ = GetParam().columns, depth_ = GetParam().depth;
  const Matrix<float> a_ = random_matrix(rows_, depth_, 1), b_ = random_matrix(depth_, columns_, 2);
  const Matrix<double> expected_ = a_.cast<double>() * b_.cast<double>();
  const double tolerance_ = 1e-6 * depth_;
  std::vector<float> panel_;

  template <class Then>
  Matrix<float> product(const Operand<float>& a, const Operand<float>& b, const Then& then) {
    Matrix<float> c = Matrix<float>::Constant(rows_ + 1, columns_, 77.0f);  // the last row must stay
    multiply(rows_, columns_, depth_, a, b, c.data(), rows_ + 1, then, panel_);
    EXPECT_EQ(c.row(rows_).minCoeff(), 77.0f);
    EXPECT_EQ(c.row(rows_).maxCoeff(), 77.0f);
    return c.topRows(rows_);
  }
  [[nodiscard]] double error(const Matrix<float>& c, const Matrix<double>& expected) const {
    return (c.cast<double>() - expected).cwiseAbs().maxCoeff();
  }
};

TEST_P(Product, TakesEitherOperandTransposed) {
  const Matrix<float> at = a_.transpose(), bt = b_.transpose();
  const Operand<float> a{a_.data(), 1, rows_}, a_transposed{at.data(), depth_, 1};
  const Operand<float> b{b_.data(), 1, depth_}, b_transposed{bt.data(), columns_, 1};
  const Matrix<float> c = product(a, b, AsIs{});
  EXPECT_LT(error(c, expected_), tolerance_);
  EXPECT_EQ(product(a_transposed, b, AsIs{}), c) << "the same sums in the same order";
  EXPECT_EQ(product(a, b_transposed, AsIs{}), c);
}

TEST_P(Product, FusesBiasAndRelu) {
  const Vector<float> bias = random_matrix(rows_, 1, 3);
  const Operand<float> a{a_.data(), 1, rows_}, b{b_.data(), 1, depth_};
  const Matrix<double> sum = expected_.colwise() + bias.cast<double>();
  EXPECT_LT(error(product(a, b, AddBias<float, false>{bias.data()}), sum), tolerance_);
  EXPECT_LT(error(product(a, b, AddBias<float, true>{bias.data()}), sum.cwiseMax(0.0)), tolerance_);
}

TEST_P(Product, FusesTheGateOfRelu) {
  const Matrix<float> activation = random_matrix(rows_ + 1, columns_, 4);
  const Operand<float> a{a_.data(), 1, rows_}, b{b_.data(), 1, depth_};
  const Matrix<double> gated = (activation.topRows(rows_).array() > 0.0f).select(expected_, 0.0);
  EXPECT_LT(error(product(a, b, GateByRelu<float>{activation.data()}), gated), tolerance_);
}

INSTANTIATE_TEST_SUITE_P(Shapes, Product,
                         testing::Values(Shape{1, 1, 1}, Shape{3, 7, 5}, Shape{16, 6, 9}, Shape{17, 13, 128},
                                         Shape{64, 12, 24}, Shape{81, 128, 27}, Shape{128, 31, 128},
                                         Shape{200, 5, 64}));

}  // namespace
}  // namespace manyhands::learn
