// The scenes of tasks: an arm at a table, and what lies on it.
#pragma once

#include <span>
#include <string>

#include "manyhands/envs/arm.h"

namespace manyhands {

/// A table whose top is z = 0, on a floor [m].
struct Table {
  double length = 1.1, width = 0.7, height = 0.4;
  double x_offset = -0.3;  ///< of its centre
};

/// A rigid body that tasks move: uniform, its frame in its centre.
struct ObjectSpec {
  std::string name;
  Shape shape{};
  double mass = 1;  ///< [kg]
  double friction = 0.5;
  std::array<float, 4> rgba{0.1f, 0.9f, 0.1f, 1};
};

[[nodiscard]] Model load_arm(const ArmSpec& spec);

/// The arm first, then floor and table, then the objects, each floating.
[[nodiscard]] Model task_scene(const ArmSpec& arm, const Table& table, std::span<const ObjectSpec> objects);

}  // namespace manyhands
