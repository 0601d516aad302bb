#include "manyhands/learn/picture_cloning.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "manyhands/learn/parameters.h"

namespace manyhands::learn {

namespace {

/// The first layer sees each pixel once, as coarse as it may be: it costs most, and textures do not matter. The others
/// overlap.
std::vector<Convolution> convolutions(const std::vector<int>& channels) {
  std::vector<Convolution> layers;
  for (const int count : channels) {
    const bool is_first = layers.empty();
    layers.push_back({.channels = count, .kernel = is_first ? 4 : 3, .stride = is_first ? 4 : 2});
  }
  return layers;
}

PictureNetShape net_shape(const EnvSpec& spec, int z_dim, const TrainerConfig& config, const Sight& sight) {
  if (spec.robot_dim == 0) {
    throw std::invalid_argument(spec.id + " does not say which numbers a robot knows of itself, which a policy that " +
                                "sees is given beside pictures; only environments of this package do");
  }
  return {.eyes = sight.num_eyes(),
          .pictures = {.height = sight.height(), .width = sight.width(), .stack = config.frame_stack},
          .layers = convolutions(config.channels),
          .own = spec.robot_dim,
          .hidden_layers = config.hidden_layers,
          .outputs = spec.action_dim + z_dim};
}

/// Sees the worlds of its batch anew.
class PicturePerformer final : public Performer {
 public:
  PicturePerformer(const EnvBatch& envs, const InputNormaliser& normaliser, const PictureNet<float>& net,
                   const std::vector<Eye>& eyes, const StateRow& layout, const TrainerConfig& config)
      : envs_(envs),
        normaliser_(normaliser),
        layout_(layout),
        sight_(envs, eyes, config.num_threads),
        memory_(sight_, envs.num_envs(), config.frame_stack, config.frame_stack, layout.size()),
        actor_(net, layout, envs.spec().robot_dim, normaliser.dim(), envs.num_envs(), config.num_threads),
        steps_(static_cast<std::size_t>(envs.num_envs())) {}

  void act(int step, std::span<const std::uint8_t> running, Matrix<float>& action) override {
    layout_.fill(envs_, rows_);
    std::ranges::fill(steps_, step);
    memory_.add(steps_, rows_, running);
    actor_.act(memory_, normaliser_, running, action);
  }

