// Lanes<double, 4> with the whole arithmetic of the number contract: what lanes.h leaves to builtins, in doubles.
#pragma once

#include "manyhands/math/lanes.h"

namespace manyhands {

using DoubleLanes = Lanes<double, 4>;

namespace internal {

using DoubleBits = VectorOf<double, 4>::bits;
inline constexpr std::int64_t kMagnitudeBits = 0x7fffffffffffffff;

MANYHANDS_INLINE DoubleBits bits_of(DoubleLanes a) { return std::bit_cast<DoubleBits>(a.v); }
MANYHANDS_INLINE DoubleLanes with_bits(DoubleBits bits) {
  return DoubleLanes(std::bit_cast<DoubleLanes::Vector>(bits));
}

}  // namespace internal

MANYHANDS_INLINE DoubleLanes abs(DoubleLanes a) {
  return internal::with_bits(internal::bits_of(a) & internal::kMagnitudeBits);
}
MANYHANDS_INLINE DoubleLanes copysign(DoubleLanes magnitude, DoubleLanes sign) {
  return internal::with_bits((internal::bits_of(magnitude) & internal::kMagnitudeBits) |
                             (internal::bits_of(sign) & ~internal::kMagnitudeBits));
}

MANYHANDS_INLINE DoubleLanes fma(DoubleLanes a, DoubleLanes b, DoubleLanes c) {
#if defined(__FMA__) && !defined(__clang__)
  return DoubleLanes(__builtin_ia32_vfmaddpd256(a.v, b.v, c.v));
#else
  DoubleLanes r;
  for (int k = 0; k < 4; ++k) r.v[k] = __builtin_fma(a.v[k], b.v[k], c.v[k]);
  return r;
#endif
}
MANYHANDS_INLINE DoubleLanes sqrt(DoubleLanes a) {
#if defined(__AVX__) && !defined(__clang__)
  return DoubleLanes(__builtin_ia32_sqrtpd256(a.v));
#else
  DoubleLanes r;
  for (int k = 0; k < 4; ++k) r.v[k] = __builtin_sqrt(a.v[k]);
  return r;
#endif
}
MANYHANDS_INLINE DoubleLanes round(DoubleLanes a) {
#if defined(__AVX__) && !defined(__clang__)
  return DoubleLanes(__builtin_ia32_roundpd256(a.v, 4));
#else
  DoubleLanes r;
  for (int k = 0; k < 4; ++k) r.v[k] = __builtin_rint(a.v[k]);
  return r;
#endif
}
MANYHANDS_INLINE DoubleLanes floor(DoubleLanes a) {
#if defined(__AVX__) && !defined(__clang__)
  return DoubleLanes(__builtin_ia32_roundpd256(a.v, 1));
#else
  DoubleLanes r;
  for (int k = 0; k < 4; ++k) r.v[k] = __builtin_floor(a.v[k]);
  return r;
#endif
}

}  // namespace manyhands
