// Elementary functions written on the number contract: the same bits as scalar, in lanes and on a device.
//
// Range reduction and polynomials follow S. Moshier, Methods and Programs for Mathematical Functions (Ellis Horwood,
// 1989), in both precisions. Worst errors that tests/math allows, in units in the last place (measured in brackets):
// sincos 1.6 (1.55 to |x| = 1e4), atan2 2.7 (2.58 float, 1.48 double), exp 1.7 (1.01, 1.63), log 1 (0.82, 0.90).
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

/// pi / 2 as a sum of three numbers, pi / 4 as one of two, and the polynomials of sin and cos on [-pi / 4, pi / 4].
template <Real R>
struct TrigTable;

template <>
struct TrigTable<float> {
  static constexpr std::array<float, 3> half_pi{0x1.921fb6p+0f, -0x1.777a5cp-25f, -0x1.ee59dap-50f};
  static constexpr std::array<float, 2> quarter_pi{0x1.921fb6p-1f, -0x1.777a5cp-26f};
  static constexpr std::array<float, 3> sin{-1.9515295891e-4f, 8.3321608736e-3f, -1.6666654611e-1f};
  static constexpr std::array<float, 3> cos{2.443315711809948e-5f, -1.388731625493765e-3f, 4.166664568298827e-2f};
};

template <>
struct TrigTable<double> {
  static constexpr std::array<double, 3> half_pi{0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54, -0x1.f1976b7ed8fbcp-110};
  static constexpr std::array<double, 2> quarter_pi{0x1.921fb54442d18p-1, 0x1.1a8p-55};  // 64 bits between them
  static constexpr std::array<double, 6> sin{1.58962301576546568060e-10, -2.50507477628578072866e-8,
                                             2.75573136213857245213e-6,  -1.98412698295895385996e-4,
                                             8.33333333332211858878e-3,  -1.66666666666666307295e-1};
  static constexpr std::array<double, 6> cos{-1.13585365213876817300e-11, 2.08757008419747316778e-9,
                                             -2.75573141792967388112e-7,  2.48015872888517045348e-5,
                                             -1.38888888888730564116e-3,  4.16666666666665929218e-2};
};

}  // namespace internal

/// sin and cos of x [rad]. The reduction keeps all digits for |x| up to about 1e4 (float) and 1e8 (double); beyond, it
/// loses them, but sin^2 + cos^2 = 1 still holds. The sine of either zero is +0; infinities and NaN give NaN.
template <Number T>
MANYHANDS_INLINE SinCos<T> sincos(T x) {
  using R = real_t<T>;
  using Table = internal::TrigTable<R>;
  const T n = round(x * T(R(2.0 * std::numbers::inv_pi)));
  T r = fma(n, T(-Table::half_pi[0]), x);  // exact: a multiple of half_pi[0]'s last bit, below 1
  r = fma(n, T(-Table::half_pi[1]), r);
  r = clamp(fma(n, T(-Table::half_pi[2]), r), T(R(-0.8)), T(R(0.8)));
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

/// atan of x in [-tan(pi / 8), tan(pi / 8)] (float) or [-0.66, 0.66] (double).
template <Number T>
MANYHANDS_INLINE T atan_small(T x) {
  const T z = x * x;
  if constexpr (std::same_as<real_t<T>, float>) {
    constexpr std::array<float, 4> p{8.05374449538e-2f, -1.38776856032e-1f, 1.99777106478e-1f, -3.33329491539e-1f};
    return fma(polynomial(z, p) * z, x, x);
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
    return fma(z * polynomial(z, p) / polynomial(z, q), x, x);
  }
}

}  // namespace internal

/// The angle of (x, y) in [-pi, pi], with the special values of C's atan2 (ISO C annex F.10.1.4): the sign of a zero y
/// chooses the side of the cut, a zero x counts by its sign, and infinities stand for equal lengths.
template <Number T>
MANYHANDS_INLINE T atan2(T y, T x) {
  using R = real_t<T>;
  const T zero(R(0)), one(R(1)), two(R(2)), four(R(4));
  const T ax = abs(x), ay = abs(y);
  const auto steep = ay > ax;
  const T low = select(steep, ax, ay), high = select(steep, ay, ax);
  const T ratio = select(low == high, select(high == zero, zero, one), low / high);
  const auto diagonal = ratio > T(std::same_as<R, float> ? R(0.414213562373095048802) : R(0.66));
  const T r = internal::atan_small(select(diagonal, (ratio - one) / (ratio + one), ratio));
  // The angle is sign r + eighths pi / 4, reflected first at the diagonal, then at the y axis.
  const auto behind = copysign(one, x) < zero;
  T eighths = select(diagonal, one, zero);
  eighths = select(steep, two - eighths, eighths);
  eighths = select(behind, four - eighths, eighths);
  const T signed_r = select(steep ^ behind, -r, r);
  constexpr std::array quarter_pi = internal::TrigTable<R>::quarter_pi;
  return copysign(fma(eighths, T(quarter_pi[0]), fma(eighths, T(quarter_pi[1]), signed_r)), y);
}

