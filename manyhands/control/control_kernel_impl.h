// ControlKernel over any number type; included by the few sources that instantiate it.
#pragma once

#include "manyhands/control/control_kernel.h"
#include "manyhands/control/sliding_control.h"
#include "manyhands/physics/dynamics/row_blocks.h"

namespace manyhands::internal {

template <Number T>
class ControlKernelOf final : public ControlKernel<real_t<T>> {
  using R = real_t<T>;

 public:
  explicit ControlKernelOf(const Model& model)
      : tree_(model),
        params_(model),
        ws_(tree_),
        reference_(tree_),
        operational_(tree_),
        nv_(static_cast<std::size_t>(model.nv())),
        theta_(kBodyParameters * (tree_.bodies.size() - 1)),
        blocks_(5 * nv_ + std::max<std::size_t>(theta_, nv_ + 25), nv_ + theta_) {}

  [[nodiscard]] int width() const override { return width_v<T>; }

  void gravity_torque(std::size_t n, const R* q, R* tau) override {
    blocks_.template for_each<1, 1>(n, {{{q, nv_}}}, {{{tau, nv_}}}, [&](const auto& in, const auto& out) {
      manyhands::gravity_torque(tree_, params_, in[0], out[0], ws_);
    });
  }

  void pd_gravity(std::size_t n, const ControlGains<R>& gains, const TrackedRows<R>& rows, R* tau) override {
    track<5>(n, tracked(rows), tau, [&](const auto& in, T* out) {
      manyhands::pd_gravity(tree_, params_, pd_of(gains), in[0], in[1], desired(in), out, ws_);
    });
  }

  void pd_feedforward(std::size_t n, const ControlGains<R>& gains, const TrackedRows<R>& rows, R* tau) override {
    track<5>(n, tracked(rows), tau, [&](const auto& in, T* out) {
      manyhands::pd_feedforward(tree_, params_, pd_of(gains), in[0], in[1], desired(in), out, ws_);
    });
  }

  void computed_torque(std::size_t n, const ControlGains<R>& gains, const TrackedRows<R>& rows, const R* integral,
                       R* tau) override {
    const auto five = tracked(rows);
    track<6>(n, {five[0], five[1], five[2], five[3], five[4], {integral, nv_}}, tau, [&](const auto& in, T* out) {
      manyhands::computed_torque(tree_, params_, pd_of(gains), in[0], in[1], desired(in), gains.ki.data(), in[5], out,
                                 ws_);
    });
  }

  void sliding_mode(std::size_t n, const ControlGains<R>& gains, const TrackedRows<R>& rows, R* tau) override {
    track<5>(n, tracked(rows), tau, [&](const auto& in, T* out) {
      manyhands::sliding_mode(tree_, params_, sliding_of(gains), in[0], in[1], desired(in), out, reference_, ws_);
    });
  }

  void adaptive(std::size_t n, const ControlGains<R>& gains, const R* rate, R h, const TrackedRows<R>& rows, R* theta,
                R* tau) override {
    const auto five = tracked(rows);
    blocks_.template for_each<6, 2>(n, {{five[0], five[1], five[2], five[3], five[4], {theta, theta_}}},
                                    {{{tau, nv_}, {theta, theta_}}}, [&](const auto& in, const auto& out) {
                                      manyhands::adaptive(tree_, params_, sliding_of(gains), rate, h, in[0], in[1],
                                                          desired(in), in[5], out[0], reference_, ws_);
                                      std::copy_n(in[5], theta_, out[1]);
                                    });
  }

  void impedance(std::size_t n, const Frame& frame, const Impedance& impedance, const R* q, const R* v,
                 const R* position, const R* quaternion, R* tau) override {
    const Transform<R> X_BF = broadcast<R>(frame.X_BF);
    const std::span<const int> path = tree_.path_of(frame.body.index());
    const std::vector<std::size_t> dofs(path.begin(), path.end());
    for (T& zero : zeros_) zero = T(R(0));
    track<4>(n, {{{q, nv_}, {v, nv_}, {position, 3}, {quaternion, 4}}}, tau, [&](const auto& in, T* out) {
      rnea(tree_, params_, in[0], in[1], zeros_.data(), out, ws_);
      const std::size_t b = frame.body.index();
      const Transform<T> X_WF = frame_pose(frame.body, X_BF, ws_);
      const Vec3<T> p_OF = X_WF.p - ws_.p_WO[b];
      const Force<T> F = impedance_force(impedance, pose(in[2], in[3]), X_WF, at_point(ws_.V[b], p_OF));
      add_frame_force(dofs, p_OF, F, ws_, out);
    });
  }

  void operational_space(std::size_t n, const Frame& frame, const OperationalTask& task, const R* q, const R* v,
                         const GoalRows<R>& goal, const R* posture, R* tau) override {
    const Transform<R> X_BF = broadcast<R>(frame.X_BF);
    const std::size_t posture_columns = posture == nullptr ? 0 : nv_;
    track<8>(n,
             {{{q, nv_},
               {v, nv_},
               {goal.position, 3},
               {goal.quaternion, 4},
               {goal.velocity, 6},
               {goal.acceleration, 6},
               {goal.force, 6},
               {posture, posture_columns}}},
             tau, [&](const auto& in, T* out) {
               const OperationalGoal<T> there{
                   pose(in[2], in[3]), motion(in[4]), motion(in[5]), {motion(in[6]).w, motion(in[6]).v}};
               manyhands::operational_space(tree_, params_, frame.body, X_BF, task, in[0], in[1], there,
                                            posture == nullptr ? nullptr : in[7], out, operational_, ws_);
             });
  }

 private:
  [[nodiscard]] std::array<Rows<const R>, 5> tracked(const TrackedRows<R>& rows) const {
    return {{{rows.q, nv_}, {rows.v, nv_}, {rows.q_d, nv_}, {rows.v_d, nv_}, {rows.a_d, nv_}}};
  }
  [[nodiscard]] static JointMotion<T> desired(const auto& in) { return {in[2], in[3], in[4]}; }
  [[nodiscard]] static JointGains<R> pd_of(const ControlGains<R>& gains) { return {gains.kp.data(), gains.kd.data()}; }
  [[nodiscard]] static SlidingGains<R> sliding_of(const ControlGains<R>& gains) {
    return {gains.slope.data(), gains.kd.data(), gains.robust.data(), gains.boundary.data()};
  }
  [[nodiscard]] static Motion<T> motion(const T* x) { return {{x[0], x[1], x[2]}, {x[3], x[4], x[5]}}; }
  [[nodiscard]] static Transform<T> pose(const T* p, const T* r) {
    return {to_matrix(normalized(Quat<T>{r[0], r[1], r[2], r[3]})), {p[0], p[1], p[2]}};
  }

  /// One output: the joint forces.
  template <std::size_t I, class Body>
  void track(std::size_t n, const std::array<Rows<const R>, I>& inputs, R* tau, Body&& body) {
    blocks_.template for_each<I, 1>(n, inputs, {{{tau, nv_}}},
                                    [&](const auto& in, const auto& out) { body(in, out[0]); });
  }

  Tree<R> tree_;
  ParamsStorage<R> params_;
  Workspace<T> ws_;
  ReferenceWorkspace<T> reference_;
  OperationalWorkspace<T> operational_;
  std::size_t nv_, theta_;
  RowBlocks<T> blocks_;
  std::vector<T> zeros_ = std::vector<T>(nv_, T(R(0)));
};

}  // namespace manyhands::internal
