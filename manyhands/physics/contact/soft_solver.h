// What contacts do where their laws contradict each other: parts that overlap from both sides, friction that wedges.
//
// Exact laws then have no solution, and the iterations run away. A solution that holds costs no more energy than the
// motion has, parting and closing aside; where the one found does, this one takes its place: projected Gauss-Seidel
// with every row softened by a part of its own mobility, whose impulses stay bounded (Bullet's and ODE's solver, with
// their constraint force mixing). It is wrong by that part, and calm.
#pragma once

#include "manyhands/physics/contact/gauss_seidel.h"
#include "manyhands/physics/contact/joint_solver.h"

namespace manyhands {

/// A solution to go back to. Scratch.
template <Number T>
struct SoftSolver {
  explicit SoftSolver(int nv) : kept(nv), velocity(index(nv)), momentum(velocity) {}

  Iterate<T> kept;
  std::vector<T> velocity, momentum;  ///< (nv)
};

namespace internal {

/// Signorini's and Coulomb's laws, softened: the normal impulse first, then each tangent, within the cone.
struct SoftLaw {
  template <Number T>
  static MANYHANDS_INLINE Vec3<T> solve(const DelassusBlock<T>& G, const Vec3<T>& u, const Vec3<T>& impulse, T&) {
    const T zero = constant<T>(0), one = constant<T>(1), soft = constant<T>(contact_settings::kSoftening);
    const T least = constant<T>(SolverTraits<real_t<T>>::kSmallest), share = one / (one + soft);
    const T n = max(fma(share, -fma(u.x, G.normal_inverse, soft * impulse.x), impulse.x), zero);
    const T du_n = G.normal * (n - impulse.x);
    const T G_1 = max(fma(G.slope_1 * G.slope_1, G.normal, G.sigma_1), least);
    const T G_2 = max(fma(G.slope_2 * G.slope_2, G.normal, G.sigma_2), least);
    const T u_1 = fma(G.slope_1, du_n, u.y);
    T y_1 = impulse.y - share * (u_1 / G_1 + soft * impulse.y);
    const T u_2 = fma(G.slope_2, fma(G.slope_1 * G.normal, y_1 - impulse.y, du_n), u.z);
    T y_2 = impulse.z - share * (u_2 / G_2 + soft * impulse.z);
    const T length = sqrt(fma(y_1, y_1, y_2 * y_2));
    const T within = select(length > n, n / max(length, least), one);
    y_1 = within * y_1;
    y_2 = within * y_2;
    const auto pushes = (n > zero) & (G.normal_inverse > zero);
    return {select(pushes, n, zero), select(pushes, y_1, zero), select(pushes, y_2, zero)};
  }
};

/// Kinetic energy after the step [J].
template <Number T>
MANYHANDS_INLINE T energy_after(const ContactProblem<T>& problem, const std::vector<T>& dv, SoftSolver<T>& soft) {
  T sum = constant<T>(0);
  for (std::size_t i = 0; i < dv.size(); ++i) soft.velocity[i] = problem.v[i] + dv[i];
  multiply_tree_matrix<T>(*problem.tree, problem.M(), soft.velocity.data(), soft.momentum.data());
  for (std::size_t i = 0; i < dv.size(); ++i) sum = fma(soft.velocity[i], soft.momentum[i], sum);
  return constant<T>(0.5) * sum;
}

/// Energy that a step may leave [J]: what there was, and that of everything at the speed at which surfaces part and
/// equality constraints close.
template <Number T>
MANYHANDS_INLINE T harmless_energy(const ContactProblem<T>& problem, const Factors<T>& factors) {
  T speed = constant<T>(contact_settings::kHarmlessSpeed), twice = constant<T>(0);
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    const T parts = problem.points[i].offset.x - factors.offsets[i].x;  // not a number where there is no point
    speed = select(parts > speed, parts, speed);
  }
  for (std::size_t i = 0; i < problem.num_equality_rows; ++i) speed = max(speed, abs(factors.closing[i]));
  for (std::size_t i = 0; i < index(problem.tree->nv); ++i) {
    const T inertia = tree_row(*problem.tree, problem.M(), i)[i];
    twice = fma(inertia, fma(problem.v[i], problem.v[i], speed * speed), twice);
  }
  return constant<T>(0.5) * twice;
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
  for (std::size_t i = 0; i < iterate.points.size(); ++i)
    iterate.points[i].impulse = select(changed, iterate.points[i].impulse, before.points[i].impulse);
  for (std::size_t i = 0; i < iterate.torsions.size(); ++i)
    iterate.torsions[i].impulse = select(changed, iterate.torsions[i].impulse, before.torsions[i].impulse);
  for (std::size_t i = 0; i < iterate.equalities.size(); ++i)
    iterate.equalities[i] = select(changed, iterate.equalities[i], before.equalities[i]);
}

/// The solution under the joints' laws alone: no impulse of contacts and equality constraints.
template <Number T>
MANYHANDS_INLINE void solve_alone(const ContactProblem<T>& problem, Factors<T>& factors, std::vector<T>& next_state,
                                  Iterate<T>& iterate) {
  for (PointImpulse<T>& point : iterate.points) point.impulse = Vec3<T>::zero();
  for (PointImpulse<T>& torsion : iterate.torsions) torsion.impulse = Vec3<T>::zero();
  for (Vec3<T>& impulse : iterate.equalities) impulse = Vec3<T>::zero();
  iterate.active_set = problem.joints.first_state;
  iterate.rhs = problem.joints.smooth;
  solve_joints(problem, factors, iterate, next_state);
}

}  // namespace internal

}  // namespace manyhands
