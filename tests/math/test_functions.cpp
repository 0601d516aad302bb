#include "manyhands/math/functions.h"
#include "tests/math/conformance.h"

namespace manyhands::testing {
namespace {

// ---- in lanes ---------------------------------------------------------------------------------------------------

template <class T>
class LaneFunctions : public ::testing::Test {};
TYPED_TEST_SUITE(LaneFunctions, LaneTypes);

const auto all_functions = [](const auto& a) {
  const auto sc = sincos(a[0]);
  return std::decay_t<decltype(a)>{sc.sin, sc.cos, exp(a[0]), log(a[0]), atan2(a[0], a[1])};
};

TYPED_TEST(LaneFunctions, GiveTheScalarsBits) {
  expect_lanes<TypeParam>(20000, 2, HardNumbers<float>(), all_functions, all_functions);
  expect_lanes<TypeParam>(20000, 2, Uniform<float>(-90, 90), all_functions, all_functions);
}

// ---- accuracy ---------------------------------------------------------------------------------------------------

/// |got - want| in units in the last place of want.
template <Real R>
double ulps(R got, long double want) {
  using L = std::numeric_limits<R>;
  int e = 0;
  std::frexp(static_cast<R>(want), &e);
  const int last = std::max(e, L::min_exponent) - L::digits;
  return static_cast<double>(std::fabs(static_cast<long double>(got) - want) / std::ldexp(1.0L, last));
}

template <Real R>
class Worst {
 public:
  void add(R got, long double want) { worst_ = std::max(worst_, ulps(got, want)); }
  [[nodiscard]] double value() const { return worst_; }

