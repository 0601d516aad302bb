// Client: bodies that programs make of shapes.
#include <algorithm>

#include "manyhands/bullet/client_body.h"
#include "manyhands/bullet/inertia.h"

namespace manyhands::bullet {

namespace {

/// The shapes of a record on a link; their meshes join the plan's.
std::vector<ShapePlan> put(BodyPlan& plan, const std::vector<ShapeRecord>& records, GeomRole role) {
  std::vector<ShapePlan> shapes;
  for (const ShapeRecord& record : records) {
    ShapePlan shape{.geom = {.role = role, .X_LG = record.pose, .shape = record.shape, .rgba = record.rgba},
                    .file = record.file,
                    .scale = record.scale};
    if (record.mesh) {
      shape.geom.shape.mesh = MeshId(plan.meshes.size());
      plan.meshes.push_back(*record.mesh);
    }
    if (record.height_field) {
      shape.geom.shape.height_field = HeightFieldId(plan.height_fields.size());
      plan.height_fields.push_back(*record.height_field);
    }
    shapes.push_back(std::move(shape));
  }
  return shapes;
}

/// PyBullet numbers links so, whatever their order in the lists.
std::vector<LinkPlan> depth_first(std::vector<LinkPlan> given) {
  std::vector<LinkPlan> links;
  const auto visit = [&](auto&& self, int parent, int number) -> void {
    for (std::size_t i = 0; i < given.size(); ++i) {
      if (given[i].parent != parent || given[i].name.empty()) continue;
      LinkPlan link = std::move(given[i]);
      given[i].name.clear();
      link.parent = number;
      links.push_back(std::move(link));
      self(self, static_cast<int>(i), static_cast<int>(links.size()) - 1);
    }
  };
  visit(visit, -1, -1);
  return links;
}

JointType joint_type(int code) {
  switch (code) {
    case kRevolute:
      return JointType::kContinuous;
    case kPrismatic:
      return JointType::kPrismatic;
    case kSpherical:
      return JointType::kSpherical;
    case kPlanar:
      return JointType::kPlanar;
    case kFixed:
      return JointType::kFixed;
    default:
      throw Error("createMultiBody failed: joint type " + std::to_string(code) + " is not known");
  }
}

}  // namespace

int Client::create_shape(std::vector<ShapeRecord> parts, GeomRole role) {
  const bool collides = role == GeomRole::kCollision;
  const int id = (collides ? next_collision_ : next_visual_)++;
  (collides ? collision_shapes_ : visual_shapes_)[id] =
      std::make_shared<const std::vector<ShapeRecord>>(std::move(parts));
  return id;
}

void Client::remove_shape(int id) { collision_shapes_.erase(id); }

int Client::create_body(const MultiBodyRequest& request, const Transform<double>& X_WB) {
  BodyPlan plan;
  const auto dress = [&](LinkPlan& link, int collision, int visual) {
    if (const auto found = collision_shapes_.find(collision); found != collision_shapes_.end()) {
      link.collisions = put(plan, *found->second, GeomRole::kCollision);
    }
    if (const auto found = visual_shapes_.find(visual); found != visual_shapes_.end()) {
      link.visuals = put(plan, *found->second, GeomRole::kVisual);
    } else {
      link.visuals = link.collisions;
      for (ShapePlan& shape : link.visuals) shape.geom.rgba = {1, 1, 1, 1};
    }
  };
  plan.base.name = "link0";
  plan.base.mass = request.mass;
  plan.base.X_LI = request.inertial_frame;
  plan.fixed = !(request.mass > 0);
  dress(plan.base, request.collision_shape, request.visual_shape);
  for (std::size_t i = 0; i < request.links.size(); ++i) {
    const MultiBodyRequest::Link& given = request.links[i];
    if (given.parent < 0 || given.parent > static_cast<int>(i)) {
      throw Error("createMultiBody failed: linkParentIndices[" + std::to_string(i) + "] is " +
                  std::to_string(given.parent) + "; expected 0 for the base, or k + 1 for an earlier link k");
    }
    LinkPlan link;
    link.name = "link" + std::to_string(i + 1);
    link.joint_name = "joint" + std::to_string(i + 1);
    link.joint = joint_type(given.joint);
    link.parent = given.parent - 1;
    link.X_PJ = given.pose;
    const double length = norm(given.axis);
    link.axis = length > 1e-12 ? (1 / length) * given.axis : Vec3<double>{1, 0, 0};
    link.lower = 1;
    link.mass = given.mass;
    link.X_LI = given.inertial_frame;
    dress(link, given.collision_shape, given.visual_shape);
    plan.links.push_back(std::move(link));
  }
  plan.links = depth_first(std::move(plan.links));
  set_inertias(plan, false);
  plan.self_collision = (request.flags & kSelfCollision) != 0;
  plan.excludes_ancestors = (request.flags & kExcludeAllParents) != 0;
  return add(std::move(plan), X_WB);
}

}  // namespace manyhands::bullet
