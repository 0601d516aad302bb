// What a trainer needs of an algorithm: what to try in the worlds, and to learn from what comes of it.
#pragma once

#include <cstdint>
#include <memory>

#include "manyhands/envs/sight.h"
#include "manyhands/learn/actor.h"
#include "manyhands/learn/archive.h"
#include "manyhands/learn/collector.h"
#include "manyhands/learn/halves.h"
#include "manyhands/learn/normaliser.h"
#include "manyhands/learn/performer.h"
#include "manyhands/learn/policy.h"

namespace manyhands::learn {

/// Sums over gradient steps, to be divided by their numbers.
struct LearnStats {
  double critic_loss = 0, q = 0;
  int steps = 0;
  double policy_q = 0, entropy = 0;
  int policy_steps = 0;
};

class Learner {  ///< an algorithm: what it does with the steps it is given
 public:
  virtual ~Learner() = default;

  /// What has been learned, as a policy over states; null if it sees pictures.
  [[nodiscard]] virtual const Actor* actor() const = 0;
  [[nodiscard]] virtual std::int64_t gradient_steps() const = 0;

  /// Acts in `envs`, which is borrowed, as are learner and normaliser. Neither may learn meanwhile.
  [[nodiscard]] virtual std::unique_ptr<Performer> performer(const EnvBatch& envs,
                                                             const InputNormaliser& normaliser) const;
  [[nodiscard]] virtual Policy policy(const EnvSpec& spec, const InputNormaliser& normaliser) const;

  /// Fills `action` (action_dim, worlds) with what to try in the worlds' present states.
  virtual void choose_actions(const Collector& worlds, const InputNormaliser& normaliser, std::int64_t iteration,
                              Matrix<float>& action) = 0;

  /// Takes in the step that the worlds have made, before those that have finished start again.
  virtual void observe(const Collector& worlds, const InputNormaliser& normaliser) = 0;

  /// Takes in an episode of worlds elsewhere, whose policy was some steps older. Throws std::logic_error if it cannot
  /// learn from that.
  virtual void add(const EpisodeView& episode);

  /// Whether so little has been taken in that the policy does not act yet.
  [[nodiscard]] virtual bool warming_up() const { return false; }

  /// Takes the gradient steps that are due.
  virtual void learn(const Collector& worlds, const InputNormaliser& normaliser, Halves& halves, LearnStats& stats) = 0;

  /// From now on learning rates are `scale` times the config's.
  void scale_rates(float scale) { rate_scale_ = scale; }

  /// All that `load` needs to go on exactly. Without the replay an off-policy learner begins to fill it anew.
  virtual void save(ArchiveWriter& out, bool with_replay) const = 0;
  virtual void load(ArchiveReader& in) = 0;

 protected:
  [[nodiscard]] float rate_scale() const { return rate_scale_; }

 private:
  float rate_scale_ = 1;
};

/// The learner that `config.algorithm` names, for the worlds of `envs`, which it may look at, and a network input of
/// `input_dim` numbers. Throws std::invalid_argument if it cannot learn this kind of environment, or if there are eyes
/// and it is blind.
[[nodiscard]] std::unique_ptr<Learner> make_learner(const EnvBatch& envs, int input_dim, const TrainerConfig& config,
                                                    const std::vector<Eye>& eyes);

}  // namespace manyhands::learn
