// What is done where a solution has more energy than there can be (energy_bound.h): contacts, limits and equality
// constraints demanded what contradicts itself, and the iterations ran away.
//
// The step is solved again, and nothing is demanded: overlap stays, constraints stay open, joints stay beyond their
// limits, but none of them grows. Standing still satisfies all that is left. Where even that solution has too much
// energy, what contacts and constraints act on stands still for a step.
#pragma once

#include "manyhands/physics/contact/active_set_search.h"
#include "manyhands/physics/contact/joint_solver.h"
#include "manyhands/physics/contact/recovery.h"

namespace manyhands::internal {

/// How fast an equation between tendons closes; 0 of other laws [m/s].
template <Number T>
MANYHANDS_INLINE T closing_speed(const ContactProblem<T>& problem, std::size_t i) {
  const std::size_t nv = index(problem.tree->nv);
  const bool couples = i >= nv && problem.tree->lengths[i - nv].type == LengthType::kCoupling;
  return couples ? abs(law_velocity(problem, i) + problem.joints.target[i]) : constant<T>(0);
}

/// The worlds in which a correction is demanded that is not slow.
template <Number T>
MANYHANDS_INLINE mask_t<T> demands_much(const ContactProblem<T>& problem, const Recovery<T>& recovery,
                                        const Factors<T>& factors) {
  const JointLaws<T>& laws = problem.joints;
  T fastest = constant<T>(0);
  for (std::size_t i = 0; i < laws.lower.size(); ++i)
    fastest = max(fastest, return_speed(law_velocity(problem, i), i, laws));
  for (std::size_t i = index(problem.tree->nv); i < laws.target.size(); ++i)
    fastest = max(fastest, closing_speed(problem, i));
  for (std::size_t i = 0; i < problem.num_equality_rows; ++i) fastest = max(fastest, abs(factors.closing[i]));
  return recovery.asked | (fastest > constant<T>(contact_settings::kSlowCorrection));
}

/// The worlds in which mocap bodies push faster than slowly: that is demanded of all they touch, come what may.
template <Number T>
MANYHANDS_INLINE mask_t<T> is_pushed(const ContactProblem<T>& problem) {
  if (problem.tree->mocap_bodies.empty()) return mask_t<T>(false);
  T fastest = constant<T>(0);
  for (const ContactPoint<T>& point : problem.points) {
    if (touches_mocap(*problem.tree, problem.patches[point.patch]))
      fastest = max(fastest, select(shall_open(point), point.target, constant<T>(0)));
  }
  return fastest > constant<T>(contact_settings::kSlowCorrection);
}

/// Lets overlap, open constraints and joints beyond their limits be in the worlds of the mask: what is left never
/// contradicts itself, for nothing need move.
template <Number T>
MANYHANDS_INLINE void demand_nothing(mask_t<T> asked, ContactProblem<T>& problem) {
  const T zero = constant<T>(0);
  JointLaws<T>& laws = problem.joints;
  for (ContactPoint<T>& point : problem.points) point.target = select(asked & shall_open(point), zero, point.target);
  for (EqualityRows<T>& block : problem.equalities) block.closing = select(asked, Vec3<T>::zero(), block.closing);
  for (std::size_t i = 0; i < laws.lower.size(); ++i) {
    const T stop = -law_velocity(problem, i);
    const auto returns = asked & ((laws.lower[i] > stop) | (laws.upper[i] < stop));
    laws.lower[i] = select(returns, min(laws.lower[i], stop), laws.lower[i]);
    laws.upper[i] = select(returns, max(laws.upper[i], stop), laws.upper[i]);
    const auto closes = asked & (closing_speed(problem, i) > zero);
    laws.target[i] = select(returns | closes, stop, laws.target[i]);
  }
}

/// Demands nothing in the worlds that have lately run away.
template <Number T>
MANYHANDS_INLINE void stay_calm(ContactProblem<T>& problem, Iterate<T>& iterate) {
  const T zero = constant<T>(0);
  const auto calm = iterate.calm > zero;
  when(calm, [&] { demand_nothing(calm, problem); });
  iterate.calm = max(iterate.calm - constant<T>(1), zero);
}

/// Worlds that have run away, or have found no solution to their demands, go without them for a while.
template <Number T>
MANYHANDS_INLINE void calm_down(mask_t<T> asked, Iterate<T>& iterate) {
  iterate.calm = select(asked, constant<T>(contact_settings::kCalmSteps), iterate.calm);
}

/// All of the iterate but what the worlds of the mask have.
template <Number T>
MANYHANDS_INLINE void keep_others(mask_t<T> changed, const Iterate<T>& before, Iterate<T>& iterate) {
  const auto keep = [&](std::vector<T>& now, const std::vector<T>& old) {
    for (std::size_t i = 0; i < now.size(); ++i) now[i] = select(changed, now[i], old[i]);
  };
  keep(iterate.dv, before.dv);
  keep(iterate.rhs, before.rhs);
  keep(iterate.joint_impulse, before.joint_impulse);
  keep(iterate.active_set, before.active_set);
  const auto keep_impulses = [&](std::vector<PointImpulse<T>>& now, const std::vector<PointImpulse<T>>& old) {
    for (std::size_t i = 0; i < now.size(); ++i) {
      now[i].impulse = select(changed, now[i].impulse, old[i].impulse);
      now[i].slide_x = select(changed, now[i].slide_x, old[i].slide_x);
    }
  };
  keep_impulses(iterate.points, before.points);
  keep_impulses(iterate.torsions, before.torsions);
  iterate.iterations = select(changed, iterate.iterations, before.iterations);
  for (std::size_t i = 0; i < iterate.equalities.size(); ++i)
    iterate.equalities[i] = select(changed, iterate.equalities[i], before.equalities[i]);
}

/// No impulse of contacts and equality constraints.
template <Number T>
MANYHANDS_INLINE void clear_impulses(Iterate<T>& iterate) {
  visit_impulses(iterate, [](std::size_t, Vec3<T>& impulse) { impulse = Vec3<T>::zero(); });
}

/// The solution under the joints' laws alone.
template <Number T>
MANYHANDS_INLINE void solve_alone(const ContactProblem<T>& problem, Factors<T>& factors, std::vector<T>& next_state,
                                  Iterate<T>& iterate) {
  clear_impulses(iterate);
  iterate.active_set = problem.joints.first_state;
  iterate.rhs = problem.joints.smooth;
  solve_joints(problem, factors, iterate, next_state);
}

/// Brings all that contacts and equality constraints act on to rest, which contradicts none of them.
template <Number T>
MANYHANDS_INLINE void stand_still(const ContactProblem<T>& problem, Iterate<T>& iterate) {
  const T zero = constant<T>(0);
  clear_impulses(iterate);
  for (std::size_t i = 0; i < index(problem.tree->nv); ++i) {
    const auto constrained = problem.joints.constrained[i] > zero;
    iterate.dv[i] = select(constrained, -problem.v[i], iterate.dv[i]);
    iterate.joint_impulse[i] = select(constrained, zero, iterate.joint_impulse[i]);
  }
}

}  // namespace manyhands::internal
