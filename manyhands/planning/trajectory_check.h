// How long a trajectory stays free: in a scene that has changed, or as nobody has looked at it yet.
#pragma once

#include "manyhands/planning/configuration_check.h"
#include "manyhands/planning/trajectory.h"

namespace manyhands {

/// The time up to which, from `from` on, a trajectory of planned coordinates is free all along, within the scene's
/// limits and the check's constraints: its duration if it is to the end; `from` if it is blocked there. To a
/// millisecond, and rather too early. Throws std::invalid_argument if the trajectory has another width than the scene.
[[nodiscard]] double free_until(const PlanningScene& scene, ConfigurationCheck& check, const Trajectory& motion,
                                double from = 0);

/// Whether it is free, and within limits, to its end.
[[nodiscard]] bool is_free_all_along(const PlanningScene& scene, ConfigurationCheck& check, const Trajectory& motion);

}  // namespace manyhands
