// Controllers of one number type behind an interface of plain rows; what BatchControl chooses from.
#pragma once

#include <memory>
#include <vector>

#include "manyhands/control/impedance.h"
#include "manyhands/control/operational_space.h"
#include "manyhands/math/instantiate.h"

namespace manyhands::internal {

/// Rows (n, nq or nv) of states, and of the desired motions.
template <Real R>
struct TrackedRows {
  const R *q, *v, *q_d, *v_d, *a_d;
};

/// Rows of where a frame shall be: position (n, 3), quaternion (n, 4), velocity and acceleration (n, 6), force (n, 6).
template <Real R>
struct GoalRows {
  const R *position, *quaternion, *velocity, *acceleration, *force;
};

/// Gains (nv) of every dof; each controller reads its own.
template <Real R>
struct ControlGains {
  std::vector<R> kp{}, ki{}, kd{}, slope{}, robust{}, boundary{};
};

/// The functions of BatchControl without its checks.
template <Real R>
class ControlKernel {
 public:
  virtual ~ControlKernel() = default;
  [[nodiscard]] virtual int width() const = 0;
  virtual void gravity_torque(std::size_t n, const R* q, R* tau) = 0;
  virtual void pd_gravity(std::size_t n, const ControlGains<R>& gains, const TrackedRows<R>& rows, R* tau) = 0;
  virtual void pd_feedforward(std::size_t n, const ControlGains<R>& gains, const TrackedRows<R>& rows, R* tau) = 0;
  virtual void computed_torque(std::size_t n, const ControlGains<R>& gains, const TrackedRows<R>& rows,
                               const R* integral, R* tau) = 0;
  virtual void sliding_mode(std::size_t n, const ControlGains<R>& gains, const TrackedRows<R>& rows, R* tau) = 0;
  virtual void adaptive(std::size_t n, const ControlGains<R>& gains, const R* rate, R h, const TrackedRows<R>& rows,
                        R* theta, R* tau) = 0;
  virtual void impedance(std::size_t n, const Frame& frame, const Impedance& impedance, const R* q, const R* v,
                         const R* position, const R* quaternion, R* tau) = 0;
  virtual void operational_space(std::size_t n, const Frame& frame, const OperationalTask& task, const R* q, const R* v,
                                 const GoalRows<R>& goal, const R* posture, R* tau) = 0;
};

template <Number T>
[[nodiscard]] std::unique_ptr<ControlKernel<real_t<T>>> make_control_kernel(const Model& model);

// clang-format off
template <> std::unique_ptr<ControlKernel<double>> make_control_kernel<double>(const Model&);
template <> std::unique_ptr<ControlKernel<float>> make_control_kernel<float>(const Model&);
template <> MANYHANDS_LANES4 std::unique_ptr<ControlKernel<float>> make_control_kernel<Lanes4>(const Model&);
template <> MANYHANDS_LANES8 std::unique_ptr<ControlKernel<float>> make_control_kernel<Lanes8>(const Model&);
template <> MANYHANDS_LANES16 std::unique_ptr<ControlKernel<float>> make_control_kernel<Lanes16>(const Model&);
// clang-format on

}  // namespace manyhands::internal
