// How deep two overlapping convex cores are in each other.
#pragma once

#include "manyhands/physics/collision/general/gjk.h"

namespace manyhands {

struct Penetration {
  double depth{};         ///< B must move this far along the normal to be free [m]
  Vec3<double> normal{};  ///< unit, from A to B, in A's frame
  Vec3<double> a{};       ///< the deepest point of A's core, in A's frame
};

/// The face of the Minkowski difference that is nearest to the origin, by an expanding polytope (van den Bergen,
/// Proximity Queries and Penetration Depth Computation on 3D Game Objects, GDC 2001), grown from the simplex at which
/// GJK stopped. Where the difference is flat, its depth is zero. Bounded in steps; should they run out, as they can on
/// curved cores that are deep in each other, the depth is that of the best direction found: enough to part the cores.
[[nodiscard]] Penetration epa(const CorePair& pair, const GjkResult& start);

}  // namespace manyhands
