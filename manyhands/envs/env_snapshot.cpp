#include "manyhands/envs/env_snapshot.h"

#include <algorithm>
#include <sstream>

#include "manyhands/base/hash.h"
#include "manyhands/model/fingerprint.h"

namespace manyhands {

namespace {

void add_text(const std::string& text, Hash& hash) {
  for (const char c : text) hash.add(c);
  hash.add('\0');
}

/// By which users know it.
std::string name_of(ArmControl control) {
  return std::ranges::find(kArmControls, control, &std::pair<const char*, ArmControl>::second)->first;
}

}  // namespace

SnapshotOwner env_snapshot_owner(const EnvSpec& spec, const Arm& arm, const Goals& goals, const EnvOptions& options,
                                 const Model& scene, int num_envs) {
  std::ostringstream text;
  text << spec.id << " (" << num_envs << (num_envs == 1 ? " world" : " worlds") << ", control " << name_of(arm.control)
       << ", time_step " << options.time_step << ", " << options.n_substeps << " substeps";
  if (!options.object_shape.empty()) text << ", object_shape " << options.object_shape;
  if (!options.obstacles.empty()) text << ", " << options.obstacles.size() << " obstacles";
  for (const RandomRange& range : options.randomize) {
    text << ", " << range.name << " in [" << range.low << ", " << range.high << "]";
  }
  text << ")";
  Hash hash;
  add_text(spec.id, hash);
  hash.add(num_envs);
  hash.add(static_cast<int>(arm.control));
  for (const double number : {arm.impedance.stiffness, arm.impedance.damping, arm.impedance.rotational_stiffness,
                              arm.impedance.rotational_damping, goals.distance_threshold, options.time_step}) {
    hash.add(number);
  }
  for (const double number : arm.neutral) hash.add(number);
  for (const double number : arm.max_force) hash.add(number);
  hash.add(static_cast<int>(goals.reward));
  hash.add(options.n_substeps);
  hash.add(options.terminate_on_success);
  add_text(options.object_shape, hash);
  for (const RandomRange& range : options.randomize) {
    add_text(range.name, hash);
    hash.add(range.low);
    hash.add(range.high);
    hash.add(range.logarithmic);
  }
  hash.add(fingerprint(scene));  // the arm, the objects and the obstacles
  return {text.str(), hash.value()};
}

}  // namespace manyhands
