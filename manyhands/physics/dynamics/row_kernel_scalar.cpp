#include "manyhands/physics/dynamics/row_kernel_impl.h"

namespace manyhands::internal {

template <>
std::unique_ptr<RowKernel<double>> make_row_kernel<double>(const Model& model) {
  return std::make_unique<RowKernelOf<double>>(model);
}

template <>
std::unique_ptr<RowKernel<float>> make_row_kernel<float>(const Model& model) {
  return std::make_unique<RowKernelOf<float>>(model);
}

}  // namespace manyhands::internal
