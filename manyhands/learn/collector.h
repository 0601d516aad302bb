// Runs the worlds of a batch through episode after episode and hands over each finished one whole.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "manyhands/envs/env_batch.h"
#include "manyhands/envs/experts/expert.h"
#include "manyhands/learn/archive.h"
#include "manyhands/learn/replay.h"

namespace manyhands::learn {

/// Every episode starts from a seed that is a function of (seed, world, episode number), so an unfinished episode is
/// saved as its number and actions, and `load` brings the batch to the same state by playing them again.
class Collector {
 public:
  /// Starts episode 0 in every world. `envs` is borrowed, and so is `expert` (may be null), asked in every state.
  Collector(EnvBatch& envs, Expert* expert, std::uint64_t seed);

  [[nodiscard]] const EnvBatch& envs() const { return envs_; }

  /// The expert's actions in the present states (n, action_dim); empty without an expert.
  [[nodiscard]] std::span<const float> advice() const { return advice_now_; }

  /// Steps all worlds under `action` (n, action_dim) and records what comes of it.
  void step(std::span<const float> action);

  /// Worlds whose episode ended with the last `step`, ascending.
  [[nodiscard]] std::span<const int> finished() const { return finished_; }
  [[nodiscard]] EpisodeView episode(int world) const;
  [[nodiscard]] bool succeeded(int world) const;

  /// Starts the next episode in the finished worlds.
  void restart_finished();

  /// The running episodes: what it takes to play them again, and where that must lead.
  struct Running {
    std::uint64_t seed{};
    std::vector<std::uint64_t> number;  // (worlds)
    std::vector<int> length;            // (worlds)
    std::vector<float> action;          // (worlds, max_episode_steps, action_dim)
    std::uint64_t state_hash{};
  };

  void save(ArchiveWriter& out) const;
  [[nodiscard]] Running read(ArchiveReader& in) const;
  /// Brings the batch to `running`. False if it did not come to the saved state (another version or machine of the
  /// environment): then every world has started a new episode instead.
  [[nodiscard]] bool restore(const Running& running);

 private:
  struct Track {
    std::uint64_t number = 0;  // of the episode in this world
    int length = 0;
    bool terminated = false, success = false;
  };

  [[nodiscard]] std::uint64_t episode_seed(std::size_t world) const;
  void begin(std::span<const std::uint8_t> mask);
  void record_state(std::size_t world);
  void ask_expert();
  void play_again(const Running& running);

  EnvBatch& envs_;
  Expert* expert_;
  std::uint64_t seed_ = 0;
  std::size_t worlds_, no_, ng_, na_, max_steps_;
  std::vector<Track> tracks_;
  std::vector<float> observation_, achieved_, desired_, action_, reward_;  // per world, rows as in EpisodeView
  std::vector<float> advice_, advice_now_;                                 // as action_; (n, action_dim)
  std::vector<std::uint8_t> mask_;
  std::vector<std::uint64_t> seeds_;
  std::vector<int> finished_;
};

}  // namespace manyhands::learn
