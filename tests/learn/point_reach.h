// A kinematic stand-in for PandaReach: a point that follows velocity commands with a lag.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <random>
#include <span>
#include <stdexcept>
#include <vector>

#include "manyhands/envs/env_batch.h"

namespace manyhands::learn {

/// Observation [position, velocity]; goals uniform in a box of side 0.3 m; the command moves up to 5 cm per step, of
/// which the point does half in the first step; reward -1, or 0 within 5 cm, which also ends the episode.
class PointReach final : public EnvBatch {
 public:
  explicit PointReach(int worlds, double reproducibility = 1.0)
      : worlds_(worlds), reproducibility_(reproducibility), states_(static_cast<std::size_t>(worlds)) {
    spec_ = {
        .id = "PointReach", .observation_dim = 6, .goal_dim = 3, .action_dim = 3, .max_episode_steps = 50, .dt = 0.04};
    const auto n = states_.size();
    observation_.resize(n * 6);
    achieved_.resize(n * 3);
    desired_.resize(n * 3);
    reward_.resize(n);
    success_.resize(n);
    terminated_.resize(n);
    truncated_.resize(n);
    for (std::size_t w = 0; w < n; ++w) states_[w].random.seed(w);
  }

  const EnvSpec& spec() const override { return spec_; }
  int num_envs() const override { return worlds_; }

  void reset(std::span<const std::uint8_t> mask, std::span<const std::uint64_t> seeds) override {
    for (std::size_t w = 0; w < states_.size(); ++w) {
      if (!mask.empty() && mask[w] == 0) continue;
      State& s = states_[w];
      if (!seeds.empty()) s.random.seed(seeds[w]);
      s.steps = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        s.position[k] = s.velocity[k] = 0.0f;
        s.goal[k] = 0.3f * (static_cast<float>(s.random() >> 40) * 0x1p-24f - 0.5f);
      }
      terminated_[w] = truncated_[w] = 0;
      publish(w);
    }
  }

  void step(std::span<const float> action) override {
    for (const float a : action) {
      if (!std::isfinite(a)) throw std::invalid_argument("PointReach: non-finite action");
    }
    for (std::size_t w = 0; w < states_.size(); ++w) {
      State& s = states_[w];
      for (std::size_t k = 0; k < 3; ++k) {
        const float command = 0.05f * std::clamp(action[3 * w + k], -1.0f, 1.0f);
        s.velocity[k] += 0.5f * (command - s.velocity[k]);
        s.position[k] += s.velocity[k] * static_cast<float>(reproducibility_);
      }
      ++s.steps;
      publish(w);
      compute_reward(std::span(achieved_).subspan(3 * w, 3), std::span(desired_).subspan(3 * w, 3),
                     std::span(reward_).subspan(w, 1));
      success_[w] = reward_[w] == 0.0f;
      terminated_[w] = success_[w];
      truncated_[w] = s.steps >= spec_.max_episode_steps && terminated_[w] == 0;
    }
  }

  std::span<const float> observation() const override { return observation_; }
  std::span<const float> achieved_goal() const override { return achieved_; }
  std::span<const float> desired_goal() const override { return desired_; }
  std::span<const float> reward() const override { return reward_; }
  std::span<const std::uint8_t> is_success() const override { return success_; }
  std::span<const std::uint8_t> terminated() const override { return terminated_; }
  std::span<const std::uint8_t> truncated() const override { return truncated_; }

  void compute_reward(std::span<const float> achieved, std::span<const float> desired,
                      std::span<float> reward) const override {
    for (std::size_t i = 0; i < reward.size(); ++i) {
      float squared = 0;
      for (std::size_t k = 3 * i; k < 3 * i + 3; ++k)
        squared += (achieved[k] - desired[k]) * (achieved[k] - desired[k]);
      reward[i] = std::sqrt(squared) < 0.05f ? 0.0f : -1.0f;
    }
  }

  std::vector<std::uint8_t> snapshot() const override { throw std::logic_error("no test needs it"); }
  void restore(std::span<const std::uint8_t>) override { throw std::logic_error("no test needs it"); }

  std::uint64_t state_hash() const override {
    std::uint64_t hash = 0xcbf29ce484222325u;
    const auto add = [&](std::uint64_t word) { hash = (hash ^ word) * 0x100000001b3u; };
    for (State s : states_) {
      for (std::size_t k = 0; k < 3; ++k) {
        for (const float x : {s.position[k], s.velocity[k], s.goal[k]}) add(std::bit_cast<std::uint32_t>(x));
      }
      add(static_cast<std::uint64_t>(s.steps));
      add(s.random());
    }
    return hash;
  }

 private:
  struct State {
    float position[3], velocity[3], goal[3];
    int steps;
    std::mt19937_64 random;
  };

  void publish(std::size_t w) {
    const State& s = states_[w];
    for (std::size_t k = 0; k < 3; ++k) {
      observation_[6 * w + k] = achieved_[3 * w + k] = s.position[k];
      observation_[6 * w + 3 + k] = s.velocity[k] / 0.04f;
      desired_[3 * w + k] = s.goal[k];
    }
  }

  EnvSpec spec_;
  int worlds_;
  double reproducibility_;  // factor on motion: anything but 1 stands for another version of the environment
  std::vector<State> states_;
  std::vector<float> observation_, achieved_, desired_, reward_;
  std::vector<std::uint8_t> success_, terminated_, truncated_;
};

}  // namespace manyhands::learn
