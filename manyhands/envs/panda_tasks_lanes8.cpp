#include "manyhands/envs/panda_tasks.inl"

namespace manyhands {

MANYHANDS_PANDA_TASKS(, Lanes8)

template <>
std::unique_ptr<EnvBatch> make_panda_task<Lanes8>(const PandaTask& task, const EnvOptions& options) {
  return internal::make_task_batch<Lanes8>(task, options);
}

}  // namespace manyhands
