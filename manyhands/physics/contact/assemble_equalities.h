// The rows of equality constraints: equations between bodies or joints that hold at the step's end.
#pragma once

#include "manyhands/physics/contact/contact_problem.h"
#include "manyhands/physics/contact/motion_rows.h"

namespace manyhands {

namespace internal {

/// Asks rows whose error is e to close: by the step's end it shall be 0 to third order, e + h u+ + h^2 / 2 gamma = 0.
template <Number T>
MANYHANDS_INLINE void ask_to_close(const Vec3<T>& e, const Vec3<T>& gamma, real_t<T> h, EqualityRows<T>& block) {
  const T most = constant<T>(contact_settings::kMaxClosing), inverse_h(real_t<T>(1) / h);
  const T far = constant<T>(contact_settings::kFarSteps) * most;
  const auto closing = [&](T error) {
    const T speed = error * inverse_h;
    block.far = block.far | (abs(speed) > far);
    return clamp(speed, -most, most);
  };
  block.closing = fma(T(real_t<T>(0.5) * h), gamma, Vec3<T>{closing(e.x), closing(e.y), closing(e.z)});
}

template <Number T>
MANYHANDS_INLINE Vec3<T> masked(const Vec3<T>& a, const std::array<bool, 3>& keep) {
  const T zero = constant<T>(0);
  return {keep[0] ? a.x : zero, keep[1] ? a.y : zero, keep[2] ? a.z : zero};
}

/// Three more rows of the equality constraint `index`.
template <Number T>
MANYHANDS_INLINE EqualityRows<T>& add_equality_rows(std::size_t index, std::size_t cache, const RowBlock& bodies,
                                                    real_t<T> h, ContactProblem<T>& problem) {
  EqualityRows<T>& block = problem.equalities.emplace_back();
  block.equality = index;
  block.cache = cache;
  block.max_impulse = T(h * problem.tree->equalities[index].max_force);
  block.rows = add_rows(bodies, problem.rows);
  return block;
}

/// Where the two frames of an equality are, in the world.
template <Number T>
struct FramePair {
  Transform<T> X_A, X_B;
};

template <Number T>
MANYHANDS_INLINE FramePair<T> place_frames(const TreeEquality<real_t<T>>& equality, const Workspace<T>& ws) {
  const auto pose = [&](std::size_t body, const Transform<real_t<T>>& X) {
    return body_pose(body, ws) * broadcast<T>(X);
  };
  return {pose(equality.body_a, equality.X_BA), pose(equality.body_b, equality.X_BB)};
}

/// Three rows between two frames, along A's axes; what is free has none.
template <Number T>
struct FrameRows {
  std::array<Vec3<T>, 3> axes;              ///< in the world
  Vec3<T> velocity, acceleration, error{};  ///< in A's axes; the acceleration is that by the velocities alone
};

template <Number T>
MANYHANDS_INLINE FrameRows<T> rows_along(const Mat3<T>& R_A, const std::array<bool, 3>& keep, const Vec3<T>& velocity,
                                         const Vec3<T>& acceleration, const Vec3<T>& error_A) {
  const Vec3<T> none = Vec3<T>::zero();
  return {{keep[0] ? R_A.x : none, keep[1] ? R_A.y : none, keep[2] ? R_A.z : none},
          masked(transpose_times(R_A, velocity), keep),
          masked(transpose_times(R_A, acceleration), keep),
          masked(error_A, keep)};
}

/// B's origin against A.
template <Number T>
MANYHANDS_INLINE FrameRows<T> linear_rows(const TreeEquality<real_t<T>>& equality, const FramePair<T>& frames,
                                          const Workspace<T>& ws) {
  const auto& [X_A, X_B] = frames;
  const bool slides = equality.type == EqualityType::kPrismatic || equality.type == EqualityType::kSlider;
  const auto [u, acceleration] = relative_motion(ws, equality.body_a, equality.body_b, X_B.p);
  const Vec3<T> gamma = acceleration - constant<T>(2) * cross(ws.V[equality.body_a].w, u);
  return rows_along(X_A.R, {true, true, !slides}, u, gamma, transpose_times(X_A.R, X_B.p - X_A.p));
}

/// B's rotation against A.
template <Number T>
MANYHANDS_INLINE FrameRows<T> angular_rows(const TreeEquality<real_t<T>>& equality, const FramePair<T>& frames,
                                           const Workspace<T>& ws) {
  const auto& [X_A, X_B] = frames;
  const std::size_t a = equality.body_a, b = equality.body_b;
  const bool turns_about_z = equality.type == EqualityType::kHinge || equality.type == EqualityType::kSlider;
  const Vec3<T> w = ws.V[b].w - ws.V[a].w;
  const Vec3<T> gamma = ws.A[b].w - ws.A[a].w - cross(ws.V[a].w, w);
  const Vec3<T> turn = turns_about_z ? transpose_times(X_A.R, cross(X_A.R.z, X_B.R.z))
                                     : rotation_vector(to_quat(transpose(X_A.R) * X_B.R));
  return rows_along(X_A.R, {true, true, !turns_about_z}, w, gamma, turn);
}

/// The rows of an equality between two frames: in A's axes, B's origin against A, and B's rotation against A.
template <Number T>
MANYHANDS_INLINE void add_frame_equality(const Workspace<T>& ws, real_t<T> h, std::size_t index,
                                         ContactProblem<T>& problem) {
  const Tree<real_t<T>>& tree = *problem.tree;
  const TreeEquality<real_t<T>>& equality = tree.equalities[index];
  const FramePair<T> frames = place_frames(equality, ws);
  const RowBlock bodies = rows_between<T>(tree, equality.body_a, equality.body_b);
  const auto ask = [&](const FrameRows<T>& rows, EqualityRows<T>& block) {
    block.offset = rows.velocity;
    ask_to_close(rows.error, rows.acceleration, h, block);
  };
  {
    EqualityRows<T>& block = add_equality_rows(index, equality.row, bodies, h, problem);
    const FrameRows<T> rows = linear_rows(equality, frames, ws);
    fill_point_rows(tree, ws, block.rows, frames.X_B.p, rows.axes, problem.rows);
    ask(rows, block);
  }
  if (!equality.turns) return;
  EqualityRows<T>& block = add_equality_rows(index, equality.row + 3, bodies, h, problem);
  const FrameRows<T> rows = angular_rows(equality, frames, ws);
  fill_rotation_rows(tree, ws, block.rows, rows.axes, problem.rows);
  ask(rows, block);
}

/// How fast an equality between two joints breaks, and by how much it is broken: q_b - ratio q_a - offset.
template <Number T>
MANYHANDS_INLINE T joint_rate(const TreeEquality<real_t<T>>& equality, const State<T>& state) {
  return state.v()[equality.dof_b] - T(equality.ratio) * state.v()[equality.dof_a];
}
template <Number T>
MANYHANDS_INLINE T joint_error(const TreeEquality<real_t<T>>& equality, const State<T>& state) {
  if (equality.type != EqualityType::kJoint) return constant<T>(0);
  return state.q()[equality.q_b] - fma(T(equality.ratio), state.q()[equality.q_a], T(equality.offset));
}

/// The row of an equality between two joints: q_b - ratio q_a - offset, or its rate alone. None if motors hold both
/// dofs where the equality wants them and nothing else acts, in all worlds.
template <Number T>
MANYHANDS_INLINE void add_joint_equality(const State<T>& state, real_t<T> h, std::size_t index,
                                         ContactProblem<T>& problem) {
  const Tree<real_t<T>>& tree = *problem.tree;
  const TreeEquality<real_t<T>>& equality = tree.equalities[index];
  const JointLaws<T>& laws = problem.joints;
  const std::size_t dof_a = equality.dof_a, dof_b = equality.dof_b;
  const T zero = constant<T>(0), one = constant<T>(1), ratio(equality.ratio);
  const T u = joint_rate(equality, state), error = joint_error(equality, state);
  const T most = constant<T>(contact_settings::kMaxClosing);
  const T closing = clamp(T(real_t<T>(1) / h) * error, -most, most);
  const T held_apart = fma(ratio, -laws.target[dof_a], laws.target[dof_b]) + (u + closing);
  const auto held = (laws.first_state[dof_a] == zero) & (laws.first_state[dof_b] == zero);
  const auto agrees = held & (abs(held_apart) < constant<T>(contact_settings::kAgreement));
  const auto acts = (!agrees) | (laws.constrained[dof_a] > zero) | (laws.constrained[dof_b] > zero);
  if (none(acts)) return;
  EqualityRows<T>& block =
      add_equality_rows(index, equality.row, rows_between<T>(tree, equality.body_a, equality.body_b), h, problem);
  block.rows.single = true;
  visit_J(tree, block.rows, [&](std::size_t entry, std::size_t i, real_t<T>) {
    const T weight = i == dof_a ? -ratio : i == dof_b ? one : zero;
    problem.rows.J[entry] = {select(acts, weight, zero), zero, zero};
  });
  block.acts = acts;
  block.offset = {select(acts, u, zero), zero, zero};
  block.closing = {select(acts, closing, zero), zero, zero};
}

}  // namespace internal

/// Adds the rows of all equality constraints that hold exactly, and marks the trees on which they act. After
/// `assemble_contacts`.
template <Number T>
MANYHANDS_INLINE void assemble_equalities(const State<T>& state, real_t<T> h, const Workspace<T>& ws,
                                          ContactProblem<T>& problem) {
  const auto& equalities = problem.tree->equalities;
  for (std::size_t i = 0; i < equalities.size(); ++i) {
    if (equalities[i].type == EqualityType::kTendon) continue;  // a law of joint_laws.h
    if (equalities[i].compliance) continue;                     // a force of yielding_equalities.h
    if (equalities[i].joins_bodies()) {
      internal::add_frame_equality(ws, h, i, problem);
    } else {
      internal::add_joint_equality(state, h, i, problem);
    }
  }
  problem.num_equality_rows = 0;
  for (EqualityRows<T>& block : problem.equalities) {
    block.first = problem.num_equality_rows;
    problem.num_equality_rows += block.count();
    internal::mark_constrained(block.rows, block.acts, problem.joints.constrained);
  }
}

}  // namespace manyhands
