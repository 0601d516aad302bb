// Where two shapes touch, or nearly do.
#pragma once

#include <array>
#include <limits>

#include "manyhands/math/vec3.h"

namespace manyhands {

/// The most contact points that one pair of shapes may have.
inline constexpr int kManifoldPoints = 4;

/// Up to four contact points of the shapes A and B with one normal, in the axes in which the shapes' poses are given.
/// A point whose phi is infinite is none. Points are ordered by no rule; those that are none come anywhere.
template <Number T>
struct Manifold {
  Vec3<T> normal{};                                ///< normal_AB: unit, from A to B
  std::array<Vec3<T>, kManifoldPoints> p{};        ///< midway between the two surfaces [m]
  std::array<T, kManifoldPoints> phi = nowhere();  ///< distance along the normal [m], negative in penetration

  /// Adds a point at index k: on A's surface at p_A, the distance phi away from B along the normal.
  MANYHANDS_INLINE void set(std::size_t k, const Vec3<T>& p_A, T distance) {
    p[k] = fma(T(real_t<T>(0.5)) * distance, normal, p_A);
    phi[k] = distance;
  }

  static MANYHANDS_INLINE std::array<T, kManifoldPoints> nowhere() {
    const T far(std::numeric_limits<real_t<T>>::infinity());
    return {far, far, far, far};
  }
};

/// Puts one world's manifold into its lane.
template <Number T>
MANYHANDS_INLINE void copy_to_lane(const Manifold<real_t<T>>& from, Manifold<T>& to, int k) {
  const auto put = [&](const Vec3<real_t<T>>& a, Vec3<T>& b) {
    set_lane(b.x, k, a.x);
    set_lane(b.y, k, a.y);
    set_lane(b.z, k, a.z);
  };
  put(from.normal, to.normal);
  for (std::size_t i = 0; i < kManifoldPoints; ++i) {
    put(from.p[i], to.p[i]);
    set_lane(to.phi[i], k, from.phi[i]);
  }
}

/// a where m, else b.
template <Number T>
MANYHANDS_INLINE Manifold<T> select(mask_t<T> m, const Manifold<T>& a, const Manifold<T>& b) {
  Manifold<T> chosen{.normal = select(m, a.normal, b.normal)};
  for (std::size_t i = 0; i < kManifoldPoints; ++i) {
    chosen.p[i] = select(m, a.p[i], b.p[i]);
    chosen.phi[i] = select(m, a.phi[i], b.phi[i]);
  }
  return chosen;
}

/// The same contact seen from B: normal and order of the shapes reversed.
template <Number T>
MANYHANDS_INLINE Manifold<T> swapped(Manifold<T> m) {
  m.normal = -m.normal;
  return m;
}

}  // namespace manyhands
