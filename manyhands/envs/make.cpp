#include "manyhands/envs/make.h"

#include <stdexcept>

#include "manyhands/envs/panda_reach.h"
#include "manyhands/math/instantiate.h"

namespace manyhands {

namespace {

struct ReachId {
  const char* id;
  PandaControl control;
  Reward reward;
};

constexpr std::array<ReachId, 4> kReachIds{{
    {"PandaReach-v3", PandaControl::kEndEffector, Reward::kSparse},
    {"PandaReachJoints-v3", PandaControl::kJoints, Reward::kSparse},
    {"PandaReachDense-v3", PandaControl::kEndEffector, Reward::kDense},
    {"PandaReachJointsDense-v3", PandaControl::kJoints, Reward::kDense},
}};

constexpr int kMaxEpisodeSteps = 50;
constexpr int kMaxEnvs = 1 << 20;
constexpr int kMaxThreads = 1024;

void require(bool condition, const std::string& message) {
  if (!condition) throw std::invalid_argument(message);
}

void check(int num_envs, const EnvOptions& options) {
  require(num_envs >= 1 && num_envs <= kMaxEnvs,
          "num_envs is " + std::to_string(num_envs) + "; expected 1 to " + std::to_string(kMaxEnvs));
  require(options.num_threads >= 0 && options.num_threads <= kMaxThreads,
          "num_threads is " + std::to_string(options.num_threads) + "; expected 0 to " + std::to_string(kMaxThreads));
  require(options.n_substeps >= 1, "n_substeps is " + std::to_string(options.n_substeps) + "; expected 1 or more");
  require(options.time_step > 0 && options.time_step <= 0.1,
          "time_step is " + std::to_string(options.time_step) + " s; expected more than 0, at most 0.1");
  require(options.distance_threshold > 0,
          "distance_threshold is " + std::to_string(options.distance_threshold) + " m; expected more than 0");
}

template <class T>
std::unique_ptr<EnvBatch> make_reach(const ReachId& which, int num_envs, const EnvOptions& options) {
  EnvSpec spec{.id = which.id,
               .observation_dim = 6,
               .goal_dim = ReachTask::kGoalSize,
               .action_dim = action_size(which.control),
               .max_episode_steps = kMaxEpisodeSteps,
               .dt = options.time_step * options.n_substeps};
  const ReachTask task{.reward = which.reward, .distance_threshold = options.distance_threshold};
  return std::make_unique<PandaReachBatch<T>>(std::move(spec), which.control, task, num_envs, options);
}

}  // namespace

std::vector<std::string> env_ids() {
  std::vector<std::string> ids;
  for (const ReachId& reach : kReachIds) ids.emplace_back(reach.id);
  return ids;
}

std::unique_ptr<EnvBatch> make_env_batch(const std::string& id, int num_envs, const EnvOptions& options) {
  check(num_envs, options);
  for (const ReachId& reach : kReachIds) {
    if (id != reach.id) continue;
    switch (options.lanes == 0 ? (num_envs == 1 ? 1 : width_v<NativeLanes>) : options.lanes) {
      case 1:
        return make_reach<float>(reach, num_envs, options);
      case 4:
        return make_reach<Lanes4>(reach, num_envs, options);
      case 8:
        return make_reach<Lanes8>(reach, num_envs, options);
      case 16:
        return make_reach<Lanes16>(reach, num_envs, options);
      default:
        throw std::invalid_argument("lanes is " + std::to_string(options.lanes) + "; expected 0, 1, 4, 8 or 16");
    }
  }
  std::string message = "unknown environment '" + id + "'; there are:";
  for (const std::string& known : env_ids()) message += ' ' + known;
  throw std::invalid_argument(message);
}

}  // namespace manyhands
