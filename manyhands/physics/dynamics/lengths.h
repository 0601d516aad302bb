// The lengths of tendons and of actuators at sites, how fast they change, and the rows J that say so.
#pragma once

#include <limits>

#include "manyhands/physics/dynamics/kinematics.h"
#include "manyhands/physics/dynamics/ltdl.h"

namespace manyhands {

namespace internal {

/// How a point of a body moves: its velocity, and the acceleration that it has by the present velocities alone, gravity
/// taken off everywhere alike.
template <Number T>
struct PointMotion {
  Vec3<T> velocity, acceleration;
};

/// `r`: the point from its tree's origin [m]. After `newton_euler_pass`.
template <Number T>
MANYHANDS_INLINE PointMotion<T> motion_at(const Workspace<T>& ws, std::size_t body, const Vec3<T>& r) {
  if (body == 0) return {Vec3<T>::zero(), ws.A[0].v};
  const Motion<T>&A = ws.A[body], &V = ws.V[body];
  const Vec3<T> velocity = V.v + cross(V.w, r);
  return {velocity, A.v + cross(A.w, r) + cross(V.w, velocity)};
}

/// Adds a straight part of a tendon.
template <Number T>
MANYHANDS_INLINE void add_segment(const TreeSegment<real_t<T>>& segment, std::size_t k, T* J, Workspace<T>& ws) {
  const std::size_t a = segment.body_a, b = segment.body_b;
  const Vec3<T> r_A = ws.R_WB[a] * broadcast<T>(segment.p_A) + ws.p_OB[a];
  const Vec3<T> r_B = ws.R_WB[b] * broadcast<T>(segment.p_B) + ws.p_OB[b];
  const Vec3<T> d = (r_B - r_A) + (ws.p_WO[b] - ws.p_WO[a]);
  const T tiny = constant<T>(1e-15), zero = constant<T>(0), share(segment.share), l = norm(d);  // MuJoCo's mjMINVAL
  const T inverse = select(l > tiny, constant<T>(1) / max(l, tiny), zero);
  const Vec3<T> u = inverse * d;
  const PointMotion<T> of_A = motion_at(ws, a, r_A), of_B = motion_at(ws, b, r_B);
  const Vec3<T> velocity = of_B.velocity - of_A.velocity;
  const T along = dot(u, velocity), across = squared_norm(velocity) - along * along;
  ws.length[k] = fma(share, l, ws.length[k]);
  ws.length_rate[k] = fma(share, along, ws.length_rate[k]);
  const T bend = fma(across, inverse, dot(u, of_B.acceleration - of_A.acceleration));
  ws.length_bend[k] = fma(share, bend, ws.length_bend[k]);
  const Force<T> on_A{cross(r_A, u), u}, on_B{cross(r_B, u), u};
  for (const TreeLever<real_t<T>>& lever : segment.levers) {
    const T moves = dot(ws.S[lever.dof], lever.sign < 0 ? on_A : on_B);
    J[lever.entry] = fma(T(lever.sign * segment.share), moves, J[lever.entry]);
  }
}

/// The wrench of an actuator at a site, and where the site is from its reference. Rare, and not worth its room in step.
template <Number T>
void place_site(const TreeSite<real_t<T>>& site, std::size_t k, T* J, Workspace<T>& ws) {
  const std::size_t a = site.body_a, b = site.body_b;
  const Vec3<T> r_S = ws.R_WB[a] * broadcast<T>(site.X_AS.p) + ws.p_OB[a];
  const Mat3<T> R_WS = ws.R_WB[a] * broadcast<T>(site.X_AS.R);
  const Vec3<T> r_R = ws.R_WB[b] * broadcast<T>(site.X_BR.p) + ws.p_OB[b];
  const Mat3<T> R_WR = site.has_reference ? ws.R_WB[b] * broadcast<T>(site.X_BR.R) : R_WS;
  const Vec3<T> f = R_WR * broadcast<T>(site.force), n = R_WR * broadcast<T>(site.torque);
  if (site.has_reference) {
    const Vec3<T> way = (r_S - r_R) + (ws.p_WO[a] - ws.p_WO[b]);
    const Vec3<T> turn = rotation_vector(to_quat(transpose(R_WR) * R_WS));
    ws.length[k] = dot(f, way) + dot(broadcast<T>(site.torque), turn);
  }
  const Force<T> on_S{n + cross(r_S, f), f}, on_R{n + cross(r_R, f), f};
  for (const TreeLever<real_t<T>>& lever : site.levers) {
    const T moves = dot(ws.S[lever.dof], lever.sign < 0 ? on_R : on_S);
    J[lever.entry] = fma(T(lever.sign), moves, J[lever.entry]);
  }
}

/// What couples two lengths: (b - reference_b) - polynomial(a - reference_a).
template <Number T>
MANYHANDS_INLINE void couple(const Tree<real_t<T>>& tree, std::size_t k, Workspace<T>& ws) {
  const TreeLength<real_t<T>>& length = tree.lengths[k];
  const std::size_t b = static_cast<std::size_t>(length.b), a = static_cast<std::size_t>(std::max(length.a, 0));
  const T zero = constant<T>(0), x = length.a < 0 ? zero : ws.length[a] - T(length.reference_a);
  T p = zero, slope = zero, curvature = zero;
  for (std::size_t i = length.polynomial.size(); i-- > 0;) {
    curvature = fma(curvature, x, constant<T>(2) * slope);
    slope = fma(slope, x, p);
    p = fma(p, x, T(length.polynomial[i]));
  }
  const T rate_a = length.a < 0 ? zero : ws.length_rate[a], bend_a = length.a < 0 ? zero : ws.length_bend[a];
  ws.length[k] = (ws.length[b] - T(length.reference_b)) - p;
  ws.length_rate[k] = fma(-slope, rate_a, ws.length_rate[b]);
  ws.length_bend[k] = fma(-curvature, rate_a * rate_a, fma(-slope, bend_a, ws.length_bend[b]));
  T* J = ws.length_J.data() + length.J;
  for (std::size_t i = 0; i < length.dofs.size(); ++i) {
    const int in_a = length.in_a[i], in_b = length.in_b[i];
    const T of_b = in_b < 0 ? zero : ws.length_J[tree.lengths[b].J + static_cast<std::size_t>(in_b)];
    J[i] = in_a < 0 ? of_b : fma(-slope, ws.length_J[tree.lengths[a].J + static_cast<std::size_t>(in_a)], of_b);
  }
}

}  // namespace internal

/// J x of length k, for x (nv).
template <Number T>
[[nodiscard]] MANYHANDS_INLINE T along_length(const Tree<real_t<T>>& tree, const Workspace<T>& ws, std::size_t k,
                                              const T* x) {
  const TreeLength<real_t<T>>& length = tree.lengths[k];
  const T* J = ws.length_J.data() + length.J;
  T sum = constant<T>(0);
  for (std::size_t i = 0; i < length.dofs.size(); ++i) sum = fma(J[i], x[length.dofs[i]], sum);
  return sum;
}

/// Lengths, their rates and rows J, and how they bend, dJ/dt v, in the state q (nq), v (nv), whose bodies are placed
/// and moved. Bends are right after `newton_euler_pass` without accelerations.
template <Number T>
MANYHANDS_INLINE void place_lengths(const Tree<real_t<T>>& tree, const T* q, const T* v, Workspace<T>& ws) {
  const T zero = constant<T>(0);
  for (std::size_t k = 0; k < tree.lengths.size(); ++k) {
    const TreeLength<real_t<T>>& length = tree.lengths[k];
    if (length.type == LengthType::kCoupling) {
      internal::couple(tree, k, ws);
      continue;
    }
    ws.length[k] = ws.length_rate[k] = ws.length_bend[k] = zero;
    T* J = ws.length_J.data() + length.J;
    for (std::size_t i = 0; i < length.dofs.size(); ++i) J[i] = zero;
    for (const TreeSegment<real_t<T>>& segment : length.segments) internal::add_segment(segment, k, J, ws);
    if (length.type == LengthType::kSite) {
      internal::place_site(length.site, k, J, ws);
      ws.length_rate[k] = along_length(tree, ws, k, v);
    }
    for (std::size_t i = 0; i < length.q.size(); ++i) {
      J[i] = T(length.weights[i]);
      ws.length[k] = fma(J[i], q[length.q[i]], ws.length[k]);
      ws.length_rate[k] = fma(J[i], v[length.dofs[i]], ws.length_rate[k]);
    }
  }
}

/// x += J^T force of length k, for x (nv).
template <Number T>
MANYHANDS_INLINE void add_along_length(const Tree<real_t<T>>& tree, const Workspace<T>& ws, std::size_t k, T force,
                                       T* x) {
  const TreeLength<real_t<T>>& length = tree.lengths[k];
  const T* J = ws.length_J.data() + length.J;
  for (std::size_t i = 0; i < length.dofs.size(); ++i) x[length.dofs[i]] = fma(J[i], force, x[length.dofs[i]]);
}

/// M += J^T mass J of length k, in M's packed lower triangle, with J of dof i multiplied by factor(i).
template <Number T, class Factor>
MANYHANDS_INLINE void add_length_square(const Tree<real_t<T>>& tree, const Workspace<T>& ws, std::size_t k, T mass,
                                        T* M, Factor&& factor) {
  const TreeLength<real_t<T>>& length = tree.lengths[k];
  const T* J = ws.length_J.data() + length.J;
  for (std::size_t i = 0; i < length.dofs.size(); ++i) {
    const auto dof = static_cast<std::size_t>(length.dofs[i]);
    const T pull = mass * (J[i] * factor(dof));
    T* row = M + tree.M_row[dof];
    for (std::size_t j = 0; j <= i; ++j) {
      const int other = length.dofs[j];
      row[other] = fma(pull, J[j] * factor(static_cast<std::size_t>(other)), row[other]);
    }
  }
}

/// The inertia that length k meets where its dofs move one at a time, and move it by factor(dof) of what J says:
/// 1 / sum of factor J^2 / M_ii. `otherwise` where none of them moves it.
template <Number T, class Factor>
[[nodiscard]] MANYHANDS_INLINE T length_inertia(const Tree<real_t<T>>& tree, const Workspace<T>& ws, std::size_t k,
                                                T otherwise, Factor&& factor) {
  const TreeLength<real_t<T>>& length = tree.lengths[k];
  const T tiny(real_t<T>(1e6) * std::numeric_limits<real_t<T>>::min()), one = constant<T>(1);
  T mobility = constant<T>(0);
  for (std::size_t i = 0; i < length.dofs.size(); ++i) {
    const auto dof = static_cast<std::size_t>(length.dofs[i]);
    const T J = ws.length_J[length.J + i];
    mobility = fma(factor(dof), J * J / tree_row(tree, ws.M.data(), dof)[dof], mobility);
  }
  const auto moves = mobility > tiny;
  return select(moves, one / select(moves, mobility, one), otherwise);
}

/// Calls visit(tendon, stiffness, stretch) for every tendon that has a spring in any world. Within the lengths at which
/// it rests, both are 0. After `place_lengths`.
template <Number T, Number P, class Visit>
MANYHANDS_INLINE void visit_tendon_springs(const Params<P>& params, const Workspace<T>& ws, Visit&& visit) {
  const T zero = constant<T>(0);
  for (std::size_t k = 0; k < params.tendon_stiffness.size(); ++k) {
    if (!any(params.tendon_stiffness[k] > constant<P>(0))) continue;
    const T lower = broadcast<T>(params.tendon_rest_lower[k]), upper = broadcast<T>(params.tendon_rest_upper[k]);
    const auto is_short = ws.length[k] <= lower, is_long = ws.length[k] >= upper;
    const T stretch = select(is_short, ws.length[k] - lower, select(is_long, ws.length[k] - upper, zero));
    visit(k, select(is_short | is_long, broadcast<T>(params.tendon_stiffness[k]), zero), stretch);
  }
}

}  // namespace manyhands
