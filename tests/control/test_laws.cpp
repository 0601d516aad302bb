// PID, admittance and the Kalman filter: closed forms, and lanes against the scalar.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "manyhands/control/impedance.h"
#include "manyhands/control/kalman.h"
#include "manyhands/control/pid.h"
#include "manyhands/math/instantiate.h"
#include "manyhands/math/philox.h"

namespace manyhands {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Pid, IntegratesWhatStays) {
  const PidGains<double> gains{2, 3, 5, kInfinity, kInfinity};
  double integral = 0;
  EXPECT_DOUBLE_EQ(pid(gains, 0.1, 1.0, 0.5, integral), 2 + 3 * 0.1 + 5 * 0.5);
  EXPECT_DOUBLE_EQ(pid(gains, 0.1, 1.0, 0.5, integral), 2 + 3 * 0.2 + 5 * 0.5);
}

TEST(Pid, DoesNotWindUpAtItsLimit) {
  const PidGains<double> gains{2, 3, 0, kInfinity, 4};
  double integral = 0;
  for (int i = 0; i < 1000; ++i) EXPECT_LE(pid(gains, 0.1, 5.0, 0.0, integral), 4);
  EXPECT_EQ(integral, 0);  // 10 from kp alone: nothing was added
  EXPECT_DOUBLE_EQ(pid(gains, 0.1, -1.0, 0.0, integral), -2 - 3 * 0.1);
  const PidGains<double> clamped{0, 1, 0, 0.25, kInfinity};
  integral = 0;
  for (int i = 0; i < 10; ++i) (void)pid(clamped, 0.1, 1.0, 0.0, integral);
  EXPECT_EQ(integral, 0.25);
}

TEST(Pid, RatesAreLimited) {
  EXPECT_EQ(rate_limited(10.0, 1.0, 2.0), 3);
  EXPECT_EQ(rate_limited(-10.0, 1.0, 2.0), -1);
  EXPECT_EQ(rate_limited(1.5, 1.0, 2.0), 1.5);
}

