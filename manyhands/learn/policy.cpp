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

/// The first `outputs` of a layer.
Policy::Layer export_layer(const Mlp<float>& net, int layer, int outputs) {
  const Matrix<float> row_major = net.weight(layer).topRows(outputs).transpose();
  const Vector<float> bias = net.bias(layer).head(outputs);
  return {.inputs = static_cast<int>(row_major.rows()),
          .outputs = outputs,
          .weight = copied(row_major),
          .bias = copied(bias)};
}

std::vector<Policy::Kernels> export_eye(const Encoder<float>& encoder) {
  std::vector<Policy::Kernels> layers;
  for (int layer = 0; layer < static_cast<int>(encoder.layers().size()); ++layer) {
    const auto [channels, kernel, stride] = encoder.layers()[static_cast<std::size_t>(layer)];
    const Matrix<float> row_major = encoder.weight(layer).transpose();
    layers.push_back({.channels = channels,
                      .kernel = kernel,
                      .stride = stride,
                      .weight = copied(row_major),
                      .bias = copied(encoder.bias(layer))});
  }
  return layers;
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
    policy.layers.push_back(
        export_layer(net, layer, spread_below ? spec.action_dim : static_cast<int>(net.weight(layer).rows())));
  }
  return policy;
}

Policy export_policy(const EnvSpec& spec, const InputNormaliser& normaliser, const PictureNet<float>& net) {
  const Vector<float> mean = normaliser.mean().head(spec.robot_dim), scale = normaliser.scale().head(spec.robot_dim);
  Policy policy = {.observation_dim = spec.robot_dim,
                   .action_dim = spec.action_dim,
                   .mean = copied(mean),
                   .scale = copied(scale),
                   .clip = normaliser.clip(),
                   .differences = {},
                   .activation = net.head().hidden(),
                   .output = PolicyOutput::kTanh,
                   .layers = {},
                   .pictures = net.encoders().front().shape()};
  for (const Encoder<float>& encoder : net.encoders()) policy.eyes.push_back(export_eye(encoder));
  for (int layer = 0; layer < net.head().num_layers(); ++layer) {
    const bool is_last = layer + 1 == net.head().num_layers();
    policy.layers.push_back(
        export_layer(net.head(), layer, is_last ? spec.action_dim : static_cast<int>(net.head().weight(layer).rows())));
  }
  return policy;
}

}  // namespace manyhands::learn
