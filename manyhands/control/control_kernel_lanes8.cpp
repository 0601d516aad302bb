#include "manyhands/control/control_kernel_impl.h"

namespace manyhands::internal {

template <>
std::unique_ptr<ControlKernel<float>> make_control_kernel<Lanes8>(const Model& model) {
  return std::make_unique<ControlKernelOf<Lanes8>>(model);
}

}  // namespace manyhands::internal
