// Jacobians of frames in every form, and how they change.
#pragma once

#include "manyhands/physics/dynamics/jacobian_form.h"
#include "manyhands/physics/dynamics/kinematics.h"

namespace manyhands {

namespace internal {

/// dS/dt of dof k of body b, about O, which stands still: the joint's axes are carried by its parent, and where its
/// centre moves with the body, by that, too (see `move`).
template <Number T>
MANYHANDS_INLINE Motion<T> axis_rate(const TreeBody<real_t<T>>& body, std::size_t b, const Motion<T>& S,
                                     const Workspace<T>& ws) {
  const Motion<T>& V_parent = ws.V[static_cast<std::size_t>(body.parent)];
  Motion<T> rate = body.parent == 0 ? Motion<T>::zero() : cross(V_parent, S);
  if (body.type == JointType::kPlanar || body.type == JointType::kFloating) {
    const Motion<T> V_J = body.parent == 0 ? ws.V[b] : ws.V[b] - V_parent;
    rate.v += cross(V_J.v - cross(ws.p_OB[b], V_J.w), S.w);
  }
  return rate;
}

/// The motion with parts turned into the axes of R_WF.
template <Number T>
MANYHANDS_INLINE Motion<T> in_axes(const Mat3<T>& R_WF, const Motion<T>& m) {
  return {transpose_times(R_WF, m.w), transpose_times(R_WF, m.v)};
}

}  // namespace internal

/// As `visit_jacobian` of kinematics.h, in any form.
template <Number T, class Visit>
MANYHANDS_INLINE void visit_jacobian(const Tree<real_t<T>>& tree, JacobianForm form, BodyId body,
                                     const Transform<real_t<T>>& X_BF, const Workspace<T>& ws, Visit&& visit) {
  if (form == JacobianForm::kMixed) return visit_jacobian(tree, body, X_BF.p, ws, visit);
  const std::size_t b = body.index();
  const bool in_space = form == JacobianForm::kSpace;
  const Mat3<T> R_WF = ws.R_WB[b] * broadcast<T>(X_BF.R);
  const Vec3<T> point = in_space ? -ws.p_WO[b] : ws.R_WB[b] * broadcast<T>(X_BF.p) + ws.p_OB[b];
  for (const int k : tree.path_of(b)) {
    const Motion<T> J = at_point(ws.S[static_cast<std::size_t>(k)], point);
    visit(k, in_space ? J : internal::in_axes(R_WF, J));
  }
}

/// Visits the columns of dJ/dt, with which the frame's acceleration is J dv/dt + dJ/dt v; dv/dt of the mixed form is
/// the acceleration of the origin, as an observer sees it. After `place` and `move` of all bodies.
template <Number T, class Visit>
MANYHANDS_INLINE void visit_jacobian_derivative(const Tree<real_t<T>>& tree, JacobianForm form, BodyId frame_body,
                                                const Transform<real_t<T>>& X_BF, const Workspace<T>& ws,
                                                Visit&& visit) {
  const std::size_t f = frame_body.index();
  const Mat3<T> R_WF = ws.R_WB[f] * broadcast<T>(X_BF.R);
  const Vec3<T> p_OF = ws.R_WB[f] * broadcast<T>(X_BF.p) + ws.p_OB[f];
  const Vec3<T> origin_velocity = at_point(ws.V[f], p_OF).v;
  for (std::size_t b = f; b != 0; b = static_cast<std::size_t>(tree.bodies[b].parent)) {
    const TreeBody<real_t<T>>& body = tree.bodies[b];
    for (int k = body.iv; k < body.iv + body.nv; ++k) {
      const Motion<T>& S = ws.S[static_cast<std::size_t>(k)];
      const Motion<T> rate = internal::axis_rate(body, b, S, ws);
      switch (form) {
        case JacobianForm::kMixed: {
          const Motion<T> still = at_point(rate, p_OF);
          visit(k, Motion<T>{still.w, still.v + cross(S.w, origin_velocity)});
          break;
        }
        case JacobianForm::kSpace:
          visit(k, at_point(rate, -ws.p_WO[f]));
          break;
        case JacobianForm::kBody:
          visit(k, internal::in_axes(R_WF, at_point(rate - cross(ws.V[f], S), p_OF)));
          break;
      }
    }
  }
}

}  // namespace manyhands
