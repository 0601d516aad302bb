// World: what the model's sensors read.
#include "manyhands/physics/collision/queries/ray_cast.h"
#include "manyhands/physics/world/sensor_reading.h"
#include "manyhands/physics/world/world_impl.h"

namespace manyhands {

namespace {

/// Normal forces on the sensor's link at points from which a ray out of the link meets its volume [N].
double touch(const WorldCore& core, const Sensor& sensor, std::span<const Contact> contacts) {
  const ShapeView volume{.type = sensor.volume.type, .size = sensor.volume.size};
  const Transform<double> X_WF = pose_before(core, sensor);
  double sum = 0;
  for (const Contact& contact : contacts) {
    if (contact.link_a != sensor.link && contact.link_b != sensor.link) continue;
    const Vec3<double> out = contact.link_a == sensor.link ? contact.normal : -contact.normal;
    const double far = std::numeric_limits<double>::infinity();
    if (ray_cast(volume, X_WF, contact.position, out, far)) sum += contact.normal_force;
  }
  return sum;
}

}  // namespace

/// Fills in the readings that tell of the last step.
void World::read_last_step(std::span<const Sensor> sensors, std::vector<std::vector<double>>& readings) const {
  const WorldCore& now = core();
  const std::vector<Contact> touching = contacts();
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    const Sensor& sensor = sensors[i];
    const auto in_F = [&](const Vec3<double>& a) { return listed(transpose_times(pose_before(now, sensor).R, a)); };
    const auto acceleration = [&] {
      place_last_step(now, time_step_);
      return acceleration_of(now, sensor);
    };
    const auto wrench = [&] {
      const Force<double> F = wrench_into(now, sensor.link);
      return Force<double>{F.n - cross(pose_before(now, sensor).p, F.f), F.f};
    };
    switch (sensor.type) {
      case SensorType::kActuatorForce:
        readings[i] = {actuator_force(now, sensor.actuator.index(), time_step_)};
        break;
      case SensorType::kFrameLinearAcceleration:
        readings[i] = listed(acceleration().v);
        break;
      case SensorType::kFrameAngularAcceleration:
        readings[i] = listed(acceleration().w);
        break;
      case SensorType::kAccelerometer:
        readings[i] = in_F(acceleration().v);
        break;
      case SensorType::kForce:
        readings[i] = in_F(wrench().f);
        break;
      case SensorType::kTorque:
        readings[i] = in_F(wrench().n);
        break;
      case SensorType::kTouch:
        readings[i] = {touch(now, sensor, touching)};
        break;
      default:
        break;
    }
  }
}

std::vector<double> World::read_sensors(std::span<const Sensor> sensors) const {
  const WorldCore& now = core();
  std::vector<std::vector<double>> readings(sensors.size());
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    if (!tells_of_step(sensors[i].type)) readings[i] = read_state(now, sensors[i], time());
  }
  if (std::ranges::any_of(sensors, [](const Sensor& sensor) { return tells_of_step(sensor.type); })) {
    if (integrator_ == Integrator::kRungeKutta4)
      throw std::runtime_error("accelerometers, forces and the like tell of a step, and rk4 has no reactions");
    if (now.has_stepped) {
      read_last_step(sensors, readings);
    } else {
      World next(*this);
      next.step();
      next.read_last_step(sensors, readings);
    }
  }
  std::vector<double> all;
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    cut_off(sensors[i], readings[i]);
    all.insert(all.end(), readings[i].begin(), readings[i].end());
  }
  return all;
}

std::vector<double> World::sensor(std::string_view name) const {
  return read_sensors(std::span(&core().model->sensor(name), 1));
}

std::vector<double> World::sensor_data() const { return read_sensors(core().model->sensors()); }

}  // namespace manyhands
