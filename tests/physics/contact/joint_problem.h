// Random joint motors and limits on random trees, and the law they must obey, written from its definition.
#pragma once

#include <algorithm>
#include <cmath>

#include "manyhands/physics/dynamics/crba.h"
#include "manyhands/physics/dynamics/state.h"
#include "tests/physics/dynamics/random_tree.h"

namespace manyhands::testing {

/// A state of a tree with motors and limits of all kinds: none, weak, strong, unreachable; far, near, reached,
/// violated.
template <Real R>
struct JointProblem {
  JointProblem(std::uint64_t seed, int links) : JointProblem(random_tree(seed, links), seed) {}

  JointProblem(Model model_, std::uint64_t seed)
      : model(std::move(model_)), tree(model), params(model), state(model, 0) {
    Generator rng(seed ^ 0x9e3779b97f4a7c15u);
    h = static_cast<R>(pick(rng, {1e-3, 2e-3, 1e-2}));
    const std::vector<double> q = random_configuration(model, rng);
    for (std::size_t i = 0; i < q.size(); ++i) state.q()[i] = static_cast<R>(q[i]);
    const double speed = pick(rng, {0.0, 1.0, 10.0});
    for (std::size_t i = 0; i < size(); ++i) {
      const double v = speed * uniform(rng, -1, 1);
      state.v()[i] = static_cast<R>(v);
      state.tau()[i] = static_cast<R>(pick(rng, {0.0, 1.0, 50.0}) * uniform(rng, -1, 1));
      state.target_q()[i] = static_cast<R>(uniform(rng, -4, 4));
      state.target_v()[i] = static_cast<R>(pick(rng, {0.0, 2.0}) * uniform(rng, -1, 1));
      params.damping[i] = static_cast<R>(pick(rng, {0.0, 0.5, 20.0}));
      params.motor_kp[i] = static_cast<R>(pick(rng, {0.0, 0.1, 1.0}));
      params.motor_kd[i] = static_cast<R>(pick(rng, {1.0, 1.0, 0.5, 0.0}));
      params.motor_max_force[i] = static_cast<R>(pick(rng, {0.0, 1.0, 20.0, 300.0, 1e5}));
      if (tree.dof_q[i] >= 0 && uniform(rng, 0, 1) < 0.7) limit(rng, i, v);
    }
  }

  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(tree.nv); }

  Model model;
  Tree<R> tree;
  ParamsStorage<R> params;
  StateStorage<R> state;
  R h{};

 private:
  static double pick(Generator& rng, std::initializer_list<double> values) {
    return values.begin()[rng() % values.size()];
  }

  void limit(Generator& rng, std::size_t i, double v) {
    const double q = state.q()[static_cast<std::size_t>(tree.dof_q[i])];
    const double near = 1e-4 + h * std::abs(v);  // what one step may reach
    const double gap = pick(rng, {1.0, near, 0.5 * near, 0.0, -0.3 * near, -0.2}), width = pick(rng, {0.0, near, 3.0});
    tree.dof_limited[i] = tree.dof_stops[i] = true;
    if (rng() % 2 == 0) {
      params.lower[i] = static_cast<R>(q - gap);
      params.upper[i] = rng() % 4 == 0 ? std::numeric_limits<R>::infinity() : static_cast<R>(q - gap + width);
    } else {
      params.upper[i] = static_cast<R>(q + gap);
      params.lower[i] = static_cast<R>(q + gap - width);
    }
  }
};