 private:
  const EnvBatch& envs_;
  const InputNormaliser& normaliser_;
  StateRow layout_;
  Sight sight_;
  PictureMemory memory_;
  PictureActor actor_;
  std::vector<float> rows_;
  std::vector<int> steps_;
};

}  // namespace

PictureCloning::PictureCloning(const EnvBatch& envs, int z_dim, const TrainerConfig& config,
                               const std::vector<Eye>& eyes)
    : spec_(envs.spec()),
      config_(config),
      eyes_(eyes),
      layout_{spec_.observation_dim, spec_.goal_dim, spec_.action_dim},
      z_dim_(z_dim),
      sight_(envs, eyes, config.num_threads),
      memory_(sight_, envs.num_envs(), config.replay_capacity / envs.num_envs(), config.frame_stack, layout_.size(),
              config.replay_folder),
      net_(net_shape(spec_, z_dim, config, sight_)),
      average_(net_),
      actor_(average_, layout_, spec_.robot_dim, z_dim, envs.num_envs(), config.num_threads),
      exploration_(config, 0, envs.num_envs()),
      steps_(static_cast<std::size_t>(envs.num_envs())),
      policy_action_(Matrix<float>::Zero(spec_.action_dim, envs.num_envs())) {
  net_.initialise(config.seed);
  for (int part = 0; part < net_.num_parts(); ++part) {
    average_.parameters(part) = net_.parameters(part);
    optimisers_.emplace_back(static_cast<int>(net_.parameters(part).size()), config.actor_learning_rate);
  }
  const int count = config.batch_size / 2;
  for (Half& half : halves_) {
    half.batch = {net_.make_tape(count), Matrix<float>::Zero(z_dim, count)};
    for (int part = 0; part < net_.num_parts(); ++part) half.gradient.push_back(net_.parameters(part));
  }
}

std::unique_ptr<Performer> PictureCloning::performer(const EnvBatch& envs, const InputNormaliser& normaliser) const {
  const StateRow without_advice{spec_.observation_dim, spec_.goal_dim, 0};
  return std::make_unique<PicturePerformer>(envs, normaliser, average_, eyes_, without_advice, config_);
}

Policy PictureCloning::policy(const EnvSpec& spec, const InputNormaliser& normaliser) const {
  return export_policy(spec, normaliser, average_);
}

void PictureCloning::choose_actions(const Collector& worlds, const InputNormaliser& normaliser, std::int64_t iteration,
                                    Matrix<float>& action) {
  layout_.fill(worlds.envs(), rows_);
  for (int world = 0; world < worlds.envs().num_envs(); ++world) {
    steps_[static_cast<std::size_t>(world)] = worlds.episode(world).length;
    std::copy_n(worlds.advice().data() + world * spec_.action_dim, spec_.action_dim,
                rows_.data() + (world + 1) * layout_.size() - spec_.action_dim);
  }
  memory_.add(steps_, rows_);
  actor_.act(memory_, normaliser, {}, policy_action_);
  exploration_.vary(policy_action_, worlds.advice(), iteration, warming_up(), action);
}

void PictureCloning::learn(const Collector& /*worlds*/, const InputNormaliser& normaliser, Halves& halves,
                           LearnStats& stats) {
  if (warming_up()) return;
  for (int i = 0; i < config_.updates_per_iteration; ++i) {
    halves.run([&](int half) { compute_gradient(normaliser, half); });
    const float rates = rate_scale() * config_.rate_scale(gradient_steps());
    for (Adam<float>& optimiser : optimisers_) optimiser.begin_step(rates);
    halves.run([&](int part) { apply(part); });
    if (!std::isfinite(halves_[0].loss + halves_[1].loss)) {
      throw std::runtime_error("Trainer: training diverged after " + std::to_string(gradient_steps() - 1) +
                               " gradient steps (the loss is not finite); try a smaller learning rate");
    }
    stats.critic_loss += (halves_[0].action_error + halves_[1].action_error) / (config_.batch_size * spec_.action_dim);
    ++stats.steps;
  }
}

/// Of the mean over the batch, from rows that this half draws by itself.
void PictureCloning::compute_gradient(const InputNormaliser& normaliser, int half) {
  Half& own = halves_[static_cast<std::size_t>(half)];
  Random random(config_.seed, Purpose::kSampling, static_cast<std::uint64_t>(2 * gradient_steps() + half));
  const auto off = [&] {
    return static_cast<int>(random.below(2 * static_cast<unsigned>(config_.shift) + 1)) - config_.shift;
  };
  std::vector<const float*> advice;
  for (Eigen::Index sample = 0; sample < own.batch.z.cols(); ++sample) {
    const int row = static_cast<int>(random.below(static_cast<unsigned>(memory_.size())));
    own.batch.set(sample, memory_, row, layout_, spec_.robot_dim, normaliser);
    advice.push_back(memory_.numbers(row) + layout_.size() - spec_.action_dim);
    for (EncoderTape<float>& eye : own.batch.tape.eyes) {
      const int x = off(), y = off();
      eye.shifts[static_cast<std::size_t>(sample)] = {x, y};
    }
  }
  net_.forward(own.batch.tape);
  own.action_error = own.loss = 0;
  for (Eigen::Index sample = 0; sample < own.batch.z.cols(); ++sample) {
    compute_loss(own, sample, advice[static_cast<std::size_t>(sample)]);
  }
  net_.backward(own.batch.tape, own.gradient);
}

/// Adds a sample's squared errors, and writes their gradient by the network's output.
void PictureCloning::compute_loss(Half& own, Eigen::Index sample, const float* advice) const {
  const auto output = own.batch.tape.head.output().col(sample);
  auto slope = own.batch.tape.head.output_gradient().col(sample);
  const float weight = 2 * config_.cloning_weight / static_cast<float>(config_.batch_size * spec_.action_dim);
  for (int k = 0; k < spec_.action_dim; ++k) {
    const float action = std::tanh(output[k]), error = action - advice[k];
    own.action_error += static_cast<double>(error * error);
    slope[k] = weight * error * (1 - action * action);
  }
  const auto state_error = output.tail(z_dim_) - own.batch.z.col(sample);
  slope.tail(z_dim_) = 2 * config_.state_weight / static_cast<float>(config_.batch_size * z_dim_) * state_error;
  own.loss += own.action_error + static_cast<double>(state_error.squaredNorm());
}

/// Adds the gradients of both halves, in fixed order, and moves one of two parts of all parameters.
void PictureCloning::apply(int part) {
  for (int piece = 0; piece < net_.num_parts(); ++piece) {
    const auto p = static_cast<std::size_t>(piece);
    Vector<float>& gradient = halves_[0].gradient[p];
    const auto [begin, end] = part_of(static_cast<int>(gradient.size()), part);
    gradient.segment(begin, end - begin) += halves_[1].gradient[p].segment(begin, end - begin);
    optimisers_[p].apply(net_.parameters(piece), gradient, begin, end);
    polyak_average(average_.parameters(piece), net_.parameters(piece), config_.target_rate, begin, end);
  }
}

void PictureCloning::save(ArchiveWriter& out, bool with_replay) const {
  for (int part = 0; part < net_.num_parts(); ++part) {
    out.array(floats(net_.parameters(part)));
    out.array(floats(average_.parameters(part)));
    save_optimiser(optimisers_[static_cast<std::size_t>(part)], out);
  }
  out.value(with_replay);
  if (with_replay) memory_.save(out);
}

void PictureCloning::load(ArchiveReader& in) {
  for (int part = 0; part < net_.num_parts(); ++part) {
    in.array(floats(net_.parameters(part)));
    in.array(floats(average_.parameters(part)));
    load_optimiser(optimisers_[static_cast<std::size_t>(part)], in);
  }
  if (in.value<bool>()) memory_.load(in);
}

}  // namespace manyhands::learn
