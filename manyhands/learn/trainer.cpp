#include "manyhands/learn/trainer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <stdexcept>

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

std::span<const float> floats(const Matrix<float>& matrix) {
  return {matrix.data(), static_cast<std::size_t>(matrix.size())};
}

}  // namespace

Trainer::Trainer(EnvBatch& envs, EnvBatch* evaluation, const TrainerConfig& config, Expert* expert)
    : config_(validated(config)),
      spec_(envs.spec()),
      evaluation_(evaluation),
      collector_(envs, wanted_expert(expert, config_, spec_), config.seed),
      replay_(empty_replay(spec_, config)),
      minibatch_(replay_.make_minibatch(config.batch_size)),
      normaliser_(spec_.observation_dim, spec_.goal_dim, config.input_clip, config.differences),
      agent_(normaliser_.dim(), spec_.action_dim, config_),
      halves_(std::make_unique<Halves>(config.num_threads)),
      acting_(agent_.actor().make_tape(envs.num_envs())),
      actions_(Matrix<float>::Zero(spec_.action_dim, envs.num_envs())) {
  if (evaluation == &envs) throw std::invalid_argument("Trainer: the evaluation batch must not be the training batch");
  if (evaluation != nullptr) require_same_task(*evaluation);
}

TrainMetrics Trainer::advance(int iterations) {
  Losses losses;
  for (int i = 0; i < iterations && !metrics_.solved; ++i) {
    collect();
    if (replay_.size() >= config_.warmup_transitions) learn(losses);
    ++metrics_.iterations;
    if (evaluation_ != nullptr && metrics_.gradient_steps > 0 &&
        metrics_.iterations % config_.evaluation_interval == 0) {
      check_progress();
    }
  }
  metrics_.critic_loss = losses.critic / std::max(losses.critic_steps, 1);
  metrics_.q_mean = losses.q / std::max(losses.critic_steps, 1);
  metrics_.policy_q_mean = losses.policy_q / std::max(losses.policy_steps, 1);
  return metrics_;
}

void Trainer::collect() {
  const Stopwatch stopwatch(metrics_.collect_seconds);
  choose_actions();
  collector_.step(floats(actions_));
  for (const int world : collector_.finished()) store(world);
  collector_.restart_finished();
  normaliser_.refresh();
  metrics_.env_steps += collector_.envs().num_envs();
}

ReplayBuffer Trainer::empty_replay(const EnvSpec& spec, const TrainerConfig& config) {
  return {spec, config.replay_capacity, config.wants_expert() ? spec.action_dim : 0};
}

/// The policy's action plus noise, or now and then, and during the warm-up always, a uniform one. Where the expert
/// acts, its action plus noise: what it shows then leads back to its way, too (Laskey et al., DART, 2017).
void Trainer::choose_actions() {
  act(collector_.envs(), acting_);
  const bool warming_up = replay_.size() < config_.warmup_transitions;
  const Eigen::Index worlds = actions_.cols();
  const bool all_led = config_.expert_rate > 0 && warming_up;
  const Eigen::Index led = all_led ? worlds : std::lround(config_.expert_rate * static_cast<double>(worlds));
  Random random(config_.seed, Purpose::kExploration, static_cast<std::uint64_t>(metrics_.iterations));
  for (Eigen::Index world = 0; world < worlds; ++world) {
    const bool random_now = random.uniform() < static_cast<float>(config_.random_action_rate);
    const bool uniform = world >= led && (warming_up || random_now);
    const float* wanted = world < led ? &collector_.advice()[static_cast<std::size_t>(world * actions_.rows())]
                                      : acting_.output().col(world).data();
    for (Eigen::Index k = 0; k < actions_.rows(); ++k) {
      const float chosen = wanted[k] + config_.exploration_noise * random.normal();
      actions_(k, world) = uniform ? random.uniform(-1.0f, 1.0f) : std::clamp(chosen, -1.0f, 1.0f);
    }
  }
}

void Trainer::store(int world) {
  const EpisodeView episode = collector_.episode(world);
  replay_.add(episode);
  for (int t = 0; t < episode.length; ++t) {
    normaliser_.add(episode.observation.data() + t * spec_.observation_dim,
                    episode.achieved_goal.data() + t * spec_.goal_dim, episode.desired_goal.data());
  }
  const std::uint8_t success = collector_.succeeded(world) ? 1 : 0;
  const auto at = static_cast<std::size_t>(metrics_.episodes++ % kRecentEpisodes);
  if (at >= recent_successes_.size()) recent_successes_.resize(at + 1);
  recent_successes_[at] = success;
  metrics_.success_rate = static_cast<double>(std::accumulate(recent_successes_.begin(), recent_successes_.end(), 0)) /
                          static_cast<double>(recent_successes_.size());
}

