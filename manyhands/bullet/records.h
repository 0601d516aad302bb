// What goes in and out of a client's calls.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "manyhands/bullet/body_plan.h"
#include "manyhands/bullet/bounds.h"
#include "manyhands/math/quaternion.h"
#include "manyhands/render/texture.h"

namespace manyhands::bullet {

/// What setPhysicsEngineParameter knows. The engine's solver needs no iterations or error reductions: those are kept
/// to be read back.
struct Settings {
  double time_step = 1.0 / 240;
  int substeps = 0;  ///< 0: one
  int iterations = 50;
  int inner_iterations = 1;
  bool real_time = false;
  int filter_mode = 1;
  int joint_feedback_mode = 0;
};

/// Of loaders; flags as in PyBullet, scale of URDF alone.
struct LoadOptions {
  bool fixed_base = false;
  bool maximal_coordinates = false;
  int flags = 0;
  double scale = 1;
};

enum UrdfFlag : int {
  kInertiaFromFile = 2,
  kSelfCollision = 8,
  kExcludeAllParents = 32,
  kImplicitCylinder = 128,
  kIncludeParent = 8192,
  kMaintainLinkOrder = 131072,
  kMergeFixedLinks = 524288,
  kIgnoreVisualShapes = 1048576,
  kIgnoreCollisionShapes = 2097152,
};

struct JointReading {
  std::vector<double> q, v, motor;  ///< none for a fixed joint
  std::array<double, 6> reaction{};
};

struct LinkReading {
  Transform<double> X_WI, X_LI, X_WL;
  Motion<double> V;  ///< of the centre of mass, world axes
};

enum ControlMode { kVelocity = 0, kTorque = 1, kPosition = 2, kPd = 3, kStablePd = 4 };

struct MotorSetting {
  ControlMode mode = kVelocity;
  double target_q = 0, target_v = 0, force = 100000, kp = 0.1, kd = 1;
  std::optional<double> max_velocity{};
  std::optional<Quat<double>> target_r{};      ///< of a spherical joint
  Vec3<double> torque = Vec3<double>::zero();  ///< of a spherical joint under TORQUE_CONTROL [N m]
};

/// Empty: leave it.
struct DynamicsChange {
  std::optional<double> mass, lateral_friction, spinning_friction, rolling_friction, restitution, linear_damping,
      angular_damping, contact_stiffness, contact_damping, joint_damping, max_joint_velocity, joint_limit_force,
      collision_margin;
  std::optional<bool> friction_anchor;
  std::optional<Vec3<double>> inertia;
  std::optional<std::array<double, 2>> limits;
  std::optional<int> activation_state;
};

struct DynamicsReading {
  double mass, lateral_friction;
  Vec3<double> inertia;
  Transform<double> X_LI;
  double restitution, rolling_friction, spinning_friction, contact_damping, contact_stiffness;
  int body_type;
  double margin;
};

struct UserConstraint {
  int parent = -1, parent_link = -1, child = -1, child_link = -1;
  JointCode type = kFixed;
  Vec3<double> axis{0, 0, 0};
  Transform<double> X_parent = Transform<double>::identity();  ///< in the parent's inertial frame
  Transform<double> X_child = Transform<double>::identity();   ///< in the child's, or the world
  double max_force = 500;
  bool has_max_force = false;
  double gear_ratio = 1;
  bool has_gear_ratio = false;
  int gear_aux_link = -1;
  double relative_target = 0;
  double erp = 0;
};

struct ConstraintChange {
  std::optional<Vec3<double>> child_pivot;
  std::optional<Quat<double>> child_orientation;
  std::optional<double> max_force, gear_ratio, relative_target, erp;
  std::optional<int> gear_aux_link;
};

struct IkRequest {
  int link = 0;
  Vec3<double> position{};
  std::optional<Quat<double>> orientation{};
  std::vector<double> lower{}, upper{}, range{}, rest{}, damping{}, start{};
  int max_iterations = 20;
  double threshold = 1e-4;
};

struct ContactReading {
  int body_a = -1, body_b = -1, link_a = -1, link_b = -1;
  Vec3<double> on_a{}, on_b{}, normal_on_b{};
  double distance = 0, normal_force = 0;
  Vec3<double> friction{};  ///< on B
  double friction_1 = 0, friction_2 = 0;
  Vec3<double> direction_1{}, direction_2{};
};

/// One side of a question for distances: a collision shape at a place, or else a body, or one of its links.
struct QuerySide {
  int body = -1, link = -2, shape = -1;                 ///< link -2: any
  Transform<double> X = Transform<double>::identity();  ///< of the shape, in the world
};

struct RayReading {
  int body = -1, link = -1;
  double fraction = 1;
  Vec3<double> point{}, normal{};
};

/// A shape before it is on a link.
struct ShapeRecord {
  Shape shape{};
  std::shared_ptr<const Mesh> mesh{};
  std::shared_ptr<const HeightField> height_field{};
  std::string file{};
  Vec3<double> scale{1, 1, 1};
  Transform<double> pose = Transform<double>::identity();
  std::array<float, 4> rgba{1, 1, 1, 1};
};

struct MultiBodyRequest {
  double mass = 0;
  int collision_shape = -1, visual_shape = -1;
  Transform<double> inertial_frame = Transform<double>::identity();
  struct Link {
    double mass = 0;
    int collision_shape = -1, visual_shape = -1;
    Transform<double> pose = Transform<double>::identity();
    Transform<double> inertial_frame = Transform<double>::identity();
    int parent = 0;  ///< 0: the base, k + 1: link k
    int joint = kFixed;
    Vec3<double> axis{0, 0, 1};
  };
  std::vector<Link> links{};
  int flags = 0;
};

struct VisualChange {
  int shape = -1;  ///< -1: all
  std::optional<std::array<float, 4>> rgba{};
  std::optional<int> texture{};
};

struct PictureRequest {
  int width = 0, height = 0;
  std::array<double, 16> view{}, projection{};
  bool shadow = false;
  std::optional<Vec3<double>> light{};
  double ambient = 0.6, diffuse = 0.35;
  bool links_too = false;
  bool segmentation = true;
};

struct PictureResult {
  std::span<std::uint8_t> rgba;          ///< (height, width, 4)
  std::span<float> depth;                ///< (height, width) of OpenGL's buffer
  std::span<std::int32_t> segmentation;  ///< (height, width)
};

}  // namespace manyhands::bullet
