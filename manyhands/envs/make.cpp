#include "manyhands/envs/make.h"

#include "manyhands/envs/panda.h"
#include "manyhands/envs/panda_tasks.h"
#include "manyhands/envs/require.h"
#include "manyhands/math/for_width.h"

namespace manyhands {

namespace {

constexpr int kMaxEnvs = 1 << 20;
constexpr int kMaxThreads = 1024;

/// What an id names beside its task.
struct Variant {
  std::string id;
  ArmControl control;
  Reward reward;
};

void check(int num_envs, const EnvOptions& options) {
  require(num_envs >= 1 && num_envs <= kMaxEnvs,
          "num_envs is " + std::to_string(num_envs) + "; expected 1 to " + std::to_string(kMaxEnvs));
  require(options.num_threads >= 0 && options.num_threads <= kMaxThreads,
          "num_threads is " + std::to_string(options.num_threads) + "; expected 0 to " + std::to_string(kMaxThreads));
  require(options.n_substeps >= 1, "n_substeps is " + std::to_string(options.n_substeps) + "; expected 1 or more");
  require(options.time_step > 0 && options.time_step <= 0.1,
          "time_step is " + std::to_string(options.time_step) + " s; expected more than 0, at most 0.1");
  require(options.distance_threshold >= 0, "distance_threshold is " + std::to_string(options.distance_threshold) +
                                               "; expected more than 0, or 0 for what the task says");
}

std::vector<Variant> variants(const std::string& task) {
  std::vector<Variant> all;
  for (const Reward reward : {Reward::kSparse, Reward::kDense}) {
    for (const ArmControl control : {ArmControl::kEndEffector, ArmControl::kJoints}) {
      const std::string joints = control == ArmControl::kJoints ? "Joints" : "";
      const std::string dense = reward == Reward::kDense ? "Dense" : "";
      all.push_back({"Panda" + task + joints + dense + "-v3", control, reward});
    }
  }
  return all;
}

/// Calls visit(task, variant) for what the id means. Throws std::invalid_argument if it means nothing.
template <class Visit>
void find_task(const std::string& id, Visit&& visit) {
  bool found = false;
  for_each_panda_task([&](const auto& task) {
    for (const Variant& variant : variants(task.kName)) {
      if (variant.id != id) continue;
      visit(task, variant);
      found = true;
    }
  });
  if (found) return;
  std::string message = "unknown environment '" + id + "'; there are:";
  for (const std::string& known : env_ids()) message += ' ' + known;
  throw std::invalid_argument(message);
}

}  // namespace

std::vector<std::string> env_ids() {
  std::vector<std::string> ids;
  for_each_panda_task([&](const auto& task) {
    for (const Variant& variant : variants(task.kName)) ids.push_back(variant.id);
  });
  return ids;
}

int max_episode_steps(const std::string& id) {
  int steps = 0;
  find_task(id, [&](const auto& task, const Variant&) { steps = task.kMaxEpisodeSteps; });
  return steps;
}

std::unique_ptr<EnvBatch> make_env_batch(const std::string& id, int num_envs, const EnvOptions& options) {
  check(num_envs, options);
  const int lanes = options.lanes == 0 ? (num_envs == 1 ? 1 : width_v<NativeLanes>) : options.lanes;
  const auto make = for_width("lanes", lanes, []<class T>() { return &make_panda_task<T>; });
  std::unique_ptr<EnvBatch> made;
  find_task(id, [&](const auto& task, const Variant& variant) {
    made = make({.name = task.kName,
                 .spec = {.id = variant.id},
                 .arm = options.arm.value_or(panda_arm()),
                 .control = options.control.value_or(variant.control),
                 .reward = variant.reward,
                 .num_envs = num_envs},
                options);
  });
  return made;
}

}  // namespace manyhands
