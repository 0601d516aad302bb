// panda-gym's six tasks as batches, each compiled once for every number type.
#pragma once

#include <memory>
#include <string>

#include "manyhands/envs/task_batch.h"
#include "manyhands/envs/tasks/flip.h"
#include "manyhands/envs/tasks/pick_and_place.h"
#include "manyhands/envs/tasks/push.h"
#include "manyhands/envs/tasks/reach.h"
#include "manyhands/envs/tasks/slide.h"
#include "manyhands/envs/tasks/stack.h"
#include "manyhands/math/instantiate.h"

namespace manyhands {

/// Calls visit(Task{}) for every task.
template <class Visit>
void for_each_panda_task(Visit&& visit) {
  visit(Reach{});
  visit(Slide{});
  visit(Push{});
  visit(PickAndPlace{});
  visit(Stack{});
  visit(Flip{});
}

/// What a batch of one of the tasks is made from.
struct PandaTask {
  std::string name;  ///< the task's kName
  EnvSpec spec;
  ArmSpec arm;
  ArmControl control;
  Reward reward;
  int num_envs;
};

template <Number T>
[[nodiscard]] std::unique_ptr<EnvBatch> make_panda_task(const PandaTask& task, const EnvOptions& options);

// clang-format off
template <> std::unique_ptr<EnvBatch> make_panda_task<float>(const PandaTask&, const EnvOptions&);
template <> MANYHANDS_LANES4 std::unique_ptr<EnvBatch> make_panda_task<Lanes4>(const PandaTask&, const EnvOptions&);
template <> MANYHANDS_LANES8 std::unique_ptr<EnvBatch> make_panda_task<Lanes8>(const PandaTask&, const EnvOptions&);
template <> MANYHANDS_LANES16 std::unique_ptr<EnvBatch> make_panda_task<Lanes16>(const PandaTask&, const EnvOptions&);
// clang-format on

#define MANYHANDS_PANDA_TASKS(prefix, T)            \
  prefix template class TaskBatch<T, Reach>;        \
  prefix template class TaskBatch<T, Push>;         \
  prefix template class TaskBatch<T, Slide>;        \
  prefix template class TaskBatch<T, PickAndPlace>; \
  prefix template class TaskBatch<T, Stack>;        \
  prefix template class TaskBatch<T, Flip>;
MANYHANDS_PANDA_TASKS(extern, float)
MANYHANDS_PANDA_TASKS(extern, Lanes4)
MANYHANDS_PANDA_TASKS(extern, Lanes8)
MANYHANDS_PANDA_TASKS(extern, Lanes16)

}  // namespace manyhands
