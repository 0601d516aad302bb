// Environments by name.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "manyhands/envs/arm_spec.h"
#include "manyhands/envs/env_batch.h"
#include "manyhands/envs/obstacle.h"

namespace manyhands {

/// From where a value is drawn at every reset: uniform in [low, high], or its logarithm is. Latencies are whole numbers
/// from low to high, each as likely as another.
struct RandomRange {
  std::string name;  ///< "object_mass", "action_latency", ...: see randomize.h
  double low = 1, high = 1;
  bool logarithmic = false;
};

struct EnvOptions {
  int num_threads = 0;       ///< 0: the variable MANYHANDS_THREADS, else as many as the machine has cores
  int n_substeps = 20;       ///< physics steps of one environment step
  double time_step = 0.002;  ///< of the physics [s]
  bool terminate_on_success = true;
  double distance_threshold = 0;         ///< success is nearer than this; 0: what the task says, 5 cm in Reach
  std::vector<RandomRange> randomize{};  ///< what differs from episode to episode
  std::string object_shape{};            ///< "": as the task says; else one of object_shapes()
  int lanes = 0;  ///< 0: the fastest for this build, or scalars for a single world; else 1 or a built width
  std::optional<ArmSpec> arm{};         ///< none: the Panda
  std::optional<ArmControl> control{};  ///< none: what the id says
  Impedance impedance{};                ///< under ArmControl::kImpedance
  std::vector<Obstacle> obstacles{};
};

/// The ids that `make_env_batch` knows, for example "PandaReachDense-v3".
[[nodiscard]] std::vector<std::string> env_ids();

/// The steps after which an episode of the environment `id` is truncated. Throws std::invalid_argument on an unknown
/// id.
[[nodiscard]] int max_episode_steps(const std::string& id);

/// `num_envs` worlds of the environment `id`, reset with fresh random streams.
/// Throws std::invalid_argument on an unknown id (the message lists the ids) or an option out of range.
[[nodiscard]] std::unique_ptr<EnvBatch> make_env_batch(const std::string& id, int num_envs,
                                                       const EnvOptions& options = {});

}  // namespace manyhands
