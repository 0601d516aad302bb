// What acts between parts beyond joints: tendons, equality constraints, and exceptions to the rules of collision.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "manyhands/model/description.h"

namespace manyhands {

/// A joint of one degree of freedom that a fixed tendon adds up.
struct TendonJoint {
  JointId joint{};
  double coefficient = 1;
};

/// A point on a link, through which a spatial tendon runs.
struct TendonPoint {
  LinkId link{};       ///< link 0 is the world
  Vec3<double> p_L{};  ///< in the link's frame [m]
};

/// A stretch of a spatial tendon, straight from point to point. Behind a pulley its length counts divided.
struct TendonBranch {
  double divisor = 1;
  std::vector<TendonPoint> points{};
};

/// A length that follows from q, and the forces along it: of springs, dampers, dry friction, limits and actuators.
struct Tendon {
  std::string name{};
  std::vector<TendonJoint> joints{};     ///< a fixed tendon: the sum of coefficient q
  std::vector<TendonBranch> branches{};  ///< a spatial one: the way through points [m]; either of the two is empty
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  std::optional<Compliance> compliance{};  ///< of lower and upper, which else hold exactly
  double damping = 0;                      ///< force per rate of length
  double friction = 0;                     ///< dry friction
  double armature = 0;                     ///< inertia that moves with the length
  double stiffness = 0;                    ///< of a spring that pulls below spring_lower and above spring_upper
  double spring_lower = 0, spring_upper = 0;
};

enum class EqualityType {
  kPoint,      ///< the origins of A and B coincide
  kHinge,      ///< kPoint, and B turns in A about z only
  kFixed,      ///< A and B coincide
  kPrismatic,  ///< B slides in A along z only
  kSlider,     ///< B slides in A along z and turns about it
  kJoint,      ///< joints: q_b = ratio q_a + offset
  kGear,       ///< joints: v_b = ratio v_a
  kTendon,     ///< tendons: length_b - reference_b = polynomial(length_a - reference_a)
};

/// An equation between two links, two joints or two tendons that always holds, or gives way by its compliance: it
/// closes a loop of the tree, or couples joints.
struct EqualityConstraint {
  std::string name{};
  EqualityType type = EqualityType::kPoint;
  LinkId link_a{}, link_b{};                               ///< of kPoint to kSlider; link 0 is the world
  Transform<double> X_LA = Transform<double>::identity();  ///< frame A on link_a
  Transform<double> X_LB = Transform<double>::identity();  ///< frame B on link_b
  JointId joint_a{}, joint_b{};                            ///< of kJoint and kGear: joints of one degree of freedom
  TendonId tendon_a{}, tendon_b{};                         ///< of kTendon; without tendon_a its length counts as 0
  std::array<double, 5> polynomial{0, 1, 0, 0, 0};         ///< coefficients of powers 0 to 4
  double reference_a = 0, reference_b = 0;
  double ratio = 1;
  double offset = 0;                                           ///< [rad or m]
  double max_force = std::numeric_limits<double>::infinity();  ///< of each row [N or N m]; of what holds exactly
  std::optional<Compliance> compliance{};
  double torque_scale = 1;  ///< of what gives way: half of it is how a rotation counts beside a displacement [m/rad]
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
