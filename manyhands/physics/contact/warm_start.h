// Where the solver starts: the impulses and constraint states of the last step, as far as they fit this one.
#pragma once

#include "manyhands/physics/contact/contact_cache.h"

namespace manyhands {

namespace internal {

/// The friction impulse of the last step within the cone of this one.
template <Number T>
MANYHANDS_INLINE Vec3<T> within_cone(const Vec3<T>& impulse) {
  const T zero = constant<T>(0), one = constant<T>(1), n = max(impulse.x, zero);
  const T length = sqrt(fma(impulse.y, impulse.y, impulse.z * impulse.z));
  const T scale = select(length > n, n / select(length > n, length, one), one);
  return {n, scale * impulse.y, scale * impulse.z};
}

/// Impulses of a patch's points and torsions from those of the last step, in world axes.
template <Number T>
MANYHANDS_INLINE void start_patch(const ContactProblem<T>& problem, const ContactPatch<T>& patch,
                                  const std::array<Vec3<T>, kManifoldPoints>& impulse,
                                  const std::array<Vec3<T>, kManifoldPoints>& moment, Iterate<T>& iterate) {
  const T zero = constant<T>(0), least = constant<T>(contact_settings::kLeastFriction);
  const auto along = [&](const Vec3<T>& world, const Vec3<T>& t, T friction) {
    return select(friction > zero, dot(world, t) / max(friction, least), zero);
  };
  for (std::size_t i = patch.first; i < patch.first + patch.count; ++i) {
    const ContactPoint<T>& point = problem.points[i];
    const Vec3<T>& old = impulse[point.index];
    const Vec3<T> y{dot(old, patch.normal), along(old, patch.t_1, patch.friction_1),
                    along(old, patch.t_2, patch.friction_2)};
    const auto carries_on = is_finite(point.phi) & (point.bounces == zero);
    iterate.points[i].impulse = select(carries_on, within_cone(y), Vec3<T>::zero());
    iterate.points[i].slide_x = zero;
    if (point.torsion < 0) continue;
    PointImpulse<T>& torsion = iterate.torsions[index(point.torsion)];
    const Vec3<T>& m = moment[point.index];
    torsion.impulse = {dot(m, patch.normal), dot(m, patch.t_1), dot(m, patch.t_2)};
    torsion.slide_x = zero;
  }
}

}  // namespace internal

/// Fills the iterate from the state and from what the touches of this step, one for each patch, have in the cache.
template <Number T>
MANYHANDS_INLINE void warm_start(const ContactProblem<T>& problem, std::span<const Touch<T>> touches,
                                 const State<T>& state, Iterate<T>& iterate) {
  iterate.active_set = problem.joints.first_state;
  iterate.calm = state.calm()[0];
  iterate.patches.resize(problem.patches.size());
  iterate.points.resize(problem.points.size());
  iterate.torsions.resize(problem.torsions.size());
  iterate.equalities.resize(problem.equalities.size());
  const std::span<const CachedManifold<T>> cache = cached_manifolds(state.contact_cache());
  for (std::size_t k = 0; k < problem.patches.size(); ++k) {
    std::array<Vec3<T>, kManifoldPoints> impulse, moment;
    match_points(cache[touches[k].manifold], touches[k].contact, impulse, moment);
    internal::start_patch(problem, problem.patches[k], impulse, moment, iterate);
  }
  for (std::size_t k = 0; k < problem.equalities.size(); ++k) {
    const EqualityRows<T>& equality = problem.equalities[k];
    const T* old = &state.equality_impulses()[equality.cache];
    iterate.equalities[k] = select(equality.acts, Vec3<T>{old[0], old[1], old[2]}, Vec3<T>::zero());
  }
  gather_impulses(problem, iterate);
}

/// Writes down what the next step starts from. A zero is added because its sign would tell what other lanes have
/// solved.
template <Number T>
MANYHANDS_INLINE void store_warm_start(const ContactProblem<T>& problem, const Iterate<T>& iterate, State<T>& state) {
  const T zero = constant<T>(0);
  for (std::size_t i = 0; i < index(problem.tree->nv); ++i) {
    state.active_set()[i] = iterate.active_set[i];
    state.dv()[i] = iterate.dv[i] + zero;
    state.joint_impulse()[i] = iterate.joint_impulse[i] + zero;
  }
  state.calm()[0] = iterate.calm;
  const std::span<T> impulses = state.equality_impulses();
  for (T& number : impulses) number = zero;
  for (std::size_t k = 0; k < problem.equalities.size(); ++k) {
    T* numbers = &impulses[problem.equalities[k].cache];
    numbers[0] = iterate.equalities[k].x;
    numbers[1] = iterate.equalities[k].y;
    numbers[2] = iterate.equalities[k].z;
  }
  store_contacts(problem, iterate, cached_manifolds(state.contact_cache()));
}

}  // namespace manyhands
