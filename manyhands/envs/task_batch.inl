// Bodies of TaskBatch, included by the files that instantiate it.
#pragma once

#include <algorithm>
#include <cstddef>

#include "manyhands/base/float_environment.h"
#include "manyhands/envs/task_batch.h"

namespace manyhands {

namespace internal {

inline std::uint64_t fresh_seed(std::random_device& device) {
  return (static_cast<std::uint64_t>(device()) << 32) | device();
}

inline void check_size(std::size_t size, std::size_t expected, const char* what) {
  if (size != expected) {
    throw std::invalid_argument(std::string(what) + " has " + std::to_string(size) + " numbers; expected " +
                                std::to_string(expected));
  }
}

inline std::size_t rows(int n, int columns) { return static_cast<std::size_t>(n) * static_cast<std::size_t>(columns); }

/// The hand's part of an observation: position, velocity and, with a gripper, the fingers' width.
template <Number T>
MANYHANDS_INLINE std::size_t write_hand(const HandState<T>& hand, bool has_gripper, T* row) {
  write_point(hand.p, row);
  write_point(hand.v, row + 3);
  row[6] = hand.open_width;
  return has_gripper ? 7 : 6;
}

template <class Task>
EnvSpec complete(EnvSpec spec, const Arm& arm, const EnvOptions& options) {
  spec.robot_dim = Task::kHasGripper ? 7 : 6;
  spec.observation_dim = spec.robot_dim + static_cast<int>(Task::kObservationSize);
  spec.goal_dim = static_cast<int>(Task::kGoalSize);
  spec.action_dim = action_size(arm);
  spec.max_episode_steps = Task::kMaxEpisodeSteps;
  spec.dt = options.time_step * options.n_substeps;
  return spec;
}

/// The task's objects in the shape that is asked for.
template <class Task>
std::array<ObjectSpec, Task::kObjects> objects_of(const Task& task, const std::string& shape) {
  std::array<ObjectSpec, Task::kObjects> objects = task.objects();
  if (shape.empty()) return objects;
  if (objects.empty()) throw std::invalid_argument("object_shape is '" + shape + "', but the task has no object");
  for (ObjectSpec& object : objects) {
    if constexpr (requires { Task::kShapes; }) {
      reshape(object, shape, Task::kShapes);
    } else {
      reshape(object, shape);
    }
  }
  return objects;
}

}  // namespace internal

template <Number T, TaskLike Task>
TaskBatch<T, Task>::TaskBatch(EnvSpec spec, const ArmSpec& arm, ArmControl control, Reward reward, int num_envs,
                              const EnvOptions& options, const Task& task)
    : task_(task),
      goals_{reward, options.distance_threshold > 0 ? options.distance_threshold : Task::kDistanceThreshold},
      options_(options),
      num_envs_(num_envs),
      arm_spec_(arm),
      room_(internal::objects_of(task, options.object_shape), options.obstacles),
      scene_(task_scene(arm, task.table(), internal::objects_of(task, options.object_shape), options.obstacles)),
      arm_(arm, scene_, control, Task::kHasGripper, options.impedance),
      system_(scene_),
      params_(scene_),
      randomizer_(options.randomize),
      parts_(scene_, arm_, task.objects()),
      start_(scene_, system_.contact_numbers()),
      gatherer_(internal::rows(blocks_of(num_envs), W)),
      pool_(std::min(choose_num_threads(options.num_threads), blocks_of(num_envs))) {
  spec_ = internal::complete<Task>(std::move(spec), arm_, options);
  spec_.randomized = randomizer_.names();
  // A block waits for its slowest world, and what these iterations leave the next step's continue.
  system_.solver.max_iterations = 8;
  if (!room_.empty()) {
    require_clear(arm_, scene_, options.obstacles.size());
    room_.require([this, random = NumpyRandom(0)]() mutable { return conflict(task_.draw(random), 1); });
  }
  set_arm_motors(arm_, params_);
  for (const ObjectSpec& object : task.objects()) {
    const BodyId id = scene_.link(scene_.link_id(object.name)).body;
    const Body& body = scene_.body(id);
    objects_.push_back({id.index(), static_cast<std::size_t>(body.iq), static_cast<std::size_t>(body.iv)});
  }
  for (int k = 0; k < W; ++k) reset_arm(arm_, start_, k);
  const bool own_params = randomizer_.varies_physics();
  Block empty(scene_, system_.contact_numbers(), own_params ? BlockParts::kParams : BlockParts::kState);
  std::ranges::copy(start_.numbers(), empty.state.numbers().begin());
  empty.worlds.fill(-1);
  if (own_params) set_arm_motors(arm_, empty.params);
  blocks_.assign(static_cast<std::size_t>(blocks_of(num_envs)), empty);
  for (int worker = 0; worker < pool_.num_threads(); ++worker) workspaces_.emplace_back(system_);
  std::random_device device;
  for (int i = 0; i < num_envs; ++i) {
    const std::uint64_t seed = internal::fresh_seed(device);
    worlds_.push_back({NumpyRandom(seed), 0, i / W, i % W, {.seed = seed}});
    blocks_[static_cast<std::size_t>(i / W)].worlds[static_cast<std::size_t>(i % W)] = i;
  }
  observation_.resize(internal::rows(num_envs, spec_.observation_dim));
  achieved_goal_.resize(internal::rows(num_envs, spec_.goal_dim));
  desired_goal_ = achieved_goal_;
  reward_.resize(internal::rows(num_envs, 1));
  is_success_.resize(reward_.size());
  terminated_ = truncated_ = unstable_ = is_success_;
  q_before_.resize(internal::rows(num_envs, system_.tree.nq));
  randomized_.resize(worlds_.size() * spec_.randomized.size());
  late_actions_.resize(internal::rows(num_envs, spec_.action_dim) * randomizer_.longest_latency());
  for (Block& block : blocks_) {
    for (int k = 0; k < W; ++k) start_episode(block, k, worlds_[0].random, 1);
  }
  reset({}, {});
}

template <Number T, TaskLike Task>
void TaskBatch<T, Task>::reset(std::span<const std::uint8_t> mask, std::span<const std::uint64_t> seeds) {
  if (!mask.empty()) internal::check_size(mask.size(), worlds_.size(), "the reset mask");
  if (!seeds.empty()) internal::check_size(seeds.size(), worlds_.size(), "the list of seeds");
  const FloatEnvironment floats;
  pool_.for_each(static_cast<int>(blocks_.size()), [&](int block, int worker) {
    reset_block(block, workspaces_[static_cast<std::size_t>(worker)], mask, seeds);
  });
}

template <Number T, TaskLike Task>
void TaskBatch<T, Task>::reset_block(int b, StepWorkspace<T>& ws, std::span<const std::uint8_t> mask,
                                     std::span<const std::uint64_t> seeds) {
  Block& block = blocks_[static_cast<std::size_t>(b)];
  const auto starts = [&](int i) { return mask.empty() || mask[static_cast<std::size_t>(i)] != 0; };
  bool any_starts = false;
  for_each_world(block, [&](int i, int lane) {
    if (!starts(i)) return;
    const auto row = static_cast<std::size_t>(i);
    any_starts = true;
    World& world = worlds_[row];
    if (!seeds.empty()) world.random = NumpyRandom(seeds[row]);
    world.key = seeds.empty() ? RandomKey{world.key.seed, world.key.episode + 1} : RandomKey{seeds[row]};
    world.steps = 0;
    begin_randomized(i);
    start_episode(block, lane, world.random, world.values[static_cast<std::size_t>(Randomized::kObjectSize)]);
  });
  if (!any_starts) return;
  const View view = look(block, ws);
  for_each_world(block, [&](int i, int lane) {
    if (!starts(i)) return;
    const auto row = static_cast<std::size_t>(i);
    reward_[row] = 0;
    terminated_[row] = truncated_[row] = unstable_[row] = 0;
    write_row(i, lane, view, block);
  });
}

template <Number T, TaskLike Task>
void TaskBatch<T, Task>::step(std::span<const float> action) {
  internal::check_size(action.size(), internal::rows(num_envs_, spec_.action_dim), "the action");
  for (std::size_t i = 0; i < action.size(); ++i) {
    if (is_finite(action[i])) continue;
    throw std::invalid_argument("the action of world " +
                                std::to_string(i / static_cast<std::size_t>(spec_.action_dim)) +
                                " is not a finite number");
  }
  const FloatEnvironment floats;
  for (int done = 0; done < options_.n_substeps; done += kSubstepsBetweenGatherings) {
    const int substeps = std::min(kSubstepsBetweenGatherings, options_.n_substeps - done);
    if constexpr (W > 1) gather();
    pool_.for_each(static_cast<int>(blocks_.size()), [&](int b, int worker) {
      Block& block = blocks_[static_cast<std::size_t>(b)];
      StepWorkspace<T>& ws = workspaces_[static_cast<std::size_t>(worker)];
      if (done == 0) act(block, ws, action);
      simulate(block, ws, substeps);
      if (done + substeps == options_.n_substeps) finish_step(block, ws);
    });
  }
}

/// Gathers worlds that touch the same things in blocks. No world's numbers depend on where it lives.
template <Number T, TaskLike Task>
void TaskBatch<T, Task>::gather() {
  const auto place_of = [&](std::size_t lane) { return std::pair{&blocks_[lane / W], static_cast<int>(lane % W)}; };
  const auto exchange = [&](std::size_t i, std::size_t j) {
    const auto [a, lane_a] = place_of(i);
    const auto [b, lane_b] = place_of(j);
    swap_lanes(*a, lane_a, *b, lane_b);
    for (const std::size_t lane : {i, j}) {
      const int world = blocks_[lane / W].worlds[lane % W];
      if (world < 0) continue;
      worlds_[static_cast<std::size_t>(world)].block = static_cast<int>(lane / W);
      worlds_[static_cast<std::size_t>(world)].lane = static_cast<int>(lane % W);
      settle(worlds_[static_cast<std::size_t>(world)]);
    }
  };
  const auto key = [&](std::size_t lane) { return blocks_[lane / W].touching[lane % W]; };
  gatherer_.gather(key, exchange);
}

template <Number T, TaskLike Task>
void TaskBatch<T, Task>::swap_lanes(Block& a, int lane_a, Block& b, int lane_b) {
  constexpr std::size_t kUsed = offsetof(CachedManifold<T>, used) / sizeof(T);
  const auto swap_numbers = [&](T& x, T& y) {
    const R kept = lane(x, lane_a);
    set_lane(x, lane_a, lane(y, lane_b));
    set_lane(y, lane_b, kept);
  };
  const std::size_t memory = a.state.numbers().size() - a.state.contact_cache().size();
  for (std::size_t i = 0; i < memory; ++i) swap_numbers(a.state.numbers()[i], b.state.numbers()[i]);
  for (std::size_t i = 0; i < a.state.contact_cache().size(); i += kManifoldNumbers<T>) {
    T *in_a = &a.state.contact_cache()[i],
      *in_b = &b.state.contact_cache()[i];  // a manifold that is not used is all zeros
    if (lane(in_a[kUsed], lane_a) == 0 && lane(in_b[kUsed], lane_b) == 0) continue;
    for (std::size_t k = 0; k < kManifoldNumbers<T>; ++k) swap_numbers(in_a[k], in_b[k]);
  }
  for (std::size_t i = 0; i < Task::kGoalSize; ++i) swap_numbers(a.goal[i], b.goal[i]);
  for (Vec3<T> HandState<T>::* const part : {&HandState<T>::p, &HandState<T>::v}) {
    swap_numbers((a.hand.*part).x, (b.hand.*part).x);
    swap_numbers((a.hand.*part).y, (b.hand.*part).y);
    swap_numbers((a.hand.*part).z, (b.hand.*part).z);
  }
  swap_numbers(a.hand.open_width, b.hand.open_width);
  for (std::size_t i = 0; i < a.action.size(); ++i) swap_numbers(a.action[i], b.action[i]);
  std::swap(a.worlds[static_cast<std::size_t>(lane_a)], b.worlds[static_cast<std::size_t>(lane_b)]);
  std::swap(a.touching[static_cast<std::size_t>(lane_a)], b.touching[static_cast<std::size_t>(lane_b)]);
}

/// Notes what each world touched in the last substep, or nearly did: a bit for each manifold, and the lowest one if
/// that was not soon settled.
template <Number T, TaskLike Task>
void TaskBatch<T, Task>::note_touching(const ContactSolver<T>& contact, Block& block) {
  constexpr R kSoon = 2;
  for (int k = 0; k < W; ++k) block.touching[static_cast<std::size_t>(k)] = lane(contact.iterate.iterations, k) > kSoon;
  for (const ContactPoint<T>& point : contact.problem.points) {
    const auto bit = std::uint64_t{2} << (contact.problem.patches[point.patch].manifold % 63);
    for_lanes<T>(is_finite(point.phi), [&](int k) { block.touching[static_cast<std::size_t>(k)] |= bit; });
  }
}

template <Number T, TaskLike Task>
void TaskBatch<T, Task>::act(Block& block, StepWorkspace<T>& ws, std::span<const float> action) {
  for_each_world(block, [&](int i, int lane) {
    std::array<float, Arm::kMostActions> row{};
    std::copy_n(&action[internal::rows(i, spec_.action_dim)], spec_.action_dim, row.begin());
    disturb(i, std::span(row).first(static_cast<std::size_t>(spec_.action_dim)));
    for (std::size_t k = 0; k < static_cast<std::size_t>(spec_.action_dim); ++k)
      set_lane(block.action[k], lane, static_cast<R>(row[k]));
    R* q = &q_before_[internal::rows(i, system_.tree.nq)];
    for (int k = 0; k < system_.tree.nq; ++k) q[k] = manyhands::lane(block.state.q()[k], lane);
  });
  apply_action(arm_, system_.tree, params_, block.hand, block.action.data(), block.state, ws.dynamics);
}

template <Number T, TaskLike Task>
void TaskBatch<T, Task>::simulate(Block& block, StepWorkspace<T>& ws, int substeps) {
  if (block.has_params()) {
    simulate(block, block.params, ws, substeps);
  } else {
    simulate(block, params_, ws, substeps);
  }
  if constexpr (W > 1) note_touching(ws.contact, block);
}

template <Number T, TaskLike Task>
void TaskBatch<T, Task>::finish_step(Block& block, StepWorkspace<T>& ws) {
  View view = look(block, ws);
  const mask_t<T> sound = is_sound(block, view);
  if (!all(sound)) {
    put_back(block, sound);
    view = look(block, ws);
  }
  for_each_world(block, [&](int i, int k) {
    const auto row = static_cast<std::size_t>(i);
    unstable_[row] = !lane(sound, k);
    reward_[row] = static_cast<float>(lane(view.outcome.reward, k));
    terminated_[row] = options_.terminate_on_success && lane(view.outcome.success, k);
    truncated_[row] = ++worlds_[row].steps >= spec_.max_episode_steps || unstable_[row] != 0;
    write_row(i, k, view, block);
  });
}

/// Whether all numbers are finite: of the state, and of what is seen of it.
template <Number T, TaskLike Task>
mask_t<T> TaskBatch<T, Task>::is_sound(const Block& block, const View& view) const {
  mask_t<T> sound = block.is_finite() & is_finite(view.outcome.reward);
  const auto check = [&](const T* numbers, int count) {
    for (int k = 0; k < count; ++k) sound = sound & is_finite(numbers[k]);
  };
  check(view.observation.data(), spec_.observation_dim);
  check(view.achieved.data(), spec_.goal_dim);
  return sound;
}

/// Puts the worlds that are not sound to rest where the step began, without memory of contacts.
template <Number T, TaskLike Task>
void TaskBatch<T, Task>::put_back(Block& block, mask_t<T> sound) {
  block.put_back(sound, start_.numbers());
  for_each_world(block, [&](int world, int k) {
    if (lane(sound, k)) return;
    const R* q = &q_before_[internal::rows(world, system_.tree.nq)];
    for (int i = 0; i < system_.tree.nq; ++i) set_lane(block.state.q()[i], k, q[i]);
  });
}

template <Number T, TaskLike Task>
template <Number P>
void TaskBatch<T, Task>::simulate(Block& block, const Params<P>& params, StepWorkspace<T>& ws, int substeps) {
  for (int k = 0; k < substeps; ++k) {
    for (const Object& object : objects_)
      apply_drag(params.inertia[object.body], block.state.q() + object.iq, block.state.v() + object.iv,
                 block.state.tau() + object.iv);
    drive_arm(arm_, system_.tree, params, block.action.data(), block.state, ws.dynamics);
    manyhands::step(system_, params, static_cast<R>(options_.time_step), block.state, ws);
  }
}

/// Sets the block's hand, too.
template <Number T, TaskLike Task>
auto TaskBatch<T, Task>::look(Block& block, StepWorkspace<T>& ws) const -> View {
  View view;
  block.hand = observe_hand(arm_, system_.tree, block.state, ws.dynamics);
  std::array<ObjectState<T>, Task::kObjects> objects;
  for (std::size_t k = 0; k < Task::kObjects; ++k)
    objects[k] = observe_object(block.state.q() + objects_[k].iq, block.state.v() + objects_[k].iv);
  T* row = view.observation.data();
  task_.observe(objects, row + internal::write_hand(block.hand, Task::kHasGripper, row));
  task_.achieve(block.hand, objects, view.achieved.data());
  view.outcome = judge(goals_, task_.distance(view.achieved.data(), block.goal.data()));
  return view;
}

template <Number T, TaskLike Task>
void TaskBatch<T, Task>::write_row(int i, int at, const View& view, const Block& block) {
  const auto write = [&](const T* from, int count, std::vector<float>& to) {
    float* row = &to[internal::rows(i, count)];
    for (int k = 0; k < count; ++k) row[k] = static_cast<float>(lane(from[k], at));
  };
  write(view.observation.data(), spec_.observation_dim, observation_);
  write(view.achieved.data(), spec_.goal_dim, achieved_goal_);
  write(block.goal.data(), spec_.goal_dim, desired_goal_);
  add_noise(i);
  is_success_[static_cast<std::size_t>(i)] = lane(view.outcome.success, at);
}

template <Number T, TaskLike Task>
void TaskBatch<T, Task>::compute_reward(std::span<const float> achieved_goal, std::span<const float> desired_goal,
                                        std::span<float> reward) const {
  internal::check_size(achieved_goal.size(), Task::kGoalSize * reward.size(), "the achieved goal");
  internal::check_size(desired_goal.size(), Task::kGoalSize * reward.size(), "the desired goal");
  for (std::size_t i = 0; i < reward.size(); ++i) {
    const std::size_t row = Task::kGoalSize * i;
    reward[i] = judge(goals_, task_.distance(&achieved_goal[row], &desired_goal[row])).reward;
  }
}

}  // namespace manyhands

#include "manyhands/envs/task_batch_randomized.inl"
#include "manyhands/envs/task_batch_seen.inl"
#include "manyhands/envs/task_batch_snapshot.inl"
#include "manyhands/envs/task_batch_start.inl"
