#include "manyhands/control/control_kernel_impl.h"

namespace manyhands::internal {

template <>
std::unique_ptr<ControlKernel<double>> make_control_kernel<double>(const Model& model) {
  return std::make_unique<ControlKernelOf<double>>(model);
}

template <>
std::unique_ptr<ControlKernel<float>> make_control_kernel<float>(const Model& model) {
  return std::make_unique<ControlKernelOf<float>>(model);
}

}  // namespace manyhands::internal
