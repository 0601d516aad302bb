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

void ModelBuilder::require_transmission(const std::string& what, const Actuator& actuator) const {
  const int count =
      (actuator.joint.is_valid() ? 1 : 0) + (actuator.tendon.is_valid() ? 1 : 0) + (actuator.site ? 1 : 0);
  if (count > 1) throw ModelError(what + " drives several of a joint, a tendon and a site; expected one");
  if (actuator.tendon.is_valid()) return require_tendon(what, actuator.tendon);
  if (!actuator.site) return require_single_dof(what, actuator.joint);
  const ActuatorSite& site = *actuator.site;
  require_link(what, site.link);
  if (site.reference.is_valid()) require_link(what, site.reference);
  if (!finite(site.force) || !finite(site.torque))
    throw ModelError(what + ": force and torque of its site must be finite");
}

ActuatorId ModelBuilder::add_actuator(Actuator actuator) {
  const std::string what = "actuator '" + actuator.name + "'";
  require_transmission(what, actuator);
  if (!finite(actuator.ctrl_scale) || !finite(actuator.ctrl_offset))
    throw ModelError(what + ": ctrl_scale and ctrl_offset must be finite");
  const auto is_number = [](double x) { return finite(x); };
  if (!std::ranges::all_of(actuator.gain, is_number) || !std::ranges::all_of(actuator.bias, is_number))
    throw ModelError(what + ": gain and bias must be finite");
  if (!(actuator.kp >= 0) || !(actuator.kd >= 0) || !(actuator.max_force >= 0)) {
    throw ModelError(what + ": kp, kd and max_force must be 0 or more");
  }
  const bool is_bounded = finite(actuator.max_force) && finite(actuator.least_force());
  if (actuator.min_force && !(is_bounded && *actuator.min_force <= actuator.max_force))
    throw ModelError(what + ": min_force and max_force must be finite and in order");
  const Activation& activation = actuator.activation;
  if (!(activation.time_constant >= 0) || !finite(activation.time_constant) || !(activation.lower <= activation.upper))
    throw ModelError(what + ": its activation needs a time constant of 0 or more, and its bounds in order");
  if (!finite(actuator.gear) || actuator.gear == 0) throw ModelError(what + ": gear must be finite and not 0");
  if (!(actuator.min_ctrl <= actuator.max_ctrl)) throw ModelError(what + ": min_ctrl is above max_ctrl");
  actuators_.push_back(std::move(actuator));
  return ActuatorId(actuators_.size() - 1);
}

void ModelBuilder::add_sensor(Sensor sensor) {
  const std::string what = "sensor '" + sensor.name + "'";
  if (sensor.name.empty()) throw ModelError("a sensor needs a name");
  switch (sensor.type) {
    case SensorType::kJointPosition:
    case SensorType::kJointVelocity:
      require_single_dof(what, sensor.joint);
      break;
    case SensorType::kBallQuaternion:
    case SensorType::kBallAngularVelocity:
      if (!sensor.joint.is_valid() || sensor.joint.index() >= joints_.size() ||
          joints_[sensor.joint.index()].type != JointType::kSpherical)
        throw ModelError(what + " needs a spherical joint added before");
      break;
    case SensorType::kTendonPosition:
    case SensorType::kTendonVelocity:
      require_tendon(what, sensor.tendon);
      break;
    case SensorType::kActuatorPosition:
    case SensorType::kActuatorVelocity:
    case SensorType::kActuatorForce:
      if (!sensor.actuator.is_valid() || sensor.actuator.index() >= actuators_.size())
        throw ModelError(what + " needs an actuator added before");
      break;
    case SensorType::kClock:
      break;
    default:
      require_link(what, sensor.link);
      if (sensor.reference.is_valid()) require_link(what, sensor.reference);
  }
  if (!(sensor.cutoff >= 0)) throw ModelError(what + ": its cutoff must be 0 or more");
  sensors_.push_back(std::move(sensor));
}

void ModelBuilder::compile_activations(Model& model) {
  for (Actuator& actuator : model.actuators_) actuator.iact = actuator.has_activation() ? model.na_++ : -1;
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
  if (pair.surface) {
    const std::string &a = geoms_[pair.a.index()].name, &b = geoms_[pair.b.index()].name;
    check_surface("the contact pair of '" + a + "' and '" + b + "'", *pair.surface);
  }
  contact_pairs_.push_back(pair);
}

}  // namespace manyhands
