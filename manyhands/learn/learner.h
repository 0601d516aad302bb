// What a trainer needs of an algorithm: what to try in the worlds, and to learn from what comes of it.
#pragma once

#include <cstdint>
#include <memory>

#include "manyhands/learn/actor.h"
#include "manyhands/learn/archive.h"
#include "manyhands/learn/collector.h"
#include "manyhands/learn/halves.h"
#include "manyhands/learn/normaliser.h"

namespace manyhands::learn {

/// Sums over gradient steps, to be divided by their numbers.
struct LearnStats {
  double critic_loss = 0, q = 0;
  int steps = 0;
  double policy_q = 0, entropy = 0;
  int policy_steps = 0;
};

class Learner {
 public:
  virtual ~Learner() = default;

  [[nodiscard]] virtual const Actor& actor() const = 0;
  [[nodiscard]] virtual std::int64_t gradient_steps() const = 0;

  /// Fills `action` (action_dim, worlds) with what to try in the worlds' present states.
  virtual void choose_actions(const Collector& worlds, const InputNormaliser& normaliser, std::int64_t iteration,
                              Matrix<float>& action) = 0;

  /// Takes in the step that the worlds have made, before those that have finished start again.
  virtual void observe(const Collector& worlds, const InputNormaliser& normaliser) = 0;

  /// Takes in an episode of worlds elsewhere, whose policy was some steps older. Only off-policy learners can.
  virtual void add(const EpisodeView& episode) = 0;

  /// Whether so little has been taken in that the policy does not act yet.
  [[nodiscard]] virtual bool warming_up() const { return false; }

  /// Takes the gradient steps that are due.
  virtual void learn(const Collector& worlds, const InputNormaliser& normaliser, Halves& halves, LearnStats& stats) = 0;

  /// All that `load` needs to go on exactly. Without the replay an off-policy learner begins to fill it anew.
  virtual void save(ArchiveWriter& out, bool with_replay) const = 0;
  virtual void load(ArchiveReader& in) = 0;
};

/// The learner that `config.algorithm` names, for `num_worlds` worlds and a network input of `input_dim` numbers.
/// Throws std::invalid_argument if it cannot learn this kind of environment.
[[nodiscard]] std::unique_ptr<Learner> make_learner(const EnvSpec& spec, int num_worlds, int input_dim,
                                                    const TrainerConfig& config);

/// Writes the network's input for the present state of every world into the columns of `state`.
void write_states(const EnvBatch& envs, const InputNormaliser& normaliser, Matrix<float>& state);

}  // namespace manyhands::learn
