// Sparse factors against dense ones.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <limits>
#include <random>

#include "manyhands/physics/contact/newton/sparse_ldl.h"

namespace manyhands {
namespace {

using internal::SparseLdl;

using Random = std::mt19937_64;

double uniform(Random& random) { return std::uniform_real_distribution<double>(-1, 1)(random); }

/// Gram matrices of a few sparse rows each, which is what contacts add, on a small diagonal.
Eigen::MatrixXd random_definite(Random& random, int n) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  for (int i = 0; i < n; ++i) A(i, i) = 0.01 + std::abs(uniform(random));
  for (int rows = 0; rows < n; ++rows) {
    Eigen::VectorXd row = Eigen::VectorXd::Zero(n);
    for (int k = 0; k < 3; ++k) row[static_cast<int>(random() % static_cast<std::uint64_t>(n))] = uniform(random);
    A += row * row.transpose();
  }
  return A;
}

/// [K, B; B^T, -C] with K and C definite: quasi-definite, factors exist in every order (Vanderbei 1995).
Eigen::MatrixXd random_quasi_definite(Random& random, int n) {
  const int first = n / 2, second = n - first;
  Eigen::MatrixXd A(n, n);
  A.topLeftCorner(first, first) = random_definite(random, first);
  A.bottomRightCorner(second, second) = -random_definite(random, second);
  A.topRightCorner(first, second) =
      Eigen::MatrixXd::NullaryExpr(first, second, [&] { return random() % 4 == 0 ? uniform(random) : 0.0; });
  A.bottomLeftCorner(second, first) = A.topRightCorner(first, second).transpose();
  Eigen::PermutationMatrix<Eigen::Dynamic> order(n);
  order.setIdentity();
  std::shuffle(order.indices().data(), order.indices().data() + n, random);
  return order * A * order.transpose();
}

/// Enters the places of A that are not zero in any order, on either side, some of them twice, each with its share.
bool factor(Random& random, const Eigen::MatrixXd& A, SparseLdl& ldl) {
  std::vector<SparseLdl::Entry> entries;
  std::vector<double> shares;
  for (int j = 0; j < A.cols(); ++j) {
    for (int i = 0; i <= j; ++i) {
      if (A(i, j) == 0) continue;
      const bool twice = random() % 3 == 0;
      for (int copy = 0; copy < (twice ? 2 : 1); ++copy) {
        entries.push_back(random() % 2 == 0 ? SparseLdl::Entry{i, j} : SparseLdl::Entry{j, i});
        shares.push_back(twice ? 0.5 * A(i, j) : A(i, j));
      }
    }
  }
  for (std::size_t i = entries.size(); i > 1; --i) {
    const std::size_t other = random() % i;
    std::swap(entries[i - 1], entries[other]);
    std::swap(shares[i - 1], shares[other]);
  }
  std::vector<std::size_t> slots;
  ldl.set_pattern(static_cast<int>(A.cols()), entries, slots);
  EXPECT_EQ(slots.size(), entries.size());
  for (std::size_t e = 0; e < entries.size(); ++e) ldl.values()[slots[e]] += shares[e];
  return ldl.factor();
}

void expect_solves(Random& random, const Eigen::MatrixXd& A, SparseLdl& ldl, const std::string& what) {
  const Eigen::VectorXd b = Eigen::VectorXd::NullaryExpr(A.cols(), [&] { return uniform(random); });
  Eigen::VectorXd x = b;
  ldl.solve({x.data(), static_cast<std::size_t>(x.size())});
  const Eigen::VectorXd truth = A.fullPivLu().solve(b);
  EXPECT_LT((x - truth).norm(), 1e-9 * truth.norm()) << what;
}

/// One object for all of them: patterns and sizes change, and nothing of the last is left.
TEST(SparseLdl, SolvesAsADenseFactorisationDoes) {
  Random random(1);
  SparseLdl ldl;
  for (int run = 0; run < 300; ++run) {
    const int n = 2 + static_cast<int>(random() % 60);
    const bool definite = run % 2 == 0;
    const Eigen::MatrixXd A = definite ? random_definite(random, n) : random_quasi_definite(random, n);
    const std::string what = "run " + std::to_string(run);
    ASSERT_TRUE(factor(random, A, ldl)) << what;
    expect_solves(random, A, ldl, what);
  }
}

TEST(SparseLdl, FactorsNewValuesInAnOldPattern) {
  Random random(2);
  const Eigen::MatrixXd A = random_definite(random, 40);
  SparseLdl ldl;
  ASSERT_TRUE(factor(random, A, ldl));
  const Eigen::MatrixXd sum = A + 3 * Eigen::MatrixXd(A.diagonal().asDiagonal());
  int places = 0;
  ldl.visit([&](int i, int j, double value) {
    EXPECT_LE(i, j);
    EXPECT_NEAR(value, A(i, j), 1e-15);
    ++places;
  });
  EXPECT_EQ(places, static_cast<int>(ldl.values().size()));
  std::size_t slot = 0;
  ldl.visit([&](int i, int j, double) { ldl.values()[slot++] = sum(i, j); });
  ASSERT_TRUE(ldl.factor());
  expect_solves(random, sum, ldl, "new values");
}

/// The matrix of a chain has no fill from an end on; of a star all, from its centre on.
TEST(SparseLdl, FillsInWhatTheTheorySays) {
  constexpr int kNodes = 20;
  SparseLdl ldl;
  std::vector<std::size_t> slots;
  std::vector<SparseLdl::Entry> chain, star;
  for (int i = 0; i < kNodes; ++i) {
    chain.push_back({i, i});
    star.push_back({i, i});
    if (i > 0) chain.push_back({i - 1, i});
    if (i > 0) star.push_back({0, i});
  }
  ldl.set_pattern(kNodes, chain, slots);
  EXPECT_EQ(ldl.fill(), kNodes - 1u);
  ldl.set_pattern(kNodes, star, slots);
  EXPECT_EQ(ldl.fill(), kNodes * (kNodes - 1u) / 2);
}

TEST(SparseLdl, RefusesWhatIsSingular) {
  Random random(3);
  SparseLdl ldl;
  for (int n = 3; n < 40; ++n) {
    // A spring between neighbours alone leaves their common motion free.
    Eigen::MatrixXd springs = Eigen::MatrixXd::Zero(n, n);
    for (int i = 0; i < n; ++i) {
      const int j = i == 0 ? n - 1 : static_cast<int>(random() % static_cast<std::uint64_t>(i));
      Eigen::VectorXd row = Eigen::VectorXd::Zero(n);
      row[i] = 1;
      row[j] = -1;
      springs += (1.5 + uniform(random)) * row * row.transpose();
    }
    EXPECT_FALSE(factor(random, springs, ldl)) << n;
    springs(n / 2, n / 2) += 1;
    ASSERT_TRUE(factor(random, springs, ldl)) << n;
    expect_solves(random, springs, ldl, std::to_string(n));
    springs(n / 2, n / 2) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(factor(random, springs, ldl)) << n;
  }
}

}  // namespace
}  // namespace manyhands
