#include "manyhands/envs/room.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <tuple>

#include "manyhands/physics/collision/queries/distance.h"

namespace manyhands {

Room::Room(std::span<const ObjectSpec> objects, std::span<const Obstacle> obstacles) {
  constexpr double kPoint = 1e-6;
  for (const ObjectSpec& object : objects) things_.push_back({object.name, object.shape, object.X_OG});
  if (objects.empty()) things_.push_back({"", {.type = ShapeType::kSphere, .size = {kPoint, 0, 0}}});
  for (std::size_t i = 0; i < obstacles.size(); ++i)
    obstacles_.push_back({obstacle_name(i), obstacles[i].shape, obstacles[i].X_WO});
}

std::optional<std::size_t> Room::obstacle_at(std::size_t k, const Vec3<double>& p, double size) const {
  constexpr double kRounding = 1e-6;  // what lies on an obstacle does not reach into it
  const Solid& thing = things_[k];
  const ShapeView shape{.type = thing.shape.type, .size = size * thing.shape.size};
  const Transform<double> X_WG{thing.pose.R, p + size * thing.pose.p};
  for (std::size_t i = 0; i < obstacles_.size(); ++i) {
    const ShapeView obstacle{.type = obstacles_[i].shape.type, .size = obstacles_[i].shape.size};
    if (signed_distance(shape, X_WG, obstacle, obstacles_[i].pose).phi < -kRounding) return i;
  }
  return std::nullopt;
}

void Room::require(const std::function<std::optional<Conflict>()>& try_start) const {
  constexpr int kStarts = 200, kFew = 2;
  std::map<std::tuple<std::size_t, std::size_t, bool>, int> conflicts;
  int clear = 0;
  for (int i = 0; i < kStarts; ++i) {
    if (const std::optional<Conflict> found = try_start()) {
      ++conflicts[{found->obstacle, found->object, found->is_goal}];
    } else {
      ++clear;
    }
  }
  if (clear >= kFew) return;
  const auto most = std::ranges::max_element(conflicts, {}, [](const auto& entry) { return entry.second; });
  const auto& [obstacle, object, is_goal] = most->first;
  throw std::invalid_argument(told({obstacle, object, is_goal}) + ": of " + std::to_string(kStarts) +
                              " starts drawn, obstacles leave " + std::to_string(clear) + "; move it away");
}

std::string Room::told(const Conflict& conflict) const {
  const std::string& name = things_[conflict.object].name;
  const std::string whose = name.empty() ? "" : " of '" + name + "'";
  return obstacles_[conflict.obstacle].name + " covers where " +
         (conflict.is_goal ? "goals" + whose + " are" : "'" + name + "' starts");
}

}  // namespace manyhands
