// Contacts as people ask for them: points with names, net forces, and how well the contact law is met.
#pragma once

#include "manyhands/base/ids.h"
#include "manyhands/math/spatial.h"

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
template <Number T>
struct ContactForces {
  Force<T> normal = Force<T>::zero();    ///< of the normal forces
  Force<T> friction = Force<T>::zero();  ///< of friction, spinning and rolling included
  [[nodiscard]] Force<T> total() const { return normal + friction; }
};
using ContactWrench = ContactForces<double>;

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

}  // namespace manyhands
