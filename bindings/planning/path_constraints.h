// Path constraints as Python gives them.
#pragma once

#include <nanobind/nanobind.h>

#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "bindings/arrays.h"
#include "bindings/planning/planner.h"

namespace manyhands::bindings {

/// frame, axis (3), direction (3), within
using AxisConstraints = std::vector<std::tuple<std::string, Array<double, 1>, Array<double, 1>, double>>;
/// frame, position (3) and quaternion (4) that bounds are measured from, lower (3), upper (3)
using PositionConstraints =
    std::vector<std::tuple<std::string, Array<double, 1>, Array<double, 1>, Array<double, 1>, Array<double, 1>>>;

/// Throws std::invalid_argument where numbers of theirs make no sense; frames are not looked up.
void check_path_constraints(const AxisConstraints& axes, const PositionConstraints& positions);

/// A check of the planner's scene that keeps them, too; none if there are none.
[[nodiscard]] std::optional<ConfigurationCheck> constrained_check(const Planner& planner, const AxisConstraints& axes,
                                                                  const PositionConstraints& positions);

}  // namespace manyhands::bindings
