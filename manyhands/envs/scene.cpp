#include "manyhands/envs/scene.h"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "manyhands/model/compose.h"
#include "manyhands/model/io/urdf/urdf.h"
#include "manyhands/model/solids.h"
#include "manyhands/physics/collision/queries/queries.h"
#include "manyhands/physics/world/world.h"

namespace manyhands {

namespace {

constexpr double kFrictionOfTables = 0.5;

void add_surroundings(ModelBuilder& builder, const Table& table) {
  Geom floor{.name = "plane", .link = builder.world(), .shape = {.type = ShapeType::kPlane}};
  floor.X_LG.p = {0, 0, -table.height};
  floor.surface.lateral_friction = kFrictionOfTables;
  floor.rgba = {0.15f, 0.15f, 0.15f, 1};
  builder.add_geom(floor);
  Geom top{.name = "table",
           .link = builder.world(),
           .shape = {.type = ShapeType::kBox, .size = {table.length / 2, table.width / 2, table.height / 2}}};
  top.X_LG.p = {table.x_offset, 0, -table.height / 2};
  top.surface.lateral_friction = kFrictionOfTables;
  top.rgba = {0.95f, 0.95f, 0.95f, 1};
  builder.add_geom(top);
}

void add_object(ModelBuilder& builder, const ObjectSpec& object) {
  const Inertial solid = placed(object.X_OG, solid_of(object.shape));
  const LinkId link = builder.add_link(object.name, scaled(solid, object.mass / solid.mass));
  builder.add_joint(
      {.name = object.name + "_joint", .type = JointType::kFloating, .parent = builder.world(), .child = link});
  Geom geom{.name = object.name, .link = link, .X_LG = object.X_OG, .shape = object.shape, .rgba = object.rgba};
  geom.surface.lateral_friction = object.friction;
  geom.surface.rolling_friction = object.rolling_friction;
  builder.add_geom(geom);
}

constexpr LinkId kBase(1);  // of the arm

/// The joint that holds the arm's base, if it has one.
std::optional<JointId> stand_of(const ModelBuilder& builder) {
  for (std::size_t i = 0; i < builder.joints().size(); ++i) {
    if (builder.joints()[i].child == kBase) return JointId(i);
  }
  return std::nullopt;
}

constexpr std::array kShapes{"box", "cylinder", "sphere", "capsule"};

void add_obstacle(ModelBuilder& builder, std::size_t i, const Obstacle& obstacle) {
  const ShapeType type = obstacle.shape.type;
  const bool solid = type == ShapeType::kBox || type == ShapeType::kSphere || type == ShapeType::kCylinder ||
                     type == ShapeType::kCapsule;
  if (!solid) throw std::invalid_argument(obstacle_name(i) + " is no box, sphere, cylinder or capsule");
  const LinkId link = builder.add_link(obstacle_name(i));
  builder.add_joint({.name = obstacle_name(i), .parent = builder.world(), .child = link});
  Geom geom{
      .name = obstacle_name(i), .link = link, .X_LG = obstacle.X_WO, .shape = obstacle.shape, .rgba = obstacle.rgba};
  geom.surface.lateral_friction = obstacle.friction;
  builder.add_geom(geom);
}

}  // namespace

std::span<const char* const> object_shapes() { return kShapes; }

std::string obstacle_name(std::size_t i) { return "obstacle " + std::to_string(i); }

void reshape(ObjectSpec& object, const std::string& shape, std::span<const char* const> allowed) {
  if (std::ranges::find(allowed, shape) == allowed.end()) {
    std::string message = "object_shape is '" + shape + "'; expected";
    for (const char* known : allowed) message += std::string(known == allowed.front() ? " " : ", ") + known;
    throw std::invalid_argument(message);
  }
  const bool was_box = object.shape.type == ShapeType::kBox;
  const double radius = object.shape.size.x, half_height = was_box ? object.shape.size.z : object.shape.size.y;
  const bool round = shape == "sphere" || shape == "capsule";
  if (shape == "box") {
    object.shape = {.type = ShapeType::kBox, .size = {radius, was_box ? object.shape.size.y : radius, half_height}};
  } else if (shape == "cylinder") {
    object.shape = {.type = ShapeType::kCylinder, .size = {radius, half_height, 0}};
  } else if (shape == "sphere") {
    object.shape = {.type = ShapeType::kSphere, .size = {half_height, 0, 0}};
  } else {
    object.shape = {.type = ShapeType::kCapsule, .size = {half_height, radius, 0}};
    object.X_OG.R = {{0, 0, -1}, {0, 1, 0}, {1, 0, 0}};  // its axis along the object's x
  }
  if (round) object.rolling_friction = 5e-4;
}

Model load_arm(const ArmSpec& spec) {
  ModelBuilder builder =
      builder_of(spec.model != nullptr ? *spec.model : load_urdf(spec.urdf, {.load_meshes = spec.meshes}).model);
  if (builder.links().size() < 2) throw std::invalid_argument("the arm has no links");
  const std::optional<JointId> stand = stand_of(builder);
  if (!stand) {
    builder.place_root(kBase, spec.X_WA * builder.links()[kBase.index()].X_BL);
    return builder.build();
  }
  Joint& joint = builder.joint(*stand);
  if (joint.type != JointType::kFixed || joint.parent != builder.world())
    throw std::invalid_argument("the arm's base, '" + builder.links()[kBase.index()].name + "', must stand fixed");
  joint.X_PF = spec.X_WA * joint.X_PF;
  return builder.build();
}

Model task_scene(const ArmSpec& arm, const Table& table, std::span<const ObjectSpec> objects,
                 std::span<const Obstacle> obstacles) {
  ModelBuilder builder = builder_of(load_arm(arm));
  // Hung on the world before the objects are, so that its numbers come first.
  const Transform<double> X_WA = builder.links()[kBase.index()].X_BL;
  if (!stand_of(builder))
    builder.add_joint({.name = "arm_base", .parent = builder.world(), .child = kBase, .X_PF = X_WA});
  add_surroundings(builder, table);
  for (const ObjectSpec& object : objects) add_object(builder, object);
  for (std::size_t i = 0; i < obstacles.size(); ++i) add_obstacle(builder, i, obstacles[i]);
  return builder.build();
}

void require_clear(const Arm& arm, const Model& scene, std::size_t obstacles) {
  World world(std::make_shared<const Model>(scene));
  std::vector<double> q = scene.initial_configuration();
  for (std::size_t i = 0; i < arm.neutral.size(); ++i) q[arm.dof(i)] = arm.neutral[i];
  for (const Follower& joint : arm.followers) q[joint.dof] = joint.neutral;
  world.set_q(q);
  for (const LinkDistance& near : world.near_links(0)) {
    for (std::size_t i = 0; i < obstacles; ++i) {
      const LinkId obstacle = scene.link_id(obstacle_name(i));
      if (near.link_a != obstacle && near.link_b != obstacle) continue;
      const Link& other = scene.link(near.link_a == obstacle ? near.link_b : near.link_a);
      if (scene.body(other.body).type == JointType::kFloating) continue;  // an object, which is put elsewhere
      throw std::invalid_argument(obstacle_name(i) + " touches the arm's link '" + other.name +
                                  "' where episodes start; move it away");
    }
  }
}

}  // namespace manyhands
