#include "manyhands/learn/policy.h"

namespace manyhands::learn {

namespace {

PolicyOutput output_of(PolicyKind kind) {
  if (kind == PolicyKind::kCategorical) return PolicyOutput::kIndex;
  return kind == PolicyKind::kGaussian ? PolicyOutput::kClip : PolicyOutput::kTanh;
}

template <class M>
std::vector<float> copied(const M& m) {
  return {m.data(), m.data() + m.size()};
}

}  // namespace

Policy export_policy(const EnvSpec& spec, const InputNormaliser& normaliser, const Actor& actor) {
  Policy policy = {.observation_dim = spec.observation_dim,
                   .goal_dim = spec.goal_dim,
                   .action_dim = spec.action_dim,
                   .mean = copied(normaliser.mean()),
                   .scale = copied(normaliser.scale()),
                   .clip = normaliser.clip(),
                   .differences = normaliser.differences(),
                   .activation = actor.net().hidden(),
                   .output = output_of(actor.kind()),
                   .layers = {}};
  const Mlp<float>& net = actor.net();
  for (int layer = 0; layer < net.num_layers(); ++layer) {
    const bool spread_below = layer + 1 == net.num_layers() && actor.kind() == PolicyKind::kSquashedGaussian;
    const Eigen::Index outputs = spread_below ? spec.action_dim : net.weight(layer).rows();
    const Matrix<float> row_major = net.weight(layer).topRows(outputs).transpose();
    const Vector<float> bias = net.bias(layer).head(outputs);
    policy.layers.push_back({.inputs = static_cast<int>(row_major.rows()),
                             .outputs = static_cast<int>(outputs),
                             .weight = copied(row_major),
                             .bias = copied(bias)});
  }
  return policy;
}

}  // namespace manyhands::learn
