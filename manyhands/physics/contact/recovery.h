// How fast surfaces that overlap part: as fast as they want to, or as the joints can without contradiction.
//
// Coulomb's problem has a solution wherever some motion satisfies all its normal velocities (Cadoux 2009). Standing
// still does, but for what overlaps and shall open: from both sides of a hinge, or between two walls, no motion opens
// both. So the contacts are first asked what they can do, from rest, without friction and each yielding by a part R of
// the mobility:
//     u_i = J_i w >= min(target_i, 0),   and where target_i > 0   impulse_i >= (target_i - u_i) / R.
// This convex problem always has a solution, and what it attains is what the contact problem then demands.
#pragma once

#include "manyhands/physics/contact/contact_factors.h"

namespace manyhands {

/// Scratch.
template <Number T>
struct Recovery {
  explicit Recovery(int nv) : y(index(nv)) {}

  std::vector<T> impulse;  ///< (points) along the normals
  std::vector<T> y;        ///< (nv) w = B y
  mask_t<T> asked{};       ///< the worlds in which something shall open faster than slowly
};

namespace internal {

/// Whether it may open more slowly than it wants to. What a mocap body pushes may not: nothing else moves it.
template <Number T>
MANYHANDS_INLINE mask_t<T> may_wait(const ContactProblem<T>& problem, const ContactPoint<T>& point) {
  return shall_open(point) & mask_t<T>(!touches_mocap(*problem.tree, problem.patches[point.patch]));
}

/// The normal impulse of a point that has the velocity u [m/s] under the present one, given all others.
template <Number T>
MANYHANDS_INLINE T opening_impulse(const ContactPoint<T>& point, const DelassusBlock<T>& G, T damping, T u, T impulse) {
  const T zero = constant<T>(0), lowest = constant<T>(-std::numeric_limits<double>::infinity());
  const T hard = fma(min(point.target, zero) - u, G.normal_inverse, impulse);
  const T yielding = fma(G.normal, impulse, point.target - u) / (G.normal + damping);
  const auto acts = (point.target > lowest) & (point.softness == zero) & (G.normal_inverse > zero);
  return select(acts, max(max(hard, select(shall_open(point), yielding, zero)), zero), zero);
}

/// One visit of a patch. `largest` is at least by how much that changed a point's velocity [m/s].
template <Number T>
MANYHANDS_INLINE void relax_opening(const ContactProblem<T>& problem, const Factors<T>& factors, std::size_t k,
                                    mask_t<T> active, Recovery<T>& recovery, T& largest) {
  const ContactPatch<T>& patch = problem.patches[k];
  const T zero = constant<T>(0), damping = constant<T>(contact_settings::kOpeningYields) * factors.mobility[k];
  Motion<T> motion = multiply_patch_Y(patch, factors.Y.data(), recovery.y.data());
  Force<T> change = Force<T>::zero();
  for (std::size_t i = patch.first; i < patch.first + patch.count; ++i) {
    const ContactPoint<T>& point = problem.points[i];
    const T before = recovery.impulse[i], u = velocity_at(patch, point.lever, motion).x;
    const T after = opening_impulse(point, factors.points[i], damping, u, before);
    recovery.impulse[i] = select(active, after, before);
    const T step = recovery.impulse[i] - before;
    largest = max(largest, factors.points[i].normal * abs(step));
    const Force<T> force = force_at(patch, point.lever, {step, zero, zero});
    change = change + force;
    motion = motion + respond(patch, factors.patches[k], force);
  }
  add_patch_YT(patch, factors.Y.data(), change, recovery.y.data());
}

/// What the points' velocities start from, less what their laws ask for.
template <Number T>
MANYHANDS_INLINE void begin_offsets(const ContactProblem<T>& problem, Recovery<T>& recovery, Factors<T>& factors) {
  const T slow = constant<T>(contact_settings::kSlowCorrection);
  recovery.asked = mask_t<T>(false);
  factors.offsets.resize(problem.points.size());
  recovery.impulse.resize(problem.points.size());
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    const ContactPoint<T>& point = problem.points[i];
    factors.offsets[i] = {point.offset.x - point.target, point.offset.y, point.offset.z};
    recovery.asked = recovery.asked | (may_wait(problem, point) & (point.target > slow));
  }
}

/// Lowers the demands of what shall open to what it attains under the present active set. After `factor_contacts`.
template <Number T>
MANYHANDS_INLINE void limit_opening(const ContactProblem<T>& problem, Recovery<T>& recovery, Factors<T>& factors) {
  const T zero = constant<T>(0), enough = constant<T>(contact_settings::kOpeningTolerance);
  recovery.impulse.assign(problem.points.size(), zero);
  recovery.y.assign(recovery.y.size(), zero);
  mask_t<T> active = recovery.asked;
  for (int pass = 0; pass < contact_settings::kOpeningPasses && any(active); ++pass) {
    T largest = zero;
    for (std::size_t k = 0; k < problem.patches.size(); ++k)
      relax_opening(problem, factors, k, active, recovery, largest);
    active = active & (largest > enough);
  }
  for (const ContactPatch<T>& patch : problem.patches) {
    const Motion<T> motion = multiply_patch_Y(patch, factors.Y.data(), recovery.y.data());
    for (std::size_t i = patch.first; i < patch.first + patch.count; ++i) {
      const ContactPoint<T>& point = problem.points[i];
      const T attained = clamp(velocity_at(patch, point.lever, motion).x, zero, point.target);
      T& offset = factors.offsets[i].x;
      offset = select(recovery.asked & may_wait(problem, point), max(point.offset.x - attained, offset), offset);
    }
  }
}

}  // namespace internal

}  // namespace manyhands
