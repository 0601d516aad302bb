#include "manyhands/learn/policy_runner.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace manyhands::learn {

namespace {

PolicyKind kind_of(PolicyOutput output) {
  if (output == PolicyOutput::kIndex) return PolicyKind::kCategorical;
  return output == PolicyOutput::kClip ? PolicyKind::kGaussian : PolicyKind::kDeterministic;
}

Mlp<float> network_of(const Policy& policy) {
  std::vector<int> sizes = {policy.layers.front().inputs};
  for (const Policy::Layer& layer : policy.layers) sizes.push_back(layer.outputs);
  Mlp<float> net(sizes, policy.output == PolicyOutput::kTanh ? OutputActivation::kTanh : OutputActivation::kLinear,
                 policy.activation);
  float* to = net.parameters().data();
  for (const Policy::Layer& layer : policy.layers) {
    const Eigen::Map<const Matrix<float>> row_major(layer.weight.data(), layer.inputs, layer.outputs);
    Eigen::Map<Matrix<float>>(to, layer.outputs, layer.inputs) = row_major.transpose();
    to = std::copy(layer.bias.begin(), layer.bias.end(), to + layer.weight.size());
  }
  return net;
}

const Policy& validated(const Policy& policy) {
  if (!policy.eyes.empty()) {
    throw std::invalid_argument("the policy sees pictures, and acts from its ONNX file alone");
  }
  policy.validate();
  return policy;
}

}  // namespace

PolicyRunner::PolicyRunner(const Policy& policy)
    : observation_dim_(validated(policy).observation_dim),
      goal_dim_(policy.goal_dim),
      normaliser_(policy.observation_dim, policy.goal_dim, policy.clip, policy.relations, policy.mean, policy.scale),
      actor_(kind_of(policy.output), network_of(policy)) {}

void PolicyRunner::act(std::span<const float> observation, std::span<const float> achieved_goal,
                       std::span<const float> desired_goal, std::span<float> action) {
  const auto no = static_cast<std::size_t>(observation_dim_), ng = static_cast<std::size_t>(goal_dim_);
  const std::size_t n = observation.size() / no;
  if (observation.size() != n * no || achieved_goal.size() != n * ng || desired_goal.size() != n * ng ||
      action.size() != n * static_cast<std::size_t>(actor_.action_dim())) {
    throw std::invalid_argument("PolicyRunner::act: the arrays are not of as many states");
  }
  const auto columns = static_cast<Eigen::Index>(n);
  if (action_.cols() != columns) {
    tape_ = actor_.make_tape(static_cast<int>(n));
    action_.setZero(actor_.action_dim(), columns);
  }
  for (std::size_t i = 0; i < n; ++i) {
    normaliser_.write(observation.data() + i * no, achieved_goal.data() + i * ng, desired_goal.data() + i * ng,
                      tape_.input().col(static_cast<Eigen::Index>(i)).data());
  }
  actor_.act(tape_, action_);
  std::copy_n(action_.data(), action_.size(), action.data());
  if (actor_.kind() != PolicyKind::kGaussian) return;
  for (float& a : action) a = std::clamp(a, -1.0f, 1.0f);
}

EvalResult PolicyRunner::evaluate(EnvBatch& envs, int episodes, std::uint64_t first_seed) const {
  const EnvSpec& spec = envs.spec();
  if (spec.observation_dim != observation_dim_ || spec.goal_dim != goal_dim_ ||
      spec.action_dim != actor_.action_dim()) {
    throw std::invalid_argument("the policy does not fit " + spec.id + ": it takes observations of " +
                                std::to_string(observation_dim_) + " and goals of " + std::to_string(goal_dim_) +
                                " and gives " + std::to_string(actor_.action_dim()) + " actions, expected " +
                                std::to_string(spec.observation_dim) + ", " + std::to_string(spec.goal_dim) + " and " +
                                std::to_string(spec.action_dim));
  }
  StatePerformer performer(envs, normaliser_, actor_);
  return evaluate_policy(envs, performer, episodes, first_seed);
}

}  // namespace manyhands::learn
