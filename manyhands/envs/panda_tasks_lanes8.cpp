#include "manyhands/envs/panda_tasks.h"
#include "manyhands/envs/task_batch.inl"
#include "manyhands/math/instantiate.h"

namespace manyhands {

MANYHANDS_PANDA_TASKS(, Lanes8)

}  // namespace manyhands
