// From manifolds to rows: every contact point with its basis, its Jacobian and the velocity it asks for.
#pragma once

#include <variant>

#include "manyhands/physics/collision/collide.h"
#include "manyhands/physics/contact/coulomb.h"
#include "manyhands/physics/contact/newton_finish.h"
#include "manyhands/physics/contact/row_block.h"

namespace manyhands {

/// One contact point in all worlds of a block. Where phi is infinite the world has no such point, and it stays without
/// impulse. Impulses are (normal, y_1, y_2) along (normal, e_1, e_2), where e_i are tangents as long as friction is
/// strong: the cone is |y| <= normal whatever the friction.
template <Number T>
struct ContactPoint {
  std::size_t pair{}, manifold{}, index{};
  RowBlock rows{};
  Vec3<T> p{}, normal{}, e_1{}, e_2{};
  T phi{};
  T target{};        ///< the least normal velocity after the step
  T bounces{};       ///< 1 where restitution asks for the target
  T softness{};      ///< what a soft surface adds to G_nn [1/kg]
  Vec3<T> offset{};  ///< J v less the target: the velocity is offset + J dv
  ContactStiffness<T> stiffness{};
  int torsion = -1;     ///< its row of torsional friction, if it has one
  Vec3<T> impulse{};    ///< [N s]
  Vec3<T> closed_at{};  ///< the impulse at which the loops were closed
};

/// What resists spinning about the normal and rolling across it at one contact point: impulses are moments.
template <Number T>
struct ContactTorsion {
  std::size_t point{};
  RowBlock rows{};
  T spinning{}, rolling{};  ///< moment per normal force [m]
  Vec3<T> t_1{}, t_2{};
  Vec3<T> offset{};
  T spin_inverse{};
  ContactStiffness<T> stiffness{};
  Vec3<T> impulse{};    ///< (about the normal, about t_1, about t_2) [N m s]
  Vec3<T> closed_at{};  ///< the impulse at which the loops were closed
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

/// All contact points of a step.
template <Number T>
struct ContactSet {
  explicit ContactSet(const Colliders<real_t<T>>& colliders, int nv) {
    points.reserve(kManifoldPoints * colliders.num_manifolds);
    store.x.resize(static_cast<std::size_t>(nv));
    free_dv.resize(static_cast<std::size_t>(nv));
    kept_dv = free_dv;
  }

  std::vector<ContactPoint<T>> points;
  std::vector<ContactTorsion<T>> torsions;
  RowStore<T> store;
  std::vector<T> free_dv;  ///< (nv) velocity change without contacts; only where something bounces
  std::vector<T> kept_dv;  ///< (nv) scratch
  std::conditional_t<std::same_as<T, double>, NewtonFinish, std::monostate> newton;
};

}  // namespace manyhands
