#include "manyhands/control/batch_control.h"

#include "manyhands/control/joint_control.h"
#include "manyhands/control/sliding_control.h"
#include "manyhands/math/for_width.h"

namespace manyhands {

namespace {

template <Real R>
std::unique_ptr<internal::ControlKernel<R>> choose_kernel(const Model& model, int width) {
  require_single_joints(model);
  if constexpr (std::same_as<R, double>) {
    if (width == 0 || width == 1) return internal::make_control_kernel<double>(model);
    throw std::invalid_argument("width is " + std::to_string(width) + "; double runs one row at a time: 0 or 1");
  } else {
    if (width == 0) width = width_v<NativeLanes>;
    return for_width("width", width, []<class T>() { return &internal::make_control_kernel<T>; })(model);
  }
}

template <class R>
R* rows(const char* name, std::span<R> array, std::size_t n, std::size_t columns) {
  if (array.size() == n * columns) return array.data();
  throw std::invalid_argument(std::string(name) + " holds " + std::to_string(array.size()) + " numbers; expected " +
                              std::to_string(n) + " rows of " + std::to_string(columns));
}

template <Real R>
std::vector<R> parameters_of(const Model& model) {
  const ParamsStorage<double> params(model);
  std::vector<R> numbers;
  for (std::size_t b = 1; b < params.inertia.size(); ++b) {
    const RigidInertia<double>& i = params.inertia[b];
    for (const double x : {i.m, i.h.x, i.h.y, i.h.z, i.I.xx, i.I.yy, i.I.zz, i.I.xy, i.I.xz, i.I.yz})
      numbers.push_back(static_cast<R>(x));
  }
  return numbers;
}

}  // namespace

template <Real R>
BatchControl<R>::BatchControl(const Model& model, int width)
    : nv_(static_cast<std::size_t>(model.nv())),
      bodies_(model.bodies().size() - 1),
      frames_(model.frames().begin(), model.frames().end()),
      parameters_(parameters_of<R>(model)),
      kernel_(choose_kernel<R>(model, width)) {}

template <Real R>
const Frame& BatchControl<R>::frame_of(FrameId frame) const {
  if (frame.is_valid() && frame.index() < frames_.size()) return frames_[frame.index()];
  throw std::invalid_argument("frame " + std::to_string(frame.value()) + " does not exist; the model has " +
                              std::to_string(frames_.size()) + " frames");
}

template <Real R>
internal::TrackedRows<R> BatchControl<R>::checked(std::size_t n, const Tracked& given) const {
  return {rows("q", given.q, n, nv_), rows("v", given.v, n, nv_), rows("desired q", given.q_d, n, nv_),
          rows("desired v", given.v_d, n, nv_), rows("desired a", given.a_d, n, nv_)};
}

template <Real R>
void BatchControl<R>::check_gains(std::initializer_list<std::pair<const char*, const std::vector<R>*>> gains) const {
  for (const auto& [name, values] : gains) (void)rows(name, std::span<const R>(*values), 1, nv_);
}

template <Real R>
void BatchControl<R>::gravity_torque(std::size_t n, std::span<const R> q, std::span<R> tau) {
  kernel_->gravity_torque(n, rows("q", q, n, nv_), rows("tau", tau, n, nv_));
}

template <Real R>
void BatchControl<R>::pd_gravity(std::size_t n, const Gains& gains, const Tracked& given, std::span<R> tau) {
  check_gains({{"kp", &gains.kp}, {"kd", &gains.kd}});
  kernel_->pd_gravity(n, gains, checked(n, given), rows("tau", tau, n, nv_));
}

template <Real R>
void BatchControl<R>::pd_feedforward(std::size_t n, const Gains& gains, const Tracked& given, std::span<R> tau) {
  check_gains({{"kp", &gains.kp}, {"kd", &gains.kd}});
  kernel_->pd_feedforward(n, gains, checked(n, given), rows("tau", tau, n, nv_));
}

template <Real R>
void BatchControl<R>::computed_torque(std::size_t n, const Gains& gains, const Tracked& given,
                                      std::span<const R> integral, std::span<R> tau) {
  check_gains({{"kp", &gains.kp}, {"ki", &gains.ki}, {"kd", &gains.kd}});
  kernel_->computed_torque(n, gains, checked(n, given), rows("integral", integral, n, nv_), rows("tau", tau, n, nv_));
}

template <Real R>
void BatchControl<R>::sliding_mode(std::size_t n, const Gains& gains, const Tracked& given, std::span<R> tau) {
  check_gains({{"slope", &gains.slope}, {"kd", &gains.kd}, {"robust", &gains.robust}, {"boundary", &gains.boundary}});
  kernel_->sliding_mode(n, gains, checked(n, given), rows("tau", tau, n, nv_));
}

template <Real R>
void BatchControl<R>::adaptive(std::size_t n, const Gains& gains, std::span<const R> rate, R h, const Tracked& given,
                               std::span<R> theta, std::span<R> tau) {
  check_gains({{"slope", &gains.slope}, {"kd", &gains.kd}});
  kernel_->adaptive(n, gains, rows("rate", rate, 1, kBodyParameters), h, checked(n, given),
                    rows("theta", theta, n, bodies_ * kBodyParameters), rows("tau", tau, n, nv_));
}

template <Real R>
void BatchControl<R>::impedance(std::size_t n, FrameId frame, const Impedance& impedance, std::span<const R> q,
                                std::span<const R> v, std::span<const R> position, std::span<const R> quaternion,
                                std::span<R> tau) {
  kernel_->impedance(n, frame_of(frame), impedance, rows("q", q, n, nv_), rows("v", v, n, nv_),
                     rows("position", position, n, 3), rows("quaternion", quaternion, n, 4), rows("tau", tau, n, nv_));
}

template <Real R>
void BatchControl<R>::operational_space(std::size_t n, FrameId frame, const OperationalTask& task, std::span<const R> q,
                                        std::span<const R> v, const Goal& goal, std::span<const R> posture,
                                        std::span<R> tau) {
  const internal::GoalRows<R> there{rows("position", goal.position, n, 3), rows("quaternion", goal.quaternion, n, 4),
                                    rows("velocity", goal.velocity, n, 6),
                                    rows("acceleration", goal.acceleration, n, 6), rows("force", goal.force, n, 6)};
  const R* const second = posture.empty() ? nullptr : rows("posture", posture, n, nv_);
  kernel_->operational_space(n, frame_of(frame), task, rows("q", q, n, nv_), rows("v", v, n, nv_), there, second,
                             rows("tau", tau, n, nv_));
}

template class BatchControl<double>;
template class BatchControl<float>;

}  // namespace manyhands
