// Distance and contact of any two convex shapes.
#pragma once

#include "manyhands/physics/collision/general/convex.h"
#include "manyhands/physics/collision/manifold.h"

namespace manyhands {

/// The nearest points of two shapes, or the deepest ones where they overlap, in the axes of their poses.
template <Real R>
struct ShapeDistance {
  R phi{};              ///< [m]; where negative, B must move by -phi along the normal to be free
  Vec3<R> p_A{};        ///< on A's surface [m]
  Vec3<R> p_B{};        ///< on B's surface: p_A + phi normal_AB [m]
  Vec3<R> normal_AB{};  ///< unit, from A to B
};

/// Exact for distance and for depth; where directions tie, one of them. GJK between the cores, EPA where these overlap.
template <Real R>
[[nodiscard]] ShapeDistance<R> convex_distance(const ConvexShape& a, const Transform<R>& X_WA, const ConvexShape& b,
                                               const Transform<R>& X_WB);

/// The contact of two shapes: points at which they are at most `margin` [m] apart, or none. The supporting features of
/// both, seen along the normal, are clipped against each other; the gap along the normal at a corner of what they share
/// is its phi, so that no point is deeper than the shapes are. Of more than four points the deepest stays, and those
/// that span the largest area with it (as in Jolt Physics, ManifoldBetweenTwoFaces).
template <Real R>
[[nodiscard]] Manifold<R> collide_convex(const ConvexShape& a, const Transform<R>& X_WA, const ConvexShape& b,
                                         const Transform<R>& X_WB, R margin);

/// The distance in A's frame, B posed at X_AB; no more than a lower bound of phi once that exceeds `far`.
[[nodiscard]] ShapeDistance<double> core_distance(const ConvexShape& a, const ConvexShape& b,
                                                  const Transform<double>& X_AB, double far);

/// The manifold in A's frame about a contact found before, or along another normal chosen for it.
/// With `clip_only`, nothing but points that both features share.
[[nodiscard]] Manifold<double> contact_manifold(const ConvexShape& a, const ConvexShape& b,
                                                const Transform<double>& X_AB, const ShapeDistance<double>& contact,
                                                double margin, bool clip_only);

/// A manifold found in A's frame, in the frame in which X_WA is given.
template <Real R>
[[nodiscard]] Manifold<R> posed(const Transform<double>& X_WA, const Manifold<double>& m) {
  Manifold<R> result;
  result.normal = broadcast<R>(X_WA.R * m.normal);
  for (std::size_t k = 0; k < kManifoldPoints; ++k) {
    if (!is_finite(m.phi[k])) continue;
    result.p[k] = broadcast<R>(X_WA * m.p[k]);
    result.phi[k] = broadcast<R>(m.phi[k]);
  }
  return result;
}

}  // namespace manyhands
