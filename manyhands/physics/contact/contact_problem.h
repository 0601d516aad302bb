// The constrained motion of one step as a problem: what is known before anything is solved. Constant for the solver.
//
// Given the state, find dv (nv) and impulses of everything that constrains it such that
//     M dv = smooth + joint_impulse + J_e^T equality_impulse + J_c^T contact_impulse
// and every constraint obeys its law between impulse and velocity at the step's end. See README.md in this folder.
#pragma once

#include "manyhands/physics/collision/colliders.h"
#include "manyhands/physics/collision/manifold.h"
#include "manyhands/physics/contact/contact_patch.h"
#include "manyhands/physics/contact/joint_laws.h"

namespace manyhands {

/// One contact point in all worlds of a block. Where phi is infinite the world has no such point. Velocities and
/// impulses are along (normal, e_1, e_2) of its patch.
template <Number T>
struct ContactPoint {
  ContactPoint() {}  // NOLINT: to add a point shall not clear what is written next

  std::size_t patch{}, index{};  ///< the patch, and which point of its manifold it is
  int torsion = -1;              ///< its torsional friction, if it has one
  Vec3<T> p;                     ///< midway between the surfaces, in the world [m]
  Vec3<T> lever;                 ///< from the patch's origin, in its axes [m]
  T phi;                         ///< [m]
  T bounces;                     ///< 1 where restitution asks for the velocity
  T softness;                    ///< what a soft surface adds to G_nn [1/kg]
  Vec3<T> offset;                ///< J v, and what keeps points that stick together along their arcs [m/s]
  T target;                      ///< the least normal velocity: how fast a gap may close (< 0), or shall open [m/s]
};

/// What resists spinning about the normal and rolling across it at one contact point: rows about (normal, t_1, t_2).
template <Number T>
struct ContactTorsion {
  std::size_t point{}, patch{};
  Vec3<T> offset{};  ///< J v: the rotation is offset + J dv [rad/s]
};

/// Three rows of one equality constraint. Rows that it does not need are zero.
template <Number T>
struct EqualityRows {
  RowBlock rows{};
  std::size_t equality{};             ///< index in Tree::equalities
  std::size_t cache{};                ///< the first of its three impulses in the state
  std::size_t first{};                ///< the first of its rows among those of all equalities that are not zero
  mask_t<T> acts{true};               ///< the worlds in which it does
  mask_t<T> far{false};               ///< those in which it stands open by more than some steps close
  Vec3<T> offset = Vec3<T>::zero();   ///< J v: its velocity is offset + J dv [m/s or rad/s]
  Vec3<T> closing = Vec3<T>::zero();  ///< the velocity -closing would close it by the step's end
  T max_impulse = constant<T>(0);     ///< of each component [N s or N m s]

  [[nodiscard]] std::size_t count() const { return rows.single ? 1 : 3; }
};

template <Number T>
struct ContactProblem {
  ContactProblem(const Tree<real_t<T>>& of, const Colliders<real_t<T>>& colliders)
      : joints(of.num_laws()), free_dv(index(of.nv)) {
    patches.reserve(colliders.num_manifolds);
    points.reserve(kManifoldPoints * colliders.num_manifolds);
    equalities.reserve(of.equality_rows / 3);
  }

  /// Takes out contacts and equality constraints; what joints ask for stays.
  void clear_constraints() {
    patches.clear();
    points.clear();
    torsions.clear();
    equalities.clear();
    rows.clear();
    std::fill_n(joints.constrained.begin(), tree->nv, constant<T>(0));
  }

  [[nodiscard]] const T* M() const { return dynamics->M.data(); }
  [[nodiscard]] bool only_joints() const { return points.empty() && equalities.empty(); }

  const Tree<real_t<T>>* tree = nullptr;   ///< set when a step is assembled, as the next
  const Workspace<T>* dynamics = nullptr;  ///< h damping added to M's diagonal
  const T* v = nullptr;                    ///< (nv) at the step's beginning
  JointLaws<T> joints;
  std::vector<ContactPatch<T>> patches;
  std::vector<ContactPoint<T>> points;  ///< by patches
  std::vector<ContactTorsion<T>> torsions;
  std::vector<EqualityRows<T>> equalities;
  std::size_t num_equality_rows = 0;  ///< that are not zero
  RowEntries<T> rows;
  std::vector<T> free_dv;  ///< (nv) M^-1 smooth, where something asks for it
};

/// The velocity (at the step's beginning) and the inertia of a dof, or of a length behind them.
template <Number T>
MANYHANDS_INLINE T law_velocity(const ContactProblem<T>& problem, std::size_t i) {
  const std::size_t nv = index(problem.tree->nv);
  return i < nv ? problem.v[i] : problem.dynamics->length_rate[i - nv];
}
template <Number T>
MANYHANDS_INLINE T law_inertia(const ContactProblem<T>& problem, std::size_t i) {
  const std::size_t nv = index(problem.tree->nv);
  return i < nv ? tree_row(*problem.tree, problem.M(), i)[i] : problem.dynamics->length_inertia[i - nv];
}

/// J x of one point, for x (nv).
template <Number T>
MANYHANDS_INLINE Vec3<T> point_velocity(const ContactProblem<T>& problem, const ContactPoint<T>& point, const T* x) {
  const ContactPatch<T>& patch = problem.patches[point.patch];
  return velocity_at(patch, point.lever, patch_motion(*problem.tree, patch, problem.rows, x));
}

/// Whether a body that a user moves takes part: it enters others at any speed, and has none itself.
template <Number T>
[[nodiscard]] bool touches_mocap(const Tree<real_t<T>>& tree, const ContactPatch<T>& patch) {
  return tree.bodies[patch.body_a()].type == JointType::kMocap || tree.bodies[patch.body_b()].type == JointType::kMocap;
}

}  // namespace manyhands
