// Learning from everything that has happened: a replay with hindsight, and an agent that learns from it.
#pragma once

#include "manyhands/learn/agent.h"
#include "manyhands/learn/exploration.h"
#include "manyhands/learn/learner.h"
#include "manyhands/learn/privileged_input.h"
#include "manyhands/learn/replay.h"

namespace manyhands::learn {

/// DDPG, TD3, SAC and TQC, with an expert's advice if the config wants it, and DAgger.
class OffPolicy final : public Learner {
 public:
  OffPolicy(const EnvSpec& spec, int num_worlds, int input_dim, const TrainerConfig& config);

  [[nodiscard]] const Actor* actor() const override { return &agent_.actor(); }
  [[nodiscard]] std::int64_t gradient_steps() const override { return agent_.gradient_steps(); }
  [[nodiscard]] bool warming_up() const override { return replay_.size() < config_.warmup_transitions; }

  void choose_actions(const Collector& worlds, const InputNormaliser& normaliser, std::int64_t iteration,
                      Matrix<float>& action) override;
  void add(const EpisodeView& episode) override;
  void observe(const Collector& worlds, const InputNormaliser& normaliser) override;
  void learn(const Collector& worlds, const InputNormaliser& normaliser, Halves& halves, LearnStats& stats) override;

  void save(ArchiveWriter& out, bool with_replay) const override;
  void load(ArchiveReader& in) override;

 private:
  void fill_half(const InputNormaliser& normaliser, int half);

  TrainerConfig config_;
  PrivilegedInput privileged_;
  ReplayBuffer replay_;
  Minibatch minibatch_;
  Agent agent_;
  StateExploration exploration_;
};

}  // namespace manyhands::learn
