#include "manyhands/envs/panda_tasks.inl"

namespace manyhands {

MANYHANDS_PANDA_TASKS(, float)

template <>
std::unique_ptr<EnvBatch> make_panda_task<float>(const PandaTask& task, const EnvOptions& options) {
  return internal::make_task_batch<float>(task, options);
}

}  // namespace manyhands
