#include "manyhands/learn/collector.h"

#include <algorithm>

#include "manyhands/learn/random.h"

namespace manyhands::learn {

Collector::Collector(EnvBatch& envs, Expert* expert, std::uint64_t seed)
    : envs_(envs),
      expert_(expert),
      seed_(seed),
      worlds_(static_cast<std::size_t>(envs.num_envs())),
      no_(static_cast<std::size_t>(envs.spec().observation_dim)),
      ng_(static_cast<std::size_t>(envs.spec().goal_dim)),
      na_(static_cast<std::size_t>(envs.spec().action_dim)),
      max_steps_(static_cast<std::size_t>(envs.spec().max_episode_steps)) {
  tracks_.resize(worlds_);
  observation_.resize(worlds_ * (max_steps_ + 1) * no_);
  achieved_.resize(worlds_ * (max_steps_ + 1) * ng_);
  desired_.resize(worlds_ * ng_);
  action_.resize(worlds_ * max_steps_ * na_);
  reward_.resize(worlds_ * max_steps_);
  if (expert != nullptr) {
    advice_.resize(action_.size());
    advice_now_.resize(worlds_ * na_);
  }
  mask_.resize(worlds_);
  seeds_.resize(worlds_);
  finished_.reserve(worlds_);
  std::ranges::fill(mask_, std::uint8_t{1});
  begin(mask_);
}

std::uint64_t Collector::episode_seed(std::size_t world) const {
  return derive_seed(derive_seed(seed_, Purpose::kWorldSeed, world), Purpose::kEpisodeSeed, tracks_[world].number);
}

void Collector::begin(std::span<const std::uint8_t> mask) {
  for (std::size_t w = 0; w < worlds_; ++w) seeds_[w] = episode_seed(w);
  envs_.reset(mask, seeds_);
  for (std::size_t w = 0; w < worlds_; ++w) {
    if (mask[w] == 0) continue;
    tracks_[w] = {.number = tracks_[w].number};
    std::copy_n(envs_.desired_goal().data() + w * ng_, ng_, desired_.data() + w * ng_);
    record_state(w);
  }
  ask_expert();
}

/// Once in every state, in turn: an expert may remember.
void Collector::ask_expert() {
  if (expert_ != nullptr) expert_->act(envs_, advice_now_);
}

void Collector::record_state(std::size_t world) {
  const std::size_t row = world * (max_steps_ + 1) + static_cast<std::size_t>(tracks_[world].length);
  std::copy_n(envs_.observation().data() + world * no_, no_, observation_.data() + row * no_);
  std::copy_n(envs_.achieved_goal().data() + world * ng_, ng_, achieved_.data() + row * ng_);
}

void Collector::step(std::span<const float> action) {
  envs_.step(action);
  finished_.clear();
  for (std::size_t w = 0; w < worlds_; ++w) {
    Track& track = tracks_[w];
    const std::size_t row = w * max_steps_ + static_cast<std::size_t>(track.length);
    std::copy_n(action.data() + w * na_, na_, action_.data() + row * na_);
    if (expert_ != nullptr) std::copy_n(advice_now_.data() + w * na_, na_, advice_.data() + row * na_);
    reward_[row] = envs_.reward()[w];
    ++track.length;
    record_state(w);
    track.terminated = envs_.terminated()[w] != 0;
    track.success = envs_.is_success()[w] != 0;
    const bool full = static_cast<std::size_t>(track.length) == max_steps_;
    if (track.terminated || envs_.truncated()[w] != 0 || full) finished_.push_back(static_cast<int>(w));
  }
}

EpisodeView Collector::episode(int world) const {
  const auto w = static_cast<std::size_t>(world);
  const auto length = static_cast<std::size_t>(tracks_[w].length);
  const std::size_t randomized = envs_.spec().randomized.size();
  const auto rows = [&](const std::vector<float>& data, std::size_t most, std::size_t count, std::size_t width) {
    return std::span(data).subspan(w * most * width, count * width);
  };
  return {.length = tracks_[w].length,
          .terminated = tracks_[w].terminated,
          .observation = rows(observation_, max_steps_ + 1, length + 1, no_),
          .achieved_goal = rows(achieved_, max_steps_ + 1, length + 1, ng_),
          .desired_goal = rows(desired_, 1, 1, ng_),
          .action = rows(action_, max_steps_, length, na_),
          .reward = rows(reward_, max_steps_, length, 1),
          .advice = expert_ != nullptr ? rows(advice_, max_steps_, length, na_) : std::span<const float>(),
          .randomized = envs_.randomized().subspan(w * randomized, randomized)};
}

bool Collector::succeeded(int world) const { return tracks_[static_cast<std::size_t>(world)].success; }

void Collector::restart_finished() {
  if (finished_.empty()) return ask_expert();
  std::ranges::fill(mask_, std::uint8_t{0});
  for (const int world : finished_) {
    mask_[static_cast<std::size_t>(world)] = 1;
    ++tracks_[static_cast<std::size_t>(world)].number;
  }
  begin(mask_);
  finished_.clear();
}

void Collector::save(ArchiveWriter& out) const {
  out.value(seed_);
  for (std::size_t w = 0; w < worlds_; ++w) {
    const EpisodeView running = episode(static_cast<int>(w));
    out.value(tracks_[w].number);
    out.value(running.length);
    out.array(running.action);
  }
  out.value(envs_.state_hash());
}

Collector::Running Collector::read(ArchiveReader& in) const {
  Running running;
  in.value(running.seed);
  running.number.resize(worlds_);
  running.length.resize(worlds_);
  running.action.resize(action_.size());
  for (std::size_t w = 0; w < worlds_; ++w) {
    in.value(running.number[w]);
    in.value(running.length[w]);
    const auto length = static_cast<std::size_t>(running.length[w]);
    in.check(running.length[w] >= 0 && length < max_steps_, "a running episode has a wrong length");
    in.array(std::span(running.action).subspan(w * max_steps_ * na_, length * na_));
  }
  in.value(running.state_hash);
  return running;
}

bool Collector::restore(const Running& running) {
  seed_ = running.seed;
  for (std::size_t w = 0; w < worlds_; ++w) tracks_[w] = {.number = running.number[w]};
  play_again(running);
  if (envs_.state_hash() == running.state_hash) return true;
  for (Track& track : tracks_) ++track.number;
  std::ranges::fill(mask_, std::uint8_t{1});
  begin(mask_);
  return false;
}

/// Worlds start late, so that all arrive together; until its start a world is held at the reset.
void Collector::play_again(const Running& running) {
  const int longest = std::ranges::max(running.length);
  std::vector<float> now(worlds_ * na_);
  for (int t = 0; t <= longest; ++t) {
    for (std::size_t w = 0; w < worlds_; ++w) {
      const int own = t - (longest - running.length[w]);
      mask_[w] = own <= 0;
      if (own < 0 || own >= running.length[w]) continue;
      const std::size_t row = w * max_steps_ + static_cast<std::size_t>(own);
      std::copy_n(running.action.data() + row * na_, na_, now.data() + w * na_);
    }
    begin(mask_);
    if (t < longest) step(now);
  }
  finished_.clear();
}

}  // namespace manyhands::learn
