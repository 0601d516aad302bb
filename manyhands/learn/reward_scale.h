// Rewards in units of the return: what a value network shall say is then of order one, whatever the task pays.
//
// Engstrom et al., "Implementation matters in deep policy gradients", 2020, algorithm 1.
#pragma once

#include <cstdint>
#include <span>

#include "manyhands/learn/archive.h"
#include "manyhands/learn/mlp.h"

namespace manyhands::learn {

class RewardScale {
 public:
  /// `on`: otherwise rewards stay as they are.
  RewardScale(int worlds, float gamma, bool on);

  /// Adds one step's rewards (worlds) to the discounted return of each world's episode.
  void add(std::span<const float> reward);
  /// The world's episode has ended.
  void end(int world) { running_[world] = 0; }

  /// 1 / the standard deviation of all returns so far.
  [[nodiscard]] float scale() const;

  void save(ArchiveWriter& out) const;
  void load(ArchiveReader& in);

 private:
  bool on_;
  float gamma_;
  Vector<float> running_;                             // (worlds)
  double count_ = 0, mean_ = 0, sum_of_squares_ = 0;  // Welford, 1962
};

}  // namespace manyhands::learn
