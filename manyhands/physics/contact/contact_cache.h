// What contacts leave to the next step: where they were and what they carried, to start from.
#pragma once

#include <array>
#include <span>

#include "manyhands/physics/collision/collide.h"
#include "manyhands/physics/contact/iterate.h"
#include "manyhands/physics/dynamics/state.h"

namespace manyhands {

/// One manifold in the contact cache of a State, as plain numbers: all zero where there is no contact.
template <Number T>
struct CachedManifold {
  T key;                                         ///< which one it is, where the cache holds only what touches; else 0
  T used;                                        ///< 1 if any point carried an impulse
  std::array<Vec3<T>, kManifoldPoints> p;        ///< in the world [m]
  std::array<Vec3<T>, kManifoldPoints> impulse;  ///< on B, in world axes [N s]
  std::array<Vec3<T>, kManifoldPoints> moment;   ///< of torsional and rolling friction on B [N m s]
};

template <Number T>
inline constexpr std::size_t kManifoldNumbers = sizeof(CachedManifold<T>) / sizeof(T);

static_assert(kManifoldNumbers<double> == 2 + 9 * kManifoldPoints);

/// The contact cache of a state as its manifolds: it is an array of plain numbers, so that states can be copied and
/// hashed whole.
template <Number T>
[[nodiscard]] MANYHANDS_INLINE std::span<CachedManifold<T>> cached_manifolds(std::span<T> numbers) {
  return {reinterpret_cast<CachedManifold<T>*>(numbers.data()), numbers.size() / kManifoldNumbers<T>};
}
template <Number T>
[[nodiscard]] MANYHANDS_INLINE std::span<const CachedManifold<T>> cached_manifolds(std::span<const T> numbers) {
  return {reinterpret_cast<const CachedManifold<T>*>(numbers.data()), numbers.size() / kManifoldNumbers<T>};
}

/// Hands the impulse of each old point that carried something to the nearest new one that is still free, in order.
template <Number T>
MANYHANDS_INLINE void match_points(const CachedManifold<T>& old, const Manifold<T>& now,
                                   std::array<Vec3<T>, kManifoldPoints>& impulse,
                                   std::array<Vec3<T>, kManifoldPoints>& moment) {
  const T zero = constant<T>(0), taken = constant<T>(std::numeric_limits<double>::infinity());
  std::array<T, kManifoldPoints> cost{};
  for (std::size_t k = 0; k < kManifoldPoints; ++k) {
    cost[k] = select(is_finite(now.phi[k]), zero, taken);
    impulse[k] = moment[k] = Vec3<T>::zero();
  }
  for (std::size_t j = 0; j < kManifoldPoints; ++j) {
    const auto carried = squared_norm(old.impulse[j]) > zero;
    T best = taken, choice = constant<T>(-1);
    for (std::size_t k = 0; k < kManifoldPoints; ++k) {
      const T distance = squared_norm(now.p[k] - old.p[j]) + cost[k];
      const auto nearer = carried & (distance < best);
      best = select(nearer, distance, best);
      choice = select(nearer, constant<T>(static_cast<double>(k)), choice);
    }
    for (std::size_t k = 0; k < kManifoldPoints; ++k) {
      const auto chosen = choice == constant<T>(static_cast<double>(k));
      impulse[k] = select(chosen, old.impulse[j], impulse[k]);
      moment[k] = select(chosen, old.moment[j], moment[k]);
      cost[k] = select(chosen, taken, cost[k]);
    }
  }
}

/// Where pairs are found anew in every step: makes the cache of `state` hold just the manifolds that touch now, in
/// their order, each with what it left behind; the touches then point there. `old` is scratch.
template <Real R>
void carry_contact_cache(std::vector<Touch<R>>& touches, State<R>& state, std::vector<R>& old) {
  old.assign(state.contact_cache().begin(), state.contact_cache().end());
  const std::span<CachedManifold<R>> before = cached_manifolds(std::span<R>(old));
  state.resize_contact_cache(touches.size() * kManifoldNumbers<R>);
  const std::span<CachedManifold<R>> now = cached_manifolds(state.contact_cache());
  std::size_t next = 0;
  for (std::size_t i = 0; i < touches.size(); ++i) {
    const R key = static_cast<R>(touches[i].manifold);
    while (next < before.size() && before[next].key < key) ++next;
    now[i] = next < before.size() && before[next].key == key ? before[next] : CachedManifold<R>{};
    now[i].key = key;
    touches[i].manifold = i;
  }
}

/// Clears every manifold, and writes down those that carry something.
template <Number T>
MANYHANDS_INLINE void store_contacts(const ContactProblem<T>& problem, const Iterate<T>& iterate,
                                     std::span<CachedManifold<T>> cache) {
  const T zero = constant<T>(0), one = constant<T>(1);
  for (CachedManifold<T>& manifold : cache) {
    when(manifold.used != zero, [&] {
      const T key = manifold.key;
      manifold = {};
      manifold.key = key;
    });
  }
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    const ContactPoint<T>& point = problem.points[i];
    const ContactPatch<T>& patch = problem.patches[point.patch];
    CachedManifold<T>& manifold = cache[patch.manifold];
    const Vec3<T>& y = iterate.points[i].impulse;
    const auto carries = y.x > zero;
    const Vec3<T> impulse = fma(y.x, patch.normal, fma(y.y, patch.e_1, y.z * patch.e_2));
    manifold.used = select(carries, one, manifold.used);
    manifold.p[point.index] = select(carries, point.p, Vec3<T>::zero());
    manifold.impulse[point.index] = select(carries, impulse, Vec3<T>::zero());
    if (point.torsion < 0) continue;
    const Vec3<T>& m = iterate.torsions[index(point.torsion)].impulse;
    const Vec3<T> moment = fma(m.x, patch.normal, fma(m.y, patch.t_1, m.z * patch.t_2));
    manifold.moment[point.index] = select(carries, moment, Vec3<T>::zero());
  }
}

}  // namespace manyhands