/// The law of each dof between its velocity change and its impulse, and the dense matrix that couples them. In double,
/// for numbers of type R.
struct JointLaw {
  template <Real R>
  explicit JointLaw(const JointProblem<R>& p)
      : n(p.size()), M(n * n), rhs(n), F(n), slope(n), friction(n), target(n), stop(n), lower(n), upper(n) {
    const Tree<double> tree(p.model);
    ParamsStorage<double> params(p.model);
    Workspace<double> ws(tree);
    const std::vector<double> q(p.state.q(), p.state.q() + p.tree.nq), v(p.state.v(), p.state.v() + n);
    params.gravity[0] = broadcast<double>(p.params.gravity[0]);
    bias_and_mass_matrix(tree, params, q.data(), v.data(), ws);
    const double h = p.h;
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j <= i; ++j) M[i * n + j] = M[j * n + i] = mass_matrix_entry(tree, ws, i, j);
      M[i * n + i] += h * p.params.damping[i];
      rhs[i] = h * (p.state.tau()[i] - ws.bias[i] - p.params.damping[i] * v[i]);
    }
    const std::vector<double> free = solved(rhs);
    for (std::size_t i = 0; i < n; ++i) {
      F[i] = h * (p.params.motor_max_force[i] > 0 ? p.params.motor_max_force[i] : p.params.friction[i]);
      stop[i] = -v[i];
      const double kd = p.params.motor_kd[i];
      double wanted = (1 - kd) * (v[i] + free[i]) + kd * p.state.target_v()[i];
      lower[i] = -std::numeric_limits<double>::infinity();
      upper[i] = -lower[i];
      if (p.tree.dof_q[i] >= 0) {
        const double at = q[static_cast<std::size_t>(p.tree.dof_q[i])], low = p.params.lower[i],
                     high = p.params.upper[i];
        const double goal =
            p.tree.dof_limited[i] ? std::clamp<double>(p.state.target_q()[i], low, high) : p.state.target_q()[i];
        wanted += p.params.motor_kp[i] * (goal - at) / h;
        if (p.tree.dof_limited[i]) {  // reaches the limit by the step's end; from outside, a fifth of the way
          lower[i] = (at < low ? std::min(0.2 * (low - at) / h, 1.0) : (low - at) / h) - v[i];
          upper[i] = (at > high ? -std::min(0.2 * (at - high) / h, 1.0) : (high - at) / h) - v[i];
        }
      }
      target[i] = wanted - v[i];
      if (!(p.params.motor_max_force[i] > 0)) target[i] = F[i] > 0 ? stop[i] : std::numeric_limits<double>::infinity();
      if (p.tree.dof_drive[i] >= 0) drive(p, i, q);
    }
  }

  /// The drive of dof i, implicit in the velocity at the step's end, and the friction beside it.
  template <Real R>
  void drive(const JointProblem<R>& p, std::size_t i, const std::vector<double>& q) {
    const auto k = static_cast<std::size_t>(p.tree.dof_drive[i]);
    const TreeActuator<R>& actuator = p.tree.actuators[k];
    const double h = p.h, gear = p.params.gear[k], kp = p.params.drive_kp[k], kd = p.params.drive_kd[k];
    const double ctrl = p.state.ctrl()[k];
    const bool position = actuator.type == ActuatorType::kPosition;
    slope[i] = h * gear * gear * (h * kp + kd);
    const double at_rest = h * gear * (position ? kp * (ctrl - gear * q[actuator.q]) : kd * ctrl);
    friction[i] = h * p.params.friction[i];
    F[i] = slope[i] > 0 ? std::min(h * double{p.params.drive_max_force[k]}, contact_settings::kMaxImpulse) : 0;
    target[i] = (slope[i] > 0 ? at_rest / slope[i] : 0) + stop[i];
    is_drive.push_back(i);
  }

  /// The least and the largest impulse of motor, drive and friction at dv, which is known to `slack`.
  [[nodiscard]] std::pair<double, double> range_at(std::size_t i, double dv, double slack) const {
    if (std::ranges::find(is_drive, i) == is_drive.end())
      return {dv < target[i] - slack ? F[i] : -F[i], dv > target[i] + slack ? -F[i] : F[i]};
    const auto driven = [&](double at) { return std::clamp(slope[i] * (target[i] - at), -F[i], F[i]); };
    return {driven(dv + slack) + (dv < stop[i] - slack ? friction[i] : -friction[i]),
            driven(dv - slack) + (dv > stop[i] + slack ? -friction[i] : friction[i])};
  }

  /// M^-1 b by Cholesky, dense.
  [[nodiscard]] std::vector<double> solved(std::vector<double> b) const {
    std::vector<double> L = M;
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t k = 0; k < j; ++k) L[j * n + j] -= L[j * n + k] * L[j * n + k];
      L[j * n + j] = std::sqrt(L[j * n + j]);
      for (std::size_t i = j + 1; i < n; ++i) {
        for (std::size_t k = 0; k < j; ++k) L[i * n + j] -= L[i * n + k] * L[j * n + k];
        L[i * n + j] /= L[j * n + j];
      }
    }
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = 0; k < i; ++k) b[i] -= L[i * n + k] * b[k];
      b[i] /= L[i * n + i];
    }
    for (std::size_t i = n; i-- > 0;) {
      for (std::size_t k = i + 1; k < n; ++k) b[i] -= L[k * n + i] * b[k];
      b[i] /= L[i * n + i];
    }
    return b;
  }

  /// The worst violation of the law by dv, relative: of the limits (by speeds) or of the impulses that dv calls for.
  [[nodiscard]] double residual(const std::vector<double>& dv, double speed_slack) const {
    double worst = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const double slack = speed_slack * (1 + std::abs(dv[i])), infinity = std::numeric_limits<double>::infinity();
      worst = std::max({worst, (lower[i] - dv[i]) / (1 + std::abs(dv[i])), (dv[i] - upper[i]) / (1 + std::abs(dv[i]))});
      const double at_hand = slope[i] > 0 ? std::min(F[i], slope[i] * (1 + std::abs(target[i]))) : F[i];
      double impulse = -rhs[i], scale = at_hand + friction[i] + std::abs(rhs[i]);
      for (std::size_t j = 0; j < n; ++j) {
        impulse += M[i * n + j] * dv[j];
        scale += std::abs(M[i * n + j] * dv[j]);
      }
      auto [least, most] = range_at(i, dv[i], slack);
      if (dv[i] >= upper[i] - slack) least = -infinity;
      if (dv[i] <= lower[i] + slack) most = infinity;
      worst = std::max({worst, (least - impulse) / scale, (impulse - most) / scale});
    }
    return worst;
  }

  /// The same problem by another road: each dof in turn takes its place on its force law while the others wait, until
  /// nothing moves. Slow and sure: coordinate descent on a strictly convex function.
  [[nodiscard]] std::vector<double> by_gauss_seidel(int max_iterations) const {
    std::vector<double> dv(n, 0.0);
    for (std::size_t i = 0; i < n; ++i) dv[i] = std::clamp(0.0, lower[i], upper[i]);
    for (int iteration = 0; iteration < max_iterations; ++iteration) {
      double change = 0;
      for (std::size_t i = 0; i < n; ++i) {
        double push = rhs[i];
        for (std::size_t j = 0; j < n; ++j) push -= j == i ? 0.0 : M[i * n + j] * dv[j];
        const double fast = (push + F[i]) / M[i * n + i], slow = (push - F[i]) / M[i * n + i];
        const double next = std::clamp(std::clamp(target[i], slow, fast), lower[i], upper[i]);
        change = std::max(change, std::abs(next - dv[i]) / (1 + std::abs(next)));
        dv[i] = next;
      }
      if (change < 1e-15) break;
    }
    return dv;
  }

  std::size_t n;
  std::vector<double> M, rhs, F, slope, friction, target, stop, lower, upper;
  std::vector<std::size_t> is_drive{};  ///< the dofs that have one
};

}  // namespace manyhands::testing
