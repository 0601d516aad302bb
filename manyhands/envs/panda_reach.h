// PandaReach for any number of worlds: the batch behind PandaReach-v3 and its dense and joints-controlled forms.
#pragma once

#include <atomic>
#include <random>
#include <stdexcept>

#include "manyhands/base/thread_pool.h"
#include "manyhands/envs/make.h"
#include "manyhands/envs/panda.h"
#include "manyhands/envs/reach.h"

namespace manyhands {

/// Worlds live in blocks of W = width_v<T> lanes; a worker of the pool takes one block through the whole step.
template <Number T>
class PandaReachBatch final : public EnvBatch {
 public:
  PandaReachBatch(EnvSpec spec, PandaControl control, const ReachTask& task, int num_envs, const EnvOptions& options);

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
  void compute_reward(std::span<const float> achieved_goal, std::span<const float> desired_goal,
                      std::span<float> reward) const override;
  [[nodiscard]] std::uint64_t state_hash() const override;

 private:
  using R = real_t<T>;
  static constexpr int W = width_v<T>;

  struct Block {
    State<T> state;
    HandState<T> hand;
    Vec3<T> goal;
  };
  struct World {
    NumpyRandom random;
    int steps;  ///< of the present episode
  };

  void step_block(int block, StepWorkspace<T>& ws, std::span<const float> action);
  void write_row(int world);

  EnvSpec spec_;
  PandaRobot robot_;
  ReachTask task_;
  EnvOptions options_;
  int num_envs_;
  System<R> system_;
  Params<R> params_;  ///< the same for all worlds
  std::vector<Block> blocks_;
  std::vector<World> worlds_;
  HandState<T> start_;                        ///< the hand as every episode begins
  std::vector<StepWorkspace<T>> workspaces_;  ///< one for each worker
  ThreadPool pool_;
  std::vector<float> observation_, achieved_goal_, desired_goal_, reward_;
  std::vector<std::uint8_t> is_success_, terminated_, truncated_;
};

}  // namespace manyhands