void Trainer::learn(Losses& losses) {
  const Stopwatch stopwatch(metrics_.learn_seconds);
  const auto horizon = static_cast<float>(1.0 / (1.0 - config_.gamma));
  const ValueBounds bounds = {.low = replay_.lowest_reward() * horizon, .high = replay_.highest_reward() * horizon};
  for (int i = 0; i < config_.updates_per_iteration; ++i) {
    replay_.sample(collector_.envs(), {config_.hindsight_fraction, config_.success_terminates},
                   Random(config_.seed, Purpose::kSampling, static_cast<std::uint64_t>(metrics_.gradient_steps)),
                   minibatch_);
    halves_->run([&](int half) { fill_half(half); });
    const UpdateStats stats = agent_.update(*halves_, bounds);
    if (!std::isfinite(stats.critic_loss) || !std::isfinite(stats.policy_q)) {
      throw std::runtime_error("Trainer: training diverged after " + std::to_string(metrics_.gradient_steps) +
                               " gradient steps (the loss is not finite); try smaller learning rates");
    }
    ++metrics_.gradient_steps;
    losses.critic += static_cast<double>(stats.critic_loss);
    losses.q += static_cast<double>(stats.q);
    ++losses.critic_steps;
    if (!stats.policy_updated) continue;
    losses.policy_q += static_cast<double>(stats.policy_q);
    ++losses.policy_steps;
  }
}

/// Normalises every second column of the mini-batch into one half, so that both hold old and new goals alike.
void Trainer::fill_half(int half) {
  AgentBatch& to = agent_.half(half);
  for (Eigen::Index column = 0; column < to.reward.size(); ++column) {
    const Eigen::Index i = 2 * column + half;
    const float* goal = minibatch_.desired_goal.col(i).data();
    normaliser_.write(minibatch_.observation.col(i).data(), minibatch_.achieved_goal.col(i).data(), goal,
                      to.state.col(column).data());
    normaliser_.write(minibatch_.next_observation.col(i).data(), minibatch_.next_achieved_goal.col(i).data(), goal,
                      to.next_state.col(column).data());
    to.action.col(column) = minibatch_.action.col(i);
    if (minibatch_.advice.rows() > 0) {
      to.advice.col(column) = minibatch_.advice.col(i);
      to.advised[column] = i < minibatch_.relabelled ? 0.0f : 1.0f;
    }
    to.reward[column] = minibatch_.reward[i];
    to.discount[column] = minibatch_.done[static_cast<std::size_t>(i)] != 0 ? 0.0f : static_cast<float>(config_.gamma);
  }
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

/// The policy's action for every world, in tape.output().
void Trainer::act(const EnvBatch& envs, MlpTape<float>& tape) const {
  for (int world = 0; world < envs.num_envs(); ++world) {
    normaliser_.write(envs.observation().data() + world * spec_.observation_dim,
                      envs.achieved_goal().data() + world * spec_.goal_dim,
                      envs.desired_goal().data() + world * spec_.goal_dim, tape.input().col(world).data());
  }
  agent_.actor().forward(tape);
}

EvalResult Trainer::evaluate(EnvBatch& envs, int episodes, std::uint64_t first_seed) const {
  require_same_task(envs);
  if (episodes <= 0) throw std::invalid_argument("Trainer::evaluate: episodes must be positive");
  const auto worlds = static_cast<std::size_t>(envs.num_envs());
  const auto wanted = static_cast<std::size_t>(episodes);
  MlpTape<float> tape = agent_.actor().make_tape(envs.num_envs());
  std::vector<std::uint64_t> seeds(worlds);
  std::vector<std::uint8_t> running(worlds);
  double successes = 0, total_reward = 0, steps = 0;
  for (std::size_t done = 0; done < wanted; done += worlds) {
    std::iota(seeds.begin(), seeds.end(), first_seed + done);
    std::size_t left = std::min(worlds, wanted - done);
    for (std::size_t w = 0; w < worlds; ++w) running[w] = w < left;
    envs.reset({}, seeds);
    for (int t = 1; left > 0; ++t) {
      act(envs, tape);
      envs.step(floats(tape.output()));
      for (std::size_t w = 0; w < worlds; ++w) {
        if (running[w] == 0) continue;
        total_reward += static_cast<double>(envs.reward()[w]);
        ++steps;
        if (envs.terminated()[w] == 0 && envs.truncated()[w] == 0 && t < spec_.max_episode_steps) continue;
        running[w] = 0;
        --left;
        successes += envs.is_success()[w];
      }
    }
  }
  return {episodes, successes / episodes, total_reward / episodes, steps / episodes};
}

Policy Trainer::policy() const {
  const auto copied = [](const auto& m) { return std::vector<float>(m.data(), m.data() + m.size()); };
  const Mlp<float>& actor = agent_.actor();
  Policy policy = {.observation_dim = spec_.observation_dim,
                   .goal_dim = spec_.goal_dim,
                   .action_dim = spec_.action_dim,
                   .mean = copied(normaliser_.mean()),
                   .scale = copied(normaliser_.scale()),
                   .clip = normaliser_.clip(),
                   .differences = normaliser_.differences(),
                   .layers = {}};
  for (int layer = 0; layer < actor.num_layers(); ++layer) {
    const Matrix<float> row_major = actor.weight(layer).transpose();
    policy.layers.push_back({.inputs = static_cast<int>(actor.weight(layer).cols()),
                             .outputs = static_cast<int>(actor.weight(layer).rows()),
                             .weight = copied(row_major),
                             .bias = copied(actor.bias(layer))});
  }
  return policy;
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
