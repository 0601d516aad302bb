#include "manyhands/physics/dynamics/batch_dynamics.h"

#include "manyhands/math/for_width.h"
#include "manyhands/physics/dynamics/row_kernel.h"

namespace manyhands {

namespace {

template <Real R>
std::unique_ptr<internal::RowKernel<R>> choose_kernel(const Model& model, int width) {
  if constexpr (std::same_as<R, double>) {
    if (width == 0 || width == 1) return internal::make_row_kernel<double>(model);
    throw std::invalid_argument("width is " + std::to_string(width) + "; double runs one row at a time: 0 or 1");
  } else {
    if (width == 0) width = width_v<NativeLanes>;
    return for_width("width", width, []<class T>() { return &internal::make_row_kernel<T>; })(model);
  }
}

/// `array` must hold n rows.
template <class R>
R* rows(const char* name, std::span<R> array, std::size_t n, std::size_t columns) {
  if (array.size() == n * columns) return array.data();
  throw std::invalid_argument(std::string(name) + " holds " + std::to_string(array.size()) + " numbers; expected " +
                              std::to_string(n) + " rows of " + std::to_string(columns));
}

}  // namespace

template <Real R>
BatchDynamics<R>::BatchDynamics(const Model& model, int width)
    : nq_(static_cast<std::size_t>(model.nq())),
      nv_(static_cast<std::size_t>(model.nv())),
      frames_(model.frames().begin(), model.frames().end()),
      kernel_(choose_kernel<R>(model, width)) {}

template <Real R>
BatchDynamics<R>::~BatchDynamics() = default;
template <Real R>
BatchDynamics<R>::BatchDynamics(BatchDynamics&&) noexcept = default;
template <Real R>
BatchDynamics<R>& BatchDynamics<R>::operator=(BatchDynamics&&) noexcept = default;

template <Real R>
void BatchDynamics<R>::rnea(std::size_t n, std::span<const R> q, std::span<const R> v, std::span<const R> a,
                            std::span<R> tau) {
  kernel_->rnea(n, rows("q", q, n, nq_), rows("v", v, n, nv_), rows("a", a, n, nv_), rows("tau", tau, n, nv_));
}

template <Real R>
void BatchDynamics<R>::aba(std::size_t n, std::span<const R> q, std::span<const R> v, std::span<const R> tau,
                           std::span<R> a) {
  kernel_->aba(n, rows("q", q, n, nq_), rows("v", v, n, nv_), rows("tau", tau, n, nv_), rows("a", a, n, nv_));
}

template <Real R>
void BatchDynamics<R>::crba(std::size_t n, std::span<const R> q, std::span<R> M) {
  kernel_->crba(n, rows("q", q, n, nq_), rows("M", M, n, nv_ * nv_));
}

template <Real R>
const Frame& BatchDynamics<R>::frame_of(FrameId frame) const {
  if (frame.is_valid() && frame.index() < frames_.size()) return frames_[frame.index()];
  throw std::invalid_argument("frame " + std::to_string(frame.value()) + " does not exist; the model has " +
                              std::to_string(frames_.size()) + " frames");
}

template <Real R>
void BatchDynamics<R>::frame_pose(std::size_t n, std::span<const R> q, FrameId frame, std::span<R> position,
                                  std::span<R> quaternion) {
  kernel_->frame_poses(n, rows("q", q, n, nq_), {&frame_of(frame), 1}, rows("position", position, n, 3),
                       rows("quaternion", quaternion, n, 4));
}

template <Real R>
void BatchDynamics<R>::forward_kinematics(std::size_t n, std::span<const R> q, std::span<R> position,
                                          std::span<R> quaternion) {
  kernel_->frame_poses(n, rows("q", q, n, nq_), frames_, rows("position", position, n, 3 * frames_.size()),
                       rows("quaternion", quaternion, n, 4 * frames_.size()));
}

template <Real R>
void BatchDynamics<R>::jacobian(std::size_t n, std::span<const R> q, FrameId frame, std::span<R> J, JacobianForm form) {
  kernel_->jacobian(n, rows("q", q, n, nq_), frame_of(frame), form, rows("J", J, n, 6 * nv_));
}

template <Real R>
void BatchDynamics<R>::jacobian_derivative(std::size_t n, std::span<const R> q, std::span<const R> v, FrameId frame,
                                           std::span<R> dJ, JacobianForm form) {
  kernel_->jacobian_derivative(n, rows("q", q, n, nq_), rows("v", v, n, nv_), frame_of(frame), form,
                               rows("dJ", dJ, n, 6 * nv_));
}

template <Real R>
void BatchDynamics<R>::center_of_mass(std::size_t n, std::span<const R> q, std::span<R> com) {
  kernel_->center_of_mass(n, rows("q", q, n, nq_), rows("com", com, n, 3));
}

template <Real R>
void BatchDynamics<R>::momentum(std::size_t n, std::span<const R> q, std::span<const R> v, std::span<R> momentum) {
  kernel_->momentum(n, rows("q", q, n, nq_), rows("v", v, n, nv_), rows("momentum", momentum, n, 6));
}

template <Real R>
void BatchDynamics<R>::energy(std::size_t n, std::span<const R> q, std::span<const R> v, std::span<R> kinetic,
                              std::span<R> potential) {
  kernel_->energy(n, rows("q", q, n, nq_), rows("v", v, n, nv_), rows("kinetic", kinetic, n, 1),
                  rows("potential", potential, n, 1));
}

template <Real R>
int BatchDynamics<R>::width() const {
  return kernel_->width();
}

template class BatchDynamics<double>;
template class BatchDynamics<float>;

}  // namespace manyhands
