// Critics: networks that say what an action in a state is worth, with their targets and optimisers.
#pragma once

#include <array>
#include <vector>

#include "manyhands/learn/archive.h"
#include "manyhands/learn/mlp.h"
#include "manyhands/learn/trainer_config.h"

namespace manyhands::learn {

/// What the critics need for one part of a mini-batch of n transitions, and what they leave there.
struct CriticTape {
  std::vector<MlpTape<float>> net;      ///< per critic
  std::vector<Vector<float>> gradient;  ///< per critic
  Matrix<float> target;                 ///< (targets of a transition, n): what the critics shall say
  Vector<float> value;                  ///< (n): what they say of the policy's actions
  Matrix<float> action_gradient;        ///< (action_dim, n), of -value, weighted
  double loss{}, value_sum{};           ///< summed over the transitions; the loss over the critics, too
  Matrix<float> atoms, quantiles;       // scratch
};

/// One or more networks (state, action) -> value, or -> quantiles of the return.
///
/// With values the target is the smallest of the target networks' (TD3: Fujimoto et al., 2018) and the loss the square
/// of the difference. With quantiles it is all target networks' quantiles but the largest (TQC), and the loss is
/// `quantile_loss`.
class Critics {
 public:
  Critics(int state_dim, int action_dim, const TrainerConfig& config);

  [[nodiscard]] int size() const { return static_cast<int>(critics_.size()); }
  [[nodiscard]] CriticTape make_tape(int columns) const;

  /// Fills tape.target with what the target networks say of (state, action).
  void set_targets(const Matrix<float>& state, const Matrix<float>& action, CriticTape& tape) const;

  /// Gradients of the mean loss, each transition with `weight`, towards tape.target.
  void set_gradients(const Matrix<float>& state, const Matrix<float>& action, float weight, CriticTape& tape) const;

  /// Fills tape.value with what (state, action) is worth to the policy, and tape.action_gradient with the gradient of
  /// -weight times it: the first critic's value (TD3), the smallest (SAC) or the mean of all quantiles (TQC).
  void set_action_gradient(const Matrix<float>& state, const Matrix<float>& action, float weight,
                           CriticTape& tape) const;

  /// The first critic's values of (state, action), in row 0.
  [[nodiscard]] const Matrix<float>& first_values(const Matrix<float>& state, const Matrix<float>& action,
                                                  CriticTape& tape) const;

  void begin_step(float rate_scale);
  /// Moves part 0 or 1 of all parameters against the sum of the two tapes' gradients, and the targets after them.
  void apply(int part, const std::array<CriticTape*, 2>& tapes, bool move_targets);

  void save(ArchiveWriter& out) const;
  void load(ArchiveReader& in);

 private:
  struct Critic {
    Mlp<float> net, target;
    Adam<float> optimiser;
  };

  void set_input(const Matrix<float>& state, const Matrix<float>& action, CriticTape& tape) const;
  void choose_worth(float weight, CriticTape& tape) const;

  std::vector<Critic> critics_;
  int state_dim_ = 0, action_dim_ = 0;
  int quantiles_ = 1, kept_ = 1;  // of a critic; of all critics together, as targets
  bool policy_takes_least_ = false;
  float target_rate_ = 0;
};

}  // namespace manyhands::learn
