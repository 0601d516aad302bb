// Some of a training's worlds, where they run apart from the trainer: in another process, on another machine.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "manyhands/learn/collector.h"
#include "manyhands/learn/exploration.h"

namespace manyhands::learn {

/// What a trainer asks of all shares at a time: some steps of every world under one policy.
[[nodiscard]] Message write_order(const Actor& actor, const InputNormaliser& normaliser, std::int64_t iteration,
                                  int steps, bool warming_up);

class Share {
 public:
  /// Worlds first, ..., first + envs.num_envs() - 1 of all. Borrows `envs` and `expert`, as a trainer does. Throws
  /// std::invalid_argument where a trainer would.
  Share(EnvBatch& envs, Expert* expert, const TrainerConfig& config, int first);

  /// Does what `order` says, from `place` on (empty: the beginning of training). What comes back holds the episodes
  /// that ended, and the place where the worlds are now. It depends on nothing else, so what is lost can be done again,
  /// here or in another share of the same worlds. Throws CheckpointError if a message is not from a trainer like this.
  [[nodiscard]] Message run(std::span<const std::byte> order, std::span<const std::byte> place);

 private:
  void go_to(std::span<const std::byte> place);

  InputNormaliser normaliser_;
  Actor actor_;
  Collector collector_;
  StateExploration exploration_;
  Matrix<float> action_;  // (action_dim, worlds)
  Message place_;         // where the worlds are
};

/// An episode that was made elsewhere.
struct Episode {
  int length{};
  bool terminated{}, succeeded{};
  std::vector<float> observation, achieved_goal, desired_goal, action, reward, advice,
      randomized;  ///< rows as in EpisodeView

  [[nodiscard]] EpisodeView view() const;
};

/// What `Share::run` brings.
struct ShareResult {
  Message place;  ///< where the worlds are now
  std::vector<Episode> episodes;
};

/// Reads it; `advice_dim`: action_dim if an expert was asked, else 0. Throws CheckpointError if it is no such thing.
[[nodiscard]] ShareResult read_result(const EnvSpec& spec, int advice_dim, std::span<const std::byte> message);

}  // namespace manyhands::learn
