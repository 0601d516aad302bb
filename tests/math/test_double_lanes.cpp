// Lanes of doubles give the bits of scalar doubles, in arithmetic and in what is built on it.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "manyhands/math/double_lanes.h"
#include "manyhands/math/philox.h"
#include "manyhands/math/quaternion.h"

namespace manyhands {
namespace {

constexpr int kWidth = width_v<DoubleLanes>;

/// Special numbers, and many of all sizes.
std::vector<double> numbers() {
  using Limits = std::numeric_limits<double>;
  std::vector<double> all{0.0,
                          -0.0,
                          1.0,
                          -1.0,
                          0.5,
                          2.5,
                          -2.5,
                          1e300,
                          -1e300,
                          Limits::min(),
                          Limits::denorm_min(),
                          Limits::infinity(),
                          -Limits::infinity(),
                          Limits::quiet_NaN(),
                          4503599627370497.5};
  RandomStream random(3, 0, 0);
  while (all.size() % kWidth != 0 || all.size() < 400)
    all.push_back(static_cast<double>(random.uniform(-1.0f, 1.0f)) * std::pow(10.0, random.uniform(-12.0f, 4.0f)));
  return all;
}

/// `op` of three lists in lanes and in scalars: equal bits, or NaN in both.
template <class Op>
void expect_equal_bits(const char* name, const Op& op) {
  const std::vector<double> x = numbers();
  const auto at = [&](std::size_t i, std::size_t shift) { return x[(i + shift) % x.size()]; };
  for (std::size_t i = 0; i < x.size(); i += kWidth) {
    for (const std::size_t shift : {0u, 1u, 7u, 40u}) {
      std::array<double, kWidth> b{}, c{};
      for (std::size_t k = 0; k < kWidth; ++k) b[k] = at(i + k, shift), c[k] = at(i + k, 3 * shift + 2);
      const DoubleLanes found = op(load<DoubleLanes>(&x[i]), load<DoubleLanes>(b.data()), load<DoubleLanes>(c.data()));
      for (int k = 0; k < kWidth; ++k) {
        const auto j = static_cast<std::size_t>(k);
        const double expected = op(x[i + j], b[j], c[j]), here = lane(found, k);
        if (expected != expected && here != here) continue;  // NOLINT: of NaN the payload is open
        ASSERT_EQ(std::bit_cast<std::uint64_t>(here), std::bit_cast<std::uint64_t>(expected))
            << name << " of " << x[i + j] << ", " << b[j] << ", " << c[j];
      }
    }
  }
}

TEST(DoubleLanes, HaveTheBitsOfScalars) {
  expect_equal_bits("abs", [](auto a, auto, auto) { return abs(a); });
  expect_equal_bits("copysign", [](auto a, auto b, auto) { return copysign(a, b); });
  expect_equal_bits("fma", [](auto a, auto b, auto c) { return fma(a, b, c); });
  expect_equal_bits("sqrt", [](auto a, auto, auto) { return sqrt(a); });
  expect_equal_bits("round", [](auto a, auto, auto) { return round(a); });
  expect_equal_bits("floor", [](auto a, auto, auto) { return floor(a); });
  expect_equal_bits("min, max", [](auto a, auto b, auto c) { return max(min(a, b), c); });
  expect_equal_bits("select", [](auto a, auto b, auto c) { return select(a < b, b, c); });
}

TEST(DoubleLanes, HaveTheBitsOfScalarsInFunctions) {
  expect_equal_bits("sin", [](auto a, auto, auto) { return sincos(a).sin; });
  expect_equal_bits("cos", [](auto a, auto, auto) { return sincos(a).cos; });
  expect_equal_bits("atan2", [](auto a, auto b, auto) { return atan2(a, b); });
  expect_equal_bits("rotation", [](auto a, auto b, auto c) {
    using T = decltype(a);
    return rotation_vector(to_quat(to_matrix(normalized(Quat<T>{a, b, c, constant<T>(1)})))).x;
  });
}

}  // namespace
}  // namespace manyhands
