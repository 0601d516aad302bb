#include "manyhands/bullet/body_plan.h"

#include <algorithm>

#include "manyhands/math/quaternion.h"
#include "manyhands/model/model_builder.h"
#include "manyhands/model/solids.h"

namespace manyhands::bullet {

namespace {

/// The plan's inertia in the axes of the link.
SymMat3<double> inertia_in_link(const LinkPlan& link) {
  return rotated(link.X_LI.R, SymMat3<double>{link.inertia.x, link.inertia.y, link.inertia.z, 0, 0, 0});
}

/// A plan turned into a model, one part at a time.
class Assembler {
 public:
  Assembler(const BodyPlan& plan, const Transform<double>& X_WB) : plan_(plan), X_WB_(X_WB), builder_(plan.name) {}

  Model assemble() {
    for (const Mesh& mesh : plan_.meshes) meshes_.push_back(builder_.add_mesh(mesh));
    for (const HeightField& field : plan_.height_fields) fields_.push_back(builder_.add_height_field(field));
    add_base();
    for (int i = 0; i < plan_.num_links(); ++i) add_link(i);
    for (int i = -1; i < plan_.num_links(); ++i) add_shapes(i);
    exclude_pairs();
    for (const JointId joint : builder_.joints_without_inertia()) builder_.joint(joint).armature = kLeastInertia;
    builder_.set_contact_rules({.friction = CombineRule::kProduct,
                                .restitution = CombineRule::kProduct,
                                .self_collision = plan_.self_collision});
    return builder_.build();
  }

 private:
  static constexpr double kLeastInertia = 1e-6;  // of joints that move nothing [kg m^2 or kg]

  [[nodiscard]] static Inertial inertial_of(const LinkPlan& link) {
    return {.mass = link.mass, .com = link.X_LI.p, .inertia = inertia_in_link(link)};
  }

  void add_base() {
    Inertial inertial = inertial_of(plan_.base);
    const bool turns = inertial.inertia.xx > 0 && inertial.inertia.yy > 0 && inertial.inertia.zz > 0;
    // PyBullet takes no inertia for an infinite one; a lever of a metre comes near enough.
    if (!plan_.fixed && !turns) inertial.inertia = {inertial.mass, inertial.mass, inertial.mass, 0, 0, 0};
    if (plan_.fixed) inertial = {};
    const LinkId base = builder_.add_link(model_name(plan_.base), inertial);
    if (plan_.fixed && plan_.has_ground()) {
      builder_.place_root(base, X_WB_);
      return;
    }
    Joint joint{.name = unused("base"), .type = JointType::kMocap, .parent = builder_.world(), .child = base};
    if (plan_.fixed) {
      joint.X_PF = X_WB_;
    } else {
      const Quat<double> r = normalized(to_quat(X_WB_.R));
      joint.type = JointType::kFloating;
      joint.initial = {X_WB_.p.x, X_WB_.p.y, X_WB_.p.z, r.x, r.y, r.z, r.w};
    }
    builder_.add_joint(std::move(joint));
  }

  void add_link(int i) {
    const LinkPlan& link = plan_.link(i);
    const LinkId child = builder_.add_link(model_name(link), inertial_of(link));
    Joint joint{.name = link.joint_name, .type = link.joint, .parent = id(link.parent), .child = child};
    joint.X_PF = link.X_PJ;
    joint.axis = link.axis;
    joint.damping = link.damping;
    if (link.is_limited()) {
      joint.limits.lower = link.lower;
      joint.limits.upper = link.upper;
    } else if (link.joint == JointType::kRevolute) {
      joint.type = JointType::kContinuous;
    }
    builder_.add_joint(std::move(joint));
  }

  void add_shapes(int i) {
    const auto add = [&](const ShapePlan& shape, GeomRole role) {
      Geom geom = shape.geom;
      geom.name.clear();
      geom.role = role;
      geom.link = id(i);
      if (role == GeomRole::kCollision) geom.surface = plan_.link(i).surface;
      if (geom.shape.mesh.is_valid()) geom.shape.mesh = meshes_[geom.shape.mesh.index()];
      if (geom.shape.height_field.is_valid()) geom.shape.height_field = fields_[geom.shape.height_field.index()];
      const bool is_hull = geom.shape.type == ShapeType::kMesh && role == GeomRole::kCollision && plan_.moves(i);
      if (is_hull) geom.shape.type = ShapeType::kConvex;
      if (!is_hull || shape.parts.empty()) {
        builder_.add_geom(std::move(geom));
        return;
      }
      for (const MeshId part : shape.parts) {
        geom.shape.mesh = meshes_[part.index()];
        builder_.add_geom(geom);
      }
    };
    for (const ShapePlan& shape : plan_.link(i).collisions) add(shape, GeomRole::kCollision);
    for (const ShapePlan& shape : plan_.link(i).visuals) add(shape, GeomRole::kVisual);
  }

