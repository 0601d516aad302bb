// What contacts leave to the next step: where they were and what they carried.
#pragma once

#include <span>

#include "manyhands/physics/contact/contact_points.h"
#include "manyhands/physics/dynamics/state.h"

namespace manyhands {

/// One manifold in the memory of a State, as plain numbers: all zero where there is no contact.
template <Number T>
struct RememberedManifold {
  T key;                                         ///< which one it is, where memory holds only what touches; else 0
  T used;                                        ///< 1 if any point carried an impulse
  std::array<Vec3<T>, kManifoldPoints> p;        ///< in the world [m]
  std::array<Vec3<T>, kManifoldPoints> impulse;  ///< on B, in world axes [N s]
  std::array<Vec3<T>, kManifoldPoints> moment;   ///< of torsional and rolling friction on B [N m s]
};

template <Number T>
inline constexpr std::size_t kManifoldNumbers = sizeof(RememberedManifold<T>) / sizeof(T);

static_assert(kManifoldNumbers<double> == 2 + 9 * kManifoldPoints);

/// The contact memory of a state as its manifolds.
template <Number T>
[[nodiscard]] MANYHANDS_INLINE std::span<RememberedManifold<T>> remembered(std::span<T> numbers) {
  return {reinterpret_cast<RememberedManifold<T>*>(numbers.data()), numbers.size() / kManifoldNumbers<T>};
}

/// Hands the impulse of each old point that carried something to the nearest new one that is still free, in order.
template <Number T>
MANYHANDS_INLINE void match_points(const RememberedManifold<T>& old, const Manifold<T>& now,
                                   std::array<Vec3<T>, kManifoldPoints>& impulse,
                                   std::array<Vec3<T>, kManifoldPoints>& moment) {
  using R = real_t<T>;
  const T zero(R(0)), taken(std::numeric_limits<R>::infinity());
  std::array<T, kManifoldPoints> cost{};
  for (std::size_t k = 0; k < kManifoldPoints; ++k) {
    cost[k] = select(is_finite(now.phi[k]), zero, taken);
    impulse[k] = moment[k] = Vec3<T>::zero();
  }
  for (std::size_t j = 0; j < kManifoldPoints; ++j) {
    const auto carried = squared_norm(old.impulse[j]) > zero;
    T best = taken, choice(R(-1));
    for (std::size_t k = 0; k < kManifoldPoints; ++k) {
      const T distance = squared_norm(now.p[k] - old.p[j]) + cost[k];
      const auto nearer = carried & (distance < best);
      best = select(nearer, distance, best);
      choice = select(nearer, T(static_cast<R>(k)), choice);
    }
    for (std::size_t k = 0; k < kManifoldPoints; ++k) {
      const auto chosen = choice == T(static_cast<R>(k));
      impulse[k] = select(chosen, old.impulse[j], impulse[k]);
      moment[k] = select(chosen, old.moment[j], moment[k]);
      cost[k] = select(chosen, taken, cost[k]);
    }
  }
}

/// Where pairs are found anew in every step: makes `state` remember just the manifolds that touch now, in their order,
/// each with what it left behind; the touches then point there. `old` is scratch.
template <Real R>
void carry_memory(std::vector<Touch<R>>& touches, State<R>& state, std::vector<R>& old) {
  old.assign(state.contacts().begin(), state.contacts().end());
  const std::span<RememberedManifold<R>> before = remembered(std::span<R>(old));
  state.resize_contacts(touches.size() * kManifoldNumbers<R>);
  const std::span<RememberedManifold<R>> now = remembered(state.contacts());
  std::size_t next = 0;
  for (std::size_t i = 0; i < touches.size(); ++i) {
    const R key = static_cast<R>(touches[i].manifold);
    while (next < before.size() && before[next].key < key) ++next;
    now[i] = next < before.size() && before[next].key == key ? before[next] : RememberedManifold<R>{};
    now[i].key = key;
    touches[i].manifold = i;
  }
}

/// Forgets every manifold, and writes down those that carry something.
template <Number T>
MANYHANDS_INLINE void remember(const ContactSet<T>& set, std::span<RememberedManifold<T>> memory) {
  using R = real_t<T>;
  const T zero(R(0)), one(R(1));
  for (RememberedManifold<T>& manifold : memory) {
    when(manifold.used != zero, [&] {
      const T key = manifold.key;
      manifold = {};
      manifold.key = key;
    });
  }
  for (const ContactPoint<T>& point : set.points) {
    RememberedManifold<T>& manifold = memory[point.manifold];
    const auto carries = point.impulse.x > zero;
    const Vec3<T> impulse =
        fma(point.impulse.x, point.normal, fma(point.impulse.y, point.e_1, point.impulse.z * point.e_2));
    manifold.used = select(carries, one, manifold.used);
    manifold.p[point.index] = select(carries, point.p, Vec3<T>::zero());
    manifold.impulse[point.index] = select(carries, impulse, Vec3<T>::zero());
  }
  for (const ContactTorsion<T>& torsion : set.torsions) {
    const ContactPoint<T>& point = set.points[torsion.point];
    const Vec3<T> moment =
        fma(torsion.impulse.x, point.normal, fma(torsion.impulse.y, torsion.t_1, torsion.impulse.z * torsion.t_2));
    memory[point.manifold].moment[point.index] = select(point.impulse.x > zero, moment, Vec3<T>::zero());
  }
}

}  // namespace manyhands
