#include "manyhands/envs/experts/joints.h"

#include <algorithm>
#include <stdexcept>

#include "manyhands/envs/control/control.h"
#include "manyhands/envs/experts/joint_actions.h"

namespace manyhands {

using experts::kHandMove;

JointsExpert::JointsExpert(std::unique_ptr<Expert> hand_expert)
    : hand_expert_(std::move(hand_expert)),
      tree_(panda_.model),
      params_(panda_.model),
      state_(panda_.model, 0),
      ws_(tree_),
      q_(static_cast<std::size_t>(panda_.model.nq())) {}

int JointsExpert::action_dim() const { return experts::joint_action_dim(panda_.arm, *hand_expert_); }

void JointsExpert::act(std::span<const float> /*observation*/, std::span<const float> /*desired_goal*/,
                       std::span<float> /*action*/) {
  throw std::logic_error("an expert that drives joints must know them, and they are not observed: give it the batch");
}

void JointsExpert::act(const EnvBatch& envs, std::span<float> action) {
  const auto n = static_cast<std::size_t>(envs.num_envs()), columns = static_cast<std::size_t>(action_dim()),
             hand_columns = static_cast<std::size_t>(hand_expert_->action_dim());
  if (action.size() != n * columns) {
    throw std::invalid_argument("the actions have length " + std::to_string(action.size()) + ", expected " +
                                std::to_string(n * columns));
  }
  hand_action_.resize(n * hand_columns);
  hand_expert_->act(envs.observation(), envs.desired_goal(), hand_action_);
  for (std::size_t i = 0; i < n; ++i) {
    envs.see(static_cast<int>(i), q_, {});
    std::ranges::transform(q_, state_.q(), [](double x) { return static_cast<float>(x); });
    const float* hand = &hand_action_[i * hand_columns];
    float* joints = &action[i * columns];
    move_joints(hand, joints);
    std::copy(hand + kHandMove, hand + hand_columns, joints + panda_.arm.joints.size());
  }
}

/// Towards where control of the hand would bring the joints.
void JointsExpert::move_joints(const float* hand_action, float* action) {
  const HandState<float> hand = observe_hand(panda_.arm, tree_, state_, ws_);
  apply_action(panda_.arm, tree_, params_, hand, hand_action, state_, ws_);
  experts::write_joint_action(panda_.arm, state_.q(), state_.target_q(), action);
}

}  // namespace manyhands