  void exclude_pairs() {
    if (!plan_.self_collision || !plan_.excludes_ancestors) return;
    for (int i = 0; i < plan_.num_links(); ++i) {
      for (int k = plan_.link(i).parent;; k = plan_.link(k).parent) {
        builder_.exclude_contact(id(i), id(k));
        if (k < 0) break;
      }
    }
  }

  [[nodiscard]] static LinkId id(int link) { return LinkId(link + 2); }

  [[nodiscard]] std::string unused(std::string name) const {
    const auto taken = [&](const LinkPlan& link) { return link.joint_name == name; };
    while (std::ranges::any_of(plan_.links, taken)) name += '_';
    return name;
  }

  const BodyPlan& plan_;
  const Transform<double>& X_WB_;
  ModelBuilder builder_;
  std::vector<MeshId> meshes_;
  std::vector<HeightFieldId> fields_;
};

}  // namespace

LinkPlan link_plan(const Model& model, LinkId id, const std::vector<int>& numbers) {
  const Link& part = model.link(id);
  LinkPlan link;
  link.name = part.name == "world_" ? "world" : part.name;  // as the file has it
  link.mass = part.inertial.mass;
  link.X_LI = {part.inertial_axes, part.inertial.com};
  link.file_inertia = part.inertial.inertia;
  link.has_file_inertia = true;
  link.inertia_scale = part.inertia_scale;
  for (const GeomId geom_id : model.geoms_of(id)) {
    ShapePlan shape{.geom = model.geoms()[geom_id.index()]};
    if (shape.geom.shape.mesh.is_valid()) {
      const Mesh& mesh = model.meshes()[shape.geom.shape.mesh.index()];
      shape.file = mesh.source.substr(0, mesh.source.find('#'));
      shape.scale = mesh.scale;
    }
    shape.is_urdf_cylinder = shape.geom.shape.type == ShapeType::kCylinder;
    if (shape.geom.role == GeomRole::kCollision) link.surface = shape.geom.surface;
    (shape.geom.role == GeomRole::kCollision ? link.collisions : link.visuals).push_back(std::move(shape));
  }
  if (!part.joint.is_valid()) return link;
  const Joint& joint = model.joint(part.joint);
  link.joint_name = joint.name;
  link.joint = joint.type;
  link.parent = part.parent.is_valid() ? numbers[part.parent.index()] : -1;
  link.X_PJ = joint.X_PF;
  link.axis = joint.axis;
  const bool finite = is_finite(joint.limits.lower) && is_finite(joint.limits.upper);
  if (finite) std::tie(link.lower, link.upper) = std::pair(joint.limits.lower, joint.limits.upper);
  if (is_finite(joint.limits.effort)) link.max_force = joint.limits.effort;
  if (is_finite(joint.limits.velocity)) link.max_velocity = joint.limits.velocity;
  link.damping = joint.damping;
  link.friction = joint.friction;
  return link;
}

bool BodyPlan::has_ground() const { return std::ranges::any_of(base.collisions, &ShapePlan::is_ground); }

std::string model_name(const LinkPlan& link) { return link.name == "world" ? "world_" : link.name; }

Model model_of(const BodyPlan& plan, const Transform<double>& X_WB) { return Assembler(plan, X_WB).assemble(); }

std::vector<BodyPlan> plans_of(const Model& model) {
  std::vector<BodyPlan> plans;
  std::vector<int> numbers(model.links().size(), -1), plan_of(model.links().size(), -1);
  const bool on_world = !model.geoms_of(LinkId(0)).empty();
  const auto begin = [&](LinkId id) {
    BodyPlan plan;
    plan.name = model.name();
    plan.base = link_plan(model, id, numbers);
    plan.root = id;
    plan.fixed = id.value() == 0 || !model.link(id).joint.is_valid() ||
                 model.joint(model.link(id).joint).type != JointType::kFloating || plan.base.mass == 0;
    plan.self_collision = model.contact_rules().self_collision;
    plan.meshes.assign(model.meshes().begin(), model.meshes().end());
    plan.height_fields.assign(model.height_fields().begin(), model.height_fields().end());
    plan_of[id.index()] = static_cast<int>(plans.size());
    plans.push_back(std::move(plan));
  };
  if (on_world) begin(LinkId(0));
  for (std::size_t i = 1; i < model.links().size(); ++i) {
    const LinkId id(i);
    const Link& link = model.link(id);
    const bool root = !link.parent.is_valid() || link.parent.value() == 0;
    const bool free = root && (!link.joint.is_valid() || model.joint(link.joint).type == JointType::kFloating);
    if (free || (root && !on_world)) {
      begin(id);
      continue;
    }
    const int plan = plan_of[i] = root ? static_cast<int>(plans.size()) - 1 : plan_of[link.parent.index()];
    BodyPlan& body = plans[static_cast<std::size_t>(plan)];
    numbers[i] = body.num_links();
    body.links.push_back(link_plan(model, id, numbers));
  }
  return plans;
}

namespace {

/// Adds a link on a fixed joint to the one that carries it.
void absorb(LinkPlan& parent, const LinkPlan& link) {
  const Inertial own{.mass = link.mass, .com = link.X_LI.p, .inertia = link.file_inertia};
  const Inertial theirs{.mass = parent.mass, .com = parent.X_LI.p, .inertia = parent.file_inertia};
  const Inertial both = sum(theirs, placed(link.X_PJ, own));
  parent.mass = both.mass;
  parent.X_LI = {parent.X_LI.R, both.com};
  parent.file_inertia = both.inertia;
  const auto move = [&](const std::vector<ShapePlan>& shapes, std::vector<ShapePlan>& into) {
    for (ShapePlan shape : shapes) {
      shape.geom.X_LG = link.X_PJ * shape.geom.X_LG;
      into.push_back(std::move(shape));
    }
  };
  move(link.collisions, parent.collisions);
  move(link.visuals, parent.visuals);
}

/// Numbers links anew as PyBullet does, which fills the gap that a merged link leaves with the last of its siblings,
/// and then appends its children.
class Merger {
 public:
  explicit Merger(BodyPlan& plan) : plan_(plan), children_(plan.links.size() + 1) {
    for (int i = 0; i < plan.num_links(); ++i) of(plan.link(i).parent).push_back(i);
  }

