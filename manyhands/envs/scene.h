// The scenes of tasks: an arm at a table, and what lies on it.
#pragma once

#include <span>
#include <string>

#include "manyhands/envs/arm.h"
#include "manyhands/envs/obstacle.h"

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
  Transform<double> X_OG = Transform<double>::identity();  ///< where the shape is in the object's frame
  double mass = 1;                                         ///< [kg]
  double friction = 0.5;
  double rolling_friction = 0;  ///< [m]
  std::array<float, 4> rgba{0.1f, 0.9f, 0.1f, 1};
};

/// What `reshape` knows: box, cylinder, sphere, capsule.
[[nodiscard]] std::span<const char* const> object_shapes();

/// Gives a box or an upright cylinder another shape of the same height and mass, as wide where that can be: a sphere's
/// width is the height, a capsule of that width lies along x. Round ones come to rest: 0.5 mm of rolling friction.
/// Throws std::invalid_argument on a shape that is not one of `allowed`; the message lists them.
void reshape(ObjectSpec& object, const std::string& shape, std::span<const char* const> allowed = object_shapes());

/// The link of the i-th obstacle, as messages name it too.
[[nodiscard]] std::string obstacle_name(std::size_t i);

[[nodiscard]] Model load_arm(const ArmSpec& spec);  ///< at its place

/// The arm first, then floor and table, then the objects, each floating, then the obstacles. Throws
/// std::invalid_argument, which names the obstacle by its place in the list, if one cannot be.
[[nodiscard]] Model task_scene(const ArmSpec& arm, const Table& table, std::span<const ObjectSpec> objects,
                               std::span<const Obstacle> obstacles = {});

/// Throws std::invalid_argument if an obstacle of the scene touches the arm in its neutral pose.
void require_clear(const Arm& arm, const Model& scene, std::size_t obstacles);

}  // namespace manyhands
