// How well the contacts of a step meet the laws of contact.
#pragma once

#include "manyhands/physics/step/step.h"
#include "manyhands/physics/world/contact_report.h"

namespace manyhands {

namespace internal {

/// |y - P(y - u / G)| G of the tangential impulse y, P onto the disc of the given radius.
template <Number T>
[[nodiscard]] T dissipation(const ContactPoint<T>& point, const Vec3<T>& u) {
  using R = real_t<T>;
  const T zero(R(0)), one(R(1));
  const T response = max(point.stiffness.sigma_1, point.stiffness.sigma_2);
  const auto moves = response > zero;
  const T inverse = select(moves, one / select(moves, response, one), zero);
  T y_1 = fma(-inverse, u.y, point.impulse.y), y_2 = fma(-inverse, u.z, point.impulse.z);
  const T length = sqrt(fma(y_1, y_1, y_2 * y_2)), radius = max(point.impulse.x, zero);
  const T scale = select(length > radius, radius / select(length > zero, length, one), one);
  y_1 = fma(-scale, y_1, point.impulse.y);
  y_2 = fma(-scale, y_2, point.impulse.z);
  return response * sqrt(fma(y_1, y_1, y_2 * y_2));
}

}  // namespace internal

/// Of the step that `ws` did last; 0 where a world has no such point.
template <Number T>
[[nodiscard]] PointResiduals<T> point_residuals(const Tree<real_t<T>>& tree, const StepWorkspace<T>& ws,
                                                const ContactPoint<T>& point) {
  const T zero(real_t<T>(0));
  const auto exists = is_finite(point.phi);
  const Vec3<T>& y = point.impulse;
  Vec3<T> u = point.offset + point_velocity(tree, ws.contacts, point, ws.joints.dv.data());
  u.x = fma(point.softness, y.x, u.x);
  const auto kept = [&](T value) { return select(exists, value, zero); };
  return {kept(abs(u.x) * y.x), kept(max(zero, -u.x)), kept(max(zero, sqrt(fma(y.y, y.y, y.z * y.z)) - y.x)),
          kept(internal::dissipation(point, u))};
}

[[nodiscard]] ContactResiduals contact_residuals(const Tree<double>& tree, const StepWorkspace<double>& ws);

}  // namespace manyhands