TEST(Admittance, FollowsTheDampedMass) {
  // m x'' + d x' = F from rest: x' = F / d (1 - exp(-d t / m)).
  const Admittance admittance{.mass = 2, .damping = 8, .stiffness = 0};
  Motion<double> x = Motion<double>::zero(), v = x;
  const double h = 1e-5;
  for (int i = 0; i < 50'000; ++i) admit(admittance, h, {{0, 0, 0}, {4, 0, -8}}, x, v);
  EXPECT_NEAR(v.v.x, 0.5 * (1 - std::exp(-2.0)), 1e-5);
  EXPECT_NEAR(v.v.z, -(1 - std::exp(-2.0)), 1e-5);
  const Admittance spring{.mass = 2, .damping = 8, .stiffness = 20, .rotational_stiffness = 5};
  for (int i = 0; i < 1000; ++i) admit(spring, 0.1, {{0, 10, 0}, {4, 0, 0}}, x, v);  // stable at any step
  EXPECT_NEAR(x.v.x, 0.2, 1e-6);
  EXPECT_NEAR(x.w.y, 2, 1e-6);
}

TEST(Kalman, OfAConstantIsTheWeightedMean) {
  // From 0 with variance 10: information adds up, 1 / P = 1 / 10 + n / 4 and x = P (sum of z) / 4.
  double x = 0, P = 10, sum = 0;
  const double one = 1, r = 4;
  std::vector<double> scratch(kalman_scratch(1, 1));
  for (int i = 1; i <= 50; ++i) {
    const double z = std::sin(i), information = 0.1 + i / r;
    sum += z;
    kalman_update<double>(1, 1, &one, &r, &z, &x, &P, scratch.data());
    EXPECT_NEAR(x, sum / r / information, 1e-14);
    EXPECT_NEAR(P, 1 / information, 1e-14);
  }
}

TEST(Kalman, SettlesAtTheRiccatiEquation) {
  // A random walk: P = (q + sqrt(q^2 + 4 q r)) / 2 before an update.
  const double F = 1, q = 0.3, r = 2;
  double x = 0, P = 1;
  std::vector<double> scratch(kalman_scratch(1, 1));
  for (int i = 0; i < 200; ++i) {
    const double z = 0;
    kalman_predict<double>(1, &F, &q, &P, scratch.data());
    EXPECT_TRUE(i < 199 || std::abs(P - (q + std::sqrt(q * q + 4 * q * r)) / 2) < 1e-12);
    kalman_update<double>(1, 1, &F, &r, &z, &x, &P, scratch.data());
  }
}

/// Five predictions and updates of a state of 4 with 2 measured.
template <Number T>
std::vector<T> filtered(const std::vector<T>& numbers) {
  constexpr std::size_t n = 4, m = 2;
  const T* next = numbers.data();
  const auto take = [&](std::size_t count) {
    next += count;
    return next - count;
  };
  const auto square_of = [](std::size_t k, const T* a) {  // A A^T + 1, which is positive definite
    std::vector<T> S(k * k);
    internal::multiply_transposed(k, k, k, a, a, S.data());
    for (std::size_t i = 0; i < k; ++i) S[i * k + i] = S[i * k + i] + T(real_t<T>(1));
    return S;
  };
  const T *F = take(n * n), *H = take(m * n), *z = take(m);
  const std::vector<T> Q = square_of(n, take(n * n)), R = square_of(m, take(m * m));
  std::vector<T> P = Q, x(next, next + n), scratch(kalman_scratch(n, m));
  for (int i = 0; i < 5; ++i) {
    kalman_predict(n, F, Q.data(), P.data(), scratch.data());
    kalman_update(n, m, H, R.data(), z, x.data(), P.data(), scratch.data());
  }
  x.insert(x.end(), P.begin(), P.end());
  return x;
}

template <class T>
class LawsInLanes : public ::testing::Test {};
using LaneTypes = ::testing::Types<Lanes4, Lanes8, Lanes16>;
TYPED_TEST_SUITE(LawsInLanes, LaneTypes);

TYPED_TEST(LawsInLanes, EqualTheScalarBitForBit) {
  using T = TypeParam;
  constexpr std::size_t kNumbers = 64;
  std::vector<T> numbers(kNumbers);
  std::vector<std::vector<float>> alone(static_cast<std::size_t>(width_v<T>), std::vector<float>(kNumbers));
  for (int k = 0; k < width_v<T>; ++k) {
    RandomStream random(static_cast<std::uint32_t>(k), 0, 0);
    for (std::size_t i = 0; i < kNumbers; ++i) {
      const float x = random.uniform(-1.0F, 1.0F);
      alone[static_cast<std::size_t>(k)][i] = x;
      set_lane(numbers[i], k, x);
    }
  }
  const auto run = []<class N>(const std::vector<N>& x) {
    std::vector<N> found = filtered(x);
    N integral = x[0];
    for (std::size_t i = 0; i < 20; ++i)
      found.push_back(
          rate_limited(pid({x[1], x[2], x[3], N(0.5F), N(0.7F)}, N(0.1F), x[i], x[i + 1], integral), x[i], N(0.2F)));
    Motion<N> displaced{{x[0], x[1], x[2]}, {x[3], x[4], x[5]}}, v = displaced;
    admit({.stiffness = 10}, 0.01F, {{x[6], x[7], x[8]}, {x[9], x[10], x[11]}}, displaced, v);
    found.insert(found.end(), {integral, displaced.w.x, displaced.w.y, displaced.v.z, v.w.z, v.v.x});
    return found;
  };
  const std::vector<T> found = run(numbers);
  for (int k = 0; k < width_v<T>; ++k) {
    const std::vector<float> expected = run(alone[static_cast<std::size_t>(k)]);
    for (std::size_t i = 0; i < expected.size(); ++i)
      EXPECT_EQ(std::bit_cast<std::uint32_t>(lane(found[i], k)), std::bit_cast<std::uint32_t>(expected[i])) << i;
  }
}

}  // namespace
}  // namespace manyhands
