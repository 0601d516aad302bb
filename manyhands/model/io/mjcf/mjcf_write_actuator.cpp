// <actuator>
#include <algorithm>
#include <cmath>

#include "manyhands/model/io/mjcf/mjcf_settings.h"
#include "manyhands/model/io/mjcf/mjcf_writer.h"

namespace manyhands::io {

namespace {

double bound(double x) { return std::clamp(x, -kMjcfUnlimited, kMjcfUnlimited); }

/// What only a <general> can say.
bool is_general(const Actuator& actuator) {
  return actuator.type == ActuatorType::kAffine || actuator.ctrl_scale != 1 || actuator.ctrl_offset != 0 ||
         actuator.has_activation() || (actuator.type == ActuatorType::kPosition && actuator.kp == 0) ||
         (actuator.type == ActuatorType::kVelocity && actuator.kd == 0);
}

/// gain and bias as <general> has them.
void write_law(pugi::xml_node node, const Actuator& actuator) {
  if (actuator.type == ActuatorType::kAffine) {
    const auto varies = [](const std::array<double, 3>& law) { return law[1] != 0 || law[2] != 0; };
    if (varies(actuator.gain)) set(node, "gaintype", "affine");
    set(node, "gainprm", actuator.gain);
    set(node, "biastype", "affine");
    set(node, "biasprm", actuator.bias);
    return;
  }
  const bool is_position = actuator.type == ActuatorType::kPosition;
  const double k = actuator.type == ActuatorType::kForce ? 1 : is_position ? actuator.kp : actuator.kd;
  const auto times_k = [&](double number) {
    return k == 0 ? 0 : number_for(k * number, number, [&](double x) { return x / k; }, 1 / k);
  };
  set(node, "gainprm", times_k(actuator.ctrl_scale));
  const double offset = times_k(actuator.ctrl_offset);
  if (actuator.type == ActuatorType::kForce && offset == 0) return;
  set(node, "biastype", "affine");
  set(node, "biasprm", std::array{offset, is_position ? -actuator.kp : 0.0, -actuator.kd});
}

void write_activation(pugi::xml_node node, const Activation& activation) {
  const bool integrates = activation.type == ActivationType::kIntegrator;
  set(node, "dyntype",
      integrates                                   ? "integrator"
      : activation.type == ActivationType::kFilter ? "filter"
                                                   : "filterexact");
  set(node, "dynprm", activation.time_constant);
  if (std::isfinite(activation.lower) || std::isfinite(activation.upper)) {
    set(node, "actlimited", "true");
    set(node, "actrange", std::array{bound(activation.lower), bound(activation.upper)});
  }
  if (activation.early) set(node, "actearly", "true");
}

/// Joint, tendon or sites, and gear.
void write_transmission(MjcfWriter& writer, pugi::xml_node node, const Actuator& actuator, const std::string& name) {
  if (actuator.tendon.is_valid()) {
    set(node, "tendon", writer.model.tendons()[actuator.tendon.index()].name);
  } else if (actuator.site) {
    const ActuatorSite& at = *actuator.site;
    set(node, "site", site_at(writer, at.link, at.X_LS, name + "_site"));
    if (at.reference.is_valid()) set(node, "refsite", site_at(writer, at.reference, at.X_LR, name + "_refsite"));
    set(node, "gear", std::array{at.force.x, at.force.y, at.force.z, at.torque.x, at.torque.y, at.torque.z});
    return;
  } else {
    set(node, "joint", writer.model.joint(actuator.joint).name);
  }
  set_unless(node, "gear", actuator.gear, 1);
}

void write_ranges(pugi::xml_node node, const Actuator& actuator) {
  if (std::isfinite(actuator.min_ctrl) || std::isfinite(actuator.max_ctrl))
    set(node, "ctrlrange", std::array{bound(actuator.min_ctrl), bound(actuator.max_ctrl)});
  if (!std::isfinite(actuator.max_force)) return;
  const double gear = actuator.gear;
  const auto bound_of = [&](double force) {
    return number_for(force / gear, force, [&](double x) { return gear * x; }, gear);
  };
  const double low = bound_of(gear > 0 ? actuator.least_force() : actuator.max_force);
  const double high = bound_of(gear > 0 ? actuator.max_force : actuator.least_force());
  set(node, "forcerange", std::array{low, high});
}

void write_actuator(MjcfWriter& writer, pugi::xml_node section, const Actuator& actuator) {
  const bool general = is_general(actuator);
  pugi::xml_node node = section.append_child(general                                    ? "general"
                                             : actuator.type == ActuatorType::kForce    ? "motor"
                                             : actuator.type == ActuatorType::kVelocity ? "velocity"
                                                                                        : "position");
  const std::string name = writer.names.claim("actuator", actuator.name, "actuator", writer.notes);
  set(node, "name", name);
  write_transmission(writer, node, actuator, name);
  if (general) {
    write_law(node, actuator);
    if (actuator.has_activation()) write_activation(node, actuator.activation);
  } else if (actuator.type != ActuatorType::kForce) {
    if (actuator.type == ActuatorType::kPosition) set(node, "kp", actuator.kp);
    set(node, "kv", actuator.kd);
  }
  write_ranges(node, actuator);
}

/// Whether all that it acts on is written.
bool is_written(const MjcfWriter& writer, const Actuator& actuator) {
  if (actuator.joint.is_valid()) return !writer.model.joint(actuator.joint).name.empty();
  const auto has_body = [&](LinkId id) { return !id.is_valid() || writer.carried_by[id.index()].is_valid(); };
  return !actuator.site || (has_body(actuator.site->link) && has_body(actuator.site->reference));
}

}  // namespace

void write_actuators(MjcfWriter& writer) {
  if (writer.model.actuators().empty()) return;
  pugi::xml_node section = writer.root.append_child("actuator");
  for (const Actuator& actuator : writer.model.actuators()) {
    if (is_written(writer, actuator)) write_actuator(writer, section, actuator);
  }
}

}  // namespace manyhands::io
