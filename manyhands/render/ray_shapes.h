// Where rays enter solids, in lanes; all in the axes of the shape. Surfaces are seen from outside only.
#pragma once

#include "manyhands/model/description.h"
#include "manyhands/render/rays.h"

namespace manyhands {

/// The first surface that a ray meets.
template <Number T>
struct Entry {
  T t;        ///< in lengths of the direction; more than any `far` where there is none
  Vec3<T> n;  ///< unit, outwards; arbitrary where there is none
};

namespace internal {

constexpr float kNever = 3e38f, kParallel = 1e6f;

/// 1 / d, large where d is 0.
template <Number T>
MANYHANDS_INLINE T reciprocal(T d) {
  const T least(1e-20f);
  return T(1.0f) / select(abs(d) < least, copysign(least, d), d);
}

/// The stretch of a ray that lies within a round shape about the origin: a ball, or a pillar along z.
template <Number T>
struct Chord {
  T enter, leave;
  mask_t<T> meets;
};

template <Number T>
MANYHANDS_INLINE Chord<T> chord(const Vec3<T>& o, const Vec3<T>& d, T r) {
  const T a = dot(d, d);
  const auto parallel = a < T(1e-12f);
  // The nearest point of the line to the axis keeps the digits of distant origins.
  const T middle = select(parallel, T(0.0f), -(dot(o, d) / a));
  const Vec3<T> nearest = fma(middle, d, o);
  const T rest = fma(r, r, -dot(nearest, nearest));
  const T half = select(parallel, T(kParallel), sqrt(max(rest, T(0.0f)) / a));
  return {middle - half, middle + half, rest >= T(0.0f)};
}

template <Number T>
MANYHANDS_INLINE Entry<T> enter_ball(const Vec3<T>& o, const Vec3<T>& d, T r) {
  const Chord<T> c = chord(o, d, r);
  return {select(c.meets, c.enter, T(kNever)), (T(1.0f) / r) * fma(c.enter, d, o)};
}

template <Number T>
MANYHANDS_INLINE Entry<T> enter_cylinder(const Vec3<T>& o, const Vec3<T>& d, T r, T half) {
  const T zero(0.0f), one(1.0f);
  const Chord<T> side = chord(Vec3<T>{o.x, o.y, zero}, Vec3<T>{d.x, d.y, zero}, r);
  const T inverse = reciprocal(d.z), reach = abs(half * inverse), middle = -(o.z * inverse);
  const T cap = middle - reach, enter = max(side.enter, cap);
  const auto meets = side.meets & (enter <= min(side.leave, middle + reach));
  const Vec3<T> round = (one / r) * Vec3<T>{fma(side.enter, d.x, o.x), fma(side.enter, d.y, o.y), zero};
  const Vec3<T> flat{zero, zero, copysign(one, -d.z)};
  return {select(meets, enter, T(kNever)), select(cap > side.enter, flat, round)};
}

template <Number T>
MANYHANDS_INLINE Entry<T> enter_capsule(const Vec3<T>& o, const Vec3<T>& d, T r, T half) {
  const T zero(0.0f);
  const Chord<T> side = chord(Vec3<T>{o.x, o.y, zero}, Vec3<T>{d.x, d.y, zero}, r);
  const T z = fma(side.enter, d.z, o.z);
  // Beyond an end, the line can only enter through that end's ball.
  const T centre = select(abs(z) <= half, z, copysign(half, z));
  const Entry<T> ball = enter_ball(Vec3<T>{o.x, o.y, o.z - centre}, d, r);
  const auto on_side = side.meets & (abs(z) <= half);
  const T t = select(on_side, side.enter, select(side.meets, ball.t, T(kNever)));
  const Vec3<T> p = fma(t, d, o);
  return {t, (T(1.0f) / r) * Vec3<T>{p.x, p.y, p.z - select(on_side, z, centre)}};
}

template <Number T>
MANYHANDS_INLINE Entry<T> enter_box(const Vec3<T>& o, const Vec3<T>& d, const Vec3<T>& half) {
  const T zero(0.0f), one(1.0f);
  const Vec3<T> inverse{reciprocal(d.x), reciprocal(d.y), reciprocal(d.z)};
  const Vec3<T> reach{abs(half.x * inverse.x), abs(half.y * inverse.y), abs(half.z * inverse.z)};
  const Vec3<T> middle{-(o.x * inverse.x), -(o.y * inverse.y), -(o.z * inverse.z)};
  const Vec3<T> in = middle - reach, out = middle + reach;
  const T enter = max(in.x, max(in.y, in.z)), leave = min(out.x, min(out.y, out.z));
  const auto by_x = in.x >= enter, by_y = in.y >= enter;
  const Vec3<T> n{select(by_x, copysign(one, -d.x), zero), select(by_x, zero, select(by_y, copysign(one, -d.y), zero)),
                  select(by_x | by_y, zero, copysign(one, -d.z))};
  return {select(enter <= leave, enter, T(kNever)), n};
}

/// Whether a stretch of the ray lies in the box.
template <Number T>
MANYHANDS_INLINE mask_t<T> meets_box(const Vec3<T>& o, const Vec3<T>& d, const Vec3<T>& half, T near, T far) {
  const Vec3<T> inverse{reciprocal(d.x), reciprocal(d.y), reciprocal(d.z)};
  const Vec3<T> reach{abs(half.x * inverse.x), abs(half.y * inverse.y), abs(half.z * inverse.z)};
  const Vec3<T> middle{-(o.x * inverse.x), -(o.y * inverse.y), -(o.z * inverse.z)};
  const Vec3<T> in = middle - reach, out = middle + reach;
  return max(max(in.x, in.y), max(in.z, near)) <= min(min(out.x, out.y), min(out.z, far));
}

template <Number T>
MANYHANDS_INLINE Entry<T> enter_plane(const Vec3<T>& o, const Vec3<T>& d) {
  const T zero(0.0f), t = -(o.z * reciprocal(d.z));
  return {select((d.z < zero) & (o.z >= zero), t, T(kNever)), {zero, zero, T(1.0f)}};
}

}  // namespace internal

/// Where a ray enters a sphere, capsule, cylinder, box or plane of these sizes (see Shape). Not for other types.
template <Number T>
MANYHANDS_INLINE Entry<T> enter_shape(ShapeType type, const Vec3<real_t<T>>& size, const Vec3<T>& o, const Vec3<T>& d) {
  const Vec3<T> s = broadcast<T>(size);
  switch (type) {
    case ShapeType::kSphere:
      return internal::enter_ball(o, d, s.x);
    case ShapeType::kCapsule:
      return internal::enter_capsule(o, d, s.x, s.y);
    case ShapeType::kCylinder:
      return internal::enter_cylinder(o, d, s.x, s.y);
    case ShapeType::kBox:
      return internal::enter_box(o, d, s);
    default:
      return internal::enter_plane(o, d);
  }
}

/// Whether a ray between `near` and `far` comes through the box from `low` to `high`: if not, it misses what is inside.
template <Number T>
MANYHANDS_INLINE mask_t<T> meets_bounds(const Vec3<real_t<T>>& low, const Vec3<real_t<T>>& high, const Vec3<T>& o,
                                        const Vec3<T>& d, T near, T far) {
  constexpr real_t<T> kRoom = 1e-5f;  // flat boxes have some
  const Vec3<T> middle = broadcast<T>(real_t<T>(0.5) * (low + high));
  const Vec3<real_t<T>> half = real_t<T>(0.5) * (high - low) + Vec3<real_t<T>>{kRoom, kRoom, kRoom};
  return internal::meets_box(o - middle, d, broadcast<T>(half), near, far);
}

}  // namespace manyhands
