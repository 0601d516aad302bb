// Contacts as people ask for them: points with names, net forces, and how well the contact law is met.
#pragma once

#include "manyhands/physics/step/step.h"

namespace manyhands {

/// A point where two links touched in a step. All in world axes; forces act on B, and reversed on A.
struct Contact {
  LinkId link_a{}, link_b{};
  GeomId geom_a{}, geom_b{};
  Vec3<double> position{};        ///< midway between the surfaces, before the step [m]
  Vec3<double> normal{};          ///< unit, from A to B
  double distance{};              ///< along the normal, before the step; negative in penetration [m]
  Vec3<double> impulse{};         ///< on B [N s]
  Vec3<double> force{};           ///< impulse / time step [N]
  double normal_force{};          ///< along the normal, 0 or more [N]
  Vec3<double> friction_force{};  ///< across it [N]
  Vec3<double> moment{};          ///< of spinning and rolling friction [N m]
};

/// What contacts do to a link, in world axes about its origin as it was before the step.
struct ContactWrench {
  Force<double> normal = Force<double>::zero();    ///< of the normal forces
  Force<double> friction = Force<double>::zero();  ///< of friction, spinning and rolling included
  [[nodiscard]] Force<double> total() const { return normal + friction; }
};

/// How far a contact point is from Signorini's and Coulomb's laws. With u the velocity of B's point against A's at the
/// step's end, its normal part less the one that the point must have at least (to stay apart, to come out of
/// penetration, to bounce), and (n, y) the impulse:
template <Number T>
struct PointResiduals {
  T signorini{};         ///< |u_n| n [J]: an impulse acts only where the surfaces do not part
  T penetration_rate{};  ///< max(0, -u_n) [m/s]
  T cone{};              ///< max(0, |y| - n) [N s], y in units of friction: the cone is |y| <= n
  T dissipation{};       ///< |y - P(y - u_t / G)| G [m/s]: P onto the disc of radius n, G what resists sliding
};

/// The largest over all points.
using ContactResiduals = PointResiduals<double>;

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

[[nodiscard]] ContactResiduals contact_residuals(const StepWorkspace<double>& ws);

}  // namespace manyhands
