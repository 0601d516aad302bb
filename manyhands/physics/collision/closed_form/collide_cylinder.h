// Contact of a cylinder with a plane.
#pragma once

#include "manyhands/physics/collision/closed_form/collide_sphere.h"

namespace manyhands {

/// size_A: (radius, half length, -); B is the half-space z <= 0 of its frame. On the cap that is lower: the lowest
/// point of the rim and the two beside it; fourth the lower of the rim's highest point and the other cap's lowest. A
/// standing cylinder thus has four points, a lying one two near the plane, and whatever changes does so far from it.
template <Number T>
Manifold<T> collide_cylinder_plane(const Vec3<T>& size_A, const Transform<T>& X_WA, const Vec3<T>& /*size_B*/,
                                   const Transform<T>& X_WB, T /*margin*/) {
  using R = real_t<T>;
  const T radius = size_A.x, half_length = size_A.y;
  const Vec3<T>& axis = X_WA.R.z;
  const Vec3<T>& up = X_WB.R.z;
  const T cosine = dot(axis, up);
  // The least bit of x gives the rim of a standing cylinder a place to begin that rounding does not move about.
  const T bias(std::same_as<R, float> ? R(1e-5) : R(1e-7));
  const Vec3<T> falling = fma(bias, X_WA.R.x, cross(axis, cross(axis, up)));
  const Vec3<T> down = internal::direction_or(falling, X_WA.R.x).unit;
  const Vec3<T> beside = cross(axis, down);

  const Vec3<T> to_cap = copysign(half_length, -cosine) * axis;  // from the centre to the lower cap
  const T h_centre = dot(up, X_WA.p - X_WB.p);
  const T h_cap = h_centre + dot(up, to_cap);
  const T h_down = radius * dot(up, down), h_beside = radius * dot(up, beside);
  const Vec3<T> cap = X_WA.p + to_cap, other_cap = X_WA.p - to_cap;
  const T h_other = h_centre - dot(up, to_cap) + h_down;
  const mask_t<T> lying = h_other < h_cap - h_down;

  Manifold<T> m;
  m.normal = -up;
  m.set(0, fma(radius, down, cap), h_cap + h_down);
  m.set(1, fma(radius, beside, cap), h_cap + h_beside);
  m.set(2, fma(-radius, beside, cap), h_cap - h_beside);
  m.set(3, select(lying, fma(radius, down, other_cap), fma(-radius, down, cap)),
        select(lying, h_other, h_cap - h_down));
  return m;
}

}  // namespace manyhands
