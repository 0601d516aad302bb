#include "manyhands/model/model_edit.h"

#include <algorithm>

#include "manyhands/base/index.h"

namespace manyhands {

namespace {

/// The first body whose tree stands on a link that is welded to the world, not on a joint; their number if none does.
int first_on_weld(const Model& model) {
  const std::span<const Body> bodies = model.bodies();
  const auto hangs_on_joint = [&](const Body& body) {
    return model.link(model.root_link(model.joint(body.joint).child)).joint.is_valid();
  };
  const auto found = std::partition_point(bodies.begin() + 1, bodies.end(), hangs_on_joint);
  return static_cast<int>(found - bodies.begin());
}

template <class Item>
void append(std::vector<Item>& into, std::span<const Item> items) {
  into.insert(into.end(), items.begin(), items.end());
}

int count_of(const auto& list) { return static_cast<int>(list.size()); }

}  // namespace

void ModelEdit::require_free_names(const Model& part) const {
  for (std::size_t i = 1; i < part.links_.size(); ++i) {
    const std::string& name = part.links_[i].name;
    if (model_.link_names_.contains(name)) throw ModelError("there is a link '" + name + "' already");
  }
  for (const Joint& joint : part.joints_) {
    if (model_.joint_names_.contains(joint.name)) throw ModelError("there is a joint '" + joint.name + "' already");
  }
  for (const auto& [name, index] : part.frame_names_) {
    if (model_.link_names_.contains(name) || model_.frame_names_.contains(name)) {
      throw ModelError("there is a frame '" + name + "' already");
    }
  }
}

Insertion ModelEdit::places_for(const Model& part) const {
  const int old_split = first_on_weld(model_), new_split = first_on_weld(part);
  const auto first_q = [](const Model& model, int body) {
    return body < model.num_bodies() ? model.bodies_[index(body)].iq : model.nq_;
  };
  const auto first_v = [](const Model& model, int body) {
    return body < model.num_bodies() ? model.bodies_[index(body)].iv : model.nv_;
  };
  return {.bodies = {old_split, model_.num_bodies(), new_split - 1, part.num_bodies() - 1},
          .q = {first_q(model_, old_split), model_.nq_, first_q(part, new_split), part.nq_},
          .v = {first_v(model_, old_split), model_.nv_, first_v(part, new_split), part.nv_},
          .equalities = {model_.described_equalities_, count_of(model_.equalities_), part.described_equalities_,
                         count_of(part.equalities_)},
          .links = count_of(model_.links_),
          .joints = count_of(model_.joints_),
          .geoms = count_of(model_.geoms_),
          .actuators = count_of(model_.actuators_),
          .activations = model_.na_,
          .meshes = count_of(model_.meshes_),
          .height_fields = count_of(model_.height_fields_),
          .lifts = count_of(model_.lifts_),
          .mocaps = count_of(model_.mocap_bodies_),
          .tendons = count_of(model_.tendons_)};
}

Insertion ModelEdit::insert(const Model& part) {
  require_free_names(part);
  const Insertion at = places_for(part);
  if (at.bodies.shifts()) shift_old(at);
  insert_links(part, at);
  insert_joints_and_bodies(part, at);
  insert_frames(part, at);
  insert_geoms(part, at);
  insert_couplings(part, at);
  insert_sensors(part, at);
  model_.keyframes_.clear();
  model_.nq_ += part.nq_;
  model_.nv_ += part.nv_;
  model_.na_ += part.na_;
  return at;
}

/// Bodies behind those that go between move up.
void ModelEdit::shift_old(const Insertion& at) {
  for (int b = at.bodies.old_first; b < model_.num_bodies(); ++b) {
    Body& body = model_.bodies_[index(b)];
    body.parent = BodyId(at.bodies.of_old(body.parent.value()));
    body.iq = at.q.of_old(body.iq);
    body.iv = at.v.of_old(body.iv);
    Joint& joint = model_.joints_[body.joint.index()];
    joint.iq = body.iq;
    joint.iv = body.iv;
    for (const LinkId id : model_.body_links_[index(b)]) {
      model_.links_[id.index()].body = BodyId(at.bodies.of_old(b));
      model_.frames_[id.index()].body = BodyId(at.bodies.of_old(b));
    }
  }
  for (std::size_t i = model_.links_.size(); i < model_.frames_.size(); ++i) {
    model_.frames_[i].body = BodyId(at.bodies.of_old(model_.frames_[i].body.value()));
  }
  for (Lift& lift : model_.lifts_) lift.body = BodyId(at.bodies.of_old(lift.body.value()));
  for (BodyId& body : model_.mocap_bodies_) body = BodyId(at.bodies.of_old(body.value()));
  for (int i = at.v.old_first; i < model_.nv_; ++i) {
    model_.dof_parent_[index(i)] = at.v.of_old(model_.dof_parent_[index(i)]);
    model_.dof_q_[index(i)] = at.q.of_old(model_.dof_q_[index(i)]);
  }
}

void ModelEdit::insert_links(const Model& part, const Insertion& at) {
  Body& world = model_.bodies_.front();
  for (std::size_t i = 1; i < part.links_.size(); ++i) {
    Link link = part.links_[i];
    if (link.body.value() == 0) world.inertia = world.inertia + transformed(link.X_BL, link.inertial.about_origin());
    link.parent = LinkId(at.new_link(link.parent.value()));
    if (link.joint.is_valid()) link.joint = JointId(at.joints + link.joint.value());
    link.body = BodyId(at.new_body(link.body.value()));
    model_.link_names_.emplace(link.name, at.new_link(static_cast<int>(i)));
    model_.links_.push_back(std::move(link));
  }
  const auto taken_in = [&](std::span<const LinkId> from, std::vector<LinkId>& into) {
    for (const LinkId id : from) {
      if (id.value() > 0) into.push_back(LinkId(at.new_link(id.value())));
    }
  };
  model_.link_children_.resize(model_.links_.size());
  for (std::size_t i = 0; i < part.links_.size(); ++i) {
    taken_in(part.link_children_[i], model_.link_children_[index(at.new_link(static_cast<int>(i)))]);
  }
  at.bodies.apply(model_.body_links_, std::vector<std::vector<LinkId>>(index(part.num_bodies() - 1)));
  for (int b = 0; b < part.num_bodies(); ++b) {
    taken_in(part.body_links_[index(b)], model_.body_links_[index(at.new_body(b))]);
  }
}

void ModelEdit::insert_joints_and_bodies(const Model& part, const Insertion& at) {
  for (Joint joint : part.joints_) {
    joint.parent = LinkId(at.new_link(joint.parent.value()));
    joint.child = LinkId(at.new_link(joint.child.value()));
    joint.iq = at.q.of_new(joint.iq);
    joint.iv = at.v.of_new(joint.iv);
    model_.joint_names_.emplace(joint.name, count_of(model_.joints_));
    model_.joints_.push_back(std::move(joint));
  }
  std::vector<Body> bodies(part.bodies_.begin() + 1, part.bodies_.end());
  for (Body& body : bodies) {
    body.parent = BodyId(at.new_body(body.parent.value()));
    body.joint = JointId(at.joints + body.joint.value());
    body.iq = at.q.of_new(body.iq);
    body.iv = at.v.of_new(body.iv);
  }
  at.bodies.apply(model_.bodies_, bodies);
  for (Lift lift : part.lifts_) {
    lift.body = BodyId(at.new_body(lift.body.value()));
    model_.lifts_.push_back(lift);
  }
  for (const BodyId body : part.mocap_bodies_) model_.mocap_bodies_.push_back(BodyId(at.new_body(body.value())));
}

void ModelEdit::insert_frames(const Model& part, const Insertion& at) {
  std::vector<Frame> frames(part.frames_.begin() + 1, part.frames_.end());
  for (Frame& frame : frames) {
    frame.body = BodyId(at.new_body(frame.body.value()));
    frame.link = LinkId(at.new_link(frame.link.value()));
  }
  const auto first_named = frames.begin() + static_cast<std::ptrdiff_t>(part.links_.size() - 1);
  const int new_links = count_of(part.links_) - 1;
  if (new_links > 0 && count_of(model_.frames_) > at.links) {
    for (auto& [name, i] : model_.frame_names_) i += new_links;
  }
  model_.frames_.insert(model_.frames_.begin() + at.links, frames.begin(), first_named);
  for (auto frame = first_named; frame != frames.end(); ++frame) {
    model_.frame_names_.emplace(frame->name, count_of(model_.frames_));
    model_.frames_.push_back(*frame);
  }
}

/// Behind all that they measure.
void ModelEdit::insert_sensors(const Model& part, const Insertion& at) {
  for (Sensor sensor : part.sensors_) {
    if (sensor.joint.is_valid()) sensor.joint = JointId(at.joints + sensor.joint.value());
    if (sensor.tendon.is_valid()) sensor.tendon = TendonId(at.tendons + sensor.tendon.value());
    if (sensor.actuator.is_valid()) sensor.actuator = ActuatorId(at.actuators + sensor.actuator.value());
    sensor.link = LinkId(at.new_link(sensor.link.value()));
    sensor.reference = LinkId(at.new_link(sensor.reference.value()));
    model_.sensors_.push_back(std::move(sensor));
  }
}

void ModelEdit::insert_geoms(const Model& part, const Insertion& at) {
  append<Mesh>(model_.meshes_, part.meshes_);
  append<HeightField>(model_.height_fields_, part.height_fields_);
  model_.link_geoms_.resize(model_.links_.size());
  for (Geom geom : part.geoms_) {
    const GeomId id(model_.geoms_.size());
    geom.link = LinkId(at.new_link(geom.link.value()));
    if (geom.shape.mesh.is_valid()) geom.shape.mesh = MeshId(at.meshes + geom.shape.mesh.value());
    if (geom.shape.height_field.is_valid()) {
      geom.shape.height_field = HeightFieldId(at.height_fields + geom.shape.height_field.value());
    }
    if (!geom.name.empty()) model_.geom_names_.emplace(geom.name, id.value());
    model_.link_geoms_[geom.link.index()].push_back(id);
    model_.geoms_.push_back(std::move(geom));
  }
  for (const ContactExclusion& e : part.exclusions_) {
    model_.exclusions_.push_back({LinkId(at.new_link(e.a.value())), LinkId(at.new_link(e.b.value()))});
  }
  for (ContactPair pair : part.contact_pairs_) {
    pair.a = GeomId(at.geoms + pair.a.value());
    pair.b = GeomId(at.geoms + pair.b.value());
    model_.contact_pairs_.push_back(pair);
  }
}

/// What acts at dofs and between parts.
void ModelEdit::insert_couplings(const Model& part, const Insertion& at) {
  std::vector<int> dof_parent = part.dof_parent_, dof_joint = part.dof_joint_, dof_q = part.dof_q_;
  for (int& i : dof_parent) i = at.v.of_new(i);
  for (int& i : dof_joint) i += at.joints;
  for (int& i : dof_q) i = at.q.of_new(i);
  at.v.apply(model_.dof_parent_, dof_parent);
  at.v.apply(model_.dof_joint_, dof_joint);
  at.v.apply(model_.dof_q_, dof_q);
  at.v.apply(model_.dof_limits_, part.dof_limits_);
  at.v.apply(model_.dof_damping_, part.dof_damping_);
  at.v.apply(model_.dof_armature_, part.dof_armature_);
  at.v.apply(model_.dof_friction_, part.dof_friction_);
  at.v.apply(model_.dof_stiffness_, part.dof_stiffness_);
  for (Actuator actuator : part.actuators_) {
    if (actuator.joint.is_valid()) actuator.joint = JointId(at.joints + actuator.joint.value());
    if (actuator.tendon.is_valid()) actuator.tendon = TendonId(at.tendons + actuator.tendon.value());
    if (actuator.site) {
      actuator.site->link = LinkId(at.new_link(actuator.site->link.value()));
      actuator.site->reference = LinkId(at.new_link(actuator.site->reference.value()));
    }
    if (actuator.iact >= 0) actuator.iact += at.activations;
    model_.actuators_.push_back(std::move(actuator));
  }
  for (Tendon tendon : part.tendons_) {
    for (TendonJoint& item : tendon.joints) item.joint = JointId(at.joints + item.joint.value());
    for (TendonBranch& branch : tendon.branches) {
      for (TendonPoint& point : branch.points) point.link = LinkId(at.new_link(point.link.value()));
    }
    model_.tendons_.push_back(std::move(tendon));
  }
  std::vector<EqualityConstraint> equalities = part.equalities_;
  for (EqualityConstraint& equality : equalities) {
    equality.link_a = LinkId(at.new_link(equality.link_a.value()));
    equality.link_b = LinkId(at.new_link(equality.link_b.value()));
    if (equality.joint_a.is_valid()) equality.joint_a = JointId(at.joints + equality.joint_a.value());
    if (equality.joint_b.is_valid()) equality.joint_b = JointId(at.joints + equality.joint_b.value());
    if (equality.tendon_a.is_valid()) equality.tendon_a = TendonId(at.tendons + equality.tendon_a.value());
    if (equality.tendon_b.is_valid()) equality.tendon_b = TendonId(at.tendons + equality.tendon_b.value());
  }
  at.equalities.apply(model_.equalities_, equalities);
  model_.described_equalities_ += part.described_equalities_;
}

void ModelEdit::forget(LinkId id) {
  model_.keyframes_.clear();
  Link& link = model_.links_[id.index()];
  const auto drop = [](Model::NameIndex& index, std::string& name) {
    index.erase(name);
    name.clear();
  };
  drop(model_.link_names_, link.name);
  model_.frames_[id.index()].name.clear();
  const bool carries = model_.body_links_[link.body.index()].front() == id;  // frames belong to a body's first link
  for (std::size_t i = model_.links_.size(); carries && i < model_.frames_.size(); ++i) {
    if (model_.frames_[i].body == link.body) drop(model_.frame_names_, model_.frames_[i].name);
  }
  if (link.joint.is_valid()) drop(model_.joint_names_, model_.joints_[link.joint.index()].name);
  for (Actuator& actuator : model_.actuators_) {
    const bool at_link = actuator.site && (actuator.site->link == id || actuator.site->reference == id);
    if (at_link || (link.joint.is_valid() && actuator.joint == link.joint)) actuator.name.clear();
  }
  for (Sensor& sensor : model_.sensors_) {
    const bool on_joint = link.joint.is_valid() && sensor.joint == link.joint;
    const bool of_none = sensor.actuator.is_valid() && model_.actuators_[sensor.actuator.index()].name.empty();
    if (on_joint || of_none || sensor.link == id || sensor.reference == id) sensor.name.clear();
  }
  for (const GeomId geom_id : model_.link_geoms_[id.index()]) {
    std::string& name = model_.geoms_[geom_id.index()].name;
    const auto found = model_.geom_names_.find(name);
    if (found != model_.geom_names_.end() && found->second == geom_id.value()) model_.geom_names_.erase(found);
    name.clear();
  }
}

void ModelEdit::add_equality(const EqualityConstraint& equality) {
  model_.equalities_.insert(model_.equalities_.begin() + model_.described_equalities_, equality);
  ++model_.described_equalities_;
}

void ModelEdit::remove_equality(std::size_t index) {
  model_.equalities_.erase(model_.equalities_.begin() + static_cast<std::ptrdiff_t>(index));
  if (static_cast<int>(index) < model_.described_equalities_) --model_.described_equalities_;
}

void ModelEdit::set_inertial(LinkId id, const Inertial& inertial) {
  model_.links_[id.index()].inertial = inertial;
  const BodyId body = model_.links_[id.index()].body;
  RigidInertia<double> sum = RigidInertia<double>::zero();
  for (const LinkId link : model_.body_links_[body.index()]) {
    const Link& part = model_.links_[link.index()];
    sum = sum + transformed(part.X_BL, part.inertial.about_origin());
  }
  model_.bodies_[body.index()].inertia = sum;
}

void ModelEdit::set_excluded(LinkId a, LinkId b, bool excluded) {
  const auto same = [&](const ContactExclusion& e) { return (e.a == a && e.b == b) || (e.a == b && e.b == a); };
  if (!excluded) {
    std::erase_if(model_.exclusions_, same);
  } else if (std::ranges::none_of(model_.exclusions_, same)) {
    model_.exclusions_.push_back({a, b});
  }
}

}  // namespace manyhands
