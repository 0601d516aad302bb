#include "manyhands/control/control_kernel_impl.h"

namespace manyhands::internal {

template <>
std::unique_ptr<ControlKernel<float>> make_control_kernel<Lanes4>(const Model& model) {
  return std::make_unique<ControlKernelOf<Lanes4>>(model);
}

}  // namespace manyhands::internal