  void merge() {
    visit(-1, -1);
    plan_.links = std::move(merged_);
  }

 private:
  std::vector<int>& of(int link) { return children_[static_cast<std::size_t>(link + 1)]; }

  /// `number`: that of the link from now on.
  void visit(int link, int number) {
    std::vector<int>& children = of(link);
    for (std::size_t k = 0; k < children.size();) {
      const int child = children[k];
      if (plan_.link(child).joint != JointType::kFixed) {
        ++k;
        continue;
      }
      for (const int grandchild : of(child)) {
        plan_.link(grandchild).X_PJ = plan_.link(child).X_PJ * plan_.link(grandchild).X_PJ;
      }
      absorb(plan_.link(link), plan_.link(child));
      children[k] = children.back();
      children.pop_back();
      children.insert(children.end(), of(child).begin(), of(child).end());
    }
    if (link >= 0) merged_[static_cast<std::size_t>(number)] = plan_.link(link);
    for (const int child : children) {
      const int next = static_cast<int>(merged_.size());
      plan_.link(child).parent = number;
      merged_.push_back(plan_.link(child));
      visit(child, next);
    }
  }

  BodyPlan& plan_;
  std::vector<std::vector<int>> children_;  // of the base, then of the links
  std::vector<LinkPlan> merged_;
};

}  // namespace

void merge_fixed_links(BodyPlan& plan) { Merger(plan).merge(); }

JointCode joint_code(JointType type) {
  switch (type) {
    case JointType::kRevolute:
    case JointType::kContinuous:
      return kRevolute;
    case JointType::kPrismatic:
      return kPrismatic;
    case JointType::kSpherical:
      return kSpherical;
    case JointType::kPlanar:
      return kPlanar;
    default:
      return kFixed;
  }
}

ShapeCode shape_code(ShapeType type) {
  switch (type) {
    case ShapeType::kSphere:
      return kSphere;
    case ShapeType::kCapsule:
      return kCapsule;
    case ShapeType::kCylinder:
      return kCylinder;
    case ShapeType::kBox:
      return kBox;
    case ShapeType::kPlane:
      return kPlane;
    case ShapeType::kHeightField:
      return kHeightField;
    default:
      return kMesh;
  }
}

}  // namespace manyhands::bullet
