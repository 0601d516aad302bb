// A trained policy as plain arrays, for files and other programs.
#pragma once

#include <string>
#include <vector>

#include "manyhands/envs/env_batch.h"
#include "manyhands/learn/actor.h"
#include "manyhands/learn/normaliser.h"
#include "manyhands/learn/picture_net.h"

namespace manyhands::learn {

/// What becomes of the last layer's output.
enum class PolicyOutput {
  kTanh,   ///< action = tanh(y)
  kClip,   ///< action = clip(y, -1, 1)
  kIndex,  ///< the action is the index of the largest y
};

/// The deterministic policy: y = W_L act(... act(W_1 z + b_1) ...) + b_L, of which `output` makes an action, with
/// z = clip((x - mean) * scale, -clip, clip) and x = [observation, desired_goal, desired_goal - achieved_goal,
/// `relations`].
///
/// With `eyes` it sees pictures: W_1 acts on [features of each eye, z], and x is what the robot knows of itself alone,
/// the first observation_dim numbers of an observation; goal_dim is 0. Features are what convolutions, each followed by
/// relu, make of the pictures' bytes / 255 - 0.5, place by place.
struct Policy {
  struct Layer {
    int inputs{}, outputs{};
    std::vector<float> weight;  ///< (outputs, inputs), row-major
    std::vector<float> bias;    ///< (outputs)
  };
  struct Kernels {
    int channels{}, kernel{}, stride{};
    std::vector<float> weight;  ///< (channels, pictures of the stack, kernel, kernel, channels below)
    std::vector<float> bias;    ///< (channels)
  };
  std::string env_id;  ///< the environment it was learned in; empty if that is not known
  int observation_dim{}, goal_dim{}, action_dim{};
  std::vector<float> mean, scale;  ///< (inputs): the length of x
  float clip{};
  Relations relations;
  HiddenActivation activation{};
  PolicyOutput output{};
  std::vector<Layer> layers;
  PictureShape pictures{};
  std::vector<std::vector<Kernels>> eyes{};

  /// Throws std::invalid_argument, with the reason, if the arrays do not fit each other or are not finite.
  void validate() const;
};

/// What runs without a trainer.
[[nodiscard]] Policy export_policy(const EnvSpec& spec, const InputNormaliser& normaliser, const Actor& actor);
/// Of a network whose first outputs, through tanh, are actions.
[[nodiscard]] Policy export_policy(const EnvSpec& spec, const InputNormaliser& normaliser,
                                   const PictureNet<float>& net);

}  // namespace manyhands::learn
