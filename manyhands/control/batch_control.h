// Controllers over rows of states: what scripts and tests call, in lanes where the numbers are float.
#pragma once

#include "manyhands/control/control_kernel.h"

namespace manyhands {

/// The controllers of one model over n independent rows, as BatchDynamics has its algorithms: arrays are row-major, all
/// functions write tau (n, nv) [N m or N], R = double is the reference, R = float runs blocks of `width` rows in lanes
/// with the same bits for every width, and a row that holds NaN spoils its own results only. One object per thread.
/// Every function throws std::invalid_argument, naming the array, if a length is wrong. The headers beside this one
/// have the laws.
template <Real R>
class BatchControl {
 public:
  /// A state q, v (n, nv) each, and the desired motion.
  struct Tracked {
    std::span<const R> q, v, q_d, v_d, a_d;
  };
  /// Where a frame shall be, world axes: position (n, 3), quaternion xyzw (n, 4), velocity and acceleration of its
  /// origin, angular first (n, 6), and the moment and force with which it pushes (n, 6).
  struct Goal {
    std::span<const R> position, quaternion, velocity, acceleration, force;
  };
  /// (nv) each, of the controllers that name them.
  using Gains = internal::ControlGains<R>;

  /// `width` as of BatchDynamics. Throws std::invalid_argument on another, ModelError as `require_single_joints`.
  explicit BatchControl(const Model& model, int width = 0);

  void gravity_torque(std::size_t n, std::span<const R> q, std::span<R> tau);
  void pd_gravity(std::size_t n, const Gains& gains, const Tracked& rows, std::span<R> tau);      ///< kp, kd
  void pd_feedforward(std::size_t n, const Gains& gains, const Tracked& rows, std::span<R> tau);  ///< kp, kd
  /// kp, ki, kd; integral (n, nv).
  void computed_torque(std::size_t n, const Gains& gains, const Tracked& rows, std::span<const R> integral,
                       std::span<R> tau);
  void sliding_mode(std::size_t n, const Gains& gains, const Tracked& rows, std::span<R> tau);  ///< slope, kd, robust,
                                                                                                ///< boundary
  /// slope, kd; rate (10); theta (n, bodies, 10), which go on by h.
  void adaptive(std::size_t n, const Gains& gains, std::span<const R> rate, R h, const Tracked& rows,
                std::span<R> theta, std::span<R> tau);
  /// J^T of the spring's force, with C v + g.
  void impedance(std::size_t n, FrameId frame, const Impedance& impedance, std::span<const R> q, std::span<const R> v,
                 std::span<const R> position, std::span<const R> quaternion, std::span<R> tau);
  /// `posture` (n, nv), or empty.
  void operational_space(std::size_t n, FrameId frame, const OperationalTask& task, std::span<const R> q,
                         std::span<const R> v, const Goal& goal, std::span<const R> posture, std::span<R> tau);

  [[nodiscard]] int width() const { return kernel_->width(); }
  /// Bodies whose inertias `adaptive` estimates: all but the world.
  [[nodiscard]] std::size_t bodies() const { return bodies_; }
  /// Their true inertias (bodies, 10), in the order m, h (3), I (xx, yy, zz, xy, xz, yz) about the body's origin, in
  /// its axes.
  [[nodiscard]] std::vector<R> body_parameters() const { return parameters_; }

 private:
  [[nodiscard]] const Frame& frame_of(FrameId frame) const;
  [[nodiscard]] internal::TrackedRows<R> checked(std::size_t n, const Tracked& rows) const;
  void check_gains(std::initializer_list<std::pair<const char*, const std::vector<R>*>> gains) const;

  std::size_t nv_, bodies_;
  std::vector<Frame> frames_;
  std::vector<R> parameters_;
  std::unique_ptr<internal::ControlKernel<R>> kernel_;
};

}  // namespace manyhands
