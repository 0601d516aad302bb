#include "manyhands/envs/panda_tasks.h"
#include "manyhands/envs/task_batch.inl"

namespace manyhands {

MANYHANDS_PANDA_TASKS(, float)

}  // namespace manyhands
