// What sensors read: of a placed world, and of the step that it took last. Internal to World.
#pragma once

#include "manyhands/physics/world/world_core.h"

namespace manyhands {

/// Its three numbers.
[[nodiscard]] inline std::vector<double> listed(const Vec3<double>& a) { return {a.x, a.y, a.z}; }

/// Whether the sensor tells of the last step, not of the present state.
[[nodiscard]] bool tells_of_step(SensorType type);

/// Reads a sensor of the present state; `time` is the world's clock [s].
[[nodiscard]] std::vector<double> read_state(const WorldCore& core, const Sensor& sensor, double time);

/// Of the last step of h [s]: the force of an actuator at its joint, divided by its gear.
[[nodiscard]] double actuator_force(const WorldCore& core, std::size_t actuator, double h);

/// Brings `core.scratch` to where the last step of h [s] began, with the accelerations that it led to; gravity counts
/// as an acceleration of the world.
void place_last_step(const WorldCore& core, double h);
/// How F of the sensor moved then, after `place_last_step`: accelerations of its origin, angular first, in world axes.
[[nodiscard]] Motion<double> acceleration_of(const WorldCore& core, const Sensor& sensor);
/// X_WF when the last step began.
[[nodiscard]] Transform<double> pose_before(const WorldCore& core, const Sensor& sensor);

/// Keeps numbers within the sensor's cutoff.
void cut_off(const Sensor& sensor, std::vector<double>& numbers);

}  // namespace manyhands
