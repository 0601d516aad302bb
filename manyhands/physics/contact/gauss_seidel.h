// Block Gauss-Seidel over the contact points: each is solved exactly given all others.
#pragma once

#include "manyhands/physics/contact/contact_factors.h"
#include "manyhands/physics/contact/coulomb.h"

namespace manyhands::internal {

/// Solves one point, which has the velocity u where it yields to nothing, given all others: the change of its impulse.
/// `opening`: as much of u as it asks for. `largest` is at least how much the change moved it.
template <Number T>
MANYHANDS_INLINE Vec3<T> relax_point(mask_t<T> active, const DelassusBlock<T>& G, T opening, Vec3<T> u,
                                     PointImpulse<T>& point, T& largest) {
  u.x += G.yields(point.impulse.x, opening);
  T x = point.slide_x;
  const Vec3<T> before = G.turned(point.impulse), after = solve_coulomb(G, G.turned(u), before, x);
  point.slide_x = select(active, x, point.slide_x);
  const Vec3<T> next = select(active, G.turned_back(after), point.impulse), change = next - point.impulse;
  point.impulse = next;
  // What an impulse of this size cannot resolve is no change.
  const Vec3<T> turned = after - before;
  const T least = T(SolverTraits<real_t<T>>::kResolution) * next.x;
  largest = max(max(largest, G.normal * (abs(turned.x) - least)),
                max(G.sigma_1 * (abs(turned.y) - least), G.sigma_2 * (abs(turned.z) - least)));
  return change;
}

/// The same for what resists spinning and rolling, limited by the normal impulse.
template <Number T>
MANYHANDS_INLINE Vec3<T> relax_torsion(mask_t<T> active, const DelassusBlock<T>& G, T spin_inverse,
                                       const ContactPatch<T>& patch, T normal_impulse, const Vec3<T>& velocity,
                                       PointImpulse<T>& torsion) {
  const Vec3<T> u = G.turned(velocity);
  const T most = patch.spinning * normal_impulse;
  T x = torsion.slide_x;
  Vec3<T> next = G.turned(torsion.impulse);
  next.x = clamp(fma(-u.x, spin_inverse, next.x), -most, most);
  solve_disc(G, u.y, u.z, patch.rolling * normal_impulse, x, next.y, next.z);
  torsion.slide_x = select(active, x, torsion.slide_x);
  next = select(active, G.turned_back(next), torsion.impulse);
  const Vec3<T> change = next - torsion.impulse;
  torsion.impulse = next;
  return change;
}

/// Solves the points of one patch in turn. The patch's own motion follows each of them, y after the last.
template <Number T>
MANYHANDS_INLINE void relax_patch(const ContactProblem<T>& problem, const Factors<T>& factors, std::size_t k,
                                  mask_t<T> active, Iterate<T>& iterate, T& largest) {
  const ContactPatch<T>& patch = problem.patches[k];
  const PatchResponse<T>& response = factors.patches[k];
  Motion<T> motion = iterate.patches[k].start + multiply_patch_Y(patch, factors.Y.data(), iterate.y.data());
  Force<T> change = Force<T>::zero();
  const auto act = [&](const Force<T>& force) {
    change = change + force;
    motion = motion + respond(patch, response, force);
  };
  for (std::size_t i = patch.first; i < patch.first + patch.count; ++i) {
    const ContactPoint<T>& point = problem.points[i];
    PointImpulse<T>& impulse = iterate.points[i];
    const Vec3<T> u = factors.offsets[i] + velocity_at(patch, point.lever, motion);
    const T opening = asked_opening(problem, factors, i);
    act(force_at(patch, point.lever, relax_point(active, factors.points[i], opening, u, impulse, largest)));
    if (point.torsion < 0) continue;
    const std::size_t j = index(point.torsion);
    const Vec3<T> w = problem.torsions[j].offset + motion.w;
    act({relax_torsion(active, factors.torsions[j], factors.spin_inverse[j], patch, impulse.impulse.x, w,
                       iterate.torsions[j]),
         Vec3<T>::zero()});
  }
  add_patch_YT(patch, factors.Y.data(), change, iterate.y.data());
}

/// How far the trees of a patch have moved under impulses in these iterations [m/s], at least.
template <Number T>
MANYHANDS_INLINE T moved(const RowBlock& rows, const Iterate<T>& iterate) {
  T sum = constant<T>(0);
  if (rows.begin_a < rows.end_a) sum += iterate.moved[index(rows.begin_a)];
  if (rows.begin_b < rows.end_b) sum += iterate.moved[index(rows.begin_b)];
  return sum;
}

template <Number T>
MANYHANDS_INLINE void add_moved(const RowBlock& rows, T change, Iterate<T>& iterate) {
  if (rows.begin_a < rows.end_a) iterate.moved[index(rows.begin_a)] += change;
  if (rows.begin_b < rows.end_b) iterate.moved[index(rows.begin_b)] += change;
}

/// Whether contacts wait while little moves.
template <Number T>
inline constexpr bool kWaits = SolverTraits<real_t<T>>::kLittleMoved > 0;

/// Visits the patches whose trees have moved by more than `least` since their last visit began, or all where none
/// waits: by how much that changed a contact's velocity, at most [m/s].
template <Number T>
MANYHANDS_INLINE T visit_contacts(const ContactProblem<T>& problem, const Factors<T>& factors, mask_t<T> active,
                                  T least, Iterate<T>& iterate) {
  T largest = constant<T>(0);
  for (std::size_t k = 0; k < problem.patches.size(); ++k) {
    if constexpr (kWaits<T>) {
      const RowBlock& rows = problem.patches[k].linear;
      const T now = moved(rows, iterate);
      const auto asked = active & (now - iterate.patches[k].seen > least);
      if (none(asked)) continue;
      T change = constant<T>(0);
      relax_patch(problem, factors, k, asked, iterate, change);
      iterate.patches[k].seen = select(asked, now, iterate.patches[k].seen);
      add_moved(rows, change, iterate);
      largest = max(largest, change);
    } else {
      relax_patch(problem, factors, k, active, iterate, largest);
    }
  }
  return largest;
}

/// Iterates over all contacts, always in the same order (orders that go back and forth converge more slowly, see
/// docs/contact_solver.md), until every world has converged to the tolerance [m/s] or used up its `budget` of
/// iterations, which counts down. How many there were; `change` is by how much a world's last one changed a contact's
/// velocity [m/s].
///
/// Where little has moved a patch may wait: in a heap most are at rest while some still find their impulses. Only
/// an iteration over all patches tells that a world has converged.
template <Number T>
MANYHANDS_INLINE int iterate_contacts(const ContactProblem<T>& problem, const Factors<T>& factors, T tolerance,
                                      T& budget, Iterate<T>& iterate, T& change) {
  using Traits = SolverTraits<real_t<T>>;
  const T zero = constant<T>(0), one = constant<T>(1), all = constant<T>(-1), part = constant<T>(Traits::kLittleMoved);
  int iterations = 0;
  change = problem.points.empty() ? zero : constant<T>(std::numeric_limits<double>::infinity());
  if constexpr (kWaits<T>) iterate.moved.assign(iterate.dv.size(), zero);
  for (std::size_t k = 0; k < problem.patches.size(); ++k) {
    iterate.patches[k].start = patch_motion(*problem.tree, problem.patches[k], problem.rows, iterate.dv.data());
    if constexpr (kWaits<T>) iterate.patches[k].seen = zero;
  }
  T least = all;
  for (auto active = budget > zero; any(active);) {
    const T largest = visit_contacts(problem, factors, active, least, iterate);
    const auto settles = largest <= tolerance, visited_all = least < zero;
    change = select(active & (visited_all | !settles), largest, change);
    budget = select(active, budget - one, budget);
    active = active & !(settles & visited_all) & (budget > zero);
    if constexpr (kWaits<T>) least = select(settles, all, part * largest);
    ++iterations;
  }
  apply_change(problem, factors, iterate);
  return iterations;
}

}  // namespace manyhands::internal
