// Elementary functions written on the number contract: the same bits as scalar, in lanes and on a device.
//
// Range reduction and polynomials follow S. Moshier, Methods and Programs for Mathematical Functions (Ellis Horwood,
// 1989), in both precisions. Worst errors measured by tests/math: about 2 units in the last place.
#pragma once

#include <array>
#include <numbers>

#include "manyhands/math/lanes.h"

namespace manyhands {

template <Number T>
struct SinCos {
  T sin, cos;
};

namespace internal {

/// Horner's rule, highest power first.
template <Number T, std::size_t N>
MANYHANDS_INLINE T polynomial(T x, const std::array<real_t<T>, N>& coefficients) {
  T y(coefficients[0]);
  for (std::size_t i = 1; i < N; ++i) y = fma(y, x, T(coefficients[i]));
  return y;
}

template <Real R>
struct TrigTable;

template <>
struct TrigTable<float> {
  // pi / 2 in three parts whose leading ones have few bits, so that n * part is exact.
  static constexpr std::array<float, 3> half_pi{1.5703125f, 4.837512969970703125e-4f, 7.54978995489188e-8f};
  static constexpr std::array<float, 3> sin{-1.9515295891e-4f, 8.3321608736e-3f, -1.6666654611e-1f};
  static constexpr std::array<float, 3> cos{2.443315711809948e-5f, -1.388731625493765e-3f, 4.166664568298827e-2f};
};

template <>
struct TrigTable<double> {
  static constexpr std::array<double, 3> half_pi{1.57079625129699707031e0, 7.54978941586159635335e-8,
                                                 5.39030285815811905290e-15};
  static constexpr std::array<double, 6> sin{1.58962301576546568060e-10, -2.50507477628578072866e-8,
                                             2.75573136213857245213e-6,  -1.98412698295895385996e-4,
                                             8.33333333332211858878e-3,  -1.66666666666666307295e-1};
  static constexpr std::array<double, 6> cos{-1.13585365213876817300e-11, 2.08757008419747316778e-9,
                                             -2.75573141792967388112e-7,  2.48015872888517045348e-5,
                                             -1.38888888888730564116e-3,  4.16666666666665929218e-2};
};

}  // namespace internal

/// sin and cos of x [rad], for |x| up to about 1e4 (float) and 1e8 (double); beyond, the reduction loses digits.
template <Number T>
MANYHANDS_INLINE SinCos<T> sincos(T x) {
  using R = real_t<T>;
  using Table = internal::TrigTable<R>;
  const T n = round(x * T(R(2.0 * std::numbers::inv_pi)));
  T r = fma(n, T(-Table::half_pi[0]), x);
  r = fma(n, T(-Table::half_pi[1]), r);
  r = fma(n, T(-Table::half_pi[2]), r);
  const T z = r * r;
  const T s = fma(internal::polynomial(z, Table::sin) * z, r, r);
  const T c = fma(internal::polynomial(z, Table::cos) * z, z, fma(T(R(-0.5)), z, T(R(1))));
  const T quadrant = n - T(R(4)) * floor(n * T(R(0.25)));
  const auto odd = (quadrant == T(R(1))) | (quadrant == T(R(3)));
  const auto sin_negative = quadrant >= T(R(2));
  const auto cos_negative = (quadrant == T(R(1))) | (quadrant == T(R(2)));
  const T sin_value = select(odd, c, s);
  const T cos_value = select(odd, s, c);
  return {select(sin_negative, -sin_value, sin_value), select(cos_negative, -cos_value, cos_value)};
}

namespace internal {

/// atan of x in [0, inf).
template <Number T>
MANYHANDS_INLINE T atan_positive(T x) {
  using R = real_t<T>;
  constexpr bool kSingle = std::same_as<R, float>;
  const auto large = x > T(R(2.41421356237309504880));                                // tan(3 pi / 8)
  const auto middle = x > T(kSingle ? R(0.414213562373095048802) : R(0.66));         // tan(pi / 8)
  const T numerator = select(large, T(R(-1)), select(middle, x - T(R(1)), x));
  const T denominator = select(large, x, select(middle, x + T(R(1)), T(R(1))));
  const T base = select(large, T(R(std::numbers::pi / 2)), select(middle, T(R(std::numbers::pi / 4)), T(R(0))));
  const T low = select(large, T(R(6.123233995736765886130e-17)),
                       select(middle, T(R(3.061616997868382943065e-17)), T(R(0))));
  const T r = numerator / denominator;
  const T z = r * r;
  if constexpr (kSingle) {
    constexpr std::array<float, 4> p{8.05374449538e-2f, -1.38776856032e-1f, 1.99777106478e-1f, -3.33329491539e-1f};
    return base + fma(polynomial(z, p) * z, r, r);
  } else {
    constexpr std::array<double, 5> p{-8.750608600031904122785e-1, -1.615753718733365076637e1,
                                      -7.500855792314704667340e1, -1.228866684490136173410e2,
                                      -6.485021904942025371773e1};
    constexpr std::array<double, 6> q{1.0,
                                      2.485846490142306297962e1,
                                      1.650270098316988542046e2,
                                      4.328810604912902668951e2,
                                      4.853903996359136964868e2,
                                      1.945506571482613964425e2};
    return base + (fma(z * polynomial(z, p) / polynomial(z, q), r, r) + low);
  }
}

}  // namespace internal

/// The angle of (x, y) in [-pi, pi]; 0 for (0, 0). The sign of a zero y chooses the side of the cut.
template <Number T>
MANYHANDS_INLINE T atan2(T y, T x) {
  using R = real_t<T>;
  const T ax = abs(x), ay = abs(y);
  const T denominator = select(ax == T(R(0)), T(std::numeric_limits<R>::min()), ax);
  const T first = internal::atan_positive(ay / denominator);
  const T upper = select(x < T(R(0)), T(R(std::numbers::pi)) - first, first);
  return copysign(upper, y);
}

/// e^x; 0 below about -87 (float) or -708 (double), and the largest power above as many.
template <Number T>
MANYHANDS_INLINE T exp(T x) {
  using R = real_t<T>;
  constexpr bool kSingle = std::same_as<R, float>;
  const T limit(kSingle ? R(87.3) : R(708.3));
  const auto vanishes = x < -limit;
  const T y = clamp(x, -limit, limit);
  const T n = round(y * T(R(std::numbers::log2e)));
  if constexpr (kSingle) {
    T r = fma(n, T(-0.693359375f), y);
    r = fma(n, T(2.12194440e-4f), r);
    constexpr std::array<float, 6> p{1.9875691500e-4f, 1.3981999507e-3f, 8.3334519073e-3f,
                                     4.1665795894e-2f, 1.6666665459e-1f, 5.0000001201e-1f};
    const T power = (fma(internal::polynomial(r, p), r * r, r) + T(1.0f)) * exp2_whole(n);
    return select(vanishes, T(0.0f), power);
  } else {
    T r = fma(n, T(-6.93145751953125e-1), y);
    r = fma(n, T(-1.42860682030941723212e-6), r);
    const T z = r * r;
    constexpr std::array<double, 3> p{1.26177193074810590878e-4, 3.02994407707441961300e-2, 9.99999999999999999910e-1};
    constexpr std::array<double, 4> q{3.00198505138664455042e-6, 2.52448340349684104192e-3, 2.27265548208155028766e-1,
                                      2.00000000000000000005e0};
    const T half = r * internal::polynomial(z, p);
    const T power = fma(T(2.0), half / (internal::polynomial(z, q) - half), T(1.0)) * exp2_whole(n);
    return select(vanishes, T(0.0), power);
  }
}

/// The natural logarithm of a normal x > 0.
template <Number T>
MANYHANDS_INLINE T log(T x) {
  using R = real_t<T>;
  T e = exponent(x);
  T m = x * exp2_whole(-e);
  const auto small = m < T(R(std::numbers::sqrt2 / 2));
  e = select(small, e - T(R(1)), e);
  m = select(small, m + m, m) - T(R(1));
  const T z = m * m;
  if constexpr (std::same_as<R, float>) {
    constexpr std::array<float, 9> p{7.0376836292e-2f, -1.1514610310e-1f, 1.1676998740e-1f,
                                     -1.2420140846e-1f, 1.4249322787e-1f, -1.6668057665e-1f,
                                     2.0000714765e-1f, -2.4999993993e-1f, 3.3333331174e-1f};
    T y = m * z * internal::polynomial(m, p);
    y = fma(e, T(-2.12194440e-4f), y);
    y = fma(T(-0.5f), z, y);
    return fma(e, T(0.693359375f), m + y);
  } else {
    constexpr std::array<double, 6> p{1.01875663804580931796e-4, 4.97494994976747001425e-1, 4.70579119878881725854e0,
                                      1.44989225341610930846e1,  1.79368678507819816313e1,  7.70838733755885391666e0};
    constexpr std::array<double, 6> q{1.0,
                                      1.12873587189167450590e1,
                                      4.52279145837532221105e1,
                                      8.29875266912776603211e1,
                                      7.11544750618563894466e1,
                                      2.31251620126765340583e1};
    T y = m * (z * internal::polynomial(m, p) / internal::polynomial(m, q));
    y = fma(e, T(-2.121944400546905827679e-4), y);
    y = fma(T(-0.5), z, y);
    return fma(e, T(0.693359375), m + y);
  }
}

}  // namespace manyhands
