// Lanes<float, W>: W worlds in one SIMD register, on the compiler's vector extension (no intrinsics). Lanes<double, 4>,
// with which tables are searched, has what needs no builtin: arithmetic, comparisons and load.
#pragma once

#include <cstring>

#include "manyhands/math/number.h"
#include "manyhands/math/vector_builtins.h"

namespace manyhands {

// A vector_size that depends on a template parameter confuses GCC's overload resolution, hence the explicit list.
template <class R, int W>
struct VectorOf;
template <>
struct VectorOf<float, 4> {
  using real __attribute__((vector_size(16))) = float;
  using bits __attribute__((vector_size(16))) = std::int32_t;
};
template <>
struct VectorOf<float, 8> {
  using real __attribute__((vector_size(32))) = float;
  using bits __attribute__((vector_size(32))) = std::int32_t;
};
template <>
struct VectorOf<float, 16> {
  using real __attribute__((vector_size(64))) = float;
  using bits __attribute__((vector_size(64))) = std::int32_t;
};
template <>
struct VectorOf<double, 4> {
  using real __attribute__((vector_size(32))) = double;
  using bits __attribute__((vector_size(32))) = std::int64_t;
};

/// One truth value per lane: all bits set or none. Deliberately without a conversion to bool: use any, all, none.
template <class R, int W>
struct LaneMask {
  using Bits = typename VectorOf<R, W>::bits;
  Bits bits;

  LaneMask() = default;
  MANYHANDS_INLINE explicit LaneMask(Bits b) : bits(b) {}
  MANYHANDS_INLINE LaneMask(bool b) : bits(Bits{} - (b ? 1 : 0)) {}  // NOLINT: uniform truth is a mask
  explicit operator bool() const = delete;

  friend MANYHANDS_INLINE LaneMask operator&(LaneMask a, LaneMask b) { return LaneMask(a.bits & b.bits); }
  friend MANYHANDS_INLINE LaneMask operator|(LaneMask a, LaneMask b) { return LaneMask(a.bits | b.bits); }
  friend MANYHANDS_INLINE LaneMask operator^(LaneMask a, LaneMask b) { return LaneMask(a.bits ^ b.bits); }
  friend MANYHANDS_INLINE LaneMask operator!(LaneMask a) { return LaneMask(~a.bits); }
};

template <class R, int W>
struct Lanes {  ///< W numbers in one SIMD register
  using Vector = typename VectorOf<R, W>::real;
  using Bits = typename VectorOf<R, W>::bits;
  using Mask = LaneMask<R, W>;
  Vector v;

  Lanes() = default;
  MANYHANDS_INLINE explicit Lanes(Vector x) : v(x) {}
  MANYHANDS_INLINE Lanes(R x) : v(x - Vector{}) {}  // NOLINT: a uniform number is the same in every lane

  friend MANYHANDS_INLINE Lanes operator+(Lanes a, Lanes b) { return Lanes(a.v + b.v); }
  friend MANYHANDS_INLINE Lanes operator-(Lanes a, Lanes b) { return Lanes(a.v - b.v); }
  friend MANYHANDS_INLINE Lanes operator*(Lanes a, Lanes b) { return Lanes(a.v * b.v); }
  friend MANYHANDS_INLINE Lanes operator/(Lanes a, Lanes b) { return Lanes(a.v / b.v); }
  friend MANYHANDS_INLINE Lanes operator-(Lanes a) { return Lanes(-a.v); }
  MANYHANDS_INLINE Lanes& operator+=(Lanes b) { return *this = *this + b; }
  MANYHANDS_INLINE Lanes& operator-=(Lanes b) { return *this = *this - b; }
  MANYHANDS_INLINE Lanes& operator*=(Lanes b) { return *this = *this * b; }
  MANYHANDS_INLINE Lanes& operator/=(Lanes b) { return *this = *this / b; }

