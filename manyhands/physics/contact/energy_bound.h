// The energy that a step can have at most, whatever its impulses: more is no solution.
//
// Impulses of contacts, limits and equality constraints take energy, but for what they ask for: surfaces that part,
// errors that close, joints that return, motors that reach their velocity. In the norm |v|^2 = v^T M v / 2 each adds no
// more than its own motion has, and the norm of a sum is at most the sum of the norms.
#pragma once

#include "manyhands/physics/contact/equality_factors.h"

namespace manyhands {

/// Scratch.
template <Number T>
struct EnergyBound {
  explicit EnergyBound(int nv) : velocity(index(nv)), momentum(velocity) {}

  std::vector<T> velocity, momentum;  ///< (nv)
  std::vector<T> closing;             ///< (equality rows)
};

namespace internal {

/// Kinetic energy [J] where dof i has velocity(i).
template <Number T, class Velocity>
MANYHANDS_INLINE T kinetic_energy(const ContactProblem<T>& problem, Velocity&& velocity, EnergyBound<T>& scratch) {
  const std::size_t nv = scratch.velocity.size();
  T sum = constant<T>(0);
  for (std::size_t i = 0; i < nv; ++i) scratch.velocity[i] = velocity(i);
  multiply_tree_matrix<T>(*problem.tree, problem.M(), scratch.velocity.data(), scratch.momentum.data());
  for (std::size_t i = 0; i < nv; ++i) sum = fma(scratch.velocity[i], scratch.momentum[i], sum);
  return constant<T>(0.5) * sum;
}

/// The norm of the motion that closes the equality constraints as far as they shall [J^1/2]: its energy is
/// c^T K^-1 c / 2.
template <Number T>
MANYHANDS_INLINE T norm_of_closing(const Factors<T>& factors, std::size_t rows, std::vector<T>& scratch) {
  scratch.assign(factors.closing.begin(), factors.closing.begin() + static_cast<std::ptrdiff_t>(rows));
  solve_K(factors.K.data(), factors.K_pivot_inverse.data(), rows, scratch.data());
  T twice = constant<T>(0);
  for (std::size_t i = 0; i < rows; ++i) twice = fma(factors.closing[i], scratch[i], twice);
  return sqrt(constant<T>(0.5) * max(twice, constant<T>(0)));
}

/// The norm of motions that part surfaces, each on its own [J^1/2].
template <Number T>
MANYHANDS_INLINE T norm_of_opening(const ContactProblem<T>& problem, const Factors<T>& factors) {
  const T zero = constant<T>(0);
  T sum = zero;
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    const T opens = asked_opening(problem, factors, i);
    sum = fma(select(opens > zero, opens * opens, zero), factors.points[i].normal_inverse, sum);
  }
  return sqrt(sum);
}

/// The norm of what motors and limits ask of dofs and tendons, and of all that moves at a speed of which there is never
/// too much [J^1/2]. A motor gives no more than the work of its impulse, and its own dof takes no more than that needs
/// to reach its velocity; where equality constraints move others along, they may take all the work.
template <Number T>
MANYHANDS_INLINE T norm_of_joints(const ContactProblem<T>& problem) {
  const JointLaws<T>& laws = problem.joints;
  const T zero = constant<T>(0), half = constant<T>(0.5);
  T sum = zero, inertia = zero;
  for (std::size_t i = 0; i < laws.target.size(); ++i) {
    const T v = law_velocity(problem, i), M = law_inertia(problem, i);
    const T driven = v + laws.target[i], returns = max(return_speed(v, i, laws), zero);
    const T reaches = half * M * (driven * driven), works = laws.max_impulse[i] * abs(driven);
    const bool drives_others = problem.num_equality_rows > 0;
    const T most = drives_others ? select(is_finite(works), works, reaches) : min(works, reaches);
    const T motor = select(laws.max_impulse[i] > zero, most, zero);
    sum += sqrt(motor) + sqrt(half * M) * returns;
    inertia += half * M;
  }
  return fma(constant<T>(contact_settings::kHarmlessSpeed), sqrt(inertia), sum);
}

/// Worlds in which dv leaves more energy than there can be. A world that was beyond all numbers before is none of them:
/// it is reported. `free_change()` is the change of v without constraints, and called only where it matters.
template <Number T, class FreeChange>
MANYHANDS_INLINE mask_t<T> exceeds_energy(const ContactProblem<T>& problem, const Factors<T>& factors,
                                          const std::vector<T>& dv, FreeChange&& free_change, EnergyBound<T>& scratch) {
  const T excess = constant<T>(contact_settings::kExcess);
  const auto energy_with = [&](const std::vector<T>& change) {
    return kinetic_energy(problem, [&](std::size_t i) { return problem.v[i] + change[i]; }, scratch);
  };
  const T has = energy_with(dv);
  const T closing = norm_of_closing(factors, problem.num_equality_rows, scratch.closing);
  const T asked = closing + norm_of_opening(problem, factors) + norm_of_joints(problem);
  const T before = kinetic_energy(problem, [&](std::size_t i) { return problem.v[i]; }, scratch);
  const auto allowed = [&](T energy) {
    const T norm = sqrt(energy) + asked;
    return excess * (norm * norm);
  };
  mask_t<T> exceeds = is_finite(before) & !(has <= allowed(before));
  when(exceeds, [&] {
    const T free = energy_with(free_change());
    exceeds = exceeds & !(has <= allowed(max(before, free)));
  });
  return exceeds;
}

}  // namespace internal

}  // namespace manyhands
