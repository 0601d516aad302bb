// Every operation of the number contract, in every lane of every number type, against the C library's scalars.
#include "manyhands/math/number.h"
#include "tests/math/conformance.h"

namespace manyhands::testing {
namespace {

constexpr int kTrials = 4000;

template <class T>
class NumberContract : public ::testing::Test {
 protected:
  template <class Function, class Expected>
  void check(std::size_t arity, Function function, Expected expected) {
    expect_lanes<T>(kTrials, arity, HardNumbers<real_t<T>>(), function, expected);
  }
};
TYPED_TEST_SUITE(NumberContract, NumberTypes);

TYPED_TEST(NumberContract, Arithmetic) {
  using T = TypeParam;
  using R = real_t<T>;
  this->check(
      2, [](const Numbers<T>& a) { return Numbers<T>{a[0] + a[1], a[0] - a[1], a[0] * a[1], a[0] / a[1], -a[0]}; },
      [](const Numbers<R>& a) { return Numbers<R>{a[0] + a[1], a[0] - a[1], a[0] * a[1], a[0] / a[1], -a[0]}; });
  const auto accumulated = [](const Numbers<T>& a) {
    T sum = a[0], difference = a[0], product = a[0], quotient = a[0];
    sum += a[1];
    difference -= a[1];
    product *= a[1];
    quotient /= a[1];
    return Numbers<T>{sum, difference, product, quotient};
  };
  this->check(2, accumulated,
              [](const Numbers<R>& a) { return Numbers<R>{a[0] + a[1], a[0] - a[1], a[0] * a[1], a[0] / a[1]}; });
}

TYPED_TEST(NumberContract, Comparisons) {
  using T = TypeParam;
  using R = real_t<T>;
  this->check(
      2,
      [](const Numbers<T>& a) {
        return Numbers<T>{as_number<T>(a[0] < a[1]),  as_number<T>(a[0] <= a[1]), as_number<T>(a[0] > a[1]),
                          as_number<T>(a[0] >= a[1]), as_number<T>(a[0] == a[1]), as_number<T>(a[0] != a[1])};
      },
      [](const Numbers<R>& a) {
        return Numbers<R>{R(a[0] < a[1]),  R(a[0] <= a[1]), R(a[0] > a[1]),
                          R(a[0] >= a[1]), R(a[0] == a[1]), R(a[0] != a[1])};
      });
}

TYPED_TEST(NumberContract, Masks) {
  using T = TypeParam;
  using R = real_t<T>;
  this->check(
      2,
      [](const Numbers<T>& a) {
        const T one(R(1));
        const auto p = a[0] < one, q = a[1] < one;
        return Numbers<T>{as_number<T>(p & q), as_number<T>(p | q),           as_number<T>(p ^ q),
                          as_number<T>(!p),    as_number<T>(mask_t<T>(true)), as_number<T>(mask_t<T>(false))};
      },
      [](const Numbers<R>& a) {
        const bool p = a[0] < 1, q = a[1] < 1;
        return Numbers<R>{R(p && q), R(p || q), R(p != q), R(!p), R(1), R(0)};
      });
}

TYPED_TEST(NumberContract, SelectionAndOrder) {
  using T = TypeParam;
  using R = real_t<T>;
  this->check(
      3,
      [](const Numbers<T>& a) {
        return Numbers<T>{select(a[0] < a[1], a[1], a[2]), min(a[0], a[1]), max(a[0], a[1]), abs(a[0]),
                          copysign(a[0], a[1])};
      },
      [](const Numbers<R>& a) {
        return Numbers<R>{a[0] < a[1] ? a[1] : a[2], a[0] < a[1] ? a[0] : a[1], a[0] > a[1] ? a[0] : a[1],
                          std::fabs(a[0]), std::copysign(a[0], a[1])};
      });
}

TYPED_TEST(NumberContract, ClampKeepsNaN) {
  using T = TypeParam;
  using R = real_t<T>;
  this->check(
      1, [](const Numbers<T>& a) { return Numbers<T>{clamp(a[0], T(R(-2)), T(R(3)))}; },
      [](const Numbers<R>& a) {
        return Numbers<R>{std::isnan(a[0]) ? a[0] : std::fmin(std::fmax(a[0], R(-2)), R(3))};
      });
}

TYPED_TEST(NumberContract, RootsAndRounding) {
  using T = TypeParam;
  using R = real_t<T>;
  this->check(
      3,
      [](const Numbers<T>& a) {
        return Numbers<T>{sqrt(a[0]),  fma(a[0], a[1], a[2]), round(a[0]),
                          floor(a[0]), square(a[0]),          as_number<T>(is_finite(a[0]))};
      },
      [](const Numbers<R>& a) {
        return Numbers<R>{std::sqrt(a[0]), std::fma(a[0], a[1], a[2]), std::nearbyint(a[0]), std::floor(a[0]),
                          a[0] * a[0],     R(std::isfinite(a[0]))};
      });
}

// GCC fuses a negation into an fma although that turns the -0 of -(1 * 1 - 1) into +0.
TYPED_TEST(NumberContract, ANegatedFmaKeepsTheSignOfItsZero) {
  using T = TypeParam;
  using R = real_t<T>;
  const auto small_whole = [draw = Uniform<R>(R(-2.4), R(2.4))]() mutable { return std::nearbyint(draw()); };
  expect_lanes<T>(
      kTrials, 3, small_whole, [](const Numbers<T>& a) { return Numbers<T>{-fma(a[0], a[1], a[2])}; },
      [](const Numbers<R>& a) {
        const volatile R unfused = a[0] * a[1] + a[2];
        return Numbers<R>{-unfused};
      });
}

TYPED_TEST(NumberContract, Exponents) {
  using T = TypeParam;
  using R = real_t<T>;
  using L = std::numeric_limits<R>;
  for (int n = L::min_exponent - 1; n < L::max_exponent; ++n) {
    const T power = exp2_whole(T(R(n)));
    for (int k = 0; k < width_v<T>; ++k) ASSERT_EQ(lane(power, k), std::ldexp(R(1), n));
  }
  const auto positive_normal = [draw = HardNumbers<R>()]() mutable {
    while (true) {
      const R x = std::fabs(draw());
      if (std::isnormal(x)) return x;
    }
  };
  expect_lanes<T>(
      kTrials, 1, positive_normal, [](const Numbers<T>& a) { return Numbers<T>{exponent(a[0]), mantissa(a[0])}; },
      [](const Numbers<R>& a) {
        int e = 0;
        const R m = std::frexp(a[0], &e);
        return Numbers<R>{R(e), m};
      });
}

TYPED_TEST(NumberContract, AnyAllNone) {
  using T = TypeParam;
  using R = real_t<T>;
  for (int bits = 0; bits < 1 << width_v<T>; ++bits) {
    T x(R(0));
    for (int k = 0; k < width_v<T>; ++k) set_lane(x, k, R(bits >> k & 1));
    const mask_t<T> m = x > T(R(0));
    ASSERT_EQ(any(m), bits != 0);
    ASSERT_EQ(none(m), bits == 0);
    ASSERT_EQ(all(m), bits == (1 << width_v<T>)-1);
    for (int k = 0; k < width_v<T>; ++k) ASSERT_EQ(lane(m, k), (bits >> k & 1) != 0);
  }
}

TYPED_TEST(NumberContract, MemoryAndLanes) {
  using T = TypeParam;
  using R = real_t<T>;
  constexpr std::size_t kWidth = width_v<T>;
  const std::vector<R>& table = special_values<R>();
  for (std::size_t offset = 0; offset + kWidth < table.size(); ++offset) {  // most offsets are not aligned
    const T loaded = load<T>(table.data() + offset);
    std::array<R, kWidth + 2> stored{};
    store(stored.data() + 1, loaded);
    std::array<std::int32_t, kWidth> index{};
    for (std::size_t k = 0; k < kWidth; ++k) index[k] = static_cast<std::int32_t>((offset + 7 * k) % table.size());
    const T gathered = gather<T>(table.data(), index.data());
    for (std::size_t k = 0; k < kWidth; ++k) {
      ASSERT_TRUE(same(lane(loaded, static_cast<int>(k)), table[offset + k]));
      ASSERT_TRUE(same(stored[k + 1], table[offset + k]));
      ASSERT_TRUE(same(lane(gathered, static_cast<int>(k)), table[static_cast<std::size_t>(index[k])]));
    }
    ASSERT_EQ(stored.front(), R(0));
    ASSERT_EQ(stored.back(), R(0));
  }
}

TYPED_TEST(NumberContract, SetLaneChangesOneLane) {
  using T = TypeParam;
  using R = real_t<T>;
  for (int changed = 0; changed < width_v<T>; ++changed) {
    T x(R(3));
    set_lane(x, changed, R(5));
    for (int k = 0; k < width_v<T>; ++k) ASSERT_EQ(lane(x, k), k == changed ? R(5) : R(3));
  }
}

TYPED_TEST(NumberContract, AUniformNumberFillsEveryLane) {
  using T = TypeParam;
  for (const real_t<T> x : special_values<real_t<T>>()) {
    const T filled(x);
    for (int k = 0; k < width_v<T>; ++k) ASSERT_TRUE(same(lane(filled, k), x));
  }
}

}  // namespace
}  // namespace manyhands::testing
