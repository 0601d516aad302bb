// <sensor>
#include "manyhands/model/io/mjcf/mjcf_writer.h"

namespace manyhands::io {

namespace {

/// A site of its own where the sensor feels touch, as wide as that.
std::string touch_site(MjcfWriter& writer, const Sensor& sensor, const std::string& name) {
  const std::string site = site_at(writer, sensor.link, sensor.X_LF, name + "_site");
  pugi::xml_node node = writer.root.find_node([&](const pugi::xml_node& candidate) {
    return std::string_view(candidate.name()) == "site" && site == candidate.attribute("name").value();
  });
  const Shape& volume = sensor.volume;
  const bool is_box = volume.type == ShapeType::kBox, is_sphere = volume.type == ShapeType::kSphere;
  node.remove_attribute("type");
  node.remove_attribute("size");
  set(node, "type",
      is_box                               ? "box"
      : is_sphere                          ? "sphere"
      : volume.type == ShapeType::kCapsule ? "capsule"
                                           : "cylinder");
  set(node, "size", volume.size);
  return site;
}

void write_frame(MjcfWriter& writer, pugi::xml_node node, const Sensor& sensor, const std::string& name) {
  set(node, "objtype", "site");
  set(node, "objname", site_at(writer, sensor.link, sensor.X_LF, name + "_site"));
  if (!sensor.reference.is_valid()) return;
  set(node, "reftype", "site");
  set(node, "refname", site_at(writer, sensor.reference, sensor.X_LR, name + "_refsite"));
}

void write_sensor(MjcfWriter& writer, pugi::xml_node section, const Sensor& sensor) {
  pugi::xml_node node = section.append_child(to_string(sensor.type));
  const std::string name = writer.names.claim("sensor", sensor.name, "sensor", writer.notes);
  set(node, "name", name);
  if (sensor.joint.is_valid()) set(node, "joint", writer.model.joint(sensor.joint).name);
  if (sensor.tendon.is_valid()) set(node, "tendon", writer.model.tendons()[sensor.tendon.index()].name);
  if (sensor.actuator.is_valid()) set(node, "actuator", writer.model.actuators()[sensor.actuator.index()].name);
  switch (sensor.type) {
    case SensorType::kSubtreeCenterOfMass:
    case SensorType::kSubtreeLinearVelocity:
    case SensorType::kSubtreeAngularMomentum:
      set(node, "body", writer.body(sensor.link));
      break;
    case SensorType::kTouch:
      set(node, "site", touch_site(writer, sensor, name));
      break;
    case SensorType::kVelocimeter:
    case SensorType::kGyro:
    case SensorType::kAccelerometer:
    case SensorType::kForce:
    case SensorType::kTorque:
    case SensorType::kRangefinder:
      set(node, "site", site_at(writer, sensor.link, sensor.X_LF, name + "_site"));
      break;
    default:
      if (sensor.link.is_valid()) write_frame(writer, node, sensor, name);
      break;
  }
  if (sensor.cutoff > 0) set(node, "cutoff", sensor.cutoff);
}

/// Whether all that it measures is written.
bool is_written(const MjcfWriter& writer, const Sensor& sensor) {
  const auto has_body = [&](LinkId id) { return !id.is_valid() || writer.carried_by[id.index()].is_valid(); };
  return !sensor.name.empty() && has_body(sensor.link) && has_body(sensor.reference);
}

}  // namespace

void write_sensors(MjcfWriter& writer) {
  if (writer.model.sensors().empty()) return;
  pugi::xml_node section = writer.root.append_child("sensor");
  for (const Sensor& sensor : writer.model.sensors()) {
    if (is_written(writer, sensor)) write_sensor(writer, section, sensor);
  }
}

}  // namespace manyhands::io
