// Bodies of TaskBatch: what differs from episode to episode.
#pragma once

#include "manyhands/envs/task_batch.h"

namespace manyhands {

/// Draws what the world's episode has, and forgets the actions on their way.
template <Number T, TaskLike Task>
void TaskBatch<T, Task>::begin_randomized(int i) {
  World& world = worlds_[static_cast<std::size_t>(i)];
  world.values = randomizer_.draw(world.key);
  if (randomizer_.empty()) return;
  const std::size_t columns = spec_.randomized.size();
  randomizer_.write(world.values, std::span(randomized_).subspan(static_cast<std::size_t>(i) * columns, columns));
  std::ranges::fill(late_actions_of(*this, static_cast<std::size_t>(i)), 0.0f);
  settle(world);
}

/// Gives the world its parameters where it lives.
template <Number T, TaskLike Task>
void TaskBatch<T, Task>::settle(const World& world) {
  Block& block = blocks_[static_cast<std::size_t>(world.block)];
  if (!block.has_params()) return;
  const auto lane = static_cast<std::size_t>(world.lane);
  write_params(world.values, parts_, manyhands::view(params_, 0), manyhands::view(block.params, lane));
}

/// What becomes of an action on its way to the arm: it comes late, and with noise.
template <Number T, TaskLike Task>
void TaskBatch<T, Task>::disturb(int i, std::span<float> action) {
  if (randomizer_.empty()) return;
  const World& world = worlds_[static_cast<std::size_t>(i)];
  const auto value = [&](Randomized what) { return world.values[static_cast<std::size_t>(what)]; };
  if (const auto latency = static_cast<std::size_t>(value(Randomized::kActionLatency)); latency > 0) {
    const auto slot = static_cast<std::size_t>(world.steps) % latency * action.size();
    std::ranges::swap_ranges(late_actions_of(*this, static_cast<std::size_t>(i)).subspan(slot, action.size()), action);
  }
  if (const float deviation = value(Randomized::kActionNoise); deviation > 0) {
    RandomStream noise = noise_of(world.key, world.steps, Randomized::kActionNoise);
    for (float& a : action) a = std::clamp(a, -1.0f, 1.0f) + deviation * noise.normal<float>();
  }
}

template <Number T, TaskLike Task>
void TaskBatch<T, Task>::add_noise(int i) {
  const World& world = worlds_[static_cast<std::size_t>(i)];
  const float deviation = world.values[static_cast<std::size_t>(Randomized::kObservationNoise)];
  if (!(deviation > 0)) return;
  RandomStream noise = noise_of(world.key, world.steps, Randomized::kObservationNoise);
  const auto columns = static_cast<std::size_t>(spec_.observation_dim);
  for (float& number : std::span(observation_).subspan(static_cast<std::size_t>(i) * columns, columns))
    number += deviation * noise.normal<float>();
}

}  // namespace manyhands
