// Learning to act from pictures, from a script that sees the state (Ross et al., DAgger, 2011).
#pragma once

#include <array>
#include <memory>

#include "manyhands/learn/exploration.h"
#include "manyhands/learn/learner.h"
#include "manyhands/learn/picture_actor.h"

namespace manyhands::learn {

/// In every state that is visited the expert is asked, and the network, which sees pictures and what the robot knows of
/// itself, is drawn to its answer. It is also asked to tell the state, of which the expert's answer is made: so that it
/// learns where to look. What acts is a running mean of the network.
class PictureCloning final : public Learner {
 public:
  /// `envs` is borrowed. Throws std::invalid_argument if it does not say what a robot knows of itself.
  PictureCloning(const EnvBatch& envs, int z_dim, const TrainerConfig& config, const std::vector<Eye>& eyes);

  [[nodiscard]] const Actor* actor() const override { return nullptr; }
  [[nodiscard]] std::int64_t gradient_steps() const override { return optimisers_.front().step_count(); }
  [[nodiscard]] bool warming_up() const override { return memory_.size() < config_.warmup_transitions; }
  [[nodiscard]] std::unique_ptr<Performer> performer(const EnvBatch& envs,
                                                     const InputNormaliser& normaliser) const override;
  [[nodiscard]] Policy policy(const EnvSpec& spec, const InputNormaliser& normaliser) const override;

  void choose_actions(const Collector& worlds, const InputNormaliser& normaliser, std::int64_t iteration,
                      Matrix<float>& action) override;
  void observe(const Collector& /*worlds*/, const InputNormaliser& /*normaliser*/) override {}
  void learn(const Collector& worlds, const InputNormaliser& normaliser, Halves& halves, LearnStats& stats) override;

  void save(ArchiveWriter& out, bool with_replay) const override;
  void load(ArchiveReader& in) override;

 private:
  /// One half of the mini-batch.
  struct Half {
    PictureBatch batch;
    std::vector<Vector<float>> gradient;  // [part]
    double action_error = 0, loss = 0;
  };

  void compute_gradient(const InputNormaliser& normaliser, int half);
  void compute_loss(Half& own, Eigen::Index sample, const float* advice) const;
  void apply(int part);

  EnvSpec spec_;
  TrainerConfig config_;
  std::vector<Eye> eyes_;
  StateRow layout_;
  int z_dim_;
  Sight sight_;
  PictureMemory memory_;
  PictureNet<float> net_, average_;
  std::vector<Adam<float>> optimisers_;  // [part]
  std::array<Half, 2> halves_;
  PictureActor actor_;
  Exploration exploration_;
  std::vector<float> rows_;
  std::vector<int> steps_;
  Matrix<float> policy_action_;
};

}  // namespace manyhands::learn
