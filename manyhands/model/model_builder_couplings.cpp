// ModelBuilder: what acts between parts beyond joints.
#include <algorithm>

#include "manyhands/model/model_builder.h"
#include "manyhands/model/part_checks.h"

namespace manyhands {

void ModelBuilder::require_link(const std::string& what, LinkId link) const {
  if (!link.is_valid() || link.index() >= links_.size()) throw ModelError(what + " needs a link added before");
}

void ModelBuilder::require_single_dof(const std::string& what, JointId joint) const {
  if (!joint.is_valid() || joint.index() >= joints_.size()) throw ModelError(what + " needs a joint added before");
  if (velocity_size(joints_[joint.index()].type) != 1) {
    throw ModelError(what + ": joint '" + joints_[joint.index()].name + "' is " +
                     to_string(joints_[joint.index()].type) + "; expected one with one degree of freedom");
  }
}

void ModelBuilder::require_tendon(const std::string& what, TendonId tendon) const {
  if (!tendon.is_valid() || tendon.index() >= tendons_.size()) throw ModelError(what + " needs a tendon added before");
}

TendonId ModelBuilder::add_tendon(Tendon tendon) {
  const std::string what = "tendon '" + tendon.name + "'";
  if (tendon.name.empty()) throw ModelError("a tendon needs a name");
  if (std::ranges::find(tendons_, tendon.name, &Tendon::name) != tendons_.end())
    throw ModelError("there is a " + what + " already");
  check_tendon(tendon);
  for (const TendonJoint& part : tendon.joints) require_single_dof(what, part.joint);
  for (const TendonBranch& branch : tendon.branches) {
    for (const TendonPoint& point : branch.points) require_link(what, point.link);
  }
  tendons_.push_back(std::move(tendon));
  return TendonId(tendons_.size() - 1);
}

EqualityId ModelBuilder::add_equality(EqualityConstraint equality) {
  const std::string what = "equality '" + equality.name + "'";
  if (equality.type == EqualityType::kJoint || equality.type == EqualityType::kGear) {
    require_single_dof(what, equality.joint_a);
    require_single_dof(what, equality.joint_b);
    if (equality.joint_a == equality.joint_b) throw ModelError(what + " couples a joint with itself");
    if (!finite(equality.ratio) || !finite(equality.offset))
      throw ModelError(what + ": ratio and offset must be finite");
  } else if (equality.type == EqualityType::kTendon) {
    require_tendon(what, equality.tendon_b);
    if (equality.tendon_a.is_valid()) require_tendon(what, equality.tendon_a);
    if (equality.tendon_a == equality.tendon_b) throw ModelError(what + " couples a tendon with itself");
    bool sound = finite(equality.reference_a) && finite(equality.reference_b);
    for (const double coefficient : equality.polynomial) sound = sound && finite(coefficient);
    if (!sound) throw ModelError(what + ": its polynomial and references must be finite");
  } else {
    require_link(what, equality.link_a);
    require_link(what, equality.link_b);
    if (equality.link_a == equality.link_b) throw ModelError(what + " joins a link to itself");
  }
  if (!(equality.max_force >= 0)) throw ModelError(what + ": max_force must be 0 or more");
  check_compliance(what, equality.compliance);
  if (equality.compliance && finite(equality.max_force))
    throw ModelError(what + ": what gives way by a compliance has no max_force; expected one of the two");
  if (!finite(equality.torque_scale) || !(equality.torque_scale > 0))
    throw ModelError(what + ": torque_scale must be finite and above 0");
  equalities_.push_back(std::move(equality));
  return EqualityId(equalities_.size() - 1);
}

ActuatorId ModelBuilder::add_actuator(Actuator actuator) {
  const std::string what = "actuator '" + actuator.name + "'";
  if (actuator.joint.is_valid() && actuator.tendon.is_valid())
    throw ModelError(what + " drives a joint and a tendon; expected one");
  if (actuator.tendon.is_valid()) {
    require_tendon(what, actuator.tendon);
  } else {
    require_single_dof(what, actuator.joint);
  }
  if (!finite(actuator.ctrl_scale) || !finite(actuator.ctrl_offset))
    throw ModelError(what + ": ctrl_scale and ctrl_offset must be finite");
  if (!(actuator.kp >= 0) || !(actuator.kd >= 0) || !(actuator.max_force >= 0)) {
    throw ModelError(what + ": kp, kd and max_force must be 0 or more");
  }
  if (!finite(actuator.gear) || actuator.gear == 0) throw ModelError(what + ": gear must be finite and not 0");
  if (!(actuator.min_ctrl <= actuator.max_ctrl)) throw ModelError(what + ": min_ctrl is above max_ctrl");
  actuators_.push_back(std::move(actuator));
  return ActuatorId(actuators_.size() - 1);
}

void ModelBuilder::exclude_contact(LinkId a, LinkId b) {
  require_link("a contact exclusion", a);
  require_link("a contact exclusion", b);
  exclusions_.push_back({a, b});
}

void ModelBuilder::add_contact_pair(const ContactPair& pair) {
  for (const GeomId id : {pair.a, pair.b}) {
    if (!id.is_valid() || id.index() >= geoms_.size()) throw ModelError("a contact pair needs two geoms added before");
  }
  contact_pairs_.push_back(pair);
}

}  // namespace manyhands
