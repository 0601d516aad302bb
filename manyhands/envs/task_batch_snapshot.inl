// Bodies of TaskBatch: hashes and snapshots.
#pragma once

#include <cstring>

#include "manyhands/base/hash.h"
#include "manyhands/envs/task_batch.h"

namespace manyhands {

template <Number T, TaskLike Task>
std::uint64_t TaskBatch<T, Task>::state_hash() const {
  Hash hash;
  for (const World& world : worlds_) {
    for (const T& number : block_of(world).state.numbers()) hash.add(lane(number, world.lane));
  }
  for (const float number : randomized_) hash.add(number);
  for (const float number : late_actions_) hash.add(number);
  return hash.value();
}

/// World by world: state, goal, random stream and step count, as bytes; where worlds are randomised, key and late
/// actions.
template <Number T, TaskLike Task>
std::size_t TaskBatch<T, Task>::bytes_of_world() const {
  const std::size_t bytes =
      (start_.numbers().size() + Task::kGoalSize) * sizeof(R) + sizeof(NumpyRandom::State) + sizeof(std::int32_t);
  return randomizer_.empty() ? bytes : bytes + sizeof(RandomKey) + late_actions_of(*this, 0).size_bytes();
}

template <Number T, TaskLike Task>
std::vector<std::uint8_t> TaskBatch<T, Task>::snapshot() const {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(bytes_of_world() * worlds_.size());
  const auto put = [&](const auto& value) {
    const auto* first = reinterpret_cast<const std::uint8_t*>(&value);
    bytes.insert(bytes.end(), first, first + sizeof(value));
  };
  for (const World& world : worlds_) {
    for (const T& number : block_of(world).state.numbers()) put(lane(number, world.lane));
    for (const T& number : block_of(world).goal) put(lane(number, world.lane));
    put(world.random.state());
    put(static_cast<std::int32_t>(world.steps));
    if (randomizer_.empty()) continue;
    put(world.key);
    for (const float number : late_actions_of(*this, static_cast<std::size_t>(&world - worlds_.data()))) put(number);
  }
  return bytes;
}

template <Number T, TaskLike Task>
void TaskBatch<T, Task>::restore(std::span<const std::uint8_t> snapshot) {
  internal::check_size(snapshot.size(), bytes_of_world() * worlds_.size(), "the snapshot");
  const std::uint8_t* from = snapshot.data();
  const auto take = [&](auto value) {
    std::memcpy(&value, from, sizeof(value));
    from += sizeof(value);
    return value;
  };
  for (World& world : worlds_) {
    Block& block = blocks_[static_cast<std::size_t>(world.block)];
    for (T& number : block.state.numbers()) set_lane(number, world.lane, take(R{}));
    for (T& number : block.goal) set_lane(number, world.lane, take(R{}));
    world.random = NumpyRandom(take(NumpyRandom::State{}));
    world.steps = take(std::int32_t{});
    if (randomizer_.empty()) continue;
    const auto i = static_cast<std::size_t>(&world - worlds_.data());
    world.key = take(RandomKey{});
    begin_randomized(static_cast<int>(i));
    for (float& number : late_actions_of(*this, i)) number = take(float{});
  }
  for (Block& block : blocks_) {
    const View view = look(block, workspaces_[0]);
    for_each_world(block, [&](int i, int lane) { write_row(i, lane, view, block); });
  }
}

}  // namespace manyhands