/// e^x over all of x: denormal and then 0 to the left, infinity to the right, NaN for NaN.
template <Number T>
MANYHANDS_INLINE T exp(T x) {
  using R = real_t<T>;
  constexpr bool kSingle = std::same_as<R, float>;
  const T y = min(max(x, T(kSingle ? R(-104) : R(-746))), T(kSingle ? R(89) : R(710)));  // beyond: 0 and infinity
  const T n = round(y * T(R(std::numbers::log2e)));
  T power;
  if constexpr (kSingle) {
    T r = fma(n, T(-0.693359375f), y);
    r = fma(n, T(2.12194440e-4f), r);
    constexpr std::array<float, 6> p{1.9875691500e-4f, 1.3981999507e-3f, 8.3334519073e-3f,
                                     4.1665795894e-2f, 1.6666665459e-1f, 5.0000001201e-1f};
    power = fma(internal::polynomial(r, p), r * r, r) + T(1.0f);
  } else {
    T r = fma(n, T(-6.93145751953125e-1), y);
    r = fma(n, T(-1.42860682030941723212e-6), r);
    const T z = r * r;
    constexpr std::array<double, 3> p{1.26177193074810590878e-4, 3.02994407707441961300e-2, 9.99999999999999999910e-1};
    constexpr std::array<double, 4> q{3.00198505138664455042e-6, 2.52448340349684104192e-3, 2.27265548208155028766e-1,
                                      2.00000000000000000009e0};
    const T half = r * internal::polynomial(z, p);
    power = fma(T(2.0), half / (internal::polynomial(z, q) - half), T(1.0));
  }
  const T half_n = floor(n * T(R(0.5)));  // 2^n may be no normal number, its two factors are
  return select(x == x, power * exp2_whole(half_n) * exp2_whole(n - half_n), x);  // NOLINT: false of NaN
}

namespace internal {

/// log(1 + m) + e log(2), for 1 + m in [sqrt(1 / 2), sqrt(2)].
template <Number T>
MANYHANDS_INLINE T log_reduced(T m, T e) {
  const T z = m * m;
  if constexpr (std::same_as<real_t<T>, float>) {
    constexpr std::array<float, 9> p{7.0376836292e-2f,  -1.1514610310e-1f, 1.1676998740e-1f,
                                     -1.2420140846e-1f, 1.4249322787e-1f,  -1.6668057665e-1f,
                                     2.0000714765e-1f,  -2.4999993993e-1f, 3.3333331174e-1f};
    T y = m * z * polynomial(m, p);
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
    T y = m * (z * polynomial(m, p) / polynomial(m, q));
    y = fma(e, T(-2.121944400546905827679e-4), y);
    y = fma(T(-0.5), z, y);
    return fma(e, T(0.693359375), m + y);
  }
}

}  // namespace internal

/// The natural logarithm of x: -infinity of a zero, NaN of a negative x, denormals like any other number.
template <Number T>
MANYHANDS_INLINE T log(T x) {
  using R = real_t<T>;
  using Limits = std::numeric_limits<R>;
  const auto denormal = x < T(Limits::min());
  const T normal = select(denormal, x * exp2_whole(T(R(Limits::digits))), x);
  T e = exponent(normal) - select(denormal, T(R(Limits::digits)), T(R(0)));
  T m = mantissa(normal);
  const auto small = m < T(R(std::numbers::sqrt2 / 2));
  e = select(small, e - T(R(1)), e);
  m = select(small, m + m, m) - T(R(1));
  const T zero(R(0)), infinity(Limits::infinity());
  const T special = select(x == zero, -infinity, select(x == infinity, infinity, T(Limits::quiet_NaN())));
  return select((x > zero) & (x < infinity), internal::log_reduced(m, e), special);
}

}  // namespace manyhands
