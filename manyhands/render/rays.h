// Rays in lanes: the number type of pictures.
#pragma once

#include "manyhands/math/instantiate.h"
#include "manyhands/math/vec3.h"

namespace manyhands {

/// Eight rays. The same width on every machine, as a picture must not depend on it.
using Rays = Lanes8;
using RayMask = Rays::Mask;
using RayInts = Rays::Bits;

inline constexpr int kRays = width_v<Rays>;

MANYHANDS_INLINE RayInts select(RayMask m, RayInts a, RayInts b) { return m.bits ? a : b; }

/// Which of its lanes hold a ray, and what it may meet: distances are multiples of the direction's length.
struct RayPacket {
  RayMask active;
  Vec3<Rays> o, d;
  Rays near, far;
};

}  // namespace manyhands
