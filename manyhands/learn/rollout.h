// What a policy did in the last few steps of every world, and how much better that went than expected.
//
// Schulman et al., "High-dimensional continuous control using generalized advantage estimation", 2016, equation 16.
#pragma once

#include <cstdint>
#include <vector>

#include "manyhands/learn/archive.h"
#include "manyhands/learn/mlp.h"

namespace manyhands::learn {

/// Steps of all worlds: step t of world w is column t * worlds + w.
struct Rollout {
  /// advice_dim: action_dim if an expert is asked, else 0.
  Rollout(int length, int count, int state_dim, int action_dim, int advice_dim);

  [[nodiscard]] int size() const { return static_cast<int>(reward.size()); }
  [[nodiscard]] bool full() const { return filled == steps; }

  /// Fills `advantage` and `value_target`, with the values of the states in which the worlds are now (worlds).
  /// Where an episode ended, what follows is worth `last_value` and belongs to no sum.
  void set_advantages(const Vector<float>& value_now, float gamma, float lambda);

  void save(ArchiveWriter& out) const;
  void load(ArchiveReader& in);

  int steps, worlds, filled = 0;
  Matrix<float> state, action;                   ///< (state_dim, n), (action_dim, n)
  Matrix<float> advice;                          ///< (advice_dim, n), what the expert would have done
  Vector<float> log_probability, value, reward;  ///< (n)
  std::vector<std::uint8_t> ended;               ///< (n), with this step its episode
  Vector<float> last_value;                      ///< (n), where it ended, of the last state; 0 if it was terminated
  Vector<float> advantage, value_target;         ///< (n)
};

}  // namespace manyhands::learn
