// A policy: a network, and what its output says about actions.
#pragma once

#include "manyhands/learn/mlp.h"
#include "manyhands/learn/random.h"
#include "manyhands/learn/trainer_config.h"

namespace manyhands::learn {

enum class PolicyKind {
  kDeterministic,     ///< the output is the action, in (-1, 1)
  kSquashedGaussian,  ///< means and log standard deviations of what tanh makes an action of (SAC)
  kGaussian,          ///< means of actions; their standard deviations do not depend on the state (PPO)
  kCategorical,       ///< logits of the choices; the action is the index of one (PPO)
};

/// The kind of policy that an algorithm learns; `choices` as in `EnvSpec`.
[[nodiscard]] PolicyKind policy_kind(Algorithm algorithm, int choices);

class Actor {  ///< the network that acts, whichever algorithm trains it
 public:
  Actor() = default;
  /// `outputs`: numbers of an action, or choices. Starts with small actions and even odds.
  Actor(PolicyKind kind, int state_dim, int outputs, const TrainerConfig& config);
  /// By a network that has been trained; `kind`: any but kSquashedGaussian.
  Actor(PolicyKind kind, Mlp<float> net);

  [[nodiscard]] PolicyKind kind() const { return kind_; }
  [[nodiscard]] int action_dim() const { return kind_ == PolicyKind::kCategorical ? 1 : outputs_; }
  [[nodiscard]] const Mlp<float>& net() const { return net_; }
  [[nodiscard]] Mlp<float>& net() { return net_; }
  [[nodiscard]] const Vector<float>& log_std() const { return log_std_; }  ///< (action_dim) if Gaussian, else (0)
  [[nodiscard]] Vector<float>& log_std() { return log_std_; }

  [[nodiscard]] MlpTape<float> make_tape(int batch) const { return net_.make_tape(batch); }

  /// The best actions (action_dim, n) in the states of tape.input().
  void act(MlpTape<float>& tape, Matrix<float>& action) const;
  /// Actions (action_dim, n) drawn from the policy. Those of a Gaussian policy are not bounded.
  void draw(MlpTape<float>& tape, Random random, Matrix<float>& action) const;

 private:
  PolicyKind kind_ = PolicyKind::kDeterministic;
  int outputs_ = 0;
  Mlp<float> net_;
  Vector<float> log_std_;
};

}  // namespace manyhands::learn
