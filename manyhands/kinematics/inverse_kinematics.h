// Inverse kinematics by damped least squares, in lanes or scalar. See README.md in this folder.
#pragma once

#include <optional>
#include <type_traits>

#include "manyhands/math/control_flow.h"
#include "manyhands/math/linear6.h"
#include "manyhands/physics/dynamics/kinematics.h"

namespace manyhands {

/// How a solve proceeds. Each iteration adds dq = J^T (J J^T + lambda 1)^-1 e with
/// lambda = damping + error_damping |e|^2 (Sugihara 2011, eq. 19: near the goal the damping vanishes with the error).
struct IkSettings {
  int max_iterations = 50;
  double damping = 1e-6;
  double error_damping = 0.1;
  double position_tolerance = 1e-5;  ///< [m]
  double rotation_tolerance = 1e-4;  ///< [rad]; infinite: only the position decides when to stop
  bool respect_limits = true;        ///< keeps every iterate within the joint limits
  int patience = 0;  ///< iterations that must bring the error down by a tenth, or the solve of a goal ends; 0: never
};

/// The bodies and dofs that move a frame, from the root out: found once, used in every solve.
struct IkChain {
  /// Where a relative pose is measured from.
  struct Base {
    BodyId body;
    Transform<double> X_BF;
    std::vector<std::uint8_t> moved_by{};  ///< (nv) 1 for the dofs that move it, and the frame does not
  };

  /// Throws ModelError if no joint moves the frame, or if a joint on the way has several dofs.
  IkChain(const Model& model, FrameId frame);
  /// Of the frame's pose in another, `relative_to`: the dofs that move only one of them. `solve_goal` takes such a
  /// chain, `improve_ik` does not. Throws ModelError likewise.
  IkChain(const Model& model, FrameId frame, FrameId relative_to);

  BodyId body;
  Transform<double> X_BF;
  std::vector<std::size_t> bodies{};  ///< on the way to the frames, parents first
  std::vector<std::size_t> dofs{};
  std::optional<Base> base{};
};

template <Number T>
struct IkResult {
  mask_t<T> success;  ///< both errors within tolerance at the returned q
  T position_error;   ///< [m]
  T rotation_error;   ///< [rad]
};

namespace internal {

/// [rotation vector of R_target R^T ; p_target - p] in world axes.
template <Number T>
MANYHANDS_INLINE Motion<T> pose_error(const Transform<T>& target, const Transform<T>& X_WF) {
  return {rotation_vector(to_quat(target.R * transpose(X_WF.R))), target.p - X_WF.p};
}

/// For solves in which nothing but the goal moves the joints.
struct NoPosture {};

/// Whether a dof at a limit is pressed against it by the error: down the slope of |e|^2, J its column.
template <Number T, Number P>
MANYHANDS_INLINE mask_t<T> presses_limit(const Params<P>& params, std::size_t dof, const T& q, const Motion<T>& J,
                                         const Motion<T>& e) {
  const T slope = dot(J.w, e.w) + dot(J.v, e.v), zero = constant<T>(0);
  return mask_t<T>(((q <= broadcast<T>(params.lower[dof])) & (slope < zero)) |
                   ((q >= broadcast<T>(params.upper[dof])) & (slope > zero)));
}

/// One step of the chain's joints, dq = z + J^T (J J^T + damped)^-1 (e - J z), where `row(i)` is dof i's column of J as
/// a motion, and z what `posture` pulls, if one is wanted. Dofs that the error presses against a limit stay there, and
/// the step is that of the others (Bertsekas 1982), rather than one that is cut off. `columns`: scratch, one for each
/// of the chain's dofs.
template <Number T, Number P, class Row, class Posture>
MANYHANDS_INLINE void take_damped_step(const Tree<real_t<T>>& tree, const Params<P>& params, const IkChain& chain,
                                       const IkSettings& settings, const mask_t<T>& active, SymMat6<T> damped,
                                       Motion<T> e, const Row& row, const Posture& posture, Motion<T>* columns, T* q) {
  constexpr bool kPulls = !std::is_same_v<Posture, NoPosture>;
  const Motion<T> error = e;
  const Vec3<T> none = Vec3<T>::zero();
  const std::size_t n = chain.dofs.size();
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t i = chain.dofs[k];
    Motion<T> J = row(i);
    if (settings.respect_limits && tree.dof_limited[i]) {
      mask_t<T> held = presses_limit(params, i, q[static_cast<std::size_t>(tree.dof_q[i])], J, error);
      if constexpr (kPulls) held = mask_t<T>(held & !posture.pulls());
      J = {select(held, none, J.w), select(held, none, J.v)};
    }
    columns[k] = J;
    damped.add_outer_product(J);
    if constexpr (kPulls) {
      if (posture.is_wanted()) e = fma(-posture.pull(i), J, e);
    }
  }
  const Motion<T> y = damped.solve(e);
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t i = chain.dofs[k];
    const Motion<T>& J = columns[k];
    T& qi = q[static_cast<std::size_t>(tree.dof_q[i])];
    T next = qi + dot(J.w, y.w) + dot(J.v, y.v);
    if constexpr (kPulls) {
      if (posture.is_wanted()) next = next + posture.pull(i);
    }
    if (settings.respect_limits && tree.dof_limited[i])
      next = clamp(next, broadcast<T>(params.lower[i]), broadcast<T>(params.upper[i]));
    qi = select(active, next, qi);
  }
}

}  // namespace internal

