#include "manyhands/learn/policy.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

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

void require(bool holds, const std::string& complaint) {
  if (!holds) throw std::invalid_argument("the policy makes no sense: " + complaint);
}

bool finite(const std::vector<float>& values) {
  return std::ranges::all_of(values, [](float x) { return std::isfinite(x); });
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

void Policy::validate() const {
  const auto count = [](int n) { return static_cast<std::size_t>(n); };
  require(observation_dim > 0 && goal_dim >= 0 && action_dim > 0, "its sizes are not positive");
  require(relations.differences.size() % 2 == 0, "a difference has no second part");
  relations.require_fit(observation_dim, goal_dim);
  const std::size_t inputs =
      count(observation_dim + 2 * goal_dim + relations.rotation_dim() + relations.difference_dim());
  require(mean.size() == inputs && scale.size() == inputs,
          "mean and scale are not of its " + std::to_string(inputs) + " inputs");
  require(finite(mean) && finite(scale) && clip > 0 && std::isfinite(clip), "its inputs are scaled without end");
  require(!layers.empty(), "it has no layer");
  int given = static_cast<int>(inputs);
  for (const Layer& layer : layers) {
    require(layer.inputs == given && layer.outputs > 0, "a layer does not fit the one before it");
    require(
        layer.weight.size() == count(layer.inputs) * count(layer.outputs) && layer.bias.size() == count(layer.outputs),
        "a layer has weights of another size");
    require(finite(layer.weight) && finite(layer.bias), "a weight is not finite");
    given = layer.outputs;
  }
  require(output == PolicyOutput::kIndex ? action_dim == 1 : action_dim == given, "its last layer gives no action");
}

Policy export_policy(const EnvSpec& spec, const InputNormaliser& normaliser, const Actor& actor) {
  Policy policy = {.env_id = spec.id,
                   .observation_dim = spec.observation_dim,
                   .goal_dim = spec.goal_dim,
                   .action_dim = spec.action_dim,
                   .mean = copied(normaliser.mean()),
                   .scale = copied(normaliser.scale()),
                   .clip = normaliser.clip(),
                   .relations = normaliser.relations(),
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
  Policy policy = {.env_id = spec.id,
                   .observation_dim = spec.robot_dim,
                   .action_dim = spec.action_dim,
                   .mean = copied(mean),
                   .scale = copied(scale),
                   .clip = normaliser.clip(),
                   .relations = {},
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
