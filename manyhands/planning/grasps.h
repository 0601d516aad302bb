// Where a gripper of two parallel jaws can take hold of an object.
#pragma once

#include <array>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "manyhands/math/rigid_motion.h"
#include "manyhands/planning/line_crossings.h"

namespace manyhands {

/// Two jaws that slide along y of the frame G, which lies between their pads; z points away from the palm. Jaws and
/// palm are boxes [m].
struct ParallelGripper {
  double opening = 0.08;                 ///< between the pads, at most
  double depth = 0.048;                  ///< from G back to the palm
  double reach = 0.0145;                 ///< from G to the tips
  double width = 0.022;                  ///< of a jaw along x, and of the round pad that touches
  double thickness = 0.022;              ///< of a jaw along y
  Vec3<double> palm{0.05, 0.15, 0.056};  ///< the size of the box behind the jaws
};

/// Throws std::invalid_argument unless all its lengths are finite and above 0.
void require_lengths(const ParallelGripper& gripper);

/// What is to be grasped: solids as `crossings` takes them, fixed to each other.
struct GraspObject {
  std::vector<PlacedShape> shapes{};
  Vec3<double> com = Vec3<double>::zero();  ///< its centre of mass [m]
};

struct GraspSettings {
  double friction = 0.5;            ///< between pads and object
  int samples = 100;                ///< points of the surface that are tried
  int approaches = 8;               ///< directions around each pair of contacts
  Vec3<double> approach{0, 0, -1};  ///< the way G's z should point, of any length
  double tilt = std::numbers::pi;   ///< how far it may point elsewhere [rad]
  double clearance = 0.005;         ///< of each jaw from its contact before it closes [m]
  std::uint64_t seed = 0;
};

/// One way to hold an object O, in whose frame everything is given.
struct Grasp {
  Transform<double> X_OG = Transform<double>::identity();
  double width{};    ///< between the contacts [m]
  double quality{};  ///< `epsilon_quality` about the centre of mass, by the radius of a ball about it that holds all
  double margin{};   ///< by which the worse contact lies within its friction cone [rad]
  std::array<Vec3<double>, 2> points{};   ///< where the jaws touch [m]
  std::array<Vec3<double>, 2> normals{};  ///< of the surface there, unit, outwards
};

/// Antipodal grasps: the line through both contacts lies within both friction cones, so pads with friction hold
/// whatever the fingers press (Nguyen, Constructing force-closure grasps, Int. J. Robotics Research 7(3), 1988). Jaws
/// at `clearance` and the palm are free of the object and of all obstacles. The best come first; of equal ones those
/// nearer to the centre of mass, then those nearer to `approach`.
///
/// Points of the surface are drawn evenly, as the ends of random lines (Crofton). From each a line runs inwards along
/// its normal, and turns until the normals at its ends agree with it, if they do.
///
/// Throws std::invalid_argument if there is no shape, on planes and height fields among the object's, and on numbers
/// that make no sense.
[[nodiscard]] std::vector<Grasp> find_grasps(const GraspObject& object, std::span<const PlacedShape> obstacles,
                                             const ParallelGripper& gripper, const GraspSettings& settings);

}  // namespace manyhands