/// The frame's pose at q, placing only the chain's bodies.
template <Number T>
MANYHANDS_INLINE Transform<T> place_chain(const Tree<real_t<T>>& tree, const IkChain& chain,
                                          const Transform<real_t<T>>& X_BF, const T* q, Workspace<T>& ws) {
  for (const std::size_t b : chain.bodies) place(tree, b, q, ws);
  return frame_pose(chain.body, X_BF, ws);
}

/// Moves q (nq) from where it is towards the pose `target` = X_WF of the chain's frame, at most max_iterations times; a
/// world stops after the update that began within tolerance. Coordinates outside the chain keep their values.
template <Number T, Number P>
MANYHANDS_INLINE void improve_ik(const Tree<real_t<T>>& tree, const Params<P>& params, const IkChain& chain,
                                 const IkSettings& settings, const Transform<T>& target, T* q, Workspace<T>& ws) {
  using R = real_t<T>;
  const Transform<R> X_BF = broadcast<R>(chain.X_BF);
  const T damping(static_cast<R>(settings.damping)), error_damping(static_cast<R>(settings.error_damping));
  const T position_tolerance(static_cast<R>(settings.position_tolerance * settings.position_tolerance));
  const T rotation_tolerance(static_cast<R>(settings.rotation_tolerance * settings.rotation_tolerance));
  iterate(mask_t<T>(true), settings.max_iterations, [&](const mask_t<T>& active) {
    const Transform<T> X_WF = place_chain(tree, chain, X_BF, q, ws);
    const Motion<T> e = internal::pose_error(target, X_WF);
    const Vec3<T> p_OF = X_WF.p - ws.p_WO[chain.body.index()];
    const T rotation2 = squared_norm(e.w), position2 = squared_norm(e.v);
    const SymMat6<T> damped = SymMat6<T>::diagonal(fma(error_damping, rotation2 + position2, damping));
    const auto row = [&](std::size_t i) { return at_point(ws.S[i], p_OF); };
    internal::take_damped_step(tree, params, chain, settings, active, damped, e, row, internal::NoPosture{},
                               ws.A.data(), q);
    return !((position2 <= position_tolerance) & (rotation2 <= rotation_tolerance));
  });
}

/// The same, with the errors that remain.
template <Number T, Number P>
MANYHANDS_INLINE IkResult<T> solve_ik(const Tree<real_t<T>>& tree, const Params<P>& params, const IkChain& chain,
                                      const IkSettings& settings, const Transform<T>& target, T* q, Workspace<T>& ws) {
  using R = real_t<T>;
  improve_ik(tree, params, chain, settings, target, q, ws);
  const Transform<R> X_BF = broadcast<R>(chain.X_BF);
  const Motion<T> e = internal::pose_error(target, place_chain(tree, chain, X_BF, q, ws));
  const T position_error = norm(e.v), rotation_error = norm(e.w);
  const mask_t<T> success((position_error <= T(static_cast<R>(settings.position_tolerance))) &
                          (rotation_error <= T(static_cast<R>(settings.rotation_tolerance))));
  return {success, position_error, rotation_error};
}

}  // namespace manyhands
