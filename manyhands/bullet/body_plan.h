// A body as PyBullet counts it: a base, number -1, and links 0 to n - 1, each on the joint of its number.
#pragma once

#include <string>
#include <vector>

#include "manyhands/model/model.h"

namespace manyhands::bullet {

/// The values of createConstraint's and getJointInfo's joint types.
enum JointCode { kRevolute = 0, kPrismatic = 1, kSpherical = 2, kPlanar = 3, kFixed = 4, kPoint = 5, kGear = 6 };
/// The values of shapes' types.
enum ShapeCode { kSphere = 2, kBox = 3, kCylinder = 4, kMesh = 5, kPlane = 6, kCapsule = 7, kHeightField = 9 };

/// A collision or visual shape on a link.
struct ShapePlan {
  Geom geom;                      ///< its mesh and height field count those of the BodyPlan; X_LG in the link's frame
  std::string file{};             ///< that the mesh came from
  Vec3<double> scale{1, 1, 1};    ///< of the mesh
  bool is_urdf_cylinder = false;  ///< a cylinder of a file, which PyBullet makes a hull of
  std::vector<MeshId> parts{};    ///< of a concave mesh that moves: the convex ones that collide in its place

  /// Whether it is a surface that only the world can have.
  [[nodiscard]] bool is_ground() const {
    const ShapeType type = geom.shape.type;
    return type == ShapeType::kPlane || type == ShapeType::kMesh || type == ShapeType::kHeightField;
  }
};

struct LinkPlan {
  std::string name{}, joint_name{};
  JointType joint = JointType::kFixed;
  int parent = -1;                                         ///< the link it hangs on
  Transform<double> X_PJ = Transform<double>::identity();  ///< the joint's frame in the parent's
  Vec3<double> axis{1, 0, 0};                              ///< in the joint's frame
  double lower = 0, upper = -1;                            ///< as they are reported; lower > upper: none
  double max_force = 0, max_velocity = 0;                  ///< reported only
  double damping = 0;                                      ///< [N m s/rad or N s/m]
  double friction = 0;                                     ///< reported only
  Transform<double> X_LI = Transform<double>::identity();  ///< the inertial frame: "centre of mass frame"
  double mass = 0;                                         ///< [kg]
  Vec3<double> inertia = Vec3<double>::zero();             ///< about the axes of I [kg m^2]
  SymMat3<double> file_inertia = SymMat3<double>::zero();  ///< as the file has it, about the axes of L
  bool has_file_inertia = false;
  double inertia_scale = 1;  ///< a factor of inertias that follow from shapes
  SurfaceMaterial surface{};
  std::vector<ShapePlan> collisions{}, visuals{};

  /// Whether its margin is its radius.
  [[nodiscard]] bool is_round() const {
    if (collisions.size() != 1) return false;
    const ShapeType type = collisions[0].geom.shape.type;
    return type == ShapeType::kSphere || type == ShapeType::kCapsule;
  }
  [[nodiscard]] bool is_limited() const {
    return (joint == JointType::kRevolute || joint == JointType::kPrismatic) && lower <= upper;
  }
};

struct BodyPlan {
  std::string name{};
  LinkPlan base{};
  LinkId root{};  ///< the base in the loader's model; invalid where it is none of that
  std::vector<LinkPlan> links{};
  std::vector<Mesh> meshes{};
  std::vector<HeightField> height_fields{};
  bool from_file = false;                                     ///< not made by a program
  bool fixed = false;                                         ///< the base stands where it is put
  bool self_collision = false;                                ///< between its links
  bool includes_parents = false, excludes_ancestors = false;  ///< see URDF_USE_SELF_COLLISION_...

  [[nodiscard]] int num_links() const { return static_cast<int>(links.size()); }
  [[nodiscard]] bool moves(int i) const { return i >= 0 || !fixed; }
  [[nodiscard]] LinkPlan& link(int i) { return i < 0 ? base : links[static_cast<std::size_t>(i)]; }
  [[nodiscard]] const LinkPlan& link(int i) const { return i < 0 ? base : links[static_cast<std::size_t>(i)]; }
  /// Whether the base has shapes that a body on a joint cannot have: planes, triangle meshes, height fields.
  [[nodiscard]] bool has_ground() const;
};

/// The model of a plan, whose base stands at X_WB or begins there: link 1 is the base, the others follow in their
/// order. The base of a fixed body is on a mocap joint, or welded to the world where it has_ground.
[[nodiscard]] Model model_of(const BodyPlan& plan, const Transform<double>& X_WB);

/// What a model calls the link: its name, which "world" may not be.
[[nodiscard]] std::string model_name(const LinkPlan& link);

/// The bodies of a model that a loader made: one for each part that stands on the world of its own.
[[nodiscard]] std::vector<BodyPlan> plans_of(const Model& model);

/// Link `id` of the model and its joint; `numbers` tells the number of each link in the plan.
[[nodiscard]] LinkPlan link_plan(const Model& model, LinkId id, const std::vector<int>& numbers);

/// Lumps links on fixed joints into their parents.
void merge_fixed_links(BodyPlan& plan);

[[nodiscard]] JointCode joint_code(JointType type);
[[nodiscard]] ShapeCode shape_code(ShapeType type);

}  // namespace manyhands::bullet
