// Bodies of TaskBatch: hashes and snapshots.
#pragma once

#include "manyhands/base/hash.h"
#include "manyhands/envs/env_snapshot.h"
#include "manyhands/envs/task_batch.h"

namespace manyhands {

template <Number T, TaskLike Task>
std::uint64_t TaskBatch<T, Task>::state_hash() const {
  Hash hash;
  for (const World& world : worlds_) add_fields(block_of(world).view(static_cast<std::size_t>(world.lane)).state, hash);
  for (const float number : randomized_) hash.add(number);
  for (const float number : late_actions_) hash.add(number);
  return hash.value();
}

template <Number T, TaskLike Task>
const SnapshotOwner& TaskBatch<T, Task>::snapshot_owner() const {
  if (!snapshot_owner_) {
    snapshot_owner_ = env_snapshot_owner(spec_, arm_, goals_, options_, scene_, num_envs_);
  }
  return *snapshot_owner_;
}

/// World by world: state, goal, random stream and step count; where worlds are randomised, key and late actions.
template <Number T, TaskLike Task>
std::vector<std::uint8_t> TaskBatch<T, Task>::snapshot() const {
  SnapshotWriter out(snapshot_owner());
  for (const World& world : worlds_) {
    const Block& block = block_of(world);
    out.put_fields(block.view(static_cast<std::size_t>(world.lane)).state);
    for (const T& number : block.goal) out.put(lane(number, world.lane));
    out.put(world.random.state());
    out.put(static_cast<std::int64_t>(world.steps));
    if (randomizer_.empty()) continue;
    out.put(world.key);
    for (const float number : late_actions_of(*this, static_cast<std::size_t>(&world - worlds_.data())))
      out.put(number);
  }
  return out.finish();
}

/// Throws std::invalid_argument if a number cannot be.
template <Number T, TaskLike Task>
void TaskBatch<T, Task>::check_snapshot(SnapshotReader in) const {
  StateStorage<R> state(scene_, system_.contact_numbers());
  const auto require_finite = [](auto number) {
    if (!is_finite(number)) throw std::invalid_argument("the snapshot holds a goal or an action that is not finite");
  };
  for (std::size_t i = 0; i < worlds_.size(); ++i) {
    in.take_fields(state.view(0));
    require_sound(scene_, state.view(0));
    require_listed_contacts(state.view(0));
    for (std::size_t k = 0; k < Task::kGoalSize; ++k) require_finite(in.take<R>());
    (void)in.take<NumpyRandom::State>();
    (void)in.take_count("a count of steps", std::numeric_limits<int>::max());
    if (randomizer_.empty()) continue;
    (void)in.take<RandomKey>();
    for (std::size_t k = 0; k < late_actions_of(*this, i).size(); ++k) require_finite(in.take<float>());
  }
  in.finish();
}

template <Number T, TaskLike Task>
void TaskBatch<T, Task>::restore(std::span<const std::uint8_t> snapshot) {
  const FloatEnvironment floats;
  SnapshotReader in(snapshot, snapshot_owner());
  check_snapshot(in);  // before anything changes
  for (World& world : worlds_) {
    Block& block = blocks_[static_cast<std::size_t>(world.block)];
    in.take_fields(block.view(static_cast<std::size_t>(world.lane)).state);
    for (T& number : block.goal) set_lane(number, world.lane, in.take<R>());
    world.random = NumpyRandom(in.take<NumpyRandom::State>());
    world.steps = static_cast<int>(in.take<std::int64_t>());
    if (randomizer_.empty()) continue;
    const auto i = static_cast<std::size_t>(&world - worlds_.data());
    world.key = in.take<RandomKey>();
    begin_randomized(static_cast<int>(i));
    for (float& number : late_actions_of(*this, i)) number = in.take<float>();
  }
  for (Block& block : blocks_) {
    const View view = look(block, workspaces_[0]);
    for_each_world(block, [&](int i, int lane) { write_row(i, lane, view, block); });
  }
}

}  // namespace manyhands
