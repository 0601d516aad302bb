#include "manyhands/learn/trainer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "manyhands/learn/parameters.h"
#include "manyhands/learn/random.h"

namespace manyhands::learn {

namespace {

TrainerConfig validated(TrainerConfig config) {
  config.validate();
  return config;
}

/// The expert if it is wanted, else null.
Expert* wanted_expert(Expert* expert, const TrainerConfig& config, const EnvSpec& spec) {
  if (!config.wants_expert()) return nullptr;
  if (expert != nullptr && expert->action_dim() == spec.action_dim) return expert;
  throw std::invalid_argument("Trainer: expert_rate and cloning_weight ask for an expert of " + spec.id +
                              ", and none was given; set both to 0");
}

/// Adds the seconds of its scope to a counter.
class Stopwatch {
 public:
  explicit Stopwatch(double& seconds) : seconds_(seconds) {}
  ~Stopwatch() { seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double& seconds_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace

Trainer::Trainer(EnvBatch& envs, EnvBatch* evaluation, const TrainerConfig& config, Expert* expert,
                 const std::vector<Eye>& eyes)
    : config_(validated(config)),
      spec_(envs.spec()),
      evaluation_(evaluation),
      eyes_(eyes),
      collector_(envs, wanted_expert(expert, config_, spec_), config.seed),
      normaliser_(spec_.observation_dim, spec_.goal_dim, config.input_clip, config.relations()),
      learner_(make_learner(envs, normaliser_.dim(), config_, eyes_)),
      halves_(std::make_unique<Halves>(config.num_threads)),
      actions_(Matrix<float>::Zero(spec_.action_dim, envs.num_envs())) {
  if (evaluation == &envs) throw std::invalid_argument("Trainer: the evaluation batch must not be the training batch");
  if (evaluation != nullptr) require_same_task(*evaluation);
}

TrainMetrics Trainer::advance(int iterations) {
  if (!rounds_.shares.empty())
    throw std::logic_error("Trainer::advance: the worlds run elsewhere; see Trainer::spread");
  LearnStats stats;
  for (int i = 0; i < iterations && !metrics_.solved; ++i) {
    collect();
    learn_once(stats);
  }
  return report(stats);
}

void Trainer::scale_rates(float scale) {
  if (!(scale >= 0 && std::isfinite(scale))) {
    throw std::invalid_argument("Trainer: learning rates cannot be " + std::to_string(scale) +
                                " times what they were, expected a finite number that is not negative");
  }
  learner_->scale_rates(scale);
}

TrainMetrics Trainer::report(const LearnStats& stats) {
  metrics_.critic_loss = stats.critic_loss / std::max(stats.steps, 1);
  metrics_.q_mean = stats.q / std::max(stats.steps, 1);
  metrics_.policy_q_mean = stats.policy_q / std::max(stats.policy_steps, 1);
  metrics_.entropy = stats.entropy / std::max(stats.policy_steps, 1);
  return metrics_;
}

void Trainer::collect() {
  const Stopwatch stopwatch(metrics_.collect_seconds);
  learner_->choose_actions(collector_, normaliser_, metrics_.iterations, actions_);
  collector_.step(floats(actions_));
  learner_->observe(collector_, normaliser_);
  for (const int world : collector_.finished()) count_episode(collector_.episode(world), collector_.succeeded(world));
  collector_.restart_finished();
  normaliser_.refresh();
  metrics_.env_steps += collector_.envs().num_envs();
}

/// One iteration's gradient steps, and the evaluation if one is due.
void Trainer::learn_once(LearnStats& stats) {
  {
    const Stopwatch stopwatch(metrics_.learn_seconds);
    learner_->learn(collector_, normaliser_, *halves_, stats);
    metrics_.gradient_steps = learner_->gradient_steps();
  }
  ++metrics_.iterations;
  if (evaluation_ != nullptr && metrics_.gradient_steps > 0 && metrics_.iterations % config_.evaluation_interval == 0) {
    check_progress();
  }
}

/// Adds a finished episode to the statistics.
void Trainer::count_episode(const EpisodeView& episode, bool succeeded) {
  for (int t = 0; t < episode.length; ++t) {
    normaliser_.add(episode.observation.data() + t * spec_.observation_dim,
                    episode.achieved_goal.data() + t * spec_.goal_dim, episode.desired_goal.data());
  }
  const auto at = static_cast<std::size_t>(metrics_.episodes++ % kRecentEpisodes);
  if (at >= recent_successes_.size()) {
    recent_successes_.resize(at + 1);
    recent_returns_.resize(at + 1);
  }
  recent_successes_[at] = succeeded ? 1 : 0;
  recent_returns_[at] = std::accumulate(episode.reward.begin(), episode.reward.end(), 0.0f);
  const auto mean = [](const auto& ring) {
    return std::accumulate(ring.begin(), ring.end(), 0.0) / static_cast<double>(ring.size());
  };
  metrics_.success_rate = mean(recent_successes_);
  metrics_.mean_return = mean(recent_returns_);
}

void Trainer::check_progress() {
  const Stopwatch stopwatch(metrics_.evaluate_seconds);
  const std::uint64_t first_seed =
      derive_seed(config_.seed, Purpose::kEvaluationSeed, static_cast<std::uint64_t>(metrics_.evaluations));
  const EvalResult result = evaluate(*evaluation_, config_.evaluation_episodes, first_seed);
  ++metrics_.evaluations;
  metrics_.evaluation_success_rate = result.success_rate;
  metrics_.streak = result.success_rate >= config_.stop_success_rate ? metrics_.streak + 1 : 0;
  metrics_.solved = config_.stop_streak > 0 && metrics_.streak >= config_.stop_streak;
}

EvalResult Trainer::evaluate(EnvBatch& envs, int episodes, std::uint64_t first_seed) const {
  require_same_task(envs);
  const std::unique_ptr<Performer> performer = learner_->performer(envs, normaliser_);
  return evaluate_policy(envs, *performer, episodes, first_seed);
}

Policy Trainer::policy() const { return learner_->policy(spec_, normaliser_); }

void Trainer::predict(std::span<const float> observation, std::span<const float> achieved_goal,
                      std::span<const float> desired_goal, bool draw, std::span<float> action) {
  if (learner_->actor() == nullptr) throw std::logic_error("Trainer::predict: this policy sees pictures; export it");
  const auto no = static_cast<std::size_t>(spec_.observation_dim), ng = static_cast<std::size_t>(spec_.goal_dim);
  const std::size_t n = action.size() / static_cast<std::size_t>(spec_.action_dim);
  if (observation.size() != n * no || achieved_goal.size() != n * ng || desired_goal.size() != n * ng) {
    throw std::invalid_argument("Trainer::predict: the arrays do not hold " + std::to_string(n) + " states of " +
                                spec_.id);
  }
  const Actor& actor = *learner_->actor();
  MlpTape<float> tape = actor.make_tape(static_cast<int>(n));
  for (std::size_t i = 0; i < n; ++i) {
    normaliser_.write(observation.data() + i * no, achieved_goal.data() + i * ng, desired_goal.data() + i * ng,
                      tape.input().col(static_cast<Eigen::Index>(i)).data());
  }
  Matrix<float> chosen = Matrix<float>::Zero(spec_.action_dim, static_cast<Eigen::Index>(n));
  if (draw) {
    actor.draw(tape, Random(config_.seed, Purpose::kPrediction, predictions_++), chosen);
  } else {
    actor.act(tape, chosen);
  }
  std::copy_n(chosen.data(), chosen.size(), action.data());
}

void Trainer::require_same_task(const EnvBatch& envs) const {
  const EnvSpec& other = envs.spec();
  if (other.id == spec_.id && other.observation_dim == spec_.observation_dim && other.goal_dim == spec_.goal_dim &&
      other.action_dim == spec_.action_dim) {
    return;
  }
  throw std::invalid_argument("Trainer: it trains on " + spec_.id + ", but was given an evaluation batch of " +
                              other.id + "; make both from the same id");
}

}  // namespace manyhands::learn
