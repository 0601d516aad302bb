// The objects of a task, as they are observed: templates over T.
#pragma once

#include "manyhands/math/quaternion.h"
#include "manyhands/physics/step/step.h"

namespace manyhands {

/// Where a free body is, and how it moves, in the world.
template <Number T>
struct ObjectState {
  Vec3<T> p;  ///< of its centre [m]
  Quat<T> r;
  Vec3<T> v, w;  ///< [m/s], [rad/s]
};

/// The free body whose numbers begin at q and v.
template <Number T>
MANYHANDS_INLINE ObjectState<T> observe_object(const T* q, const T* v) {
  return {{q[0], q[1], q[2]}, {q[3], q[4], q[5], q[6]}, {v[3], v[4], v[5]}, {v[0], v[1], v[2]}};
}

/// (roll, pitch, yaw) of R = Rz(yaw) Ry(pitch) Rx(roll), each turn left to yaw where the pitch is upright: Bullet's
/// getEulerFromQuaternion.
template <Number T>
MANYHANDS_INLINE Vec3<T> euler_angles(const Quat<T>& r) {
  using R = real_t<T>;
  const T zero(R(0)), one(R(1)), two(R(2)), upright(R(0.99999)), right(static_cast<R>(std::numbers::pi / 2));
  const T sine = two * fma(r.w, r.y, -(r.x * r.z));
  const auto up = sine >= upright, down = sine <= -upright;
  const T xx = r.x * r.x, yy = r.y * r.y, zz = r.z * r.z, ww = r.w * r.w;
  const T s = clamp(sine, -one, one);
  const T roll = atan2(two * fma(r.y, r.z, r.w * r.x), (ww - xx) - (yy - zz));
  const T pitch = atan2(s, sqrt(max(fma(-s, s, one), zero)));
  const T yaw = atan2(two * fma(r.x, r.y, r.w * r.z), (ww + xx) - (yy + zz));
  return {select(up | down, zero, roll), select(up, right, select(down, -right, pitch)),
          select(up, two * atan2(-r.x, r.y), select(down, two * atan2(r.x, -r.y), yaw))};
}

/// Writes p, Euler angles, v, w: 12 numbers.
template <Number T>
MANYHANDS_INLINE void write_object(const ObjectState<T>& object, T* row) {
  const Vec3<T> angles = euler_angles(object.r);
  for (const Vec3<T>& part : {object.p, angles, object.v, object.w}) {
    *row++ = part.x;
    *row++ = part.y;
    *row++ = part.z;
  }
}

/// The air's drag on a free body whose axes are principal, as Bullet has it: accelerations of -u (0.04 + 0.04 |u|)
/// for u its velocity and its angular velocity: into the forces tau of its joint.
template <Number T, Number P>
MANYHANDS_INLINE void apply_drag(const RigidInertia<P>& inertia, const T* q, const T* v, T* tau) {
  using R = real_t<T>;
  const T drag(R(0.04));
  const auto slowed = [&](const T* u) {
    const T c = -fma(drag, sqrt(fma(u[0], u[0], fma(u[1], u[1], u[2] * u[2]))), drag);
    return Vec3<T>{c * u[0], c * u[1], c * u[2]};
  };
  const Mat3<T> R_WB = to_matrix(Quat<T>{q[3], q[4], q[5], q[6]});
  const Vec3<T> w = transpose_times(R_WB, slowed(v)), a = slowed(v + 3);
  const T m = broadcast<T>(inertia.m);
  const Vec3<T> torque = R_WB * Vec3<T>{broadcast<T>(inertia.I.xx) * w.x, broadcast<T>(inertia.I.yy) * w.y,
                                        broadcast<T>(inertia.I.zz) * w.z};
  tau[0] = torque.x;
  tau[1] = torque.y;
  tau[2] = torque.z;
  tau[3] = m * a.x;
  tau[4] = m * a.y;
  tau[5] = m * a.z;
}

}  // namespace manyhands