  friend MANYHANDS_INLINE Mask operator<(Lanes a, Lanes b) { return Mask(a.v < b.v); }
  friend MANYHANDS_INLINE Mask operator<=(Lanes a, Lanes b) { return Mask(a.v <= b.v); }
  friend MANYHANDS_INLINE Mask operator>(Lanes a, Lanes b) { return Mask(a.v > b.v); }
  friend MANYHANDS_INLINE Mask operator>=(Lanes a, Lanes b) { return Mask(a.v >= b.v); }
  friend MANYHANDS_INLINE Mask operator==(Lanes a, Lanes b) { return Mask(a.v == b.v); }
  friend MANYHANDS_INLINE Mask operator!=(Lanes a, Lanes b) { return Mask(a.v != b.v); }
};

template <class R, int W>
struct NumberTraits<Lanes<R, W>> {  ///< of lanes
  using real = R;
  using mask = LaneMask<R, W>;
  static constexpr int width = W;
};

template <class T>
concept LaneNumber = Number<T> && (width_v<T> > 1);

// ---- the contract's operations ---------------------------------------------------------------------------------

template <class R, int W>
MANYHANDS_INLINE Lanes<R, W> select(LaneMask<R, W> m, Lanes<R, W> a, Lanes<R, W> b) {
  return Lanes<R, W>(m.bits ? a.v : b.v);
}
template <class R, int W>
MANYHANDS_INLINE Lanes<R, W> min(Lanes<R, W> a, Lanes<R, W> b) {
  return Lanes<R, W>(a.v < b.v ? a.v : b.v);
}
template <class R, int W>
MANYHANDS_INLINE Lanes<R, W> max(Lanes<R, W> a, Lanes<R, W> b) {
  return Lanes<R, W>(a.v > b.v ? a.v : b.v);
}

template <int W>
MANYHANDS_INLINE Lanes<float, W> with_bits(typename VectorOf<float, W>::bits bits) {
  return Lanes<float, W>(std::bit_cast<typename VectorOf<float, W>::real>(bits));
}
template <int W>
MANYHANDS_INLINE auto bits_of(Lanes<float, W> a) {
  return std::bit_cast<typename VectorOf<float, W>::bits>(a.v);
}

template <int W>
MANYHANDS_INLINE Lanes<float, W> abs(Lanes<float, W> a) {
  return with_bits<W>(bits_of(a) & 0x7fffffff);
}
template <int W>
MANYHANDS_INLINE Lanes<float, W> copysign(Lanes<float, W> magnitude, Lanes<float, W> sign) {
  return with_bits<W>((bits_of(magnitude) & 0x7fffffff) | (bits_of(sign) & ~0x7fffffff));
}
template <class R, int W>
MANYHANDS_INLINE Lanes<R, W> sqrt(Lanes<R, W> a) {
  return Lanes<R, W>(internal::vector_sqrt(a.v));
}
template <class R, int W>
MANYHANDS_INLINE Lanes<R, W> fma(Lanes<R, W> a, Lanes<R, W> b, Lanes<R, W> c) {
  return Lanes<R, W>(internal::vector_fma(a.v, b.v, c.v));
}
template <class R, int W>
MANYHANDS_INLINE Lanes<R, W> round(Lanes<R, W> a) {
  return Lanes<R, W>(internal::vector_round(a.v));
}
template <class R, int W>
MANYHANDS_INLINE Lanes<R, W> floor(Lanes<R, W> a) {
  return Lanes<R, W>(internal::vector_floor(a.v));
}
template <int W>
MANYHANDS_INLINE Lanes<float, W> exp2_whole(Lanes<float, W> n) {
  using Bits = typename VectorOf<float, W>::bits;
  return with_bits<W>((__builtin_convertvector(n.v, Bits) + 127) << 23);
}
template <int W>
MANYHANDS_INLINE Lanes<float, W> exponent(Lanes<float, W> a) {
  using Vector = typename VectorOf<float, W>::real;
  return Lanes<float, W>(__builtin_convertvector(((bits_of(a) >> 23) & 0xff) - 126, Vector));
}
template <int W>
MANYHANDS_INLINE Lanes<float, W> mantissa(Lanes<float, W> a) {
  return with_bits<W>((bits_of(a) & 0x7fffff) | 0x3f000000);
}

template <class R, int W>
MANYHANDS_INLINE bool any(LaneMask<R, W> m) {
  return internal::vector_any(std::bit_cast<typename VectorOf<float, sizeof(m.bits) / sizeof(float)>::bits>(m.bits));
}
template <class R, int W>
MANYHANDS_INLINE bool none(LaneMask<R, W> m) {
  return !any(m);
}
template <class R, int W>
MANYHANDS_INLINE bool all(LaneMask<R, W> m) {
  return none(!m);
}

// ---- memory and lanes ------------------------------------------------------------------------------------------

/// W consecutive numbers, at any alignment.
template <LaneNumber T>
MANYHANDS_INLINE T load(const real_t<T>* from) {
  T r;
  std::memcpy(&r.v, from, sizeof(r.v));
  return r;
}
template <class R, int W>
MANYHANDS_INLINE void store(R* to, Lanes<R, W> a) {
  std::memcpy(to, &a.v, sizeof(a.v));
}
template <LaneNumber T>
MANYHANDS_INLINE T gather(const real_t<T>* table, const std::int32_t* index) {
  T r;
  for (int k = 0; k < width_v<T>; ++k) r.v[k] = table[index[k]];
  return r;
}
template <class R, int W>
MANYHANDS_INLINE R lane(Lanes<R, W> a, int k) {
  return a.v[k];
}
template <class R, int W>
MANYHANDS_INLINE bool lane(LaneMask<R, W> m, int k) {
  return m.bits[k] != 0;
}
template <class R, int W>
MANYHANDS_INLINE void set_lane(Lanes<R, W>& a, int k, R value) {
  a.v[k] = value;
}

}  // namespace manyhands
