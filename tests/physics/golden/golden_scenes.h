// Scenes that between them use every part of a step: joints, motors, drives, limits, equality constraints, every
// pair of shapes, and contacts of every kind.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tests/physics/contact/contact_scenes.h"
#include "tests/physics/world/world_scenes.h"

namespace manyhands::testing {

/// A model, and how its joints are driven: every second dof of the robot has a motor, if any.
struct GoldenScene {
  std::string name;
  std::function<std::shared_ptr<const Model>()> make;
  double motor_force = 0;  ///< [N m or N]; 0: no motors
  double push = 0.3;       ///< how fast the start moves [m/s and rad/s]
};

namespace golden {

inline Transform<double> at(double x, double y, double z) { return {Mat3<double>::identity(), {x, y, z}}; }

inline std::shared_ptr<const Model> share(const SceneBuilder& s) {
  return std::make_shared<const Model>(s.builder.build());
}

inline SceneBuilder on_floor(const std::string& name) {
  SceneBuilder s(name);
  s.add_geom(s.builder.world(), {ShapeType::kPlane});
  return s;
}

/// A link on a joint of any type, below `parent`.
inline LinkId add_arm(SceneBuilder& s, const std::string& name, LinkId parent, JointType type, const Vec3<double>& p,
                      const Vec3<double>& axis = {0, 1, 0}) {
  Inertial inertial = SceneBuilder::inertial({ShapeType::kBox, {0.02, 0.03, 0.1}}, 0.8);
  inertial.com = {0, 0.01, -0.1};
  const LinkId link = s.builder.add_link(name, inertial);
  Joint joint{.name = name, .type = type, .parent = parent, .child = link, .X_PF = at(p.x, p.y, p.z), .axis = axis};
  if (type == JointType::kRevolute || type == JointType::kPrismatic) joint.limits = {.lower = -0.6, .upper = 0.9};
  s.builder.add_joint(joint);
  return link;
}

/// A chain that uses every joint type, with damping, dry friction and armature.
inline std::shared_ptr<const Model> joints() {
  SceneBuilder s("joints");
  LinkId link = s.builder.world();
  const JointType types[] = {JointType::kPrismatic, JointType::kRevolute, JointType::kSpherical, JointType::kContinuous,
                             JointType::kPlanar};
  int k = 0;
  for (const JointType type : types) {
    link = add_arm(s, "part" + std::to_string(k), link, type, {0.05, 0, k == 0 ? 1.5 : -0.2},
                   {k == 3 ? 1.0 : 0.0, k == 3 ? 0.0 : 1.0, 0});
    ++k;
  }
  s.builder.joint(JointId(1)).damping = 0.2;
  s.builder.joint(JointId(1)).friction = 0.4;
  s.builder.joint(JointId(3)).armature = 0.05;
  s.builder.joint(JointId(3)).friction = 0.1;
  return share(s);
}

/// Three hinges beside each other, driven by a force, a position and a velocity actuator.
inline std::shared_ptr<const Model> actuators() {
  SceneBuilder s = on_floor("actuators");
  const ActuatorType types[] = {ActuatorType::kForce, ActuatorType::kPosition, ActuatorType::kVelocity};
  for (int k = 0; k < 3; ++k) {
    s.add_hinge("arm" + std::to_string(k), s.builder.world(), {0, 0.3 * k, 0.5}, 0.1, 1);
    s.builder.add_actuator({.name = "drive" + std::to_string(k),
                            .type = types[k],
                            .joint = JointId(static_cast<std::size_t>(k)),
                            .gear = 2,
                            .kp = k == 1 ? 40.0 : 0.0,
                            .kd = k == 0 ? 0.0 : 3.0,
                            .max_force = 8});
  }
  return share(s);
}

/// One pair of links for each equality constraint between frames, and two coupled joints.
inline std::shared_ptr<const Model> equalities() {
  SceneBuilder s("equalities");
  const EqualityType types[] = {EqualityType::kPoint, EqualityType::kHinge, EqualityType::kFixed,
                                EqualityType::kPrismatic, EqualityType::kSlider};
  int k = 0;
  for (const EqualityType type : types) {
    const std::string name = std::to_string(k);
    const LinkId a = s.add("a" + name, {ShapeType::kSphere, {0.02, 0, 0}}, 0.5, {0.5 * k, 0, 1});
    const LinkId b = s.add("b" + name, {ShapeType::kSphere, {0.02, 0, 0}}, 0.3, {0.5 * k + 0.2, 0, 1});
    s.builder.add_equality(
        {.name = name, .type = type, .link_a = a, .link_b = b, .X_LA = at(0.1, 0, 0), .X_LB = at(-0.1, 0, 0)});
    ++k;
  }
  const auto first = static_cast<std::size_t>(2 * k);
  for (const double x : {0.0, 0.3, 0.6}) s.add_hinge("h" + std::to_string(x), s.builder.world(), {x, 1, 1}, 0.1, 1);
  s.builder.add_equality({.name = "couple",
                          .type = EqualityType::kJoint,
                          .joint_a = JointId(first),
                          .joint_b = JointId(first + 1),
                          .ratio = -0.5,
                          .offset = 0.1});
  s.builder.add_equality({.name = "gear",
                          .type = EqualityType::kGear,
                          .joint_a = JointId(first + 1),
                          .joint_b = JointId(first + 2),
                          .ratio = 2,
                          .max_force = 3});
  return share(s);
}

/// A tetrahedron and a cube with a corner off, as hulls.
inline MeshId add_hull(SceneBuilder& s, float size, bool cut) {
  Mesh mesh;
  if (cut) {
    mesh.vertices = {{-size, -size, -size}, {size, -size, -size}, {-size, size, -size}, {size, size, -size},
                     {-size, -size, size},  {size, -size, size},  {-size, size, size},  {size, size, 0.2F * size}};
  } else {
    mesh.vertices = {{0, 0, 1.5F * size}, {size, 0, -size}, {-0.7F * size, size, -size}, {-0.7F * size, -size, -size}};
  }
  return s.builder.add_mesh(mesh);
}

inline void add_shape_of_hull(SceneBuilder& s, const std::string& name, MeshId mesh, const Vec3<double>& p) {
  const LinkId link = s.builder.add_link(name, SceneBuilder::inertial({ShapeType::kBox, {0.04, 0.04, 0.04}}, 0.3));
  s.builder.add_joint({.name = name + "_free",
                       .type = JointType::kFloating,
                       .parent = s.builder.world(),
                       .child = link,
                       .X_PF = at(p.x, p.y, p.z)});
  s.builder.add_geom({.name = name, .link = link, .shape = {.type = ShapeType::kConvex, .mesh = mesh}});
}

inline std::shared_ptr<const Model> hulls() {
  SceneBuilder s = on_floor("hulls");
  const MeshId tetrahedron = add_hull(s, 0.05F, false), cut = add_hull(s, 0.04F, true);
  add_shape_of_hull(s, "first", cut, {0, 0, 0.05});
  add_shape_of_hull(s, "second", cut, {0.01, 0.01, 0.14});
  add_shape_of_hull(s, "third", tetrahedron, {0.2, 0, 0.08});
  s.add("box", {ShapeType::kBox, {0.03, 0.03, 0.03}}, 0.3, {0.2, 0.01, 0.2});
  return share(s);
}

/// Round things of every kind on each other.
inline std::shared_ptr<const Model> heap() {
  SceneBuilder s = on_floor("heap");
  s.add("log", {ShapeType::kCylinder, {0.05, 0.1, 0}}, 1, {0, 0, 0.11});
  s.add("disc", {ShapeType::kCylinder, {0.06, 0.02, 0}}, 0.4, {0.01, 0.005, 0.235});
  s.add("pill", {ShapeType::kCapsule, {0.03, 0.05, 0}}, 0.3, {0.15, 0, 0.081});
  s.add("ball", {ShapeType::kSphere, {0.04, 0, 0}}, 0.3, {0.15, 0.01, 0.21});
  s.add("box", {ShapeType::kBox, {0.05, 0.04, 0.03}}, 0.5, {0.01, 0, 0.29});
  return share(s);
}

/// A tilted floor made of triangles, and a height field beside it.
inline std::shared_ptr<const Model> ground() {
  SceneBuilder s("ground");
  Mesh mesh;
  mesh.vertices = {{-1, -1, 0}, {1, -1, 0.1F}, {-1, 1, 0}, {1, 1, 0.15F}};
  mesh.triangles = {{0, 1, 3}, {0, 3, 2}};
  s.add_geom(s.builder.world(), {.type = ShapeType::kMesh, .mesh = s.builder.add_mesh(mesh)});
  HeightField field{.columns = 5, .rows = 5, .dx = 0.4, .dy = 0.4};
  for (int i = 0; i < 25; ++i) field.height.push_back(0.01 * ((7 * i) % 5));
  s.add_geom(s.builder.world(), {.type = ShapeType::kHeightField, .height_field = s.builder.add_height_field(field)},
             at(3, 0, 0));
  for (const double x : {0.0, 3.0}) {
    const std::string name = std::to_string(static_cast<int>(x));
    s.add("ball" + name, {ShapeType::kSphere, {0.05, 0, 0}}, 0.3, {x, 0.1, 0.2});
    s.add("box" + name, {ShapeType::kBox, {0.05, 0.04, 0.03}}, 0.3, {x + 0.2, -0.1, 0.2});
  }
  return share(s);
}

inline std::shared_ptr<const Model> bouncing() {
  SceneBuilder s("bouncing");
  s.add_geom(s.builder.world(), {ShapeType::kPlane}, Transform<double>::identity(), {.restitution = 0.9});
  s.add("ball", {ShapeType::kSphere, {0.05, 0, 0}}, 0.3, {0, 0, 0.3}, {.restitution = 0.9});
  s.add("box", {ShapeType::kBox, {0.05, 0.04, 0.03}}, 0.3, {0.3, 0, 0.2}, {.restitution = 0.5});
  s.add("pill", {ShapeType::kCapsule, {0.03, 0.05, 0}}, 0.3, {0.6, 0, 0.3}, {.restitution = 1});
  return share(s);
}

/// 100 kg on 1 kg: Newton steps in double.
inline std::shared_ptr<const Model> heavy() {
  SceneBuilder s = on_floor("heavy");
  s.add("light", {ShapeType::kBox, {0.05, 0.05, 0.05}}, 1, {0, 0, 0.0501});
  s.add("heavy", {ShapeType::kBox, {0.05, 0.05, 0.05}}, 100, {0.005, 0, 0.1503});
  return share(s);
}

/// Twelve bricks in four courses.
inline std::shared_ptr<const Model> wall() {
  SceneBuilder s = on_floor("wall");
  for (int course = 0; course < 4; ++course)
    for (int i = 0; i < 3; ++i)
      s.add("brick" + std::to_string(3 * course + i), {ShapeType::kBox, {0.1, 0.05, 0.04}}, 2,
            {0.201 * i + 0.1 * (course % 2), 0, 0.0401 + 0.0801 * course});
  return share(s);
}

/// A gripper of two coupled fingers, one of them driven, about a spinning and rolling ball.
inline std::shared_ptr<const Model> gripper() {
  SceneBuilder s = on_floor("gripper");
  for (const double side : {-1.0, 1.0})
    s.add_slide(side < 0 ? "left" : "right", {ShapeType::kBox, {0.01, 0.02, 0.03}}, 0.1, {0.05 * side, 0, 0.05},
                {-side, 0, 0}, 2);
  s.builder.add_equality(
      {.name = "mirror", .type = EqualityType::kJoint, .joint_a = JointId(0), .joint_b = JointId(1)});
  s.builder.add_actuator(
      {.name = "close", .type = ActuatorType::kPosition, .joint = JointId(0), .kp = 4000, .kd = 10, .max_force = 20});
  s.add("ball", {ShapeType::kSphere, {0.03, 0, 0}}, 0.1, {0, 0.002, 0.04},
        {.spinning_friction = 0.005, .rolling_friction = 0.001});
  return share(s);
}

/// More than 60 geoms: pairs are found by the broad phase in double.
inline std::shared_ptr<const Model> crowd() {
  SceneBuilder s = on_floor("crowd");
  for (int i = 0; i < 64; ++i)
    s.add("ball" + std::to_string(i), {ShapeType::kSphere, {0.05, 0, 0}}, 0.2,
          {0.11 * (i % 4) + 0.003 * (i / 16), 0.11 * (i / 4 % 4), 0.06 + 0.105 * (i / 16)});
  return share(s);
}

inline std::shared_ptr<const Model> arm() {
  return std::make_shared<const Model>(load_urdf(asset_path("panda/panda.urdf")).model);
}

inline std::shared_ptr<const Model> second_arm() {
  return std::make_shared<const Model>(load_urdf(asset_path("arm6/arm6.urdf")).model);
}

}  // namespace golden

inline std::vector<GoldenScene> golden_scenes() {
  std::vector<GoldenScene> scenes;
  const char* names[] = {"boxes", "pinch", "arm among boxes", "surfaces", "four-bar", "yielding"};
  for (int i = 0; i < kScenes; ++i)
    scenes.push_back({names[i], [i] { return std::make_shared<const Model>(contact_scene(i)); }, i == 2 ? 3.0 : 0.0});
  scenes.push_back({"stack", [] { return stack(4); }, 0, 0.05});
  scenes.push_back({"panda and cube", [] { return panda_and_cube(); }, 40});
  scenes.push_back({"panda falls", golden::arm, 0});
  scenes.push_back({"arm6", golden::second_arm, 5});
  scenes.push_back({"joints", golden::joints, 2});
  scenes.push_back({"actuators", golden::actuators});
  scenes.push_back({"equalities", golden::equalities});
  scenes.push_back({"hulls", golden::hulls});
  scenes.push_back({"heap", golden::heap});
  scenes.push_back({"ground", golden::ground});
  scenes.push_back({"bouncing", golden::bouncing});
  scenes.push_back({"heavy", golden::heavy, 0, 0.01});
  scenes.push_back({"wall", golden::wall, 0, 0.02});
  scenes.push_back({"gripper", golden::gripper});
  scenes.push_back({"crowd", golden::crowd, 0, 0.1});
  return scenes;
}

}  // namespace manyhands::testing
