// Any number of worlds of one task: the batch behind the environments.
#pragma once

#include <atomic>
#include <optional>
#include <random>
#include <stdexcept>

#include "manyhands/base/thread_pool.h"
#include "manyhands/envs/control/control.h"
#include "manyhands/envs/gather_lanes.h"
#include "manyhands/envs/randomize.h"
#include "manyhands/envs/room.h"
#include "manyhands/envs/tasks/task.h"
#include "manyhands/physics/world/snapshot.h"

namespace manyhands {

/// Worlds live in blocks of W = width_v<T> lanes. A block looks at all contacts that any of its worlds has, so worlds
/// that touch the same things, and take as long, are gathered every few substeps.
template <Number T, TaskLike Task>
class TaskBatch final : public EnvBatch {
 public:
  /// `spec` needs only an id; the rest follows from the task. Throws std::invalid_argument if the arm or an obstacle
  /// cannot be, or obstacles leave no room for objects and goals.
  TaskBatch(EnvSpec spec, const ArmSpec& arm, ArmControl control, Reward reward, int num_envs,
            const EnvOptions& options, const Task& task = {});

  [[nodiscard]] const EnvSpec& spec() const override { return spec_; }
  [[nodiscard]] int num_envs() const override { return num_envs_; }
  void reset(std::span<const std::uint8_t> mask, std::span<const std::uint64_t> seeds) override;
  void step(std::span<const float> action) override;
  [[nodiscard]] std::span<const float> observation() const override { return observation_; }
  [[nodiscard]] std::span<const float> achieved_goal() const override { return achieved_goal_; }
  [[nodiscard]] std::span<const float> desired_goal() const override { return desired_goal_; }
  [[nodiscard]] std::span<const float> reward() const override { return reward_; }
  [[nodiscard]] std::span<const std::uint8_t> is_success() const override { return is_success_; }
  [[nodiscard]] std::span<const std::uint8_t> terminated() const override { return terminated_; }
  [[nodiscard]] std::span<const std::uint8_t> truncated() const override { return truncated_; }
  [[nodiscard]] std::span<const std::uint8_t> unstable() const override { return unstable_; }
  [[nodiscard]] std::span<const float> randomized() const override { return randomized_; }
  void compute_reward(std::span<const float> achieved_goal, std::span<const float> desired_goal,
                      std::span<float> reward) const override;
  [[nodiscard]] EnvScene scene() const override;
  void see(int world, std::span<double> q, std::span<Vec3<double>> sizes) const override;
  [[nodiscard]] std::uint64_t state_hash() const override;
  [[nodiscard]] std::vector<std::uint8_t> snapshot() const override;
  void restore(std::span<const std::uint8_t> snapshot) override;

 private:
  using R = real_t<T>;
  static constexpr int W = width_v<T>;
  static constexpr int kSubstepsBetweenGatherings = 2;
  static constexpr int blocks_of(int worlds) { return (worlds + W - 1) / W; }

  struct Block : WorldBlock<T> {  ///< with parameters of its own where physics are randomised
    using WorldBlock<T>::WorldBlock;
    std::array<T, Task::kGoalSize> goal{};
    HandState<T> hand{};                        ///< at the end of the last step
    std::array<T, Arm::kMostActions> action{};  ///< of this step
    std::array<int, W> worlds{};                ///< in its lanes; -1: none
    std::array<std::uint64_t, W> touching{};    ///< what its worlds did in the last step: see `note_touching`
  };
  struct World {
    NumpyRandom random;
    int steps;        ///< of the present episode
    int block, lane;  ///< where it lives
    RandomKey key{};
    RandomValues values{};
  };
  struct Object {
    std::size_t body, iq, iv;
  };
  /// What is seen of a block.
  struct View {
    std::array<T, 7 + Task::kObservationSize> observation;
    std::array<T, Task::kGoalSize> achieved;
    Outcome<T> outcome;
  };

  /// Calls visit(world, lane) for every world of the block.
  template <class Visit>
  void for_each_world(const Block& block, Visit&& visit) const {
    for (int k = 0; k < W; ++k) {
      if (block.worlds[static_cast<std::size_t>(k)] >= 0) visit(block.worlds[static_cast<std::size_t>(k)], k);
    }
  }
  [[nodiscard]] const Block& block_of(const World& world) const {
    return blocks_[static_cast<std::size_t>(world.block)];
  }
  void gather();
  static void swap_lanes(Block& a, int lane_a, Block& b, int lane_b);
  void reset_block(int block, StepWorkspace<T>& ws, std::span<const std::uint8_t> mask,
                   std::span<const std::uint64_t> seeds);
  void start_episode(Block& block, int lane, NumpyRandom& random, double size);
  using Start = TaskStart<Task::kGoalSize, Task::kObjects>;
  [[nodiscard]] Start draw_start(NumpyRandom& random, double size) const;
  [[nodiscard]] std::optional<Room::Conflict> conflict(const Start& start, double size) const;
  void begin_randomized(int world);
  void settle(const World& world);
  /// Of one world: (longest latency x action_dim). `batch` is *this, const or not.
  template <class Batch>
  [[nodiscard]] static auto late_actions_of(Batch& batch, std::size_t world) {
    const std::size_t size = batch.late_actions_.size() / batch.worlds_.size();
    return std::span(batch.late_actions_).subspan(world * size, size);
  }
  void disturb(int world, std::span<float> action);
  void add_noise(int world);
  void act(Block& block, StepWorkspace<T>& ws, std::span<const float> action);
  void simulate(Block& block, StepWorkspace<T>& ws, int substeps);
  template <Number P>
  void simulate(Block& block, const Params<P>& params, StepWorkspace<T>& ws, int substeps);
  void finish_step(Block& block, StepWorkspace<T>& ws);
  [[nodiscard]] mask_t<T> is_sound(const Block& block, const View& view) const;
  void put_back(Block& block, mask_t<T> sound);
  [[nodiscard]] View look(Block& block, StepWorkspace<T>& ws) const;
  static void note_touching(const ContactSolver<T>& contact, Block& block);
  void write_row(int world, int lane, const View& view, const Block& block);
  [[nodiscard]] const SnapshotOwner& snapshot_owner() const;
  void check_snapshot(SnapshotReader in) const;

  EnvSpec spec_;
  Task task_;
  Goals goals_;
  EnvOptions options_;
  int num_envs_;
  ArmSpec arm_spec_;
  Room room_;
  Model scene_;
  Arm arm_;
  std::vector<Object> objects_;
  System<R> system_;
  ParamsStorage<R> params_;  ///< the same for all worlds, unless they are randomised
  Randomizer randomizer_;
  SceneParts parts_;
  StateStorage<T> start_;  ///< the arm as every episode begins
  std::vector<Block> blocks_;
  std::vector<World> worlds_;
  LaneGatherer gatherer_;
  ThreadPool pool_;
  std::vector<StepWorkspace<T>> workspaces_;  ///< one for each worker
  std::vector<float> observation_, achieved_goal_, desired_goal_, reward_, randomized_;
  std::vector<R> q_before_;          ///< (n, nq) at the start of the step
  std::vector<float> late_actions_;  ///< (n, longest latency, action_dim) those of the last steps, in a circle
  std::vector<std::uint8_t> is_success_, terminated_, truncated_, unstable_;
  mutable std::optional<SnapshotOwner> snapshot_owner_;  ///< once it is asked for
};

}  // namespace manyhands
