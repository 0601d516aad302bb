// Bodies of TaskBatch: what cameras see.
#pragma once

#include "manyhands/envs/task_batch.h"

namespace manyhands {

template <Number T, TaskLike Task>
EnvScene TaskBatch<T, Task>::scene() const {
  const auto objects = internal::objects_of(task_, options_.object_shape);
  ArmSpec arm = arm_spec_;
  arm.meshes = true;
  EnvScene scene{task_scene(arm, task_.table(), objects, options_.obstacles), {}};
  for (const ObjectSpec& object : objects) {
    const std::span<const Geom> geoms = scene.model.geoms();
    const auto found = std::ranges::find(geoms, object.name, &Geom::name);
    scene.objects.push_back(GeomId(static_cast<std::size_t>(found - geoms.begin())));
  }
  return scene;
}

template <Number T, TaskLike Task>
void TaskBatch<T, Task>::see(int i, std::span<double> q, std::span<Vec3<double>> sizes) const {
  if (i < 0 || i >= num_envs_) throw std::out_of_range(spec_.id + ": there is no world " + std::to_string(i));
  const World& world = worlds_[static_cast<std::size_t>(i)];
  const Block& block = block_of(world);
  for (std::size_t k = 0; k < q.size(); ++k) q[k] = static_cast<double>(lane(block.state.q()[k], world.lane));
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    const std::size_t geom = parts_.object_geoms[k];
    sizes[k] = broadcast<double>(block.has_params() ? lane(block.params.geom_size[geom], world.lane)
                                                    : params_.geom_size[geom]);
  }
}

}  // namespace manyhands
