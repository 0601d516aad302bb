// RowKernel over any number type; included by the few sources that instantiate it.
#pragma once

#include <algorithm>
#include <array>

#include "manyhands/physics/dynamics/aba.h"
#include "manyhands/physics/dynamics/crba.h"
#include "manyhands/physics/dynamics/energy.h"
#include "manyhands/physics/dynamics/jacobians.h"
#include "manyhands/physics/dynamics/row_blocks.h"
#include "manyhands/physics/dynamics/row_kernel.h"

namespace manyhands::internal {

template <Number T>
class RowKernelOf final : public RowKernel<real_t<T>> {
  using R = real_t<T>;

 public:
  explicit RowKernelOf(const Model& model)
      : tree_(model),
        params_(model),
        ws_(tree_),
        nq_(static_cast<std::size_t>(model.nq())),
        nv_(static_cast<std::size_t>(model.nv())),
        blocks_(nq_ + 2 * nv_, std::max({nv_ * nv_, 6 * nv_, 7 * model.frames().size()})) {}

  [[nodiscard]] int width() const override { return width_v<T>; }

  void rnea(std::size_t n, const R* q, const R* v, const R* a, R* tau) override {
    blocks_.template for_each<3, 1>(
        n, {{{q, nq_}, {v, nv_}, {a, nv_}}}, {{{tau, nv_}}},
        [&](const auto& in, const auto& out) { manyhands::rnea(tree_, params_, in[0], in[1], in[2], out[0], ws_); });
  }

  void aba(std::size_t n, const R* q, const R* v, const R* tau, R* a) override {
    blocks_.template for_each<3, 1>(
        n, {{{q, nq_}, {v, nv_}, {tau, nv_}}}, {{{a, nv_}}},
        [&](const auto& in, const auto& out) { manyhands::aba(tree_, params_, in[0], in[1], in[2], out[0], ws_); });
  }

  void crba(std::size_t n, const R* q, R* M) override {
    blocks_.template for_each<1, 1>(n, {{{q, nq_}}}, {{{M, nv_ * nv_}}}, [&](const auto& in, const auto& out) {
      manyhands::crba(tree_, params_, in[0], ws_);
      for (std::size_t i = 0; i < nv_; ++i) {
        for (std::size_t j = 0; j <= i; ++j)
          out[0][i * nv_ + j] = out[0][j * nv_ + i] = mass_matrix_entry(tree_, ws_, i, j);
      }
    });
  }

  void frame_poses(std::size_t n, const R* q, std::span<const Frame> frames, R* position, R* quaternion) override {
    const std::size_t nf = frames.size();
    blocks_.template for_each<1, 2>(
        n, {{{q, nq_}}}, {{{position, 3 * nf}, {quaternion, 4 * nf}}}, [&](const auto& in, const auto& out) {
          manyhands::forward_kinematics(tree_, in[0], ws_);
          for (std::size_t f = 0; f < nf; ++f) {
            const Transform<T> X_WF = frame_pose(frames[f].body, broadcast<R>(frames[f].X_BF), ws_);
            const Quat<T> r = to_quat(X_WF.R);
            std::ranges::copy(std::array{X_WF.p.x, X_WF.p.y, X_WF.p.z}, out[0] + 3 * f);
            std::ranges::copy(std::array{r.x, r.y, r.z, r.w}, out[1] + 4 * f);
          }
        });
  }

  void jacobian(std::size_t n, const R* q, const Frame& frame, JacobianForm form, R* J) override {
    const Transform<R> X_BF = broadcast<R>(frame.X_BF);
    blocks_.template for_each<1, 1>(n, {{{q, nq_}}}, {{{J, 6 * nv_}}}, [&](const auto& in, const auto& out) {
      manyhands::forward_kinematics(tree_, in[0], ws_);
      std::fill_n(out[0], 6 * nv_, T(R(0)));
      visit_jacobian(tree_, form, frame.body, X_BF, ws_,
                     [&](int dof, const Motion<T>& m) { set_column(out[0], dof, m); });
    });
  }

  void jacobian_derivative(std::size_t n, const R* q, const R* v, const Frame& frame, JacobianForm form,
                           R* dJ) override {
    const Transform<R> X_BF = broadcast<R>(frame.X_BF);
    blocks_.template for_each<2, 1>(n, {{{q, nq_}, {v, nv_}}}, {{{dJ, 6 * nv_}}}, [&](const auto& in, const auto& out) {
      for (std::size_t b = 1; b < tree_.bodies.size(); ++b) {
        place(tree_, b, in[0], ws_);
        move(tree_, b, in[1], ws_);
      }
      std::fill_n(out[0], 6 * nv_, T(R(0)));
      visit_jacobian_derivative(tree_, form, frame.body, X_BF, ws_,
                                [&](int dof, const Motion<T>& m) { set_column(out[0], dof, m); });
    });
  }

  void center_of_mass(std::size_t n, const R* q, R* com) override {
    const std::vector<T> at_rest(nv_, T(R(0)));
    blocks_.template for_each<1, 1>(n, {{{q, nq_}}}, {{{com, 3}}}, [&](const auto& in, const auto& out) {
      const Vec3<T> c = mass_properties(tree_, params_, in[0], at_rest.data(), ws_).com;
      std::ranges::copy(std::array{c.x, c.y, c.z}, out[0]);
    });
  }

  void momentum(std::size_t n, const R* q, const R* v, R* momentum) override {
    blocks_.template for_each<2, 1>(n, {{{q, nq_}, {v, nv_}}}, {{{momentum, 6}}}, [&](const auto& in, const auto& out) {
      const Force<T> p = mass_properties(tree_, params_, in[0], in[1], ws_).momentum;
      std::ranges::copy(std::array{p.n.x, p.n.y, p.n.z, p.f.x, p.f.y, p.f.z}, out[0]);
    });
  }

  void energy(std::size_t n, const R* q, const R* v, R* kinetic, R* potential) override {
    blocks_.template for_each<2, 2>(n, {{{q, nq_}, {v, nv_}}}, {{{kinetic, 1}, {potential, 1}}},
                                    [&](const auto& in, const auto& out) {
                                      const Energy<T> e = manyhands::energy(tree_, params_, in[0], in[1], ws_);
                                      *out[0] = e.kinetic;
                                      *out[1] = e.potential;
                                    });
  }

 private:
  /// Of a matrix (6, nv).
  void set_column(T* J, int dof, const Motion<T>& m) const {
    const std::array column{m.w.x, m.w.y, m.w.z, m.v.x, m.v.y, m.v.z};
    for (std::size_t i = 0; i < 6; ++i) J[i * nv_ + static_cast<std::size_t>(dof)] = column[i];
  }

  Tree<R> tree_;
  ParamsStorage<R> params_;
  Workspace<T> ws_;
  std::size_t nq_, nv_;
  RowBlocks<T> blocks_;
};

}  // namespace manyhands::internal
