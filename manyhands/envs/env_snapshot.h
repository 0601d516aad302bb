// What the snapshots of environments belong to.
#pragma once

#include "manyhands/envs/arm.h"
#include "manyhands/envs/make.h"
#include "manyhands/envs/tasks/task.h"
#include "manyhands/physics/world/snapshot.h"

namespace manyhands {

/// Of `num_envs` worlds of an environment: its id, control, options and scene fix what its numbers mean. Lanes and
/// threads do not count.
[[nodiscard]] SnapshotOwner env_snapshot_owner(const EnvSpec& spec, const Arm& arm, const Goals& goals,
                                               const EnvOptions& options, const Model& scene, int num_envs);

}  // namespace manyhands
