// What the tests of the number contract share: hard inputs, and the comparison of every lane with the scalar.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "manyhands/math/lanes.h"

namespace manyhands::testing {

using NumberTypes = ::testing::Types<double, float, Lanes<float, 4>, Lanes<float, 8>, Lanes<float, 16>>;
using LaneTypes = ::testing::Types<Lanes<float, 4>, Lanes<float, 8>, Lanes<float, 16>>;
using RealTypes = ::testing::Types<float, double>;

/// Equal bits; any NaN equals any NaN, and +0 differs from -0.
template <Real R>
bool same(R a, R b) {
  if (std::isnan(a) || std::isnan(b)) return std::isnan(a) && std::isnan(b);
  return a == b && std::signbit(a) == std::signbit(b);
}

template <Real R>
const std::vector<R>& special_values() {
  using L = std::numeric_limits<R>;
  static const std::vector<R> values = [] {
    std::vector<R> v;
    for (const R x : {R(0),
                      L::denorm_min(),
                      R(37) * L::denorm_min(),
                      L::min(),
                      std::nextafter(L::min(), R(0)),
                      L::epsilon(),
                      R(0.25),
                      R(0.5),
                      R(0.75),
                      R(1),
                      std::nextafter(R(1), R(2)),
                      R(1.5),
                      R(2),
                      R(2.5),
                      R(3.14159265358979323846),
                      R(1e4),
                      R(87.5),
                      R(89),
                      R(104),
                      R(1) / L::epsilon(),
                      R(1.5) / L::epsilon(),
                      R(1e30),
                      R(0.5) * L::max(),
                      L::max(),
                      L::infinity(),
                      L::quiet_NaN()}) {
      v.push_back(x);
      v.push_back(-x);
    }
    return v;
  }();
  return values;
}

/// Random numbers of every kind: special, of any bit pattern, and of everyday size.
template <Real R>
class HardNumbers {
 public:
  R operator()() {
    const std::uint64_t bits = engine_();
    switch (bits % 3) {
      case 0:
        return special_values<R>()[(bits >> 8) % special_values<R>().size()];
      case 1:
        if constexpr (std::same_as<R, float>) {
          return std::bit_cast<float>(static_cast<std::uint32_t>(bits >> 32));
        } else {
          return std::bit_cast<double>(engine_());
        }
      default:
        return std::uniform_real_distribution<R>(-10, 10)(engine_);
    }
  }

 private:
  std::mt19937_64 engine_{20};
};

/// Random numbers in [low, high].
template <Real R>
class Uniform {
 public:
  Uniform(R low, R high) : distribution_(low, high) {}
  R operator()() { return distribution_(engine_); }

 private:
  std::mt19937_64 engine_{21};
  std::uniform_real_distribution<R> distribution_;
};

template <Number T>
using Numbers = std::vector<T>;

/// A mask as a number, 1 or 0 in each lane.
template <Number T>
T as_number(mask_t<T> m) {
  return select(m, T(real_t<T>(1)), T(real_t<T>(0)));
}

/// Fills `arity` numbers lane by lane from `draw`, and checks that lane k of `function(inputs)` holds the bits of
/// `expected(inputs of lane k)`. Both map a vector of numbers to a vector of numbers.
template <Number T, class Draw, class Function, class Expected>
void expect_lanes(int trials, std::size_t arity, Draw draw, Function function, Expected expected) {
  using R = real_t<T>;
  for (int trial = 0; trial < trials; ++trial) {
    Numbers<T> in(arity);
    std::array<Numbers<R>, width_v<T>> lanes;
    for (std::size_t k = 0; k < lanes.size(); ++k) {
      lanes[k].resize(arity);
      for (std::size_t i = 0; i < arity; ++i) {
        lanes[k][i] = draw();
        set_lane(in[i], static_cast<int>(k), lanes[k][i]);
      }
    }
    const Numbers<T> out = function(in);
    for (std::size_t k = 0; k < lanes.size(); ++k) {
      const Numbers<R> want = expected(lanes[k]);
      ASSERT_EQ(out.size(), want.size());
      for (std::size_t i = 0; i < out.size(); ++i) {
        const R got = lane(out[i], static_cast<int>(k));
        ASSERT_TRUE(same(got, want[i])) << "output " << i << " in lane " << k << ": " << got << ", expected " << want[i]
                                        << ", inputs " << ::testing::PrintToString(lanes[k]);
      }
    }
  }
}

}  // namespace manyhands::testing
