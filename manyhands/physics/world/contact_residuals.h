// How well the contacts of a step meet the laws of contact.
#pragma once

#include "manyhands/physics/step/step.h"
#include "manyhands/physics/world/contact_report.h"

namespace manyhands {

namespace internal {

/// |y - P(y - u / G)| G of the tangential impulse y, P onto the disc of radius n.
template <Number T>
[[nodiscard]] T dissipation(const DelassusBlock<T>& block, const Vec3<T>& impulse, const Vec3<T>& u) {
  const T zero = constant<T>(0), one = constant<T>(1), G = max(block.sigma_1, block.sigma_2);
  const auto moves = G > zero;
  const T inverse = select(moves, one / select(moves, G, one), zero);
  T y_1 = fma(-inverse, u.y, impulse.y), y_2 = fma(-inverse, u.z, impulse.z);
  const T length = sqrt(fma(y_1, y_1, y_2 * y_2)), radius = max(impulse.x, zero);
  const T scale = select(length > radius, radius / select(length > zero, length, one), one);
  y_1 = fma(-scale, y_1, impulse.y);
  y_2 = fma(-scale, y_2, impulse.z);
  return G * sqrt(fma(y_1, y_1, y_2 * y_2));
}

}  // namespace internal

/// Of point i of the last step; 0 where a world has no such point.
template <Number T>
[[nodiscard]] PointResiduals<T> point_residuals(const ContactSolver<T>& contact, std::size_t i) {
  const T zero = constant<T>(0);
  const ContactPoint<T>& point = contact.problem.points[i];
  const auto exists = is_finite(point.phi);
  const Vec3<T>& y = contact.iterate.points[i].impulse;
  Vec3<T> u = point.offset + point_velocity(contact.problem, point, contact.iterate.dv.data());
  u.x = fma(point.softness, y.x, u.x);
  const auto kept = [&](T value) { return select(exists, value, zero); };
  return {kept(abs(u.x) * y.x), kept(max(zero, -u.x)), kept(max(zero, sqrt(fma(y.y, y.y, y.z * y.z)) - y.x)),
          kept(internal::dissipation(contact.factors.points[i], y, u))};
}

/// Of the step that the workspace holds.
[[nodiscard]] ContactResiduals contact_residuals(const StepWorkspace<double>& ws);

}  // namespace manyhands
