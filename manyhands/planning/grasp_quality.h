// How well contacts hold an object, whatever pulls at it.
#pragma once

#include <span>

#include "manyhands/math/vec3.h"

namespace manyhands {

/// A soft finger: with a normal force of 1 it pulls sideways by f and turns about its normal by m within
/// (f / friction)^2 + (m / torsion)^2 <= 1 (Howe and Cutkosky, Practical force-motion models for sliding manipulation,
/// Int. J. Robotics Research 15(6), 1996).
struct GraspContact {
  Vec3<double> point{};   ///< [m]
  Vec3<double> normal{};  ///< unit, into the object: the way the finger pushes
  double friction = 0.5;  ///< above 0
  double torsion = 0;     ///< [m]; 0 for a point that rubs
};

/// The epsilon metric: the largest wrench that forces of the contacts can balance in every direction, where their
/// normal forces sum up to 1 (Ferrari and Canny, Planning optimal grasps, ICRA 1992, their first metric). Moments are
/// taken about the point `about`, divided by `length` [m], so the metric has no unit. 0 where some wrench cannot be
/// balanced.
///
/// It is exact for contacts whose friction is what it is along `edges` directions around the normal, and in torsion;
/// between these it is interpolated linearly. So it is a lower bound: each contact counts no more than it can do.
/// Throws std::invalid_argument on fewer than 3 edges.
[[nodiscard]] double epsilon_quality(std::span<const GraspContact> contacts, const Vec3<double>& about, double length,
                                     int edges = 8);

}  // namespace manyhands
