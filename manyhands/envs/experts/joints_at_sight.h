// A script of the hand that drives joints without knowing them: an adviser of policies, which do not see them either.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "manyhands/envs/experts/expert.h"
#include "manyhands/envs/panda.h"

namespace manyhands {

/// Holds the arm in the posture that the hand's position alone tells: pointing down, with the arm in an upright plane.
/// An action is the difference between two such postures. What turns the arm out of its plane goes unseen; over an
/// episode it stays small.
class JointsAtSight final : public Expert {
 public:
  using Expert::act;

  explicit JointsAtSight(std::unique_ptr<Expert> hand_expert);

  void act(std::span<const float> observation, std::span<const float> desired_goal, std::span<float> action) override;

  [[nodiscard]] int action_dim() const override;

 private:
  void pose(const Vec3<float>& p, std::vector<float>& q);

  std::unique_ptr<Expert> hand_expert_;
  LonePanda panda_;
  Vec3<float> base_ = broadcast<float>(panda_arm().X_WA.p);
  Tree<float> tree_;
  ParamsStorage<float> params_;
  Workspace<float> ws_;
  IkChain plane_;
  std::vector<float> here_, there_;  ///< (nq)
  std::vector<float> hand_action_;
};

}  // namespace manyhands
