// Operational space control: a frame moves as a unit mass that is told where to go, pushes where it is told to push,
// and what freedom is left serves a second task (Khatib, A unified approach for motion and force control of robot
// manipulators: the operational space formulation, IEEE J. Robotics and Automation 3(1), 1987).
#pragma once

#include <array>

#include "manyhands/kinematics/inverse_kinematics.h"
#include "manyhands/math/linear6.h"
#include "manyhands/physics/dynamics/crba.h"
#include "manyhands/physics/dynamics/jacobians.h"
#include "manyhands/physics/dynamics/ltdl.h"

namespace manyhands {

/// What becomes of one of the six directions of a frame.
enum class TaskDirection {
  kMotion,  ///< it follows the goal
  kForce,   ///< the frame pushes with the force that is asked for, and its velocity is damped
  kFree,    ///< left to the second task
};

/// Of the six directions, about and along the axes of the goal: rotations first.
struct OperationalTask {
  std::array<TaskDirection, 6> directions{};
  double kp = 400;               ///< of motion: acceleration per error [1/s^2]
  double kd = 40;                ///< [1/s]
  double rotational_kp = 400;    ///< [1/s^2]
  double rotational_kd = 40;     ///< [1/s]
  double force_damping = 10;     ///< of the velocity along force directions [N s/m]; about them [N m s/rad]
  double regularisation = 1e-6;  ///< of J M^-1 J^T, relative to its largest diagonal entry: at singular postures
                                 ///< accelerations that nothing can give are not asked for
};

/// Where a frame shall be, and how it moves there: at its origin, in world axes.
template <Number T>
struct OperationalGoal {
  Transform<T> X;
  Motion<T> V, A;
  Force<T> F;  ///< with which it pushes along force directions, in the goal's axes
};

/// Scratch of `operational_space`: the frame's Jacobian as columns, and the half response D^-1/2 L^-T J^T.
template <Number T>
struct OperationalWorkspace {
  explicit OperationalWorkspace(const Tree<real_t<T>>& tree)
      : J(static_cast<std::size_t>(tree.nv), Motion<T>::zero()), Y(J), tau(J.size()) {}

