// Lanes<double, 4> with the whole arithmetic of the number contract: what lanes.h has for the bits of floats alone.
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

}  // namespace manyhands
