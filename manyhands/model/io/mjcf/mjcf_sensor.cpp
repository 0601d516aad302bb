// <sensor>: what the scene measures.
#include <algorithm>

#include "manyhands/model/io/mjcf/mjcf_scene.h"

namespace manyhands::io {

namespace {

/// What a sensor is on.
enum class On { kJoint, kTendon, kActuator, kSite, kBody, kFrame, kNothing };

On subject_of(SensorType type) {
  switch (type) {
    case SensorType::kJointPosition:
    case SensorType::kJointVelocity:
    case SensorType::kBallQuaternion:
    case SensorType::kBallAngularVelocity:
      return On::kJoint;
    case SensorType::kTendonPosition:
    case SensorType::kTendonVelocity:
      return On::kTendon;
    case SensorType::kActuatorPosition:
    case SensorType::kActuatorVelocity:
    case SensorType::kActuatorForce:
      return On::kActuator;
    case SensorType::kSubtreeCenterOfMass:
    case SensorType::kSubtreeLinearVelocity:
    case SensorType::kSubtreeAngularMomentum:
      return On::kBody;
    case SensorType::kVelocimeter:
    case SensorType::kGyro:
    case SensorType::kAccelerometer:
    case SensorType::kForce:
    case SensorType::kTorque:
    case SensorType::kTouch:
    case SensorType::kRangefinder:
      return On::kSite;
    case SensorType::kClock:
      return On::kNothing;
    default:
      return On::kFrame;
  }
}

/// The type of that name; none if it is not read.
std::optional<SensorType> type_of(std::string_view tag) {
  for (int i = 0; i < kSensorTypes; ++i) {
    if (tag == to_string(static_cast<SensorType>(i))) return static_cast<SensorType>(i);
  }
  return {};
}

/// Whether the type reads the axes of its frame, not its origin alone.
bool reads_axes(SensorType type) {
  return type == SensorType::kFrameQuaternion || type == SensorType::kFrameXAxis || type == SensorType::kFrameYAxis ||
         type == SensorType::kFrameZAxis;
}

/// Leaves the sensor out, with a note.
bool leave_out(const MjcfElement& e, const std::string& why) {
  e.note(LoadAction::kIgnored, why + "; it is left out");
  return false;
}

/// The frame that a pair of attributes names. The axes of a body's inertia and of a mesh are MuJoCo's own.
bool read_frame(const MjcfScene& scene, const MjcfElement& e, const char* type_attribute, const char* name_attribute,
                bool needs_axes, LinkId& link, Transform<double>& X_LF) {
  const std::string type = e.text(type_attribute);
  if (type == "site") {
    const MjcfSite& site = scene.site(e, name_attribute);
    link = site.link;
    X_LF = site.X_LS;
    return true;
  }
  if (type == "body" || type == "xbody") {
    link = scene.body(e, name_attribute).link;
    if (type == "xbody") return true;
    X_LF.p = scene.builder.links()[link.index()].inertial.com;
    return !needs_axes || leave_out(e, "the axes of a body's inertia are not read");
  }
  if (type != "geom") return leave_out(e, "frames of kind " + in_quotes(type) + " are not read");
  const MjcfGeom& geom = scene.geoms[scene.geom(e, name_attribute)];
  if (!geom.id) return leave_out(e, "its geom was left out");
  const Geom& found = scene.builder.geoms()[geom.id->index()];
  link = found.link;
  X_LF = found.X_LG;
  return !found.shape.mesh.is_valid() || leave_out(e, "the frame of a mesh is not read");
}

/// What the sensor is on; false, with a note, if that is not there.
bool read_object(const MjcfScene& scene, const MjcfElement& e, Sensor& sensor) {
  switch (subject_of(sensor.type)) {
    case On::kJoint:
      sensor.joint = scene.joint(e, "joint").id;
      return true;
    case On::kTendon: {
      const MjcfTendon& tendon = scene.tendon(e, "tendon");
      if (!tendon.id) return leave_out(e, "its tendon was left out");
      sensor.tendon = *tendon.id;
      return true;
    }
    case On::kActuator: {
      const auto& actuators = scene.builder.actuators();
      const auto found = std::ranges::find(actuators, e.text("actuator"), &Actuator::name);
      if (found == actuators.end()) return leave_out(e, "its actuator is not there");
      sensor.actuator = ActuatorId(static_cast<std::size_t>(found - actuators.begin()));
      return true;
    }
    case On::kSite: {
      if (!e.has("site")) return leave_out(e, "it is on no site");
      const MjcfSite& site = scene.site(e, "site");
      sensor.link = site.link;
      sensor.X_LF = site.X_LS;
      sensor.volume = site.shape;
      const bool is_ellipsoid = site.shape.type == ShapeType::kConvex;
      return !is_ellipsoid || sensor.type != SensorType::kTouch || leave_out(e, "touch of an ellipsoid is not read");
    }
    case On::kBody:
      sensor.link = scene.body(e, "body").link;
      return true;
    case On::kFrame:
      if (!read_frame(scene, e, "objtype", "objname", reads_axes(sensor.type), sensor.link, sensor.X_LF)) return false;
      return !e.has("refname") || read_frame(scene, e, "reftype", "refname", true, sensor.reference, sensor.X_LR);
    case On::kNothing:
      return true;
  }
  return false;
}

void read_sensor(MjcfScene& scene, const MjcfElement& e, const std::string& name) {
  const std::optional<SensorType> type = type_of(e.tag());
  if (!type) {
    e.note_once("sensor <" + std::string(e.tag()) + ">", LoadAction::kIgnored,
                "sensors of kind <" + std::string(e.tag()) + "> are not read");
    return;
  }
  e.expect({"name", "joint", "tendon", "actuator", "site", "body", "objtype", "objname", "reftype", "refname", "cutoff",
            "noise", "user"});
  Sensor sensor{.name = name, .type = *type, .cutoff = e.positive_or("cutoff", 0)};
  if (!read_object(scene, e, sensor)) return;
  checked(e, [&] {
    scene.builder.add_sensor(sensor);
    return true;
  });
}

}  // namespace

void read_sensors(MjcfScene& scene) {
  MjcfNames names;
  for (const MjcfElement& section : scene.sections("sensor")) {
    for (const MjcfElement& element : scene.elements(section)) {
      const std::string name = claim_name(names, element.named("sensor"), "sensor", names.size(), scene.reserved);
      read_sensor(scene, element.named("sensor " + in_quotes(name)), name);
    }
  }
}

}  // namespace manyhands::io
