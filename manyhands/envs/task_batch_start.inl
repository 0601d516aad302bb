// Bodies of TaskBatch: how an episode begins.
#pragma once

#include "manyhands/envs/task_batch.h"

namespace manyhands {

template <Number T, TaskLike Task>
void TaskBatch<T, Task>::start_episode(Block& block, int lane, NumpyRandom& random, double size) {
  copy_lane(start_, lane, block.state, lane);
  block.touching[static_cast<std::size_t>(lane)] = 0;
  const Start start = draw_start(random, size);
  for (std::size_t i = 0; i < Task::kGoalSize; ++i)
    set_lane(block.goal[i], lane, static_cast<R>(static_cast<float>(start.goal[i])));
  for (std::size_t k = 0; k < Task::kObjects; ++k) {
    const Vec3<double>& p = start.objects[k];
    const std::array pose{p.x, p.y, size * p.z, 0.0, 0.0, 0.0, 1.0};
    for (std::size_t i = 0; i < pose.size(); ++i)
      set_lane(block.state.q()[objects_[k].iq + i], lane, static_cast<R>(pose[i]));
  }
}

/// Draws until obstacles are clear of it: `Room::require` has seen that they can be.
template <Number T, TaskLike Task>
auto TaskBatch<T, Task>::draw_start(NumpyRandom& random, double size) const -> Start {
  constexpr int kMostDraws = 10000;
  for (int draw = 1;; ++draw) {
    Start start = task_.draw(random);
    if constexpr (requires { task_.resize(start, size); }) task_.resize(start, size);
    if (draw == kMostDraws || !conflict(start, size)) return start;
  }
}

template <Number T, TaskLike Task>
std::optional<Room::Conflict> TaskBatch<T, Task>::conflict(const Start& start, double size) const {
  if (room_.empty()) return std::nullopt;
  for (std::size_t k = 0; k < Task::kObjects; ++k) {
    const Vec3<double>& p = start.objects[k];
    if (const auto i = room_.obstacle_at(k, {p.x, p.y, size * p.z}, size)) return Room::Conflict{*i, k, false};
  }
  if constexpr (requires { Task::kGoalIsPlaces; }) {
    for (std::size_t k = 0; 3 * k < Task::kGoalSize; ++k) {
      const double* p = &start.goal[3 * k];
      if (const auto i = room_.obstacle_at(k, {p[0], p[1], p[2]}, size)) return Room::Conflict{*i, k, true};
    }
  }
  return std::nullopt;
}

}  // namespace manyhands
