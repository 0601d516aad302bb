// What a trainer's checkpoint holds, in order.
#include "manyhands/learn/random.h"
#include "manyhands/learn/trainer.h"

namespace manyhands::learn {

namespace {

/// Counters and the stop state; losses and wall times belong to the process.
void save_counters(const TrainMetrics& metrics, ArchiveWriter& out) {
  out.value(metrics.iterations);
  out.value(metrics.env_steps);
  out.value(metrics.gradient_steps);
  out.value(metrics.episodes);
  out.value(metrics.success_rate);
  out.value(metrics.mean_return);
  out.value(metrics.evaluation_success_rate);
  out.value(metrics.evaluations);
  out.value(metrics.streak);
}

TrainMetrics load_counters(ArchiveReader& in) {
  TrainMetrics metrics;
  in.value(metrics.iterations);
  in.value(metrics.env_steps);
  in.value(metrics.gradient_steps);
  in.value(metrics.episodes);
  in.value(metrics.success_rate);
  in.value(metrics.mean_return);
  in.value(metrics.evaluation_success_rate);
  in.value(metrics.evaluations);
  in.value(metrics.streak);
  return metrics;
}

}  // namespace

/// What must agree for the arrays to mean the same.
void Trainer::save_shape(ArchiveWriter& out) const {
  out.text(spec_.id);
  for (const int dim : {spec_.observation_dim, spec_.goal_dim, spec_.action_dim, spec_.max_episode_steps, spec_.choices,
                        collector_.envs().num_envs(), static_cast<int>(config_.algorithm),
                        static_cast<int>(config_.activation), config_.num_critics, config_.num_quantiles,
                        config_.rollout_steps, config_.frame_stack, static_cast<int>(eyes_.size())}) {
    out.value(dim);
  }
  out.value(static_cast<int>(config_.hidden_layers.size()));
  for (const int units : config_.hidden_layers) out.value(units);
  out.value(static_cast<int>(config_.differences.size()));
  for (const int i : config_.differences) out.value(i);
  out.value(config_.cube_rotation);
}

void Trainer::expect_shape(ArchiveReader& in) const {
  in.expect("task", spec_.id);
  in.expect("observation length", spec_.observation_dim);
  in.expect("goal length", spec_.goal_dim);
  in.expect("action length", spec_.action_dim);
  in.expect("episode step limit", spec_.max_episode_steps);
  in.expect("number of choices", spec_.choices);
  in.expect("number of worlds", collector_.envs().num_envs());
  in.expect("algorithm", static_cast<int>(config_.algorithm));
  in.expect("activation", static_cast<int>(config_.activation));
  in.expect("number of critics", config_.num_critics);
  in.expect("number of quantiles", config_.num_quantiles);
  in.expect("rollout's steps", config_.rollout_steps);
  in.expect("frame stack", config_.frame_stack);
  in.expect("number of cameras", static_cast<int>(eyes_.size()));
  in.expect("number of hidden layers", static_cast<int>(config_.hidden_layers.size()));
  for (const int units : config_.hidden_layers) in.expect("hidden layer size", units);
  in.expect("length of differences", static_cast<int>(config_.differences.size()));
  for (const int i : config_.differences) in.expect("index in differences", i);
  in.expect("cube_rotation", config_.cube_rotation);
}

void Trainer::save(const std::filesystem::path& path, bool with_replay) const {
  ArchiveWriter out;
  save_shape(out);
  out.value(config_.seed);
  save_counters(metrics_, out);
  out.value(static_cast<int>(recent_successes_.size()));
  out.array(std::span(recent_successes_));
  out.array(std::span(recent_returns_));
  normaliser_.save(out);
  learner_->save(out, with_replay);
  collector_.save(out);
  save_rounds(out);
  out.commit(path);
}

bool Trainer::load(const std::filesystem::path& path) {
  ArchiveReader in(path);
  expect_shape(in);
  TrainerConfig config = config_;
  in.value(config.seed);
  const TrainMetrics metrics = load_counters(in);
  const int recent = in.value<int>();
  in.check(recent >= 0 && recent <= kRecentEpisodes, "it counts too many recent episodes");
  std::vector<std::uint8_t> recent_successes(static_cast<std::size_t>(recent));
  std::vector<float> recent_returns(recent_successes.size());
  in.array(std::span(recent_successes));
  in.array(std::span(recent_returns));
  InputNormaliser normaliser = normaliser_;
  normaliser.load(in);
  auto learner = make_learner(collector_.envs(), normaliser.dim(), config, eyes_);
  learner->load(in);
  const Collector::Running running = collector_.read(in);
  Rounds rounds = read_rounds(in);
  in.finish();

  config_ = std::move(config);
  metrics_ = metrics;
  metrics_.solved = config_.stop_streak > 0 && metrics_.streak >= config_.stop_streak;
  recent_successes_ = std::move(recent_successes);
  recent_returns_ = std::move(recent_returns);
  normaliser_ = std::move(normaliser);
  learner_ = std::move(learner);
  rounds_ = std::move(rounds);
  return collector_.restore(running);
}

}  // namespace manyhands::learn
