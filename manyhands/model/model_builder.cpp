#include "manyhands/model/model_builder.h"

#include <algorithm>

#include "manyhands/model/part_checks.h"
#include "manyhands/model/unit.h"

namespace manyhands {

namespace {

/// The smallest rotation that takes z to the unit vector `axis`; the identity, exactly, if they are equal.
Mat3<double> rotation_from_z_to(const Vec3<double>& axis) {
  if (axis.z < -0.999999) {
    // Half a turn about x, then what remains.
    const Mat3<double> flip{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
    return flip * rotation_from_z_to({axis.x, -axis.y, -axis.z});
  }
  // 1 / (1 + z), without the cancellation where z is near -1.
  const double k = axis.z > 0 ? 1.0 / (1.0 + axis.z) : (1.0 - axis.z) / (axis.x * axis.x + axis.y * axis.y);
  const double xy = -k * axis.x * axis.y;
  return {{1.0 - k * axis.x * axis.x, xy, -axis.x}, {xy, 1.0 - k * axis.y * axis.y, -axis.y}, axis};
}

/// Throws unless the coordinates are none, or those of a joint of this type.
void require_coordinates(const std::string& what, JointType type, const std::vector<double>& q) {
  if (q.empty() || std::ssize(q) == configuration_size(type)) return;
  throw ModelError(what + " has " + std::to_string(q.size()) + " numbers; expected " +
                   std::to_string(configuration_size(type)));
}

}  // namespace

ModelBuilder::ModelBuilder(std::string name) : name_(std::move(name)) {
  links_.push_back({.name = "world"});
  link_names_.emplace("world", 0);
}

LinkId ModelBuilder::add_link(std::string name, const Inertial& inertial) {
  if (name.empty()) throw ModelError("a link needs a name");
  check_inertial(name, inertial);
  const LinkId id(links_.size());
  if (!link_names_.emplace(name, id.value()).second) throw ModelError("there is a link '" + name + "' already");
  links_.push_back({.name = std::move(name), .inertial = inertial});
  return id;
}

JointId ModelBuilder::add_joint(Joint joint) {
  const std::string what = "joint '" + joint.name + "'";
  if (joint.name.empty()) throw ModelError("a joint needs a name");
  for (const LinkId id : {joint.parent, joint.child}) {
    if (!id.is_valid() || id.index() >= links_.size())
      throw ModelError(what + ": parent and child must be added first");
  }
  Link& child = links_[joint.child.index()];
  if (joint.child == world()) throw ModelError(what + ": the world cannot be a child");
  if (joint.child == joint.parent) throw ModelError(what + ": parent and child are both '" + child.name + "'");
  if (child.joint.is_valid()) {
    const std::string& other = joints_[child.joint.index()].name;
    throw ModelError(what + ": link '" + child.name + "' has a parent already, by joint '" + other + "'");
  }
  const double length = norm(joint.axis);
  if (!finite(joint.axis) || length < 1e-9) throw ModelError(what + ": the axis must be a finite vector other than 0");
  joint.axis = at_unit_length(joint.axis);
  check_compliance(what, joint.limits.compliance);
  if (!(joint.limits.lower <= joint.limits.upper)) {
    throw ModelError(what + ": lower limit " + std::to_string(joint.limits.lower) + " is above the upper limit " +
                     std::to_string(joint.limits.upper));
  }
  if (!(joint.damping >= 0) || !(joint.friction >= 0) || !(joint.armature >= 0)) {
    throw ModelError(what + ": damping, friction and armature must be 0 or more");
  }
  if (!finite(joint.stiffness) || joint.stiffness < 0) {
    throw ModelError(what + ": its stiffness is " + std::to_string(joint.stiffness) +
                     "; expected a finite number of 0 or more");
  }
  if (joint.type == JointType::kMocap && joint.parent != world()) {
    throw ModelError(what + ": a mocap joint carries a link in the world; its parent is '" +
                     links_[joint.parent.index()].name + "'");
  }
  require_coordinates(what + ": its initial configuration", joint.type, joint.initial);
  require_coordinates(what + ": its spring reference", joint.type, joint.spring_reference);
  const JointId id(joints_.size());
  if (!joint_names_.emplace(joint.name, id.value()).second) throw ModelError("there is a " + what + " already");
  child.parent = joint.parent;
  child.joint = id;
  joints_.push_back(std::move(joint));
  return id;
}

void ModelBuilder::set_initial(JointId joint, std::vector<double> q) {
  Joint& moved = joints_[joint.index()];
  require_coordinates("joint '" + moved.name + "': its initial configuration", moved.type, q);
  moved.initial = std::move(q);
}

GeomId ModelBuilder::add_geom(Geom geom) {
  require_link("a geom", geom.link);
  check_geom(geom);
  const bool needs_mesh = geom.shape.type == ShapeType::kMesh || geom.shape.type == ShapeType::kConvex;
  if (needs_mesh && (!geom.shape.mesh.is_valid() || geom.shape.mesh.index() >= meshes_.size())) {
    throw ModelError("geom '" + geom.name + "' needs a mesh added before");
  }
  const HeightFieldId field = geom.shape.height_field;
  if (geom.shape.type == ShapeType::kHeightField && (!field.is_valid() || field.index() >= height_fields_.size())) {
    throw ModelError("geom '" + geom.name + "' needs a height field added before");
  }
  geoms_.push_back(std::move(geom));
  return GeomId(geoms_.size() - 1);
}

MeshId ModelBuilder::add_mesh(Mesh mesh) {
  check_mesh(mesh);
  meshes_.push_back(std::move(mesh));
  return MeshId(meshes_.size() - 1);
}

HeightFieldId ModelBuilder::add_height_field(HeightField field) {
  check_height_field(field);
  height_fields_.push_back(std::move(field));
  return HeightFieldId(height_fields_.size() - 1);
}

void ModelBuilder::add_frame(std::string name, LinkId link, const Transform<double>& X_LF) {
  require_link("frame '" + name + "'", link);
  if (link_names_.contains(name) || !frame_names_.emplace(name, static_cast<int>(frames_.size())).second) {
    throw ModelError("there is a frame '" + name + "' already");
  }
  frames_.push_back({std::move(name), link, X_LF});
}

std::pair<LinkId, Transform<double>> ModelBuilder::frame(std::string_view name) const {
  if (const auto link = link_names_.find(name); link != link_names_.end())
    return {LinkId(link->second), Transform<double>::identity()};
  const auto found = frame_names_.find(name);
  if (found == frame_names_.end()) {
    std::string message = "there is no link or frame '" + std::string(name) + "'; there are:";
    for (const Link& link : links_) message += " '" + link.name + "'";
    for (const NamedFrame& frame : frames_) message += " '" + frame.name + "'";
    throw ModelError(message);
  }
  const NamedFrame& frame = frames_[static_cast<std::size_t>(found->second)];
  return {frame.link, frame.X_LF};
}

void ModelBuilder::set_medium(const Medium& medium) {
  const Vec3<double>& wind = medium.wind;
  for (const double x : {medium.density, medium.viscosity})
    if (!(x >= 0 && is_finite(x))) throw ModelError("the density and viscosity of a medium must be 0 or more");
  for (const double x : {wind.x, wind.y, wind.z})
    if (!is_finite(x)) throw ModelError("the wind must be finite");
  medium_ = medium;
}

std::vector<LinkId> ModelBuilder::depth_first() const {
  std::vector<std::vector<LinkId>> children(links_.size());
  for (const Joint& joint : joints_) children[joint.parent.index()].push_back(joint.child);
  for (std::size_t i = 1; i < links_.size(); ++i) {
    if (!links_[i].joint.is_valid()) children[0].push_back(LinkId(i));
  }
  std::vector<LinkId> order, stack{world()};
  while (!stack.empty()) {
    const LinkId link = stack.back();
    stack.pop_back();
    order.push_back(link);
    stack.insert(stack.end(), children[link.index()].rbegin(), children[link.index()].rend());
  }
  if (order.size() != links_.size()) {
    std::vector<bool> reached(links_.size(), false);
    for (const LinkId link : order) reached[link.index()] = true;
    const auto lost = static_cast<std::size_t>(std::ranges::find(reached, false) - reached.begin());
    throw ModelError("link '" + links_[lost].name + "' is its own ancestor: the joints form a cycle");
  }
  return order;
}

Model ModelBuilder::compile() const {
  Model model;
  model.name_ = name_;
  model.gravity_ = gravity_;
  model.medium_ = medium_;
  model.time_step_ = time_step_;
  model.links_ = links_;
  model.joints_ = joints_;
  model.geoms_ = geoms_;
  model.meshes_ = meshes_;
  model.height_fields_ = height_fields_;
  model.equalities_ = equalities_;
  model.described_equalities_ = static_cast<int>(equalities_.size());
  model.tendons_ = tendons_;
  model.actuators_ = actuators_;
  model.sensors_ = sensors_;
  model.exclusions_ = exclusions_;
  model.contact_pairs_ = contact_pairs_;
  model.contact_rules_ = contact_rules_;
  model.bodies_.push_back({});
  for (const LinkId id : depth_first()) {
    if (id == world()) {
      model.links_[id.index()].body = BodyId(0);
    } else {
      compile_link(model, id);
    }
  }
  for (std::size_t i = 0; i < model.links_.size(); ++i) {
    const Link& link = model.links_[i];
    model.frames_.push_back({.name = link.name, .body = link.body, .X_BF = link.X_BL, .link = LinkId(i)});
  }
  for (const NamedFrame& frame : frames_) {
    const Link& link = model.link(frame.link);
    model.frames_.push_back({frame.name, link.body, link.X_BL * frame.X_LF, frame.link, frame.X_LF});
  }
  compile_dofs(model);
  compile_activations(model);
  model.link_names_ = link_names_;
  model.joint_names_ = joint_names_;
  model.index_parts();
  return model;
}

/// Puts a link on its body, which is its parent's, the world, or a new one that its joint moves.
void ModelBuilder::compile_link(Model& model, LinkId id) {
  Link& link = model.links_[id.index()];
  if (!link.joint.is_valid()) {
    link.body = BodyId(0);
    link.parent = LinkId(0);
  } else {
    Joint& joint = model.joints_[link.joint.index()];
    const Link& parent = model.links_[joint.parent.index()];
    const Transform<double> X_BF = parent.X_BL * joint.X_PF;
    if (joint.type == JointType::kFixed) {
      link.body = parent.body;
      link.X_BL = X_BF;
    } else {
      const bool has_axis =
          joint.type != JointType::kSpherical && joint.type != JointType::kFloating && joint.type != JointType::kMocap;
      const Mat3<double> R_FZ = has_axis ? rotation_from_z_to(joint.axis) : Mat3<double>::identity();
      Body body{.parent = parent.body, .joint = link.joint, .type = joint.type, .X_PF = {X_BF.R * R_FZ, X_BF.p}};
      body.iq = joint.iq = model.nq_;
      body.iv = joint.iv = model.nv_;
      model.nq_ += body.nq = configuration_size(joint.type);
      model.nv_ += body.nv = velocity_size(joint.type);
      link.body = BodyId(model.bodies_.size());
      if (joint.type == JointType::kMocap) model.mocap_bodies_.push_back(link.body);
      link.X_BL = {transpose(R_FZ), Vec3<double>::zero()};
      model.bodies_.push_back(body);
    }
  }
  Body& body = model.bodies_[link.body.index()];
  body.inertia = body.inertia + transformed(link.X_BL, link.inertial.about_origin());
  compile_lift(model, link);
}

void ModelBuilder::compile_lift(Model& model, const Link& link) {
  const double mass = link.gravity_compensation * link.inertial.mass;
  if (mass == 0) return;
  auto lift = std::ranges::find(model.lifts_, link.body, &Lift::body);
  if (lift == model.lifts_.end()) lift = model.lifts_.insert(lift, {.body = link.body});
  lift->mass += mass;
  lift->moment = lift->moment + mass * (link.X_BL * link.inertial.com);
}

void ModelBuilder::compile_dofs(Model& model) {
  std::vector<int> last_dof(model.bodies_.size(), -1);
  for (std::size_t b = 1; b < model.bodies_.size(); ++b) {
    const Body& body = model.bodies_[b];
    const Joint& joint = model.joint(body.joint);
    int previous = last_dof[body.parent.index()];
    for (int k = 0; k < body.nv; ++k) {
      model.dof_parent_.push_back(previous);
      model.dof_joint_.push_back(body.joint.value());
      model.dof_q_.push_back(body.nq == body.nv ? body.iq + k : -1);
      model.dof_limits_.push_back(body.nv == 1 ? joint.limits : JointLimits{});
      if (joint.type == JointType::kContinuous) {  // whatever range a file tells
        model.dof_limits_.back().lower = JointLimits{}.lower;
        model.dof_limits_.back().upper = JointLimits{}.upper;
      }
      model.dof_damping_.push_back(joint.damping);
      model.dof_armature_.push_back(joint.armature);
      model.dof_friction_.push_back(joint.friction);
      model.dof_stiffness_.push_back(joint.stiffness);
      previous = body.iv + k;
    }
    last_dof[b] = previous;
  }
}

namespace {

/// The least inertia that any motion of the joint meets, given its subtree's inertia I about the body's origin.
double least_inertia(JointType type, const RigidInertia<double>& I) {
  const double rotation = std::min({I.I.xx, I.I.yy, I.I.zz});
  switch (type) {
    case JointType::kRevolute:
    case JointType::kContinuous:
      return I.I.zz;
    case JointType::kPrismatic:
      return I.m;
    case JointType::kSpherical:
      return rotation;
    case JointType::kPlanar:
      return std::min(I.m, I.I.zz);
    default:
      return std::min(I.m, rotation);
  }
}

std::vector<JointId> joints_that_move_nothing(const Model& model) {
  // Composite inertias at the neutral configuration, each about its own body's origin.
  std::vector<RigidInertia<double>> composite(model.bodies().size(), RigidInertia<double>::zero());
  std::vector<JointId> found;
  for (std::size_t b = model.bodies().size() - 1; b > 0; --b) {
    const Body& body = model.bodies()[b];
    composite[b] = composite[b] + body.inertia;
    composite[body.parent.index()] = composite[body.parent.index()] + transformed(body.X_PF, composite[b]);
    const double inertia = least_inertia(body.type, composite[b]) + model.joint(body.joint).armature;
    if (body.nv > 0 && inertia < 1e-12) found.push_back(body.joint);
  }
  std::ranges::reverse(found);
  return found;
}

}  // namespace

std::vector<JointId> ModelBuilder::joints_without_inertia() const { return joints_that_move_nothing(compile()); }

/// A mimic joint is an equality constraint between its driver and itself, where both have one degree of freedom.
void ModelBuilder::add_mimic_equalities(Model& model) const {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const Joint& joint = joints_[i];
    if (!joint.mimic) continue;
    const JointId driver(joint_names_.find(joint.mimic->joint)->second);
    if (velocity_size(joint.type) != 1 || velocity_size(joints_[driver.index()].type) != 1) continue;
    model.equalities_.push_back({.name = joint.name + "_mimic",
                                 .type = EqualityType::kJoint,
                                 .joint_a = driver,
                                 .joint_b = JointId(i),
                                 .ratio = joint.mimic->multiplier,
                                 .offset = joint.mimic->offset});
  }
}

void ModelBuilder::add_keyframes(Model& model) const {
  for (Keyframe key : keyframes_) {
    if (key.q.empty()) key.q = model.initial_configuration();
    if (key.v.empty()) key.v.resize(static_cast<std::size_t>(model.nv()), 0.0);
    if (key.ctrl.empty()) key.ctrl.resize(static_cast<std::size_t>(model.nu()), 0.0);
    if (key.act.empty()) key.act.resize(static_cast<std::size_t>(model.na()), 0.0);
    if (key.mocap.empty()) key.mocap = model.initial_mocap();
    if (std::ssize(key.q) != model.nq() || std::ssize(key.v) != model.nv() || std::ssize(key.ctrl) != model.nu() ||
        std::ssize(key.act) != model.na()) {
      throw ModelError("keyframe '" + key.name + "' does not have nq, nv, nu and na numbers");
    }
    if (key.mocap.size() != 7 * model.mocap_bodies().size()) {
      throw ModelError("keyframe '" + key.name + "' does not have 7 numbers for each mocap body");
    }
    model.keyframes_.push_back(std::move(key));
  }
}

Model ModelBuilder::build() const {
  for (const Joint& joint : joints_) {
    if (joint.mimic && !joint_names_.contains(joint.mimic->joint)) {
      throw ModelError("joint '" + joint.name + "' mimics '" + joint.mimic->joint + "', which does not exist");
    }
  }
  Model model = compile();
  add_mimic_equalities(model);
  add_keyframes(model);
  const std::vector<JointId> massless = joints_that_move_nothing(model);
  if (!massless.empty()) {
    throw ModelError("joint '" + joints_[massless.front().index()].name +
                     "' moves no inertia: give a link beyond it mass and inertia, or the joint an armature");
  }
  return model;
}

}  // namespace manyhands
