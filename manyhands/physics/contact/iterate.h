// The solution so far: the change of velocity, and the impulse of everything that constrains it.
#pragma once

#include "manyhands/physics/contact/contact_problem.h"

namespace manyhands {

/// The impulse of one contact point along (normal, e_1, e_2) [N s], or of its torsion about (normal, t_1, t_2) [N m s].
template <Number T>
struct PointImpulse {
  PointImpulse() {}  // NOLINT: to add one shall not clear what is written next

  Vec3<T> impulse;
  T slide_x;  ///< where the root of a sliding point goes on in the next iteration; 0 before the first
};

/// Of a patch, while its points are relaxed.
template <Number T>
struct PatchIterate {
  PatchIterate() {}  // NOLINT: as above

  Motion<T> start;      ///< J dv when the iterations began
  T seen;               ///< how far its trees had moved when it was last visited [m/s]
  Force<T> at_closing;  ///< the force when the equality constraints were last closed
};

/// Impulses and active set: what a search may go back to.
template <Number T>
struct Iterate {
  explicit Iterate(int laws) : dv(index(laws)), rhs(dv), joint_impulse(dv), active_set(dv), y(dv) {}

  std::vector<T> dv;             ///< (laws) M dv = rhs + joint_impulse, tendons' included; behind that J dv of lengths
  std::vector<T> rhs;            ///< (laws) smooth, and the impulses of contacts and equality constraints
  std::vector<T> joint_impulse;  ///< (laws) of motors, drives, dry friction and limits
  std::vector<T> active_set;     ///< (laws) see JointConstraintState
  std::vector<PointImpulse<T>> points;    ///< (points)
  std::vector<PointImpulse<T>> torsions;  ///< (torsions)
  std::vector<Vec3<T>> equalities;        ///< (equalities) [N s or N m s]
  std::vector<PatchIterate<T>> patches;   ///< (patches)
  std::vector<T> y;                       ///< (laws) change of dv = B y that is not yet in dv
  std::vector<T> moved;                   ///< (laws) by how much contacts moved a cluster, at its first dof [m/s]
  T iterations{};                         ///< that each world took
  T calm{};                               ///< steps to come in which constraints demand nothing: see runaway.h
};

/// All that acts on a patch at present.
template <Number T>
MANYHANDS_INLINE Force<T> patch_force(const ContactProblem<T>& problem, const Iterate<T>& iterate,
                                      const ContactPatch<T>& patch) {
  Force<T> sum = Force<T>::zero();
  for (std::size_t i = patch.first; i < patch.first + patch.count; ++i) {
    const ContactPoint<T>& point = problem.points[i];
    sum = sum + force_at(patch, point.lever, iterate.points[i].impulse);
    if (point.torsion >= 0) sum.n += iterate.torsions[index(point.torsion)].impulse;
  }
  return sum;
}

/// rhs = smooth + J^T impulses.
template <Number T>
MANYHANDS_INLINE void gather_impulses(const ContactProblem<T>& problem, Iterate<T>& iterate) {
  iterate.rhs = problem.joints.smooth;
  T* rhs = iterate.rhs.data();
  for (const ContactPatch<T>& patch : problem.patches)
    add_patch_JT(*problem.tree, patch, problem.rows, patch_force(problem, iterate, patch), rhs);
  for (std::size_t k = 0; k < problem.equalities.size(); ++k)
    add_JT(*problem.tree, problem.equalities[k].rows, problem.rows, iterate.equalities[k], rhs);
}

}  // namespace manyhands
