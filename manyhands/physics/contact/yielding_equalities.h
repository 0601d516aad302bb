// Equality constraints that give way by a compliance: no rows to be solved for, but forces that are implicit in the
// velocity, as springs and dampers are. M += J^T slope J, smooth += J^T pull.
#pragma once

#include "manyhands/physics/contact/assemble_equalities.h"
#include "manyhands/physics/dynamics/yielding.h"

namespace manyhands {

namespace internal {

/// Adds the rows, where `mobility` is W. They yield at least by what rounding needs; one that no joint moves does
/// nothing.
template <Number T>
MANYHANDS_INLINE void add_yielding_rows(const TreeEquality<real_t<T>>& equality, real_t<T> h, T impedance, T mobility,
                                        const RowBlock& block, const FrameRows<T>& rows, Workspace<T>& ws,
                                        ContactProblem<T>& problem) {
  const Tree<real_t<T>>& tree = *problem.tree;
  const Vec3<T>* J = problem.rows.J.data();
  Vec3<T> moves = Vec3<T>::zero();
  visit_J(tree, block, [&](std::size_t entry, std::size_t i, real_t<T>) {
    const T inverse = constant<T>(1) / tree_row(tree, ws.M.data(), i)[i];
    moves = moves + Vec3<T>{J[entry].x * J[entry].x * inverse, J[entry].y * J[entry].y * inverse,
                            J[entry].z * J[entry].z * inverse};
  });
  const T zero = constant<T>(0), tiny = constant<T>(SolverTraits<real_t<T>>::kSmallest);
  const auto row = [&](T Vec3<T>::* k) -> YieldingRow<T> {
    const T least = max(moves.*k * constant<T>(1 / SolverTraits<real_t<T>>::kStiffest), tiny);
    const YieldingRow<T> found = yielding_row(*equality.compliance, h, impedance, mobility, least, rows.error.*k,
                                              rows.velocity.*k, rows.acceleration.*k);
    return {select(moves.*k > tiny, found.slope, zero), select(moves.*k > tiny, found.pull, zero)};
  };
  const YieldingRow<T> x = row(&Vec3<T>::x), y = row(&Vec3<T>::y), z = row(&Vec3<T>::z);
  add_JT(tree, block, problem.rows, {x.pull, y.pull, z.pull}, problem.joints.smooth.data());
  visit_J(tree, block, [&](std::size_t entry, std::size_t i, real_t<T>) {
    const Vec3<T> pull{x.slope * J[entry].x, y.slope * J[entry].y, z.slope * J[entry].z};
    visit_J(tree, block, [&](std::size_t other, std::size_t k, real_t<T>) {
      if (k > i) return;
      T& inertia = tree_row(tree, ws.M.data(), i)[k];
      inertia += dot(pull, J[other]);
    });
  });
}

/// How B's origin moves off A's, each on its own body. What slides in A moves as A has it there.
template <Number T>
MANYHANDS_INLINE FrameRows<T> parting_rows(const TreeEquality<real_t<T>>& equality, const FramePair<T>& frames,
                                           const Vec3<T>& p_A, const Workspace<T>& ws) {
  FrameRows<T> rows = linear_rows(equality, frames, ws);
  const PointMotion<T> a = point_motion(ws, equality.body_a, p_A), b = point_motion(ws, equality.body_b, frames.X_B.p);
  const auto along = [&](const Vec3<T>& x) {
    return Vec3<T>{dot(rows.axes[0], x), dot(rows.axes[1], x), dot(rows.axes[2], x)};
  };
  rows.velocity = along(b.velocity - a.velocity);
  rows.acceleration = along(b.acceleration - a.acceleration);
  return rows;
}

/// How B turns against A. Where that is all held, measured as in MuJoCo by e = 2 sin(angle / 2) along the axis, twice
/// the vector r of the quaternion (r, w) between the frames: de/dt = w omega + omega x r, and its derivative is
/// w gamma + gamma x r - |omega|^2 r / 2 with gamma = d omega / dt.
template <Number T>
MANYHANDS_INLINE FrameRows<T> turning_rows(const TreeEquality<real_t<T>>& equality, const FramePair<T>& frames,
                                           const Workspace<T>& ws) {
  FrameRows<T> rows = angular_rows(equality, frames, ws);
  if (equality.type == EqualityType::kHinge || equality.type == EqualityType::kSlider) return rows;
  const Mat3<T>& R_A = frames.X_A.R;
  const Quat<T> q = to_quat(transpose(R_A) * frames.X_B.R);
  const T sign = copysign(constant<T>(1), q.w), w = sign * q.w;
  const Vec3<T> r = sign * Vec3<T>{q.x, q.y, q.z}, r_W = R_A * r, omega = rows.velocity, gamma = rows.acceleration;
  for (Vec3<T>& axis : rows.axes) axis = fma(w, axis, cross(r_W, axis));
  rows.velocity = fma(w, omega, cross(omega, r));
  rows.acceleration = fma(w, gamma, cross(gamma, r)) - (constant<T>(0.5) * squared_norm(omega)) * r;
  rows.error = constant<T>(2) * r;
  return rows;
}

/// Of two frames.
template <Number T>
[[gnu::noinline]] void add_yielding_frames(const TreeEquality<real_t<T>>& equality, real_t<T> h, Workspace<T>& ws,
                                           ContactProblem<T>& problem) {
  const Tree<real_t<T>>& tree = *problem.tree;
  const FramePair<T> frames = place_frames(equality, ws);
  const bool slides = equality.type == EqualityType::kPrismatic || equality.type == EqualityType::kSlider;
  const Vec3<T> p_A = slides ? frames.X_B.p : frames.X_A.p;
  const FrameRows<T> linear = parting_rows(equality, frames, p_A, ws);
  FrameRows<T> angular{};
  T square = squared_norm(linear.error);
  if (equality.turns) {
    angular = turning_rows(equality, frames, ws);
    square = fma(T(equality.arm * equality.arm), squared_norm(angular.error), square);
  }
  const T impedance = impedance_at(*equality.compliance, sqrt(square));
  const std::size_t used_J = problem.rows.used_J, used_Y = problem.rows.used_Y;
  const RowBlock block = add_rows(rows_between<T>(tree, equality.body_a, equality.body_b), problem.rows);
  fill_point_rows(tree, ws, block, p_A, frames.X_B.p, linear.axes, problem.rows);
  add_yielding_rows(equality, h, impedance, T(equality.linear), block, linear, ws, problem);
  if (equality.turns) {
    fill_rotation_rows(tree, ws, block, angular.axes, problem.rows);
    add_yielding_rows(equality, h, impedance, T(equality.angular), block, angular, ws, problem);
  }
  problem.rows.used_J = used_J;
  problem.rows.used_Y = used_Y;
}

/// Of two joints.
template <Number T>
[[gnu::noinline]] void add_yielding_joints(const TreeEquality<real_t<T>>& equality, const State<T>& state, real_t<T> h,
                                           Workspace<T>& ws, ContactProblem<T>& problem) {
  const Tree<real_t<T>>& tree = *problem.tree;
  const std::size_t a = equality.dof_a, b = equality.dof_b, later = a > b ? a : b, earlier = a > b ? b : a;
  const T ratio(equality.ratio), tiny = constant<T>(SolverTraits<real_t<T>>::kSmallest);
  const T rate = joint_rate(equality, state), error = joint_error(equality, state);
  T &M_a = tree_row(tree, ws.M.data(), a)[a], &M_b = tree_row(tree, ws.M.data(), b)[b];
  const T moves = constant<T>(1) / M_b + ratio * ratio / M_a;
  const T least = max(moves * constant<T>(1 / SolverTraits<real_t<T>>::kStiffest), tiny);
  const YieldingRow<T> row = yielding_row(*equality.compliance, h, impedance_at(*equality.compliance, error),
                                          T(equality.linear), least, error, rate);
  problem.joints.smooth[a] = fma(-ratio, row.pull, problem.joints.smooth[a]);
  problem.joints.smooth[b] += row.pull;
  M_a = fma(ratio * ratio, row.slope, M_a);
  M_b += row.slope;
  T& coupled = tree_row(tree, ws.M.data(), later)[earlier];
  coupled = fma(-ratio, row.slope, coupled);
}

}  // namespace internal

/// Adds what equality constraints that give way do to M and to the smooth impulse, before M is used. Of tendons they
/// are laws of lengths.
template <Number T>
MANYHANDS_INLINE void assemble_yielding_equalities(const State<T>& state, real_t<T> h, Workspace<T>& ws,
                                                   ContactProblem<T>& problem) {
  for (const TreeEquality<real_t<T>>& equality : problem.tree->equalities) {
    if (!equality.compliance) continue;
    if (equality.joins_bodies()) {
      internal::add_yielding_frames(equality, h, ws, problem);
    } else {
      internal::add_yielding_joints(equality, state, h, ws, problem);
    }
  }
}

}  // namespace manyhands
