#include "manyhands/envs/panda_tasks.inl"

namespace manyhands {

MANYHANDS_PANDA_TASKS(, Lanes4)

template <>
std::unique_ptr<EnvBatch> make_panda_task<Lanes4>(const PandaTask& task, const EnvOptions& options) {
  return internal::make_task_batch<Lanes4>(task, options);
}

}  // namespace manyhands
