// The vector operations for which a loop over lanes is not reliably one instruction: GCC 12 takes some of them apart.
//
// Each is a loop over the lanes, the definition, and beside it the compiler's builtin for that very instruction. No
// intrinsics header: GCC 12's raises false alarms about uninitialised values (GCC bug 105593).
#pragma once

#include <cmath>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "manyhands/base/macros.h"

namespace manyhands::internal {

template <class Vector>
using Element = std::remove_cvref_t<decltype(std::declval<Vector&>()[0])>;
template <class Vector>
inline constexpr int kLanes = sizeof(Vector) / sizeof(Element<Vector>);
template <class Vector>
inline constexpr int kFloats = std::is_same_v<Element<Vector>, float> ? kLanes<Vector> : 0;
template <class Vector>
inline constexpr int kDoubles = std::is_same_v<Element<Vector>, double> ? kLanes<Vector> : 0;

#if defined(__clang__)

template <class Vector>
MANYHANDS_INLINE Vector vector_fma(Vector a, Vector b, Vector c) {
  return __builtin_elementwise_fma(a, b, c);
}
template <class Vector>
MANYHANDS_INLINE Vector vector_sqrt(Vector a) {
  return __builtin_elementwise_sqrt(a);
}
template <class Vector>
MANYHANDS_INLINE Vector vector_round(Vector a) {
  return __builtin_elementwise_rint(a);
}
template <class Vector>
MANYHANDS_INLINE Vector vector_floor(Vector a) {
  return __builtin_elementwise_floor(a);
}

#else

template <class Vector>
MANYHANDS_INLINE Vector vector_fma(Vector a, Vector b, Vector c) {
#if defined(__AVX512F__)
  if constexpr (kFloats<Vector> == 16) return __builtin_ia32_vfmaddps512_mask(a, b, c, -1, 4);
#endif
#if defined(__FMA__)
  if constexpr (kDoubles<Vector> == 4) return __builtin_ia32_vfmaddpd256(a, b, c);
  if constexpr (kFloats<Vector> == 8) return __builtin_ia32_vfmaddps256(a, b, c);
  if constexpr (kFloats<Vector> == 4) return __builtin_ia32_vfmaddps(a, b, c);
#endif
  Vector r;
  for (int k = 0; k < kLanes<Vector>; ++k) r[k] = std::fma(a[k], b[k], c[k]);
  return r;
}

template <class Vector>
MANYHANDS_INLINE Vector vector_sqrt(Vector a) {
#if defined(__AVX512F__)
  if constexpr (kFloats<Vector> == 16) return __builtin_ia32_sqrtps512_mask(a, a, -1, 4);
#endif
#if defined(__AVX__)
  if constexpr (kDoubles<Vector> == 4) return __builtin_ia32_sqrtpd256(a);
  if constexpr (kFloats<Vector> == 8) return __builtin_ia32_sqrtps256(a);
  if constexpr (kFloats<Vector> == 4) return __builtin_ia32_sqrtps(a);
#endif
  Vector r;
  for (int k = 0; k < kLanes<Vector>; ++k) r[k] = std::sqrt(a[k]);
  return r;
}

template <class Vector>
MANYHANDS_INLINE Vector vector_round(Vector a) {
#if defined(__AVX512F__)
  if constexpr (kFloats<Vector> == 16) return __builtin_ia32_rndscaleps_mask(a, 4, a, -1, 4);
#endif
#if defined(__AVX__)
  if constexpr (kDoubles<Vector> == 4) return __builtin_ia32_roundpd256(a, 4);
  if constexpr (kFloats<Vector> == 8) return __builtin_ia32_roundps256(a, 4);
  if constexpr (kFloats<Vector> == 4) return __builtin_ia32_roundps(a, 4);
#endif
  Vector r;
  for (int k = 0; k < kLanes<Vector>; ++k) r[k] = std::rint(a[k]);
  return r;
}

template <class Vector>
MANYHANDS_INLINE Vector vector_floor(Vector a) {
#if defined(__AVX512F__)
  if constexpr (kFloats<Vector> == 16) return __builtin_ia32_rndscaleps_mask(a, 1, a, -1, 4);
#endif
#if defined(__AVX__)
  if constexpr (kDoubles<Vector> == 4) return __builtin_ia32_roundpd256(a, 1);
  if constexpr (kFloats<Vector> == 8) return __builtin_ia32_roundps256(a, 1);
  if constexpr (kFloats<Vector> == 4) return __builtin_ia32_roundps(a, 1);
#endif
  Vector r;
  for (int k = 0; k < kLanes<Vector>; ++k) r[k] = std::floor(a[k]);
  return r;
}

#endif

/// Whether any bit of a lane mask is set.
template <class Bits>
MANYHANDS_INLINE bool vector_any(Bits bits) {
#if defined(__AVX512F__) && !defined(__clang__)
  if constexpr (kLanes<Bits> == 16) return __builtin_ia32_ptestmd512(bits, bits, -1) != 0;
#endif
#if defined(__AVX__) && !defined(__clang__)
  if constexpr (kLanes<Bits> == 8) {
    using Real __attribute__((vector_size(32))) = float;
    return __builtin_ia32_movmskps256(reinterpret_cast<Real>(bits)) != 0;
  }
  if constexpr (kLanes<Bits> == 4) {
    using Real __attribute__((vector_size(16))) = float;
    return __builtin_ia32_movmskps(reinterpret_cast<Real>(bits)) != 0;
  }
#endif
  std::int32_t r = 0;
  for (int k = 0; k < kLanes<Bits>; ++k) r |= bits[k];
  return r != 0;
}

}  // namespace manyhands::internal
