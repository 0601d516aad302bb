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

/// By how much the first and the last of some iterations changed a contact's velocity at most [m/s].
template <Number T>
struct IterationChanges {
  T first, last;
};

/// Iterates over all contacts, always in the same order (orders that go back and forth converge more slowly, see
/// docs/contact_solver.md), until every world has converged to the tolerance [m/s] or used up its `budget` of
/// iterations, which counts down. How many there were.
template <Number T>
MANYHANDS_INLINE int iterate_contacts(const ContactProblem<T>& problem, const Factors<T>& factors, T tolerance,
                                      T& budget, Iterate<T>& iterate, IterationChanges<T>& changes) {
  const T zero = constant<T>(0), one = constant<T>(1);
  int iterations = 0;
  changes.first = changes.last = problem.points.empty() ? zero : constant<T>(std::numeric_limits<double>::infinity());
  for (std::size_t k = 0; k < problem.patches.size(); ++k)
    iterate.patches[k].start = patch_motion(*problem.tree, problem.patches[k], problem.rows, iterate.dv.data());
  for (auto active = budget > zero; any(active); active = (changes.last > tolerance) & (budget > zero)) {
    T largest = zero;
    for (std::size_t k = 0; k < problem.patches.size(); ++k) relax_patch(problem, factors, k, active, iterate, largest);
    changes.last = select(active, largest, changes.last);
    if (iterations == 0) changes.first = changes.last;
    budget = select(active, budget - one, budget);
    ++iterations;
  }
  apply_change(problem, factors, iterate);
  return iterations;
}

}  // namespace manyhands::internal
