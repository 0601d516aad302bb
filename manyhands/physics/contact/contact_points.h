// From manifolds to rows: every contact point with its basis, its Jacobian and the velocity it asks for.
#pragma once

#include <variant>

#include "manyhands/physics/collision/collide.h"
#include "manyhands/physics/contact/contact_patch.h"
#include "manyhands/physics/contact/coulomb.h"
#include "manyhands/physics/contact/newton_finish.h"

namespace manyhands {

/// One contact point in all worlds of a block. Where phi is infinite the world has no such point, and it stays without
/// impulse. Impulses are (normal, y_1, y_2) along (normal, e_1, e_2), where e_i are tangents as long as friction is
/// strong: the cone is |y| <= normal whatever the friction.
template <Number T>
struct ContactPoint {
  ContactPoint() {}  // NOLINT: to add a point shall not clear what is written next

  std::size_t pair{}, manifold{}, index{};
  std::size_t patch{};  ///< index in ContactSet::patches
  RowBlock rows{};      ///< the patch's linear ones
  Vec3<T> p, normal, e_1, e_2;
  Vec3<T> lever;  ///< from the patch's origin, in its axes
  T phi;
  T bounces;       ///< 1 where restitution asks for the target
  T softness;      ///< what a soft surface adds to G_nn [1/kg]
  Vec3<T> offset;  ///< J v less what the point asks for: the velocity is offset + J dv
  ContactStiffness<T> stiffness;
  int torsion = -1;  ///< its row of torsional friction, if it has one
  Vec3<T> impulse;   ///< [N s]
  T slide_x;         ///< where `slide` goes on in the next sweep; 0 before the first
};

/// What resists spinning about the normal and rolling across it at one contact point: impulses are moments.
template <Number T>
struct ContactTorsion {
  std::size_t point{};
  RowBlock rows{};          ///< the patch's angular ones
  T spinning{}, rolling{};  ///< moment per normal force [m]
  Vec3<T> t_1{}, t_2{};
  Vec3<T> offset{};
  T spin_inverse{};
  ContactStiffness<T> stiffness{};
  Vec3<T> impulse{};  ///< (about the normal, about t_1, about t_2) [N m s]
  T slide_x{};        ///< as of ContactPoint
};

/// A touching surface's numbers, those of its two geoms combined.
template <Number T>
struct CombinedSurface {
  T friction_1, friction_2;  ///< along t_1 and t_2
  Vec3<T> t_1, t_2;
  T restitution, spinning, rolling;
  T radius_A, radius_B;  ///< by which each side is curved at the contact [m]; 0 where it is flat or a corner
  T softness, push;      ///< of a soft surface: see `soften`; 0 where it is hard
};

/// The least wrong stances that a search has seen, and the impulses that they came with.
template <Number T>
struct BestStances {
  explicit BestStances(int nv) : stances(static_cast<std::size_t>(nv)) {}

  T wrong{};                      ///< by how much [rad/s or m/s]
  std::vector<T> stances;         ///< (nv)
  std::vector<Vec3<T>> impulses;  ///< of contacts, torsions and loops
};

/// All contact points of a step.
template <Number T>
struct ContactSet {
  explicit ContactSet(const Colliders<real_t<T>>& colliders, int nv)
      : store(nv), free_dv(static_cast<std::size_t>(nv)), kept_dv(free_dv), kept_rhs(free_dv), best(nv) {
    patches.reserve(colliders.num_manifolds);
    points.reserve(kManifoldPoints * colliders.num_manifolds);
  }

  std::vector<ContactPatch<T>> patches;
  std::vector<ContactPoint<T>> points;  ///< by patches
  std::vector<ContactTorsion<T>> torsions;
  RowStore<T> store;
  std::vector<T> free_dv;  ///< (nv) velocity change without contacts; only where something bounces
  std::vector<T> kept_dv;  ///< (nv) scratch, as the next
  std::vector<T> kept_rhs;
  BestStances<T> best;
  T sweeps{};  ///< that each world took
  std::conditional_t<std::same_as<T, double>, NewtonFinish, std::monostate> newton;
};

/// All that acts on a patch at present.
template <Number T>
MANYHANDS_INLINE Force<T> patch_force(const ContactSet<T>& set, const ContactPatch<T>& patch) {
  Force<T> sum = Force<T>::zero();
  for (std::size_t i = patch.first; i < patch.first + patch.count; ++i) {
    const ContactPoint<T>& point = set.points[i];
    sum = sum + force_at(patch, point.lever, point.impulse);
    if (point.torsion >= 0) sum.n += set.torsions[static_cast<std::size_t>(point.torsion)].impulse;
  }
  return sum;
}

/// J x of one point, for x over the dofs.
template <Number T>
MANYHANDS_INLINE Vec3<T> point_velocity(const Tree<real_t<T>>& tree, const ContactSet<T>& set,
                                        const ContactPoint<T>& point, const T* x) {
  const ContactPatch<T>& patch = set.patches[point.patch];
  return velocity_at(patch, point.lever, patch_motion(tree, patch, set.store, x));
}

}  // namespace manyhands
