// The dynamics of one number type behind an interface of plain rows; what BatchDynamics chooses from.
#pragma once

#include <memory>
#include <span>

#include "manyhands/math/instantiate.h"
#include "manyhands/model/model.h"
#include "manyhands/physics/dynamics/jacobian_form.h"

namespace manyhands::internal {

/// The functions of BatchDynamics without its checks.
template <Real R>
class RowKernel {
 public:
  virtual ~RowKernel() = default;
  [[nodiscard]] virtual int width() const = 0;
  virtual void rnea(std::size_t n, const R* q, const R* v, const R* a, R* tau) = 0;
  virtual void aba(std::size_t n, const R* q, const R* v, const R* tau, R* a) = 0;
  virtual void crba(std::size_t n, const R* q, R* M) = 0;
  virtual void frame_poses(std::size_t n, const R* q, std::span<const Frame> frames, R* position, R* quaternion) = 0;
  virtual void jacobian(std::size_t n, const R* q, const Frame& frame, JacobianForm form, R* J) = 0;
  virtual void jacobian_derivative(std::size_t n, const R* q, const R* v, const Frame& frame, JacobianForm form,
                                   R* dJ) = 0;
  virtual void center_of_mass(std::size_t n, const R* q, R* com) = 0;
  virtual void momentum(std::size_t n, const R* q, const R* v, R* momentum) = 0;
  virtual void energy(std::size_t n, const R* q, const R* v, R* kinetic, R* potential) = 0;
};

template <Number T>
[[nodiscard]] std::unique_ptr<RowKernel<real_t<T>>> make_row_kernel(const Model& model);

// clang-format off
template <> std::unique_ptr<RowKernel<double>> make_row_kernel<double>(const Model&);
template <> std::unique_ptr<RowKernel<float>> make_row_kernel<float>(const Model&);
template <> MANYHANDS_LANES4 std::unique_ptr<RowKernel<float>> make_row_kernel<Lanes4>(const Model&);
template <> MANYHANDS_LANES8 std::unique_ptr<RowKernel<float>> make_row_kernel<Lanes8>(const Model&);
template <> MANYHANDS_LANES16 std::unique_ptr<RowKernel<float>> make_row_kernel<Lanes16>(const Model&);
// clang-format on

}  // namespace manyhands::internal
