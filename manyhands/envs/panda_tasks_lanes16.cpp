#include "manyhands/envs/panda_tasks.inl"

namespace manyhands {

MANYHANDS_PANDA_TASKS(, Lanes16)

template <>
std::unique_ptr<EnvBatch> make_panda_task<Lanes16>(const PandaTask& task, const EnvOptions& options) {
  return internal::make_task_batch<Lanes16>(task, options);
}

}  // namespace manyhands
