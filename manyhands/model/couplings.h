// What acts between parts beyond joints: equality constraints, actuators, and exceptions to the rules of collision.
#pragma once

#include <limits>
#include <optional>
#include <string>

#include "manyhands/model/description.h"

namespace manyhands {

enum class EqualityType {
  kPoint,      ///< the origins of A and B coincide
  kHinge,      ///< kPoint, and B turns in A about z only
  kFixed,      ///< A and B coincide
  kPrismatic,  ///< B slides in A along z only
  kSlider,     ///< B slides in A along z and turns about it
  kJoint,      ///< joints: q_b = ratio q_a + offset
  kGear,       ///< joints: v_b = ratio v_a
};

/// An equation between two links or two joints that always holds: it closes a loop of the tree, or couples joints.
struct EqualityConstraint {
  std::string name{};
  EqualityType type = EqualityType::kPoint;
  LinkId link_a{}, link_b{};                               ///< of kPoint to kSlider; link 0 is the world
  Transform<double> X_LA = Transform<double>::identity();  ///< frame A on link_a
  Transform<double> X_LB = Transform<double>::identity();  ///< frame B on link_b
  JointId joint_a{}, joint_b{};                            ///< of kJoint and kGear: joints of one degree of freedom
  double ratio = 1;
  double offset = 0;                                           ///< [rad or m]
  double max_force = std::numeric_limits<double>::infinity();  ///< of each row [N or N m]
};

enum class ActuatorType {
  kForce,     ///< force = gear ctrl
  kPosition,  ///< force = gear (kp (ctrl - gear q) - kd gear v)
  kVelocity,  ///< force = gear kd (ctrl - gear v)
};

/// A drive on a joint of one degree of freedom, commanded by one number, `ctrl`. Drives of one joint add up, and so do
/// their bounds.
struct Actuator {
  std::string name{};
  ActuatorType type = ActuatorType::kForce;
  JointId joint{};
  double gear = 1;
  double kp = 0;  ///< [N m/rad or N/m]
  double kd = 0;  ///< [N m s/rad or N s/m]
  double min_ctrl = -std::numeric_limits<double>::infinity();
  double max_ctrl = std::numeric_limits<double>::infinity();
  double max_force = std::numeric_limits<double>::infinity();  ///< at the joint [N m or N]
};

/// Two links whose geoms never touch, whatever their filters say.
struct ContactExclusion {
  LinkId a{}, b{};
};

/// Two geoms that may touch whatever their filters and links say; `surface`, if given, replaces their combination.
struct ContactPair {
  GeomId a{}, b{};
  std::optional<SurfaceMaterial> surface{};
};

/// The rules by which geoms find each other and combine.
struct ContactRules {
  CombineRule friction = CombineRule::kGeometricMean;
  CombineRule restitution = CombineRule::kMaximum;
  bool self_collision = true;  ///< between links of one tree, joint neighbours excepted
  bool contacts = true;        ///< whether anything touches at all
};

}  // namespace manyhands
