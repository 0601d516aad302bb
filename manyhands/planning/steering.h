// How one configuration leads to another: straight, or in steps along path constraints.
#pragma once

#include <optional>

#include "manyhands/planning/configuration_check.h"

namespace manyhands {

enum class Step { kStuck, kAdvances, kArrives };

/// Sets `to` (n) to the target, or to where a step of `range` at most [rad or m] leads from `from`. With constraints
/// the step is projected onto them, and halved until they hold all along it: the extension of CBiRRT (Berenson,
/// Srinivasa, Ferguson and Kuffner, Manipulation planning on constraint manifolds, ICRA 2009). Stuck where steps lead
/// no nearer. Does not look at collisions.
[[nodiscard]] Step step_towards(ConfigurationCheck& check, std::span<const float> from, std::span<const float> target,
                                float range, std::span<float> to);

/// The configurations, rows of n, by way of which a free way leads from a to b, all of which keep the constraints; none
/// in between where it is straight. Nothing if no such way is found.
[[nodiscard]] std::optional<std::vector<float>> way_between(ConfigurationCheck& check, std::span<const float> a,
                                                            std::span<const float> b);

}  // namespace manyhands
