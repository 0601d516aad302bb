// Bodies of PandaReachBatch, included by the files that instantiate it.
#pragma once

#include "manyhands/base/hash.h"
#include "manyhands/envs/panda_reach.h"

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

}  // namespace internal

template <Number T>
PandaReachBatch<T>::PandaReachBatch(EnvSpec spec, PandaControl control, const ReachTask& task, int num_envs,
                                    const EnvOptions& options)
    : spec_(std::move(spec)),
      robot_(control),
      task_(task),
      options_(options),
      num_envs_(num_envs),
      system_(robot_.model),
      params_(robot_.model),
      blocks_(internal::rows((num_envs + W - 1) / W, 1),
              Block{State<T>(robot_.model, system_.contact_numbers()), {Vec3<T>::zero(), Vec3<T>::zero()}, Vec3<T>::zero()}),
      pool_(std::min(choose_num_threads(options.num_threads), static_cast<int>(blocks_.size()))),
      observation_(internal::rows(num_envs, spec_.observation_dim)),
      achieved_goal_(internal::rows(num_envs, spec_.goal_dim)),
      desired_goal_(achieved_goal_),
      reward_(internal::rows(num_envs, 1)),
      is_success_(internal::rows(num_envs, 1)),
      terminated_(is_success_),
      truncated_(is_success_) {
  set_panda_motors(params_);
  for (int worker = 0; worker < pool_.num_threads(); ++worker) workspaces_.emplace_back(system_);
  std::random_device device;
  for (int i = 0; i < num_envs; ++i) worlds_.push_back({NumpyRandom(internal::fresh_seed(device)), 0});
  for (Block& block : blocks_) {
    for (int k = 0; k < W; ++k) reset_panda(block.state, k);
    block.hand = observe_hand(robot_, system_.tree, block.state, workspaces_[0].dynamics);
  }
  start_ = blocks_[0].hand;
  reset({}, {});
}

template <Number T>
void PandaReachBatch<T>::reset(std::span<const std::uint8_t> mask, std::span<const std::uint64_t> seeds) {
  if (!mask.empty()) internal::check_size(mask.size(), worlds_.size(), "the reset mask");
  if (!seeds.empty()) internal::check_size(seeds.size(), worlds_.size(), "the list of seeds");
  for (int i = 0; i < num_envs_; ++i) {
    const auto row = static_cast<std::size_t>(i);
    if (!mask.empty() && mask[row] == 0) continue;
    World& world = worlds_[row];
    if (!seeds.empty()) world.random = NumpyRandom(seeds[row]);
    world.steps = 0;
    Block& block = blocks_[static_cast<std::size_t>(i / W)];
    const Vec3<float> goal = sample_reach_goal(world.random);
    reset_panda(block.state, i % W);
    copy_lane(start_.p, block.hand.p, i % W);
    copy_lane(start_.v, block.hand.v, i % W);
    copy_lane(broadcast<T>(goal), block.goal, i % W);
    reward_[row] = 0;
    terminated_[row] = truncated_[row] = 0;
    is_success_[row] = judge(task_, lane(start_.p, 0), broadcast<R>(goal)).success;
    write_row(i);
  }
}

template <Number T>
void PandaReachBatch<T>::step(std::span<const float> action) {
  internal::check_size(action.size(), internal::rows(num_envs_, spec_.action_dim), "the action");
  for (std::size_t i = 0; i < action.size(); ++i) {
    if (is_finite(action[i])) continue;
    throw std::invalid_argument("the action of world " +
                                std::to_string(i / static_cast<std::size_t>(spec_.action_dim)) +
                                " is not a finite number");
  }
  pool_.for_each(static_cast<int>(blocks_.size()), [&](int block, int worker) {
    step_block(block, workspaces_[static_cast<std::size_t>(worker)], action);
  });
}

template <Number T>
void PandaReachBatch<T>::step_block(int b, StepWorkspace<T>& ws, std::span<const float> action) {
  Block& block = blocks_[static_cast<std::size_t>(b)];
  std::array<T, PandaRobot::kArmJoints> lanes{};
  const int first = b * W, last = std::min(first + W, num_envs_);
  for (int i = first; i < last; ++i) {
    const float* row = &action[internal::rows(i, spec_.action_dim)];
    for (int k = 0; k < spec_.action_dim; ++k)
      set_lane(lanes[static_cast<std::size_t>(k)], i - first, static_cast<R>(row[k]));
  }
  apply_panda_action(robot_, system_.tree, params_, block.hand, lanes.data(), block.state, ws.dynamics);
  for (int k = 0; k < options_.n_substeps; ++k) {
    manyhands::step(system_, params_, static_cast<R>(options_.time_step), block.state, ws);
  }
  block.hand = observe_hand(robot_, system_.tree, block.state, ws.dynamics);
  const Outcome<T> outcome = judge(task_, block.hand.p, block.goal);
  for (int i = first; i < last; ++i) {
    const auto row = static_cast<std::size_t>(i);
    reward_[row] = static_cast<float>(lane(outcome.reward, i - first));
    terminated_[row] = options_.terminate_on_success && lane(outcome.success, i - first);
    truncated_[row] = ++worlds_[row].steps >= spec_.max_episode_steps;
    is_success_[row] = lane(outcome.success, i - first);
    write_row(i);
  }
}

template <Number T>
void PandaReachBatch<T>::write_row(int i) {
  const Block& block = blocks_[static_cast<std::size_t>(i / W)];
  const Vec3<R> p = lane(block.hand.p, i % W), v = lane(block.hand.v, i % W), goal = lane(block.goal, i % W);
  const auto write = [](const Vec3<R>& from, float* to) {
    to[0] = static_cast<float>(from.x);
    to[1] = static_cast<float>(from.y);
    to[2] = static_cast<float>(from.z);
  };
  write(p, &observation_[internal::rows(i, 6)]);
  write(v, &observation_[internal::rows(i, 6) + 3]);
  write(p, &achieved_goal_[internal::rows(i, 3)]);
  write(goal, &desired_goal_[internal::rows(i, 3)]);
}

template <Number T>
void PandaReachBatch<T>::compute_reward(std::span<const float> achieved_goal, std::span<const float> desired_goal,
                                        std::span<float> reward) const {
  internal::check_size(achieved_goal.size(), 3 * reward.size(), "the achieved goal");
  internal::check_size(desired_goal.size(), 3 * reward.size(), "the desired goal");
  for (std::size_t i = 0; i < reward.size(); ++i) {
    const float* a = &achieved_goal[3 * i];
    const float* d = &desired_goal[3 * i];
    reward[i] = judge(task_, Vec3<float>{a[0], a[1], a[2]}, Vec3<float>{d[0], d[1], d[2]}).reward;
  }
}

template <Number T>
std::uint64_t PandaReachBatch<T>::state_hash() const {
  Hash hash;
  for (int i = 0; i < num_envs_; ++i) {
    const State<T>& state = blocks_[static_cast<std::size_t>(i / W)].state;
    for (const T& number : state.numbers()) hash.add(lane(number, i % W));
  }
  return hash.value();
}

}  // namespace manyhands
