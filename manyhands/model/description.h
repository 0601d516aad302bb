// The parts of a robot or scene as people describe them: links, joints, geoms and meshes.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "manyhands/base/ids.h"
#include "manyhands/math/spatial.h"
#include "manyhands/model/compliance.h"

namespace manyhands {

enum class JointType {
  kFixed,       ///< nq 0, nv 0
  kRevolute,    ///< nq 1, nv 1: angle about the axis [rad], limited
  kContinuous,  ///< nq 1, nv 1: angle about the axis [rad], unlimited
  kPrismatic,   ///< nq 1, nv 1: shift along the axis [m]
  kSpherical,   ///< nq 4, nv 3: quaternion xyzw; angular velocity in the joint frame F [rad/s]
  kPlanar,      ///< nq 3, nv 3: (x, y) in the plane across the axis and the angle about it; v is their rate
  kFloating,    ///< nq 7, nv 6: position and quaternion xyzw; (omega, velocity of the origin), both in F
  kMocap,       ///< nq 0, nv 0: on the world only; the child stands, at rest, where World::set_mocap puts it
};

[[nodiscard]] const char* to_string(JointType type);   ///< as URDF writes it
[[nodiscard]] int configuration_size(JointType type);  ///< nq
[[nodiscard]] int velocity_size(JointType type);       ///< nv

/// Mass properties of a link: rotational inertia about the centre of mass, in the link frame's axes.
struct Inertial {
  double mass{};              ///< [kg]
  Vec3<double> com{};         ///< centre of mass in the link frame [m]
  SymMat3<double> inertia{};  ///< about the centre of mass [kg m^2]

  [[nodiscard]] RigidInertia<double> about_origin() const;
};

/// A rigid part with a name. Its frame L is the frame of the joint that moves it, at q = 0.
struct Link {
  std::string name{};
  Inertial inertial{};
  Mat3<double> inertial_axes = Mat3<double>::identity();  ///< those of the file's <inertial>, in the link frame
  double inertia_scale = 1;         ///< Bullet's <inertia_scaling>, which is in `inertial` already
  double gravity_compensation = 0;  ///< share of its weight that is carried for it: 1, and it floats
  LinkId parent{};                  ///< invalid for a root
  JointId joint{};                  ///< the joint to the parent; invalid for a root
  BodyId body{};                    ///< the moving body that carries the link (set by build)
  Transform<double> X_BL = Transform<double>::identity();  ///< pose on that body (set by build)
};

/// What links move through: it drags on each as on the box of its inertia, as in MuJoCo.
struct Medium {
  double density = 0;                        ///< [kg/m^3]
  double viscosity = 0;                      ///< [Pa s]
  Vec3<double> wind = Vec3<double>::zero();  ///< its velocity, world axes [m/s]

