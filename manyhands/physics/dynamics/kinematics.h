// Where the bodies are, how they move, and how frames follow the joints.
//
// `place` and `move` treat one body whose parent is done; every algorithm that runs from the root to the leaves calls
// them in its own pass, so that a body's numbers are still in registers when the next formula needs them.
#pragma once

#include "manyhands/base/assert.h"
#include "manyhands/math/quaternion.h"
#include "manyhands/physics/dynamics/checks.h"

namespace manyhands {

namespace internal {

template <Number T>
MANYHANDS_INLINE Motion<T> rotation_about(const Vec3<T>& axis, const Vec3<T>& p_OB) {
  return {axis, cross(p_OB, axis)};
}
template <Number T>
MANYHANDS_INLINE Motion<T> translation_along(const Vec3<T>& axis) {
  return {Vec3<T>::zero(), axis};
}

/// One of the columns of R, or its reverse: `axis` is 1, 2, 3 or minus that.
template <Number T>
MANYHANDS_INLINE Vec3<T> signed_column(const Mat3<T>& R, int axis) {
  const Vec3<T>& column = axis == 1 || axis == -1 ? R.x : axis == 2 || axis == -2 ? R.y : R.z;
  return axis > 0 ? column : -column;
}

/// R_WF from R_WP: the parent's rotation, turned as F is in the parent.
template <Number T>
MANYHANDS_INLINE Mat3<T> turned(const Mat3<T>& R_WP, const TreeBody<real_t<T>>& body) {
  if (body.turn == Turn::kNone) return R_WP;
  if (body.turn == Turn::kGeneral) return R_WP * broadcast<T>(body.X_PF.R);
  return {signed_column(R_WP, body.axes[0]), signed_column(R_WP, body.axes[1]), signed_column(R_WP, body.axes[2])};
}

/// Body b's pose once its joint frame F and the joint's shift in world axes are known.
template <Number T>
MANYHANDS_INLINE void set_origin(const TreeBody<real_t<T>>& body, std::size_t b, const Vec3<T>& p_F,
                                 const Vec3<T>& shift, Workspace<T>& ws) {
  const auto parent = static_cast<std::size_t>(body.parent);
  if (body.parent == 0) {
    ws.p_WO[b] = p_F + shift;
    ws.p_OB[b] = Vec3<T>::zero();
  } else {
    ws.p_WO[b] = ws.p_WO[parent];
    ws.p_OB[b] = p_F + shift;
  }
}

}  // namespace internal

/// Puts the bodies that a user moves where the state has them, at rest: `poses`, x y z and quaternion xyzw each. A
/// workspace keeps them there; a new one has them where the model does.
template <Number T>
MANYHANDS_INLINE void place_mocap(const Tree<real_t<T>>& tree, const T* poses, Workspace<T>& ws) {
  for (const std::size_t b : tree.mocap_bodies) {
    ws.p_WO[b] = {poses[0], poses[1], poses[2]};
    ws.R_WB[b] = to_matrix(Quat<T>{poses[3], poses[4], poses[5], poses[6]});
    ws.p_OB[b] = Vec3<T>::zero();
    ws.V[b] = Motion<T>::zero();
    poses += kPoseNumbers;
  }
}

/// R_WB, p_OB, p_WO and the joint axes S of body b from the configuration q (nq).
template <Number T>
MANYHANDS_INLINE void place(const Tree<real_t<T>>& tree, std::size_t b, const T* q, Workspace<T>& ws) {
  MANYHANDS_ASSERT(b > 0 && b < tree.bodies.size() && b < ws.R_WB.size());
  const TreeBody<real_t<T>>& body = tree.bodies[b];
  const auto parent = static_cast<std::size_t>(body.parent);
  const Vec3<T> p_PF = broadcast<T>(body.X_PF.p);
  const bool on_world = body.parent == 0;
  const Mat3<T> R_WF = on_world ? broadcast<T>(body.X_PF.R) : internal::turned(ws.R_WB[parent], body);
  const Vec3<T> p_F = on_world ? p_PF : body.shifted ? ws.R_WB[parent] * p_PF + ws.p_OB[parent] : ws.p_OB[parent];
  const T* qj = q + body.iq;
  Motion<T>* S = ws.S.data() + body.iv;
  switch (body.type) {
    case JointType::kFixed:
    case JointType::kMocap:  // see `place_mocap`
      break;
    case JointType::kRevolute:
    case JointType::kContinuous: {
      const SinCos<T> a = sincos(qj[0]);
      ws.R_WB[b] = {fma(a.cos, R_WF.x, a.sin * R_WF.y), fma(a.cos, R_WF.y, -a.sin * R_WF.x), R_WF.z};
      internal::set_origin(body, b, p_F, Vec3<T>::zero(), ws);
      S[0] = internal::rotation_about(R_WF.z, ws.p_OB[b]);
      break;
    }
    case JointType::kPrismatic:
      ws.R_WB[b] = R_WF;
      internal::set_origin(body, b, p_F, qj[0] * R_WF.z, ws);
      S[0] = internal::translation_along(R_WF.z);
      break;
    case JointType::kSpherical:
      ws.R_WB[b] = R_WF * to_matrix(Quat<T>{qj[0], qj[1], qj[2], qj[3]});
      internal::set_origin(body, b, p_F, Vec3<T>::zero(), ws);
      S[0] = internal::rotation_about(R_WF.x, ws.p_OB[b]);
      S[1] = internal::rotation_about(R_WF.y, ws.p_OB[b]);
      S[2] = internal::rotation_about(R_WF.z, ws.p_OB[b]);
      break;
    case JointType::kPlanar: {
      const SinCos<T> a = sincos(qj[2]);
      ws.R_WB[b] = {fma(a.cos, R_WF.x, a.sin * R_WF.y), fma(a.cos, R_WF.y, -a.sin * R_WF.x), R_WF.z};
      internal::set_origin(body, b, p_F, fma(qj[0], R_WF.x, qj[1] * R_WF.y), ws);
      S[0] = internal::translation_along(R_WF.x);
      S[1] = internal::translation_along(R_WF.y);
      S[2] = internal::rotation_about(R_WF.z, ws.p_OB[b]);
      break;
    }
    case JointType::kFloating:
      ws.R_WB[b] = R_WF * to_matrix(Quat<T>{qj[3], qj[4], qj[5], qj[6]});
      internal::set_origin(body, b, p_F, R_WF * Vec3<T>{qj[0], qj[1], qj[2]}, ws);
      S[0] = internal::rotation_about(R_WF.x, ws.p_OB[b]);
      S[1] = internal::rotation_about(R_WF.y, ws.p_OB[b]);
      S[2] = internal::rotation_about(R_WF.z, ws.p_OB[b]);
      S[3] = internal::translation_along(R_WF.x);
      S[4] = internal::translation_along(R_WF.y);
      S[5] = internal::translation_along(R_WF.z);
      break;
  }
}

/// Sets V of body b from the velocity v (nv), after `place`, and returns the acceleration that is due to velocities
/// alone: c = V_parent x v_J + dS/dt v (Featherstone 2008, eq. 3.42; for planar and floating joints the rotation's
/// centre moves, hence the last term).
template <Number T>
MANYHANDS_INLINE Motion<T> move(const Tree<real_t<T>>& tree, std::size_t b, const T* v, Workspace<T>& ws) {
  const TreeBody<real_t<T>>& body = tree.bodies[b];
  if (body.type == JointType::kMocap) return Motion<T>::zero();
  const auto parent = static_cast<std::size_t>(body.parent);
  const auto iv = static_cast<std::size_t>(body.iv);
  Motion<T> V_J = v[iv] * ws.S[iv];
  for (std::size_t k = iv + 1; k < iv + static_cast<std::size_t>(body.nv); ++k) V_J = fma(v[k], ws.S[k], V_J);
  Motion<T> c = Motion<T>::zero();
  if (body.parent == 0) {
    ws.V[b] = V_J;
  } else {
    ws.V[b] = ws.V[parent] + V_J;
    c = cross(ws.V[parent], V_J);
  }
  if (body.type == JointType::kPlanar || body.type == JointType::kFloating) {
    const Vec3<T> origin_velocity = V_J.v - cross(ws.p_OB[b], V_J.w);
    c.v -= cross(V_J.w, origin_velocity);
  }
  return c;
}

/// Poses of all bodies at q (nq).
template <Number T>
void forward_kinematics(const Tree<real_t<T>>& tree, const T* q, Workspace<T>& ws) {
  for (std::size_t b = 1; b < tree.bodies.size(); ++b) place(tree, b, q, ws);
}

/// X_WB of body b, after forward_kinematics.
template <Number T>
MANYHANDS_INLINE Transform<T> body_pose(std::size_t b, const Workspace<T>& ws) {
  return {ws.R_WB[b], ws.p_OB[b] + ws.p_WO[b]};
}

/// X_WF of a frame on a body, after forward_kinematics.
template <Number T>
MANYHANDS_INLINE Transform<T> frame_pose(BodyId body, const Transform<real_t<T>>& X_BF, const Workspace<T>& ws) {
  const std::size_t b = body.index();
  MANYHANDS_ASSERT(b < ws.R_WB.size());
  const Vec3<T> p_OF = ws.R_WB[b] * broadcast<T>(X_BF.p) + ws.p_OB[b];
  return {ws.R_WB[b] * broadcast<T>(X_BF.R), p_OF + ws.p_WO[b]};
}

/// The spatial velocity of a frame at its own origin, in world axes, given V about O and the frame's p_OF.
template <Number T>
MANYHANDS_INLINE Motion<T> at_point(const Motion<T>& V, const Vec3<T>& p_OF) {
  return {V.w, V.v + cross(V.w, p_OF)};
}

/// Visits the columns of a frame's Jacobian (world axes, at the frame's origin, angular first): calls
/// `visit(dof, Motion)` for every dof that moves the frame. After forward_kinematics.
template <Number T, class Visit>
MANYHANDS_INLINE void visit_jacobian(const Tree<real_t<T>>& tree, BodyId body, const Vec3<real_t<T>>& p_BF,
                                     const Workspace<T>& ws, Visit&& visit) {
  const TreeBody<real_t<T>>& start = tree.bodies[body.index()];
  const Vec3<T> p_OF = ws.R_WB[body.index()] * broadcast<T>(p_BF) + ws.p_OB[body.index()];
  for (int k = start.iv + start.nv - 1; k >= 0; k = tree.dof_parent[static_cast<std::size_t>(k)]) {
    visit(k, at_point(ws.S[static_cast<std::size_t>(k)], p_OF));
  }
}

}  // namespace manyhands
