// The pairs that no closed form treats, one world at a time.
#pragma once

#include "manyhands/physics/collision/colliders.h"
#include "manyhands/physics/collision/manifold.h"

namespace manyhands {

/// The manifolds of a pair of any shapes into `out`; how many there are. Sizes are the world's own.
template <Real R>
[[nodiscard]] int collide_general(const Colliders<R>& colliders, const ColliderPair& pair, const Vec3<R>& size_A,
                                  const Transform<R>& X_WA, const Vec3<R>& size_B, const Transform<R>& X_WB, R margin,
                                  std::span<Manifold<R>> out);

}  // namespace manyhands
