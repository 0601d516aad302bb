// RowKernel over any number type; included by the few sources that instantiate it.
#pragma once

#include <algorithm>
#include <array>

#include "manyhands/physics/dynamics/aba.h"
#include "manyhands/physics/dynamics/crba.h"
#include "manyhands/physics/dynamics/energy.h"
#include "manyhands/physics/dynamics/jacobians.h"
#include "manyhands/physics/dynamics/row_kernel.h"

namespace manyhands::internal {

/// An array (n, columns).
template <class R>
struct Rows {
  R* data;
  std::size_t columns;
};

template <Number T>
class RowKernelOf final : public RowKernel<real_t<T>> {
  using R = real_t<T>;
  static constexpr std::size_t kWidth = width_v<T>;

 public:
  explicit RowKernelOf(const Model& model)
      : tree_(model),
        params_(model),
        ws_(tree_),
        nq_(static_cast<std::size_t>(model.nq())),
        nv_(static_cast<std::size_t>(model.nv())),
        in_(nq_ + 2 * nv_, T(R(0))),
        out_(std::max({nv_ * nv_, 6 * nv_, 7 * model.frames().size()}), T(R(0))) {}

  [[nodiscard]] int width() const override { return width_v<T>; }

  void rnea(std::size_t n, const R* q, const R* v, const R* a, R* tau) override {
    for_each_block<3, 1>(n, {{{q, nq_}, {v, nv_}, {a, nv_}}}, {{{tau, nv_}}}, [&](const auto& in, const auto& out) {
      manyhands::rnea(tree_, params_, in[0], in[1], in[2], out[0], ws_);
    });
  }

  void aba(std::size_t n, const R* q, const R* v, const R* tau, R* a) override {
    for_each_block<3, 1>(n, {{{q, nq_}, {v, nv_}, {tau, nv_}}}, {{{a, nv_}}}, [&](const auto& in, const auto& out) {
      manyhands::aba(tree_, params_, in[0], in[1], in[2], out[0], ws_);
    });
  }

  void crba(std::size_t n, const R* q, R* M) override {
    for_each_block<1, 1>(n, {{{q, nq_}}}, {{{M, nv_ * nv_}}}, [&](const auto& in, const auto& out) {
      manyhands::crba(tree_, params_, in[0], ws_);
      for (std::size_t i = 0; i < nv_; ++i) {
        for (std::size_t j = 0; j <= i; ++j)
          out[0][i * nv_ + j] = out[0][j * nv_ + i] = mass_matrix_entry(tree_, ws_, i, j);
      }
    });
  }

  void frame_poses(std::size_t n, const R* q, std::span<const Frame> frames, R* position, R* quaternion) override {
    const std::size_t nf = frames.size();
    for_each_block<1, 2>(n, {{{q, nq_}}}, {{{position, 3 * nf}, {quaternion, 4 * nf}}},
                         [&](const auto& in, const auto& out) {
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
    for_each_block<1, 1>(n, {{{q, nq_}}}, {{{J, 6 * nv_}}}, [&](const auto& in, const auto& out) {
      manyhands::forward_kinematics(tree_, in[0], ws_);
      std::fill_n(out[0], 6 * nv_, T(R(0)));
      visit_jacobian(tree_, form, frame.body, X_BF, ws_,
                     [&](int dof, const Motion<T>& m) { set_column(out[0], dof, m); });
    });
  }

  void jacobian_derivative(std::size_t n, const R* q, const R* v, const Frame& frame, JacobianForm form,
                           R* dJ) override {
    const Transform<R> X_BF = broadcast<R>(frame.X_BF);
    for_each_block<2, 1>(n, {{{q, nq_}, {v, nv_}}}, {{{dJ, 6 * nv_}}}, [&](const auto& in, const auto& out) {
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
    for_each_block<1, 1>(n, {{{q, nq_}}}, {{{com, 3}}}, [&](const auto& in, const auto& out) {
      const Vec3<T> c = mass_properties(tree_, params_, in[0], at_rest.data(), ws_).com;
      std::ranges::copy(std::array{c.x, c.y, c.z}, out[0]);
    });
  }

  void momentum(std::size_t n, const R* q, const R* v, R* momentum) override {
    for_each_block<2, 1>(n, {{{q, nq_}, {v, nv_}}}, {{{momentum, 6}}}, [&](const auto& in, const auto& out) {
      const Force<T> p = mass_properties(tree_, params_, in[0], in[1], ws_).momentum;
      std::ranges::copy(std::array{p.n.x, p.n.y, p.n.z, p.f.x, p.f.y, p.f.z}, out[0]);
    });
  }

  void energy(std::size_t n, const R* q, const R* v, R* kinetic, R* potential) override {
    for_each_block<2, 2>(n, {{{q, nq_}, {v, nv_}}}, {{{kinetic, 1}, {potential, 1}}},
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

  /// Turns `count` rows from `first` on into lanes; lanes beyond repeat the last row.
  static void load_rows(const Rows<const R>& rows, std::size_t first, std::size_t count, T* to) {
    for (std::size_t k = 0; k < kWidth; ++k) {
      const R* row = rows.data + (first + std::min(k, count - 1)) * rows.columns;
      for (std::size_t c = 0; c < rows.columns; ++c) set_lane(to[c], static_cast<int>(k), row[c]);
    }
  }

  static void store_rows(const T* from, std::size_t first, std::size_t count, const Rows<R>& rows) {
    for (std::size_t k = 0; k < count; ++k) {
      R* row = rows.data + (first + k) * rows.columns;
      for (std::size_t c = 0; c < rows.columns; ++c) row[c] = lane(from[c], static_cast<int>(k));
    }
  }

  template <std::size_t I, std::size_t O, class Body>
  void for_each_block(std::size_t n, const std::array<Rows<const R>, I>& inputs, const std::array<Rows<R>, O>& outputs,
                      Body&& body) {
    std::array<T*, I> in;
    std::array<T*, O> out;
    T* next = in_.data();
    for (std::size_t i = 0; i < I; ++i) {
      in[i] = next;
      next += inputs[i].columns;
    }
    next = out_.data();
    for (std::size_t i = 0; i < O; ++i) {
      out[i] = next;
      next += outputs[i].columns;
    }
    for (std::size_t first = 0; first < n; first += kWidth) {
      const std::size_t count = std::min(kWidth, n - first);
      for (std::size_t i = 0; i < I; ++i) load_rows(inputs[i], first, count, in[i]);
      body(in, out);
      for (std::size_t i = 0; i < O; ++i) store_rows(out[i], first, count, outputs[i]);
    }
  }

  Tree<R> tree_;
  ParamsStorage<R> params_;
  Workspace<T> ws_;
  std::size_t nq_, nv_;
  std::vector<T> in_, out_;  // one block
};

}  // namespace manyhands::internal
