#include "manyhands/control/control_kernel_impl.h"

namespace manyhands::internal {

template <>
std::unique_ptr<ControlKernel<float>> make_control_kernel<Lanes16>(const Model& model) {
  return std::make_unique<ControlKernelOf<Lanes16>>(model);
}

}  // namespace manyhands::internal
