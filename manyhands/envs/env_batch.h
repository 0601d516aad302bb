// Many goal-conditioned environments of one kind, stepped together.
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "manyhands/model/model.h"

namespace manyhands {

/// What an environment id means: sizes and limits, the same for every world of a batch.
struct EnvSpec {
  std::string id;         ///< for example "PandaReach-v3"
  int observation_dim{};  ///< length of one observation row
  int robot_dim{};        ///< so many of its first numbers are what the robot knows of itself; 0: not known
  int goal_dim{};         ///< length of an achieved or desired goal row
  int action_dim{};       ///< length of an action row; every component lies in [-1, 1]
  int choices{};          ///< if not 0, an action row is one number instead: the index of one of so many choices
  int max_episode_steps{};
  double dt{};                            ///< simulated seconds of one environment step
  std::vector<std::string> randomized{};  ///< what differs from episode to episode
};

/// What a batch looks like.
struct EnvScene {
  Model model;                  ///< with the meshes that are seen
  std::vector<GeomId> objects;  ///< what the task moves
};

/// The batch API on which the Gymnasium environments and the trainers rest.
///
/// Rows are worlds: an array written (n, k) is row-major, n = num_envs(), float32. The views returned by the getters
/// stay valid and are overwritten by the next `step` or `reset`. A batch never resets a world by itself: after `step`,
/// the views hold the true last observation of a finished episode, and the caller resets what it wants by mask.
/// World i is the same bits whatever the batch size, the number of threads or its place in the batch.
class EnvBatch {
 public:
  virtual ~EnvBatch() = default;

  [[nodiscard]] virtual const EnvSpec& spec() const = 0;
  [[nodiscard]] virtual int num_envs() const = 0;

  /// Starts a new episode in every world whose mask byte is not 0 (all of them if `mask` is empty). With `seeds` (n),
  /// world i's random stream restarts from seeds[i]; without, each stream continues.
  /// Throws std::invalid_argument on a wrong length.
  virtual void reset(std::span<const std::uint8_t> mask, std::span<const std::uint64_t> seeds = {}) = 0;

  /// One environment step of every world under `action` (n, action_dim), clipped to [-1, 1].
  /// Throws std::invalid_argument on a wrong length or a non-finite component.
  virtual void step(std::span<const float> action) = 0;

  [[nodiscard]] virtual std::span<const float> observation() const = 0;        ///< (n, observation_dim)
  [[nodiscard]] virtual std::span<const float> achieved_goal() const = 0;      ///< (n, goal_dim)
  [[nodiscard]] virtual std::span<const float> desired_goal() const = 0;       ///< (n, goal_dim)
  [[nodiscard]] virtual std::span<const float> reward() const = 0;             ///< (n), of the last step
  [[nodiscard]] virtual std::span<const std::uint8_t> is_success() const = 0;  ///< (n), 0 or 1
  [[nodiscard]] virtual std::span<const std::uint8_t> terminated() const = 0;  ///< (n), success ended the episode
  [[nodiscard]] virtual std::span<const std::uint8_t> truncated()
      const = 0;  ///< (n), the step limit ended it, or unstable()

  /// (n), 0 or 1, or empty if no world can be: numbers stopped being finite in the last step. Such a world lies at rest
  /// where that step began, and its episode is truncated.
  [[nodiscard]] virtual std::span<const std::uint8_t> unstable() const { return {}; }

  /// (n, spec().randomized.size()): what the present episode of each world has.
  [[nodiscard]] virtual std::span<const float> randomized() const { return {}; }

  /// The task's reward for k pairs of goals (k, goal_dim), k = reward.size(): what hindsight replay asks.
  virtual void compute_reward(std::span<const float> achieved_goal, std::span<const float> desired_goal,
                              std::span<float> reward) const = 0;

  /// For cameras. Throws std::logic_error where there is nothing to see.
  [[nodiscard]] virtual EnvScene scene() const { throw std::logic_error(spec().id + " has no scene to be seen"); }
  /// The configuration q (nq) of a world, and the sizes of its objects (objects), see Shape [m].
  virtual void see(int /*world*/, std::span<double> /*q*/, std::span<Vec3<double>> /*sizes*/) const {
    throw std::logic_error(spec().id + " has no scene to be seen");
  }

  /// A hash over the bits of every world's physical state: equal runs have equal hashes.
  [[nodiscard]] virtual std::uint64_t state_hash() const = 0;

  /// All that a run needs to continue bit for bit, in the same build with the same options: physics, goals, random
  /// streams and step counts of every world. Lanes and threads may differ.
  [[nodiscard]] virtual std::vector<std::uint8_t> snapshot() const = 0;

  /// Goes back to a snapshot. Throws std::invalid_argument if it is of another environment or number of worlds.
  virtual void restore(std::span<const std::uint8_t> snapshot) = 0;
};

}  // namespace manyhands
