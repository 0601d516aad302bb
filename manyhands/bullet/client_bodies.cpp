// Client: bodies that come and go.
#include <algorithm>
#include <utility>

#include "manyhands/bullet/client_body.h"
#include "manyhands/bullet/inertia.h"
#include "manyhands/math/quaternion.h"
#include "manyhands/model/io/mjcf/mjcf.h"
#include "manyhands/model/io/sdf/sdf.h"
#include "manyhands/model/io/urdf/urdf.h"

namespace manyhands::bullet {

namespace {

std::string body_label(int id) { return "b" + std::to_string(id); }

void apply_flags(BodyPlan& plan, const LoadOptions& options) {
  if ((options.flags & kMergeFixedLinks) != 0) merge_fixed_links(plan);
  for (int i = -1; i < plan.num_links(); ++i) {
    LinkPlan& link = plan.link(i);
    if ((options.flags & kIgnoreVisualShapes) != 0) link.visuals.clear();
    if ((options.flags & kIgnoreCollisionShapes) != 0) link.collisions.clear();
    for (ShapePlan& shape : link.collisions) {
      if ((options.flags & kImplicitCylinder) != 0) shape.is_urdf_cylinder = false;
    }
  }
  plan.from_file = true;
  set_inertias(plan, (options.flags & kInertiaFromFile) != 0);
  plan.self_collision = (options.flags & kSelfCollision) != 0;
  plan.excludes_ancestors = (options.flags & kExcludeAllParents) != 0;
  plan.includes_parents = (options.flags & kIncludeParent) != 0;
}

/// What a link without shapes to see shows: its collision shapes, in white.
void show_collisions(BodyPlan& plan) {
  for (int i = -1; i < plan.num_links(); ++i) {
    LinkPlan& link = plan.link(i);
    if (!link.visuals.empty()) continue;
    link.visuals = link.collisions;
    for (ShapePlan& shape : link.visuals) shape.geom.rgba = {1, 1, 1, 1};
  }
}

/// What PyBullet reads of an MJCF file's joints: no damping and friction, and no limits as a range that is reversed.
void take_mjcf_rules(BodyPlan& plan) {
  for (LinkPlan& link : plan.links) {
    link.damping = link.friction = 0;
    const bool turns = link.joint == JointType::kContinuous || link.joint == JointType::kPrismatic ||
                       link.joint == JointType::kRevolute;
    if (turns && !link.is_limited()) std::tie(link.lower, link.upper) = std::pair(1.0, 0.0);
  }
}

/// Where a base stands in the world of its own file, or begins there.
Transform<double> place_of(const Model& model, const BodyPlan& plan) {
  if (!plan.root.is_valid() || plan.root.value() == 0) return Transform<double>::identity();
  const Link& link = model.link(plan.root);
  if (!link.joint.is_valid()) return link.X_BL;
  const Joint& joint = model.joint(link.joint);
  const std::vector<double>& q = joint.initial;
  if (q.size() != 7) return joint.X_PF;
  return joint.X_PF * Transform<double>{to_matrix(Quat<double>{q[3], q[4], q[5], q[6]}), {q[0], q[1], q[2]}};
}

}  // namespace

int Client::load_urdf(const std::filesystem::path& path, const Transform<double>& X_WB, const LoadOptions& options) {
  const LoadedModel loaded = manyhands::load_urdf(path, {.fixed_base = true,
                                                         .allow_outside_package = true,
                                                         .bullet = true,
                                                         .file_order = (options.flags & kMaintainLinkOrder) != 0,
                                                         .scale = options.scale});
  take_notes(loaded.report);
  BodyPlan plan = plans_of(loaded.model).at(0);
  plan.fixed = options.fixed_base || !(plan.base.mass > 0);
  apply_flags(plan, options);
  show_collisions(plan);
  if (options.fixed_base) plan.base.inertia = Vec3<double>::zero();
  return add(std::move(plan), X_WB);
}

std::vector<int> Client::add_all(const LoadedModel& loaded, const LoadOptions& options, bool from_mjcf) {
  take_notes(loaded.report);
  std::vector<int> ids;
  for (BodyPlan& plan : plans_of(loaded.model)) {
    Transform<double> X_WB = place_of(loaded.model, plan);
    if (from_mjcf) {
      X_WB = X_WB * inverse(plan.base.X_LI);  // its centre of mass stands where the file has the body
      take_mjcf_rules(plan);
    }
    apply_flags(plan, options);
    show_collisions(plan);
    ids.push_back(add(std::move(plan), X_WB));
  }
  return ids;
}

std::vector<int> Client::load_mjcf(const std::filesystem::path& path, const LoadOptions& options) {
  return add_all(manyhands::load_mjcf(path, {.allow_outside_package = true, .bullet = true}), options, true);
}

std::vector<int> Client::load_sdf(const std::filesystem::path& path, const LoadOptions& options) {
  std::vector<int> ids;
  for (const LoadedModel& loaded : manyhands::load_sdf(path, {.allow_outside_package = true, .bullet = true})) {
    const std::vector<int> more = add_all(loaded, options, false);
    ids.insert(ids.end(), more.begin(), more.end());
  }
  return ids;
}

int Client::fresh_id() const { return freed_.empty() ? next_id_ : freed_.back(); }

int Client::add(BodyPlan plan, const Transform<double>& X_WB) {
  keep_contacts();
  const int id = fresh_id();
  auto body = std::make_unique<Body>();
  body->id = id;
  body->plan = std::move(plan);
  if (decompose_) split_concave(decompose_, body->plan);
  world_.add(model_of(body->plan, X_WB), Transform<double>::identity(), body_label(id));
  ++scene_;
  const std::size_t n = body->plan.links.size();
  body->motors.resize(n);
  body->memory.resize(n + 1);
  body->dof.assign(n, -1);
  for (std::size_t i = 0; i < n; ++i) {
    const int dofs = velocity_size(body->plan.links[i].joint);
    if (dofs > 0) body->dof[i] = body->num_dofs;
    body->num_dofs += dofs;
  }
  for (int i = -1; i < static_cast<int>(n); ++i) {
    for (const ShapePlan& shape : body->plan.link(i).visuals) body->of(i).rgba.push_back(shape.geom.rgba);
    const LinkPlan& link = body->plan.link(i);
    if (link.is_round()) body->of(i).margin = link.collisions[0].geom.shape.size.x;
    if (!body->plan.from_file && !stands_for_link(link)) body->of(i).margin = 0;
    const SurfaceMaterial& surface = body->plan.link(i).surface;
    if (surface.stiffness && surface.damping) {
      body->of(i).contact_stiffness = surface.stiffness;
      body->of(i).contact_damping = surface.damping;
    }
    body->of(i).textures.assign(body->of(i).rgba.size(), -1);
    if (i < 0 && body->plan.fixed) body->of(i).filter = {2, -3};
  }
  if (freed_.empty()) {
    ++next_id_;
  } else {
    freed_.pop_back();
  }
  Body& added = *(bodies_[id] = std::move(body));
  order_.push_back(id);
  locate(added);
  for (int i = 0; i < added.plan.num_links(); ++i) write_motor(added, i);
  apply_filters(id);
  return id;
}

void Client::remove(int id) {
  Body* const body = find(id);
  if (body == nullptr) return;
  keep_contacts();
  std::vector<int> cut;
  for (const auto& [number, c] : constraints_) {
    if (c.parent == id || c.child == id) cut.push_back(number);
  }
  for (const int number : cut) drop_constraint(number);
  if (!cut.empty()) write_constraints();
  world_.remove(body_label(id));
  ++scene_;
  const auto place = std::ranges::find(order_, id);
  *place = order_.back();
  order_.pop_back();
  bodies_.erase(id);
  user_data_.remove_body(id);
  freed_.push_back(id);
  std::erase_if(pair_rules_, [&](const auto& rule) { return rule.first[0] == id || rule.first[2] == id; });
}

/// Builds a body anew where its plan has changed in what a model fixes, and leaves its state as it is.
void Client::replace(Body& body) {
  keep_contacts();
  const Transform<double> X_WI = inertial_pose(body, -1);
  const Motion<double> V = body.plan.fixed ? Motion<double>::zero() : base_velocity(body.id);
  std::vector<std::vector<double>> q, v;
  for (int i = 0; i < body.plan.num_links(); ++i) {
    const std::span<const double> qi = world_.joint_q(joint_id(body, i)), vi = world_.joint_v(joint_id(body, i));
    q.emplace_back(qi.begin(), qi.end());
    v.emplace_back(vi.begin(), vi.end());
  }
  world_.remove(body_label(body.id));
  const Transform<double> X_WB = X_WI * inverse(body.plan.base.X_LI);
  body.mechanism.reset();
  world_.add(model_of(body.plan, X_WB), Transform<double>::identity(), body_label(body.id));
  ++scene_;
  locate(body);
  for (int i = 0; i < body.plan.num_links(); ++i) {
    world_.set_joint(joint_id(body, i), q[static_cast<std::size_t>(i)], v[static_cast<std::size_t>(i)]);
    write_motor(body, i);
  }
  if (!body.plan.fixed) reset_base_velocity(body.id, V.v, V.w);
  for (int i = -1; i < body.plan.num_links(); ++i) write_surface(body, i);
  apply_filters(body.id);
  write_constraints();
}

// ---- numbers ------------------------------------------------------------------------------------------------------

Client::Body* Client::find(int id) {
  const auto found = bodies_.find(id);
  return found == bodies_.end() ? nullptr : found->second.get();
}
const Client::Body* Client::find(int id) const { return const_cast<Client*>(this)->find(id); }

Client::Body& Client::at(int id, const char* error) {
  Body* const body = find(id);
  if (body == nullptr) throw Error(error);
  return *body;
}
const Client::Body& Client::at(int id, const char* error) const { return const_cast<Client*>(this)->at(id, error); }

bool Client::has_body(int id) const { return find(id) != nullptr; }
const BodyPlan& Client::plan(int id, const char* error) const { return at(id, error).plan; }
int Client::num_joints(int id) const { return has_body(id) ? find(id)->plan.num_links() : 0; }
int Client::num_dofs(int id) const { return has_body(id) ? find(id)->num_dofs : 0; }

namespace {

/// "there is no joint 9; body 1 has 0 'shoulder', 1 'elbow'", on one line.
std::string none_of(const BodyPlan& plan, int id, int joint) {
  constexpr int kListed = 16;
  std::string text = "there is no joint " + std::to_string(joint) + "; body " + std::to_string(id) + " has ";
  if (plan.num_links() == 0) return text + "none";
  for (int i = 0; i < std::min(plan.num_links(), kListed); ++i) {
    text += (i > 0 ? ", " : "") + std::to_string(i) + " '" + plan.link(i).joint_name + "'";
  }
  return plan.num_links() > kListed ? text + " ... to " + std::to_string(plan.num_links() - 1) : text;
}

}  // namespace

void Client::require_joint(const Body* body, int joint, const char* error) const {
  if (body == nullptr) throw Error(std::string(error) + ": there is no such body");
  if (!body->has_joint(joint)) throw Error(std::string(error) + ": " + none_of(body->plan, body->id, joint));
}

void Client::require_joint(int id, int joint, const char* error) const { require_joint(find(id), joint, error); }

std::array<int, 2> Client::joint_indices(int id, int joint) const {
  const Body& body = at(id, "GetJointInfo failed.");
  int q = 7, v = 6;
  for (int i = 0; i < joint; ++i) {
    q += configuration_size(body.plan.link(i).joint);
    v += velocity_size(body.plan.link(i).joint);
  }
  return velocity_size(body.plan.link(joint).joint) > 0 ? std::array{q, v} : std::array{-1, -1};
}

void Client::locate(Body& body) {
  const Model& parts = world_.parts();
  body.edition = world_.edition();
  body.first_link = parts.link_id(body_label(body.id) + "/" + model_name(body.plan.base));
  if (body.plan.num_links() > 0) body.first_joint = parts.link(LinkId(body.first_link.value() + 1)).joint;
  own_links(body);
}

void Client::own_links(const Body& body) {
  owners_.resize(world_.parts().links().size(), {-1, -1});
  for (int i = -1; i < body.plan.num_links(); ++i)
    owners_[body.first_link.index() + static_cast<std::size_t>(i + 1)] = {body.id, i};
}

void Client::locate_all() {
  (void)world_.model();  // sweeps out what was removed
  if (edition_ == world_.edition()) return;
  edition_ = world_.edition();
  owners_.assign(world_.parts().links().size(), {-1, -1});
  for (const auto& [id, body] : bodies_) locate(*body);
}

LinkId Client::link_id(Body& body, int link) {
  (void)world_.parts();
  if (body.edition != world_.edition()) locate(body);
  return LinkId(body.first_link.value() + link + 1);
}

JointId Client::joint_id(Body& body, int joint) {
  (void)world_.parts();
  if (body.edition != world_.edition()) locate(body);
  return JointId(body.first_joint.value() + joint);
}

void Client::take_notes(const LoadReport& report) {
  for (const LoadNote& note : report.notes) {
    if (note.serious)
      notes_.push_back(note.file + ":" + std::to_string(note.line) + ": " + note.element + ": " + note.message);
  }
}

std::vector<std::string> Client::drain_notes() { return std::exchange(notes_, {}); }

}  // namespace manyhands::bullet
