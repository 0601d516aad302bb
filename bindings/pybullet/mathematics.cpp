// Rotations and transforms; they need no connection.
#include <cmath>
#include <numbers>

#include "bindings/pybullet/arguments.h"
#include "manyhands/bullet/aim.h"

namespace manyhands::pybullet {

namespace {

using Q = Quat<double>;
constexpr const char* kQuaternion = "Quaternion needs a 4 components [x,y,z,w].";
constexpr const char* kVector = "Position needs a 3 coordinates [x,y,z].";

Q product(const Q& a, const Q& b) {
  return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
          a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}
Q conjugate(const Q& a) { return {-a.x, -a.y, -a.z, a.w}; }
double inner(const Q& a, const Q& b) { return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w; }

/// R v of the quaternion as it is, for unit length.
Vec3<double> turn(const Q& r, const Vec3<double>& v) {
  const Q p = product(product(r, {v.x, v.y, v.z, 0}), conjugate(r));
  return {p.x, p.y, p.z};
}

/// The same rotation, on the side of `start`.
Q nearest(const Q& start, const Q& end) { return inner(start, end) < 0 ? Q{-end.x, -end.y, -end.z, -end.w} : end; }

constexpr FreeFunction kFromEuler{
    "getQuaternionFromEuler", "eulerAngles", "Quaternion xyzw of roll, pitch and yaw about the fixed axes x, y, z.",
    [](const Arguments& a) -> PyObject* {
      const Vec3<double> e = 0.5 * a.vec3(0, "Euler angles need a 3 coordinates [roll, pitch, yaw].");
      const double cr = std::cos(e.x), sr = std::sin(e.x), cp = std::cos(e.y), sp = std::sin(e.y), cy = std::cos(e.z),
                   sy = std::sin(e.z);
      return of(Q{sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy,
                  cr * cp * cy + sr * sp * sy});
    }};

constexpr FreeFunction kToEuler{
    "getEulerFromQuaternion", "quaternion", "Roll, pitch and yaw of a quaternion xyzw.",
    [](const Arguments& a) -> PyObject* {
      const Q r = a.quaternion(0, "Quaternion need a 4 components [x,y,z,w].");
      const double s = -2 * (r.x * r.z - r.w * r.y) / inner(r, r);
      constexpr double kLock = 0.99999;
      if (s <= -kLock) return of(Vec3<double>{0, -0.5 * std::numbers::pi, 2 * std::atan2(r.x, -r.y)});
      if (s >= kLock) return of(Vec3<double>{0, 0.5 * std::numbers::pi, 2 * std::atan2(-r.x, r.y)});
      return of(Vec3<double>{std::atan2(2 * (r.y * r.z + r.w * r.x), r.w * r.w - r.x * r.x - r.y * r.y + r.z * r.z),
                             std::asin(s),
                             std::atan2(2 * (r.x * r.y + r.w * r.z), r.w * r.w + r.x * r.x - r.y * r.y - r.z * r.z)});
    }};

constexpr FreeFunction kMatrix{
    "getMatrixFromQuaternion", "quaternion", "The rotation matrix, 9 numbers by rows.",
    [](const Arguments& a) -> PyObject* {
      const Mat3<double> R = to_matrix(normalized(a.quaternion(0, kQuaternion)));
      return of(std::span<const double>(std::array{R.x.x, R.y.x, R.z.x, R.x.y, R.y.y, R.z.y, R.x.z, R.y.z, R.z.z}));
    }};

constexpr FreeFunction kMultiply{
    "multiplyTransforms", "positionA, orientationA, positionB, orientationB",
    "The pose of B in A's parent: position and quaternion of A after B.", [](const Arguments& a) -> PyObject* {
      const Q ra = normalized(a.quaternion(1, kQuaternion)), rb = normalized(a.quaternion(3, kQuaternion));
      return tuple(of(a.vec3(0, kVector) + turn(ra, a.vec3(2, kVector))), of(product(ra, rb)));
    }};

constexpr FreeFunction kInvert{"invertTransform", "position, orientation", "The inverse of a pose.",
                               [](const Arguments& a) -> PyObject* {
                                 const Q r = conjugate(normalized(a.quaternion(1, kQuaternion)));
                                 return tuple(of(-turn(r, a.vec3(0, kVector))), of(r));
                               }};

constexpr FreeFunction kRotate{
    "rotateVector", "quaternion, vector", "The vector, turned.",
    [](const Arguments& a) -> PyObject* { return of(turn(a.quaternion(0, kQuaternion), a.vec3(1, kVector))); }};

constexpr FreeFunction kFromAxis{"getQuaternionFromAxisAngle", "axis, angle", "Quaternion of a turn about an axis.",
                                 [](const Arguments& a) -> PyObject* {
                                   const Vec3<double> axis = a.vec3(0, "expected axis of 3 numbers.");
                                   const double length = norm(axis), half = 0.5 * a.number(1);
                                   const double s = length > 0 ? std::sin(half) / length : 0;
                                   return of(Q{s * axis.x, s * axis.y, s * axis.z, std::cos(half)});
                                 }};

PyObject* axis_angle(const Q& r) {
  const double angle = 2 * std::acos(std::clamp(r.w, -1.0, 1.0)), s2 = 1 - r.w * r.w;
  if (s2 < 1e-14) return tuple(of(Vec3<double>{1, 0, 0}), of(angle));
  const double s = 1 / std::sqrt(s2);
  return tuple(of(Vec3<double>{s * r.x, s * r.y, s * r.z}), of(angle));
}

constexpr FreeFunction kToAxis{
    "getAxisAngleFromQuaternion", "quaternion", "The axis and angle of a rotation.",
    [](const Arguments& a) -> PyObject* { return axis_angle(normalized(a.quaternion(0, kQuaternion))); }};

constexpr FreeFunction kDifference{"getDifferenceQuaternion", "quaternionStart, quaternionEnd",
                                   "The rotation from start to end, the shorter way.",
                                   [](const Arguments& a) -> PyObject* {
                                     const Q start = a.quaternion(0, kQuaternion), end = a.quaternion(1, kQuaternion);
                                     return of(product(nearest(start, end), conjugate(start)));
                                   }};

constexpr FreeFunction kSlerp{
    "getQuaternionSlerp", "quaternionStart, quaternionEnd, interpolationFraction",
    "The rotation a share of the way from start to end, the shorter way.", [](const Arguments& a) -> PyObject* {
      const Q start = normalized(a.quaternion(0, kQuaternion));
      const Q end = nearest(start, normalized(a.quaternion(1, kQuaternion)));
      const double t = a.number(2), angle = std::acos(std::clamp(inner(start, end), -1.0, 1.0));
      const double s = std::sin(angle);
      const double u = s < 1e-9 ? 1 - t : std::sin((1 - t) * angle) / s;
      const double v = s < 1e-9 ? t : std::sin(t * angle) / s;
      return of(Q{u * start.x + v * end.x, u * start.y + v * end.y, u * start.z + v * end.z, u * start.w + v * end.w});
    }};

/// The way from start to end as axis times angle, world axes.
Vec3<double> rotation_between(const Q& start, const Q& end) {
  const Q d = normalized(product(nearest(start, end), conjugate(start)));
  const double s = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
  const double factor = s < 1e-12 ? 2 : 2 * std::atan2(s, d.w) / s;
  return {factor * d.x, factor * d.y, factor * d.z};
}

constexpr FreeFunction kVelocity{
    "calculateVelocityQuaternion", "quaternionStart, quaternionEnd, deltaTime",
    "The angular velocity that leads from start to end in deltaTime [s].", [](const Arguments& a) -> PyObject* {
      const Vec3<double> way = rotation_between(a.quaternion(0, kQuaternion), a.quaternion(1, kQuaternion));
      return of((1 / a.number(2)) * way);
    }};

/// The angles about the axes of start that lead to end, with which spherical motors aim.
constexpr FreeFunction kAxisDifference{
    "getAxisDifferenceQuaternion", "quaternionStart, quaternionEnd",
    "Three angles that lead from start to end, about the axes of start: the error of a spherical joint's motor.",
    [](const Arguments& a) -> PyObject* {
      return of(bullet::aiming_angles(a.quaternion(0, kQuaternion), a.quaternion(1, kQuaternion)));
    }};

}  // namespace

void add_mathematics(Methods& methods) {
  add_to<kFromEuler>(methods);
  add_to<kToEuler>(methods);
  add_to<kMatrix>(methods);
  add_to<kMultiply>(methods);
  add_to<kInvert>(methods);
  add_to<kRotate>(methods);
  add_to<kFromAxis>(methods);
  add_to<kToAxis>(methods);
  add_to<kDifference>(methods);
  add_to<kSlerp>(methods);
  add_to<kVelocity>(methods);
  add_to<kAxisDifference>(methods);
}

}  // namespace manyhands::pybullet