  std::vector<Motion<T>> J, Y;  ///< (nv)
  std::vector<T> tau;           ///< (nv)
};

namespace internal {

template <Number T>
MANYHANDS_INLINE std::array<T, 6> as_numbers(const Motion<T>& m) {
  return {m.w.x, m.w.y, m.w.z, m.v.x, m.v.y, m.v.z};
}

template <Number T>
MANYHANDS_INLINE Motion<T> as_motion(const std::array<T, 6>& x) {
  return {{x[0], x[1], x[2]}, {x[3], x[4], x[5]}};
}

/// The motion in task axes with the directions that are not taken left out.
template <Number T, class Taken>
MANYHANDS_INLINE Motion<T> taken_part(const OperationalTask& task, const Mat3<T>& R, const Motion<T>& m,
                                      Taken&& taken) {
  std::array<T, 6> x = as_numbers(Motion<T>{transpose_times(R, m.w), transpose_times(R, m.v)});
  for (std::size_t i = 0; i < 6; ++i) {
    if (!taken(task.directions[i])) x[i] = constant<T>(0);
  }
  return as_motion(x);
}

/// How the frame moves, and dJ/dt v.
template <Number T>
struct FrameMotion {
  Motion<T> V, dJ_v;
};

/// Sets the columns of J; after `bias_and_mass_matrix`.
template <Number T>
MANYHANDS_INLINE FrameMotion<T> find_jacobian(const Tree<real_t<T>>& tree, BodyId body,
                                              const Transform<real_t<T>>& X_BF, const T* v,
                                              OperationalWorkspace<T>& scratch, const Workspace<T>& ws) {
  FrameMotion<T> found{Motion<T>::zero(), Motion<T>::zero()};
  for (Motion<T>& column : scratch.J) column = Motion<T>::zero();
  visit_jacobian(tree, body, X_BF.p, ws, [&](int k, const Motion<T>& column) {
    scratch.J[static_cast<std::size_t>(k)] = column;
    found.V = fma(v[k], column, found.V);
  });
  visit_jacobian_derivative(tree, JacobianForm::kMixed, body, X_BF, ws,
                            [&](int k, const Motion<T>& column) { found.dJ_v = fma(v[k], column, found.dJ_v); });
  return found;
}

/// J M^-1 J^T of the rows that are taken, in task axes, and ones on the diagonal for the others; with M factored.
template <Number T, class Taken>
MANYHANDS_INLINE SymMat6<T> inverse_inertia(const Tree<real_t<T>>& tree, const OperationalTask& task, const Mat3<T>& R,
                                            OperationalWorkspace<T>& scratch, const Workspace<T>& ws, Taken&& taken) {
  for (std::size_t i = 0; i < scratch.J.size(); ++i) scratch.Y[i] = taken_part(task, R, scratch.J[i], taken);
  solve_to_root(tree.dofs_from_leaves, tree.M_parent.data(), tree.M_row.data(), ws.M.data(), scratch.Y.data());
  std::array<T, 6> diagonal{};
  diagonal.fill(constant<T>(0));
  for (std::size_t i = 0; i < scratch.Y.size(); ++i) {
    scratch.Y[i] = sqrt(tree_row(tree, ws.M.data(), i)[i]) * scratch.Y[i];
    const std::array<T, 6> y = as_numbers(scratch.Y[i]);
    for (std::size_t k = 0; k < 6; ++k) diagonal[k] = fma(y[k], y[k], diagonal[k]);
  }
  T largest = constant<T>(0);
  for (const T& d : diagonal) largest = max(largest, d);
  SymMat6<T> A = SymMat6<T>::diagonal(constant<T>(task.regularisation) * largest);
  for (const Motion<T>& y : scratch.Y) A.add_outer_product(y);
  for (std::size_t k = 0; k < 6; ++k) {
    std::array<T, 6> unit{};
    unit.fill(constant<T>(0));
    unit[k] = constant<T>(1);
    if (!taken(task.directions[k])) A.add_outer_product(as_motion(unit));
  }
  return A;
}

/// tau += J^T of a moment and force in task axes.
template <Number T>
MANYHANDS_INLINE void add_task_force(const Mat3<T>& R, const Motion<T>& f, const OperationalWorkspace<T>& scratch,
                                     T* tau) {
  const Force<T> F{R * f.w, R * f.v};
  for (std::size_t i = 0; i < scratch.J.size(); ++i) tau[i] = tau[i] + dot(scratch.J[i], F);
}

}  // namespace internal

/// tau (nv) = C v + g + J_f^T f + J_m^T Lambda_m (a - dJ/dt v) + N^T posture, where
///     a = A + kd (V_goal - V) + kp error,   Lambda = (J M^-1 J^T)^-1,   N^T = 1 - J_mf^T Lambda_mf J_mf M^-1
/// with the rows m of motion, f of force and mf of both. `posture` (nv) are the second task's joint forces, or null.
/// A force that meets resistance is met exactly when nothing moves: the motion directions do not lean on it.
template <Number T, Number P>
void operational_space(const Tree<real_t<T>>& tree, const Params<P>& params, BodyId body,
                       const Transform<real_t<T>>& X_BF, const OperationalTask& task, const T* q, const T* v,
                       const OperationalGoal<T>& goal, const T* posture, T* tau, OperationalWorkspace<T>& scratch,
                       Workspace<T>& ws) {
  const Mat3<T>& R = goal.X.R;
  const auto is_motion = [](TaskDirection d) { return d == TaskDirection::kMotion; };
  const auto is_force = [](TaskDirection d) { return d == TaskDirection::kForce; };
  const auto is_held = [](TaskDirection d) { return d != TaskDirection::kFree; };
  const auto gains = [](double rotational, double linear, const Motion<T>& m) {
    return Motion<T>{constant<T>(rotational) * m.w, constant<T>(linear) * m.v};
  };

  bias_and_mass_matrix(tree, params, q, v, ws);
  for (std::size_t i = 0; i < ws.bias.size(); ++i) tau[i] = ws.bias[i];
  factor_ltdl(tree.dofs_from_leaves, tree.M_parent.data(), tree.M_row.data(), ws.M.data());
  const internal::FrameMotion<T> moving = internal::find_jacobian(tree, body, X_BF, v, scratch, ws);

  const Motion<T> e = internal::pose_error(goal.X, frame_pose(body, X_BF, ws));
  const Motion<T> a = goal.A + gains(task.rotational_kp, task.kp, e) +
                      gains(task.rotational_kd, task.kd, goal.V - moving.V) - moving.dJ_v;
  SymMat6<T> moved = internal::inverse_inertia(tree, task, R, scratch, ws, is_motion);
  internal::add_task_force(R, moved.solve(internal::taken_part(task, R, a, is_motion)), scratch, tau);
  const Motion<T> damping = constant<T>(-task.force_damping) * moving.V;
  const Motion<T> push = damping + Motion<T>{R * goal.F.n, R * goal.F.f};
  internal::add_task_force(R, internal::taken_part(task, R, push, is_force), scratch, tau);
  if (posture == nullptr) return;

  SymMat6<T> held = internal::inverse_inertia(tree, task, R, scratch, ws, is_held);
  for (std::size_t i = 0; i < scratch.tau.size(); ++i) scratch.tau[i] = posture[i];
  solve_ltdl(tree.dofs_from_leaves, tree.M_parent.data(), tree.M_row.data(), ws.M.data(), scratch.tau.data());
  Motion<T> drift = Motion<T>::zero();
  for (std::size_t i = 0; i < scratch.J.size(); ++i) drift = fma(-scratch.tau[i], scratch.J[i], drift);
  internal::add_task_force(R, held.solve(internal::taken_part(task, R, drift, is_held)), scratch, tau);
  for (std::size_t i = 0; i < scratch.J.size(); ++i) tau[i] = tau[i] + posture[i];
}

}  // namespace manyhands
