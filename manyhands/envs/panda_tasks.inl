// Body of make_panda_task, included by the files that instantiate it.
#pragma once

#include "manyhands/envs/panda_tasks.h"
#include "manyhands/envs/task_batch.inl"

namespace manyhands::internal {

template <Number T>
std::unique_ptr<EnvBatch> make_task_batch(const PandaTask& task, const EnvOptions& options) {
  std::unique_ptr<EnvBatch> made;
  for_each_panda_task([&]<class Task>(const Task&) {
    if (task.name != Task::kName) return;
    made = std::make_unique<TaskBatch<T, Task>>(task.spec, task.arm, task.control, task.reward, task.num_envs, options);
  });
  return made;
}

}  // namespace manyhands::internal
