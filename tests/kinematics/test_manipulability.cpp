// Ellipsoids of closed form, singular values by their definition, and lanes against the scalar.
#include <gtest/gtest.h>

#include <bit>
#include <vector>

#include "manyhands/kinematics/manipulability.h"
#include "manyhands/math/instantiate.h"
#include "manyhands/math/philox.h"

namespace manyhands {
namespace {

constexpr std::size_t kDofs = 7;

std::vector<double> random_jacobian(std::uint32_t seed, std::size_t columns = kDofs) {
  RandomStream random(seed, 0, 0);
  std::vector<double> J(6 * columns);
  for (double& x : J) x = random.uniform(-1.0F, 1.0F);
  return J;
}

TEST(Manipulability, OfTwoLinksInAPlane) {
  // Links of 1 m at right angles (Yoshikawa 1985: the measure is l1 l2 |sin q2|), seen as a plane: rows x, y, and z
  // lost.
  std::vector<double> J(6 * 2, 0.0);
  J[3 * 2] = J[3 * 2 + 1] = -1;
  J[4 * 2] = 1;
  std::vector<double> lengths(3), axes(9);
  const Manipulability<double> found = manipulability(VelocityPart::kLinear, 2, J.data(), lengths.data(), axes.data());
  EXPECT_NEAR(lengths[0] * lengths[1], 1.0, 1e-15);
  EXPECT_NEAR(lengths[0], (std::sqrt(5.0) + 1) / 2, 1e-15);
  EXPECT_EQ(lengths[2], 0.0);
  EXPECT_EQ(found.measure, 0.0);
  EXPECT_EQ(found.isotropy, 0.0);
  EXPECT_TRUE(std::isinf(found.condition));
  EXPECT_EQ(std::abs(axes[2 * 3 + 2]), 1.0);  // z
}

TEST(Manipulability, OfAFrameThatNothingMoves) {
  std::vector<double> J(6 * kDofs, 0.0), lengths(6), axes(36);
  const Manipulability<double> found = manipulability(VelocityPart::kAll, kDofs, J.data(), lengths.data(), axes.data());
  EXPECT_EQ(found.measure, 0.0);
  EXPECT_EQ(found.isotropy, 0.0);
  EXPECT_TRUE(std::isinf(found.condition));
}

/// J J^T = axes diag(lengths^2) axes^T with orthonormal axes: that is what the ellipsoid is.
TEST(Manipulability, AxesAndLengthsMakeUpTheJacobian) {
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    const std::vector<double> J = random_jacobian(seed);
    std::vector<double> turned = J, s(6), u(36);
    (void)manipulability(VelocityPart::kAll, kDofs, turned.data(), s.data(), u.data());
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_LE(s[i], s[i == 0 ? 0 : i - 1]);
      for (std::size_t j = 0; j < 6; ++j) {
        double product = 0, made = 0, identity = 0;
        for (std::size_t k = 0; k < kDofs; ++k) product += J[i * kDofs + k] * J[j * kDofs + k];
        for (std::size_t k = 0; k < 6; ++k) {
          made += u[i * 6 + k] * s[k] * s[k] * u[j * 6 + k];
          identity += u[k * 6 + i] * u[k * 6 + j];
        }
        EXPECT_NEAR(made, product, 1e-13) << "seed " << seed;
        EXPECT_NEAR(identity, i == j ? 1 : 0, 1e-14) << "seed " << seed;
      }
    }
  }
}

template <class T>
class ManipulabilityLanes : public ::testing::Test {};
using LaneTypes = ::testing::Types<Lanes4, Lanes8, Lanes16>;
TYPED_TEST_SUITE(ManipulabilityLanes, LaneTypes);

TYPED_TEST(ManipulabilityLanes, EqualTheScalarBitForBit) {
  using T = TypeParam;
  std::vector<T> J(6 * kDofs), lengths(6), axes(36);
  std::vector<std::vector<float>> alone(static_cast<std::size_t>(width_v<T>));
  for (int k = 0; k < width_v<T>; ++k) {
    std::vector<double> numbers = random_jacobian(static_cast<std::uint32_t>(k));
    if (k == 1) std::fill_n(numbers.begin(), kDofs, 0.0);  // a singular posture, done after fewer sweeps
    alone[static_cast<std::size_t>(k)].assign(numbers.begin(), numbers.end());
    for (std::size_t i = 0; i < J.size(); ++i) set_lane(J[i], k, static_cast<float>(numbers[i]));
  }
  const Manipulability<T> found = manipulability(VelocityPart::kAll, kDofs, J.data(), lengths.data(), axes.data());
  for (int k = 0; k < width_v<T>; ++k) {
    std::vector<float> s(6), u(36);
    const Manipulability<float> one =
        manipulability(VelocityPart::kAll, kDofs, alone[static_cast<std::size_t>(k)].data(), s.data(), u.data());
    EXPECT_EQ(lane(found.measure, k), one.measure);
    EXPECT_EQ(lane(found.condition, k), one.condition);
    EXPECT_EQ(lane(found.isotropy, k), one.isotropy);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(lane(lengths[i], k), s[i]) << "lane " << k;
    for (std::size_t i = 0; i < 36; ++i)
      EXPECT_EQ(std::bit_cast<std::uint32_t>(lane(axes[i], k)), std::bit_cast<std::uint32_t>(u[i])) << "lane " << k;
  }
}

}  // namespace
}  // namespace manyhands