 private:
  double worst_ = 0;
};

constexpr int kSamples = 300'000;

template <class R>
class Functions : public ::testing::Test {
 protected:
  static constexpr R kInfinity = std::numeric_limits<R>::infinity();
  static constexpr R kNaN = std::numeric_limits<R>::quiet_NaN();
};
TYPED_TEST_SUITE(Functions, RealTypes);

TYPED_TEST(Functions, SinCosAreAccurate) {
  using R = TypeParam;
  for (const R range : {R(1), R(10), std::same_as<R, float> ? R(1e4) : R(1e8)}) {
    Uniform<R> draw(-range, range);
    Worst<R> sin, cos;
    for (int i = 0; i < kSamples; ++i) {
      const R x = draw();
      const SinCos<R> y = sincos(x);
      sin.add(y.sin, std::sin(static_cast<long double>(x)));
      cos.add(y.cos, std::cos(static_cast<long double>(x)));
    }
    EXPECT_LT(sin.value(), 1.6) << "to " << range;
    EXPECT_LT(cos.value(), 1.6) << "to " << range;
  }
}

// The reduction must not lose the digits of arguments next to multiples of pi / 2.
TYPED_TEST(Functions, SinCosKeepTheirDigitsNextToTheirZeros) {
  using R = TypeParam;
  Worst<R> worst;
  for (int n = 1; n < 6000; ++n) {
    const R x = static_cast<R>(n * (std::numbers::pi_v<long double> / 2));
    const SinCos<R> y = sincos(x);
    const long double wide = static_cast<long double>(x);
    worst.add(n % 2 == 0 ? y.sin : y.cos, n % 2 == 0 ? std::sin(wide) : std::cos(wide));
  }
  EXPECT_LT(worst.value(), 1.6);
}

TYPED_TEST(Functions, SinCosOfAnyFiniteNumberLieOnTheUnitCircle) {
  using R = TypeParam;
  HardNumbers<R> draw;
  for (int i = 0; i < kSamples; ++i) {
    const R x = draw();
    const SinCos<R> y = sincos(x);
    if (std::isfinite(x)) {
      ASSERT_NEAR(y.sin * y.sin + y.cos * y.cos, R(1), 4 * std::numeric_limits<R>::epsilon()) << x;
    } else {
      ASSERT_TRUE(std::isnan(y.sin) && std::isnan(y.cos)) << x;
    }
  }
}

TYPED_TEST(Functions, SinCosOfZeroAndTinyNumbers) {
  using R = TypeParam;
  const R tiny = std::numeric_limits<R>::denorm_min(), small = std::numeric_limits<R>::min();
  for (const R x : {R(0), -R(0), tiny, -tiny, small, -small}) {
    EXPECT_TRUE(same(sincos(x).sin, x == R(0) ? R(0) : x));
    EXPECT_EQ(sincos(x).cos, R(1));
  }
}

TYPED_TEST(Functions, Atan2IsAccurate) {
  using R = TypeParam;
  Uniform<R> draw(-1, 1);
  Worst<R> worst;
  for (int i = 0; i < kSamples; ++i) {
    const R y = draw(), x = i % 2 == 0 ? draw() : draw() * std::exp2(30 * draw());
    worst.add(atan2(y, x), std::atan2(static_cast<long double>(y), static_cast<long double>(x)));
  }
  EXPECT_LT(worst.value(), 2.7);
}

// Where the last bits of pi / 4 decide: taken from a long double, they were others on ARM than on x86-64.
TEST(Atan2, HasTheSameBitsEverywhere) { EXPECT_EQ(atan2(0x1p-12, -0x1.51p-1), 0x1.92138dc3eaef9p+1); }

// Every pair of special values, among them signed zeros, infinities, denormals and NaN.
TYPED_TEST(Functions, Atan2HasTheSpecialValuesOfC) {
  using R = TypeParam;
  for (const R y : special_values<R>()) {
    for (const R x : special_values<R>()) {
      const R got = atan2(y, x), want = std::atan2(y, x);
      if (std::isnan(want)) {
        ASSERT_TRUE(std::isnan(got)) << y << " " << x << " " << got;
      } else {
        ASSERT_EQ(std::signbit(got), std::signbit(want)) << y << " " << x;
        ASSERT_LE(ulps(got, static_cast<long double>(want)), 3) << y << " " << x << " " << got << " " << want;
      }
    }
  }
}

TYPED_TEST(Functions, ExpIsAccurate) {
  using R = TypeParam;
  // The second range crosses the underflow to denormals and to zero, and the overflow.
  for (const R range : {R(2), std::same_as<R, float> ? R(110) : R(750)}) {
    Uniform<R> draw(-range, range);
    Worst<R> worst;
    for (int i = 0; i < kSamples; ++i) {
      const R x = draw();
      const long double want = std::exp(static_cast<long double>(x));
      if (want > static_cast<long double>(std::numeric_limits<R>::max())) {
        ASSERT_EQ(exp(x), this->kInfinity) << x;
      } else {
        worst.add(exp(x), want);
      }
    }
    EXPECT_LT(worst.value(), 1.7) << "to " << range;
  }
}

TYPED_TEST(Functions, ExpHasItsLimits) {
  using R = TypeParam;
  EXPECT_EQ(exp(R(0)), R(1));
  EXPECT_EQ(exp(-R(0)), R(1));
  EXPECT_EQ(exp(std::numeric_limits<R>::denorm_min()), R(1));
  EXPECT_EQ(exp(this->kInfinity), this->kInfinity);
  EXPECT_TRUE(same(exp(-this->kInfinity), R(0)));
  EXPECT_EQ(exp(std::numeric_limits<R>::max()), this->kInfinity);
  EXPECT_TRUE(same(exp(std::numeric_limits<R>::lowest()), R(0)));
  EXPECT_TRUE(std::isnan(exp(this->kNaN)));
}

TYPED_TEST(Functions, LogIsAccurate) {
  using R = TypeParam;
  using L = std::numeric_limits<R>;
  Uniform<R> near_one(R(0.999), R(1.001)), middle(R(0.01), R(10));
  Uniform<R> power(R(L::min_exponent - L::digits), R(L::max_exponent));
  Worst<R> worst;
  for (int i = 0; i < kSamples; ++i) {
    for (const R x : {near_one(), middle(), std::exp2(power())}) {
      if (x > 0 && x <= L::max()) worst.add(log(x), std::log(static_cast<long double>(x)));
    }
  }
  EXPECT_LT(worst.value(), 1.0);
}

TYPED_TEST(Functions, LogHasItsLimits) {
  using R = TypeParam;
  using L = std::numeric_limits<R>;
  EXPECT_TRUE(same(log(R(1)), R(0)));
  EXPECT_EQ(log(R(0)), -this->kInfinity);
  EXPECT_EQ(log(-R(0)), -this->kInfinity);
  EXPECT_EQ(log(this->kInfinity), this->kInfinity);
  for (const R x : {R(-1), -L::denorm_min(), L::lowest(), -this->kInfinity, this->kNaN}) {
    EXPECT_TRUE(std::isnan(log(x))) << x;
  }
  for (const R x : {L::denorm_min(), R(37) * L::denorm_min(), L::min(), L::max(), R(0.5) * L::max()}) {
    EXPECT_LT(ulps(log(x), std::log(static_cast<long double>(x))), 1) << x;
  }
}

}  // namespace
}  // namespace manyhands::testing
