// The number contract: the operations that every number type of the physics offers, and their scalar form.
//
// Kernels are templates over `T`, which is `double`, `float` or `Lanes<float, W>` (W worlds in one register).
// What the model says is uniform: plain int, real_t<T>, if, switch, for. What depends on the state is varying: T,
// mask_t<T> and `select`. A lane mask has no conversion to bool, so a branch on a varying value does not compile.
// Every operation gives in lane k exactly the bits that the scalar of type real_t<T> gives (tests/math); only the sign
// and payload of a NaN are open.
#pragma once

#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>

#include "manyhands/base/macros.h"

namespace manyhands {

/// Traits of a number type: `real` is the uniform companion, `mask` the result of a comparison, `width` the lanes.
template <class T>
struct NumberTraits;

template <>
struct NumberTraits<double> {  ///< of double precision
  using real = double;
  using mask = bool;
  static constexpr int width = 1;
};

template <>
struct NumberTraits<float> {  ///< of single precision
  using real = float;
  using mask = bool;
  static constexpr int width = 1;
};

template <class T>
concept Number = requires { typename NumberTraits<T>::real; };

template <Number T>
using real_t = typename NumberTraits<T>::real;
template <Number T>
using mask_t = typename NumberTraits<T>::mask;
template <Number T>
inline constexpr int width_v = NumberTraits<T>::width;

template <class R>
concept Real = std::same_as<R, double> || std::same_as<R, float>;

/// A number of the code, rounded to the precision of T, in every lane.
template <Number T>
[[nodiscard]] MANYHANDS_INLINE T constant(double value) {
  return T(static_cast<real_t<T>>(value));
}

// ---- selection and order -------------------------------------------------------------------------------------

/// a where the mask holds, else b.
template <Real R>
MANYHANDS_INLINE R select(bool m, R a, R b) {
  return m ? a : b;
}

/// The smaller of a and b; b if either is not a number.
template <Real R>
MANYHANDS_INLINE R min(R a, R b) {
  return a < b ? a : b;
}

/// The larger of a and b; b if either is not a number.
template <Real R>
MANYHANDS_INLINE R max(R a, R b) {
  return a > b ? a : b;
}

template <Real R>
MANYHANDS_INLINE R abs(R a) {
  return std::fabs(a);
}

/// |magnitude| with the sign bit of `sign`.
template <Real R>
MANYHANDS_INLINE R copysign(R magnitude, R sign) {
  return std::copysign(magnitude, sign);
}

MANYHANDS_INLINE bool any(bool m) { return m; }
MANYHANDS_INLINE bool all(bool m) { return m; }
MANYHANDS_INLINE bool none(bool m) { return !m; }

// ---- arithmetic ------------------------------------------------------------------------------------------------

template <Real R>
MANYHANDS_INLINE R sqrt(R a) {
  return std::sqrt(a);
}

/// a * b + c with one rounding. Opaque, because GCC fuses a following negation in one place and not in another, and
/// -fma(a, b, c) and the fused -(a * b) - c differ in the sign of a zero.
template <Real R>
MANYHANDS_INLINE R fma(R a, R b, R c) {
  R r = std::fma(a, b, c);
  MANYHANDS_OPAQUE(r);
  return r;
}

/// The nearest whole number, ties to even.
template <Real R>
MANYHANDS_INLINE R round(R a) {
  return std::rint(a);
}

template <Real R>
MANYHANDS_INLINE R floor(R a) {
  return std::floor(a);
}

/// 2^n for a whole number n within the exponents of normal numbers.
MANYHANDS_INLINE float exp2_whole(float n) { return std::bit_cast<float>((static_cast<std::int32_t>(n) + 127) << 23); }
MANYHANDS_INLINE double exp2_whole(double n) {
  return std::bit_cast<double>((static_cast<std::int64_t>(n) + 1023) << 52);
}

/// The exponent e of a normal a > 0 such that a = m 2^e with m, the mantissa, in [0.5, 1).
MANYHANDS_INLINE float exponent(float a) {
  return static_cast<float>(((std::bit_cast<std::int32_t>(a) >> 23) & 0xff) - 126);
}
MANYHANDS_INLINE double exponent(double a) {
  return static_cast<double>(((std::bit_cast<std::int64_t>(a) >> 52) & 0x7ff) - 1022);
}

MANYHANDS_INLINE float mantissa(float a) {
  return std::bit_cast<float>((std::bit_cast<std::int32_t>(a) & 0x7fffff) | 0x3f000000);
}
MANYHANDS_INLINE double mantissa(double a) {
  return std::bit_cast<double>((std::bit_cast<std::int64_t>(a) & 0xfffffffffffff) | 0x3fe0000000000000);
}

// ---- memory and lanes --------------------------------------------------------------------------------------------

template <Number T>
MANYHANDS_INLINE T load(const real_t<T>* from)
  requires Real<T>
{
  return *from;
}

template <Real R>
MANYHANDS_INLINE void store(R* to, R a) {
  *to = a;
}

/// table[index] in each lane.
template <Number T>
MANYHANDS_INLINE T gather(const real_t<T>* table, const std::int32_t* index)
  requires Real<T>
{
  return table[*index];
}

/// The value in lane k.
template <Real R>
MANYHANDS_INLINE R lane(R a, int /*k*/) {
  return a;
}
MANYHANDS_INLINE bool lane(bool m, int /*k*/) { return m; }

template <Real R>
MANYHANDS_INLINE void set_lane(R& a, int /*k*/, R value) {
  a = value;
}

// ---- for every number type -----------------------------------------------------------------------------------------

/// a moved into [low, high]; NaN stays NaN.
template <Number T>
MANYHANDS_INLINE T clamp(T a, T low, T high) {
  return min(high, max(low, a));
}

/// Whether a is neither infinite nor NaN.
template <Number T>
MANYHANDS_INLINE mask_t<T> is_finite(T a) {
  return abs(a) <= T(std::numeric_limits<real_t<T>>::max());
}

template <Number T>
MANYHANDS_INLINE T square(T a) {
  return a * a;
}

}  // namespace manyhands
