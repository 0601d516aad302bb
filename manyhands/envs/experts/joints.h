// An expert of the hand that drives joints: it moves them as control of the hand would, as far as one action can.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "manyhands/envs/experts/expert.h"
#include "manyhands/envs/panda.h"

namespace manyhands {

/// Needs the joints' positions, which are not observed: it acts in environments only.
class JointsExpert final : public Expert {
 public:
  explicit JointsExpert(std::unique_ptr<Expert> hand_expert);

  /// Throws std::logic_error: what is observed does not tell the joints.
  void act(std::span<const float> observation, std::span<const float> desired_goal, std::span<float> action) override;
  void act(const EnvBatch& envs, std::span<float> action) override;

  [[nodiscard]] int action_dim() const override;

 private:
  void move_joints(const float* hand_action, float* action);

  std::unique_ptr<Expert> hand_expert_;
  LonePanda panda_;
  Tree<float> tree_;
  ParamsStorage<float> params_;
  StateStorage<float> state_;
  Workspace<float> ws_;
  std::vector<double> q_;
  std::vector<float> hand_action_;
};

}  // namespace manyhands
