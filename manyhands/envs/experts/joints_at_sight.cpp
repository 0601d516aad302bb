#include "manyhands/envs/experts/joints_at_sight.h"

#include <algorithm>
#include <cmath>

#include "manyhands/envs/control/hand.h"
#include "manyhands/envs/experts/joint_actions.h"

namespace manyhands {

namespace {

constexpr std::size_t kYaw = 0, kRollOfUpperArm = 2, kRollOfForearm = 4, kRollOfHand = 6;  // the Panda's joints

/// The chain without the rolls of upper arm and forearm, which stay zero.
IkChain in_a_plane(const Arm& arm) {
  IkChain chain = arm.chain;
  for (const std::size_t k : {kRollOfUpperArm, kRollOfForearm}) std::erase(chain.dofs, arm.joints[k]);
  return chain;
}

}  // namespace

JointsAtSight::JointsAtSight(std::unique_ptr<Expert> hand_expert)
    : hand_expert_(std::move(hand_expert)),
      tree_(panda_.model),
      params_(panda_.model),
      ws_(tree_),
      plane_(in_a_plane(panda_.arm)),
      here_(static_cast<std::size_t>(panda_.model.nq())),
      there_(here_.size()) {}

int JointsAtSight::action_dim() const { return experts::joint_action_dim(panda_.arm, *hand_expert_); }

void JointsAtSight::act(std::span<const float> observation, std::span<const float> desired_goal,
                        std::span<float> action) {
  const auto columns = static_cast<std::size_t>(action_dim()), n = action.size() / columns,
             hand_columns = static_cast<std::size_t>(hand_expert_->action_dim());
  hand_action_.resize(n * hand_columns);
  hand_expert_->act(observation, desired_goal, hand_action_);
  for (std::size_t i = 0; i < n; ++i) {
    const float* row = &observation[i * (observation.size() / n)];
    const float* hand = &hand_action_[i * hand_columns];
    const Vec3<float> p{row[0], row[1], row[2]};
    pose(p, here_);
    pose(internal::displaced(p, hand), there_);
    float* joints = &action[i * columns];
    experts::write_joint_action(panda_.arm, here_.data(), there_.data(), joints);
    std::copy(hand + experts::kHandMove, hand + hand_columns, joints + panda_.arm.joints.size());
  }
}

/// Solved from a start that p alone tells, too, so that it does not depend on what was solved before.
void JointsAtSight::pose(const Vec3<float>& p, std::vector<float>& q) {
  const Arm& arm = panda_.arm;
  for (std::size_t k = 0; k < arm.joints.size(); ++k) q[arm.joints[k]] = static_cast<float>(arm.neutral[k]);
  const float yaw = std::atan2(p.y - base_.y, p.x - base_.x);
  q[arm.joints[kYaw]] += yaw;
  q[arm.joints[kRollOfHand]] += yaw;
  improve_ik(tree_, params_, plane_, IkSettings{}, {internal::pointing_down<float>(), p}, q.data(), ws_);
}

}  // namespace manyhands
