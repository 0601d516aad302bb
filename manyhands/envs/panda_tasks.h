// panda-gym's six tasks as batches, each compiled once for every number type.
#pragma once

#include "manyhands/envs/task_batch.h"
#include "manyhands/envs/tasks/flip.h"
#include "manyhands/envs/tasks/pick_and_place.h"
#include "manyhands/envs/tasks/push.h"
#include "manyhands/envs/tasks/reach.h"
#include "manyhands/envs/tasks/slide.h"
#include "manyhands/envs/tasks/stack.h"
#include "manyhands/math/instantiate.h"

namespace manyhands {

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