  [[nodiscard]] bool drags() const { return density > 0 || viscosity > 0; }
};

/// One joint drives another: q = multiplier * q_driver + offset.
struct Mimic {
  std::string joint{};
  double multiplier = 1;
  double offset = 0;  ///< [rad or m]
};

struct JointLimits {
  double lower = -std::numeric_limits<double>::infinity();    ///< [rad or m]
  double upper = std::numeric_limits<double>::infinity();     ///< [rad or m]
  double effort = std::numeric_limits<double>::infinity();    ///< [N m or N]
  double velocity = std::numeric_limits<double>::infinity();  ///< [rad/s or m/s]
  std::optional<Compliance> compliance{};                     ///< of lower and upper, which else hold exactly
};

/// A joint between a parent link P and a child link. Frame F is fixed in P; at q = 0 the child's frame is F.
struct Joint {
  std::string name{};
  JointType type = JointType::kFixed;
  LinkId parent{};
  LinkId child{};
  Transform<double> X_PF = Transform<double>::identity();
  Vec3<double> axis{0, 0, 1};  ///< unit, in F; of revolute, continuous, prismatic; the normal of planar
  JointLimits limits{};
  double damping = 0;    ///< [N m s/rad or N s/m]
  double friction = 0;   ///< dry friction [N m or N]
  double armature = 0;   ///< rotor inertia seen at the joint [kg m^2 or kg]
  double stiffness = 0;  ///< of a spring at each dof [N m/rad or N/m]
  std::optional<Mimic> mimic{};
  std::vector<double> initial{};           ///< where it starts, in q; empty: at 0, or unturned
  std::vector<double> spring_reference{};  ///< where the spring is at rest, in q; empty: at 0, or unturned
  int iq = -1;                             ///< first index in q; -1 for fixed joints (set by build)
  int iv = -1;                             ///< first index in v; -1 for fixed joints (set by build)
};

/// A triangle mesh, shared by the geoms that show or use it.
struct Mesh {
  std::string source{};                         ///< the file it came from, or a description
  Vec3<double> scale{1, 1, 1};                  ///< by which the file's numbers were multiplied
  std::vector<Vec3<float>> vertices{};          ///< [m], the file's scale applied
  std::vector<std::array<int, 3>> triangles{};  ///< counter-clockwise seen from outside
};

enum class ShapeType {  ///< for sizes see Shape
  kSphere,
  kCapsule,
  kCylinder,
  kBox,
  kPlane,        ///< the half-space z <= 0; on the world only
  kMesh,         ///< its triangles; where it collides, on the world only: a surface, not a volume
  kConvex,       ///< the convex hull of a mesh's vertices
  kHeightField,  ///< the ground below a grid of heights; on the world only
};

/// A shape: along z where it has an axis.
struct Shape {
  ShapeType type = ShapeType::kSphere;
  Vec3<double> size{};           ///< sphere: r; capsule, cylinder: r, half length; box: half extents [m]
  MeshId mesh{};                 ///< for kMesh and kConvex
  HeightFieldId height_field{};  ///< for kHeightField
};

/// Heights on a grid in the xy plane, centred on the geom's origin.
struct HeightField {
  int columns = 0, rows = 0;     ///< vertices along x and along y, 2 or more
  double dx = 1, dy = 1;         ///< spacing [m]
  std::vector<double> height{};  ///< (rows, columns) z of each vertex [m]
};

enum class GeomRole { kVisual, kCollision };  ///< what is seen, or what touches

/// How a link touches others; PyBullet's <contact> block where a URDF has one.
struct SurfaceMaterial {
  double lateral_friction = 0.5;
  std::optional<double> friction_y{};  ///< along the geom's y, where it differs from that along its x
  double spinning_friction = 0;        ///< torque about the normal per normal force [m]
  double rolling_friction = 0;         ///< torque across the normal per normal force [m]
  double restitution = 0;
  std::optional<double> stiffness{};  ///< [N/m]; only where somebody asked for softness
  std::optional<double> damping{};    ///< [N s/m]
  std::optional<Compliance>
      compliance{};  ///< along the normal: another softness, relative to the inertia that it meets

  /// All of it but its compliance, for the model's fingerprint.
  [[nodiscard]] auto fields() const {
    return std::tie(lateral_friction, friction_y, spinning_friction, rolling_friction, restitution, stiffness, damping);
  }
};

/// How the numbers of two surfaces become one.
enum class CombineRule { kProduct, kGeometricMean, kMaximum, kMinimum };

/// Two geoms may touch if each one's group is in the other's mask.
struct CollisionFilter {
  std::uint32_t group = 1;
  std::uint32_t mask = 0xffffffff;
};

inline constexpr float kMostRepeats = 1e4f;  ///< of textures, in each direction

/// What a geom shows in place of one colour, multiplied by it: an image, or checks of 2 x 2 squares.
struct GeomTexture {
  std::string file{};                         ///< the image; empty: checks
  std::array<std::array<float, 3>, 2> rgb{};  ///< of the checks
  std::array<float, 2> repeat{1.0f, 1.0f};    ///< how often it lies there, of planes on every metre, along x and y
};

struct Geom {  ///< a shape on a link
  std::string name{};
  GeomRole role = GeomRole::kCollision;
  LinkId link{};
  Transform<double> X_LG = Transform<double>::identity();
  Shape shape{};
  std::array<float, 4> rgba{0.7f, 0.7f, 0.7f, 1.0f};
  std::optional<GeomTexture> texture{};
  SurfaceMaterial surface{};
  CollisionFilter filter{};
  double margin = 0;  ///< how far the surface is pushed outwards for contact [m]
};

/// A state that a scene was given a name for.
struct Keyframe {
  std::string name{};
  double time = 0;              ///< [s]
  std::vector<double> q{};      ///< (nq)
  std::vector<double> v{};      ///< (nv)
  std::vector<double> ctrl{};   ///< (nu)
  std::vector<double> act{};    ///< (na)
  std::vector<double> mocap{};  ///< of the mocap bodies: x y z [m] and quaternion xyzw each
};

}  // namespace manyhands
