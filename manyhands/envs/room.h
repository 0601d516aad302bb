// What obstacles leave free: where objects may start, and goals may be.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "manyhands/envs/scene.h"

namespace manyhands {

/// Tells whether what a task puts somewhere would lie in an obstacle.
class Room {
 public:
  /// Without objects the goal is the hand's: a point, numbered 0.
  Room(std::span<const ObjectSpec> objects, std::span<const Obstacle> obstacles);

  /// Whether there are no obstacles.
  [[nodiscard]] bool empty() const { return obstacles_.empty(); }

  /// The first obstacle into which object k would reach with its centre at p, not turned, its lengths times `size`.
  [[nodiscard]] std::optional<std::size_t> obstacle_at(std::size_t k, const Vec3<double>& p, double size) const;

  /// What is in the way of a start.
  struct Conflict {
    std::size_t obstacle, object;
    bool is_goal;
  };
  /// Throws std::invalid_argument, which names the obstacle and what it covers, if hardly any of many starts is clear.
  /// `try_start` draws one.
  void require(const std::function<std::optional<Conflict>()>& try_start) const;

 private:
  struct Solid {
    std::string name;
    Shape shape{};
    Transform<double> pose = Transform<double>::identity();  ///< of an object in its frame, of an obstacle in the world
  };
  [[nodiscard]] std::string told(const Conflict& conflict) const;

  std::vector<Solid> things_, obstacles_;
};

}  // namespace manyhands
