#include "manyhands/physics/dynamics/row_kernel_impl.h"

namespace manyhands::internal {

template <>
std::unique_ptr<RowKernel<float>> make_row_kernel<Lanes4>(const Model& model) {
  return std::make_unique<RowKernelOf<Lanes4>>(model);
}

}  // namespace manyhands::internal
