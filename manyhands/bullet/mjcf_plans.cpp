#include "manyhands/bullet/mjcf_plans.h"

namespace manyhands::bullet {

namespace {

constexpr const char* kNameless = "MuJoCo Model";  // what the loader calls a model without a name

/// Whether the loader made up the geom's name, "geom_" and a number.
bool is_nameless(const std::string& name) {
  return name.empty() || (name.starts_with("geom_") && name.find_first_not_of("0123456789", 5) == name.npos);
}

class Planner {
 public:
  Planner(const Model& model, int& fixed)
      : model_(model), fixed_(fixed), children_(model.links().size()), numbers_(model.links().size(), -1) {
    for (std::size_t i = 1; i < children_.size(); ++i) {
      const LinkId parent = model.links()[i].parent;
      children_[parent.is_valid() ? parent.index() : 0].push_back(LinkId(i));
    }
  }

  std::vector<BodyPlan> plan() {
    const LinkPlan world = link_plan(model_, LinkId(0), numbers_);
    for (const ShapePlan& shape : world.collisions) add_static(shape, world.surface);
    for (const ShapePlan& shape : world.visuals) add_static(shape, world.surface);
    for (const LinkId top : children_[0]) add_top(top);
    return std::move(plans_);
  }

 private:
  BodyPlan& begin() {
    BodyPlan plan;
    plan.name = model_.name() == kNameless ? "" : model_.name();
    plan.self_collision = model_.contact_rules().self_collision;
    plan.meshes.assign(model_.meshes().begin(), model_.meshes().end());
    plan.height_fields.assign(model_.height_fields().begin(), model_.height_fields().end());
    plans_.push_back(std::move(plan));
    next_ = 0;
    return plans_.back();
  }

  void add_static(const ShapePlan& shape, const SurfaceMaterial& surface) {
    BodyPlan& body = begin();
    body.fixed = true;
    body.base.name = is_nameless(shape.geom.name) ? "anonymous" : shape.geom.name;
    body.base.surface = surface;
    (shape.geom.role == GeomRole::kCollision ? body.base.collisions : body.base.visuals).push_back(shape);
  }

  /// Whether the link was made by the loader, to carry one of several joints or one that is off the body's origin.
  [[nodiscard]] bool is_carrier(const Link& link) const {
    if (!link.joint.is_valid() || children_[model_.link_id(link.name).index()].size() != 1) return false;
    return link.inertial.mass == 0 && link.name.ends_with("_" + model_.joint(link.joint).name);
  }

  [[nodiscard]] static bool moves(const LinkPlan& link) {
    return link.joint != JointType::kFixed && link.joint != JointType::kFloating;
  }

  std::string fresh_name() { return "link" + std::to_string(plans_.size() - 1) + "_" + std::to_string(next_++); }

  void add_top(LinkId top) {
    begin();
    add_body(top, -1, 0);
    plans_.back().fixed = !(plans_.back().base.mass > 0);
  }

  /// A body of the file with all that hangs on it, on link `parent` of the plan, whose number in the file is
  /// `parent_number`.
  void add_body(LinkId first, int parent, int parent_number) {
    std::vector<LinkPlan> joints;
    LinkId id = first;
    for (; is_carrier(model_.link(id)); id = children_[id.index()].front()) joints.push_back(plan_of(id));
    LinkPlan own = plan_of(id);
    const int number = next_;
    const std::string spare = fresh_name();
    if (own.name == "body_" + std::to_string(body_number(id))) own.name = spare;
    const bool is_direct = moves(own);  // the last joint is that of the link itself
    if (is_direct) joints.push_back(own);
    if (is_direct) own.X_PJ = Transform<double>::identity();
    std::vector<LinkPlan>& links = plans_.back().links;
    const bool is_base = parent < 0 && plans_.back().base.name.empty();
    int carrier = parent, carrier_number = parent_number;
    if (is_base && !joints.empty()) plans_.back().base.name = fresh_name();
    for (LinkPlan& joint : joints) {
      carrier_number = next_;
      links.push_back(carrying(joint, fresh_name(), carrier));
      carrier = static_cast<int>(links.size()) - 1;
    }
    int place = -1;
    if (is_base && joints.empty()) {
      plans_.back().base = std::move(own);
      plans_.back().root = id;
    } else {
      own.joint = JointType::kFixed;
      own.parent = carrier;
      own.lower = 0;
      own.upper = -1;
      own.max_force = own.max_velocity = own.damping = own.friction = 0;
      place = static_cast<int>(links.size());
      links.push_back(std::move(own));
    }
    for (const LinkId child : children_[id.index()]) add_body(child, place, number);
    if (place < 0) return;
    plans_.back().links[static_cast<std::size_t>(place)].joint_name =
        "jointfix_" + std::to_string(fixed_++) + "_" + std::to_string(carrier_number);
  }

  [[nodiscard]] LinkPlan plan_of(LinkId id) const { return link_plan(model_, id, numbers_); }

  /// The joint alone, on a link without mass; its damping and friction do not count.
  static LinkPlan carrying(const LinkPlan& joint, std::string name, int parent) {
    LinkPlan link;
    link.name = std::move(name);
    link.joint_name = joint.joint_name;
    link.joint = joint.joint;
    link.parent = parent;
    link.X_PJ = joint.X_PJ;
    link.axis = joint.axis;
    const bool is_limited = joint.is_limited();
    link.lower = is_limited ? joint.lower : 1;
    link.upper = is_limited ? joint.upper : 0;
    return link;
  }

  /// How the loader counts bodies without a name: the carriers do not count.
  [[nodiscard]] int body_number(LinkId id) const {
    int number = 0;
    for (std::size_t i = 1; i <= id.index(); ++i) number += is_carrier(model_.links()[i]) ? 0 : 1;
    return number;
  }

  const Model& model_;
  int& fixed_;
  std::vector<std::vector<LinkId>> children_;
  std::vector<int> numbers_;
  std::vector<BodyPlan> plans_;
  int next_ = 0;  // the number of the next link in its file
};

}  // namespace

std::vector<BodyPlan> mjcf_plans_of(const Model& model, int& fixed) { return Planner(model, fixed).plan(); }

}  // namespace manyhands::bullet
