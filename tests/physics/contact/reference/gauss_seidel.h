// Nonlinear Gauss-Seidel on the velocity (Jourdan, Alart, Jean 1998; Bonnefon and Daviet 2011; Hwangbo et al. 2018):
// each contact in turn is solved exactly while the others keep their impulses.
#pragma once

#include <functional>

#include "tests/physics/contact/reference/problem.h"

namespace manyhands::testing {

/// One contact by itself in principal axes: u = w + G lambda, with the tangents turned so that friction's own matrix,
/// once the normal is eliminated, is diagonal.
struct LocalContact {
  double normal = 0;                                    ///< G_nn
  Eigen::Vector2d coupling = Eigen::Vector2d::Zero();   ///< G_nt
  Eigen::Vector2d stiffness = Eigen::Vector2d::Zero();  ///< of S = G_tt - G_tn G_nt / G_nn
  double mu = 0;
};

/// The contact of G's block; `turn` gets the principal tangents as columns.
inline LocalContact make_local_contact(const Eigen::Matrix3d& G, double mu, Eigen::Matrix2d& turn) {
  LocalContact contact;
  contact.mu = mu;
  contact.normal = G(0, 0);
  const Eigen::Vector2d g = G.block<2, 1>(1, 0);
  const Eigen::Matrix2d S = G.bottomRightCorner<2, 2>() - g * g.transpose() / G(0, 0);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(S);
  turn = axes.eigenvectors();
  contact.coupling = turn.transpose() * g;
  contact.stiffness = axes.eigenvalues().cwiseMax(1e-13 * G.trace());
  return contact;
}

/// The impulse that makes one contact obey the law, where its velocity (less b) would be `w` without any.
/// While it slides, u_t = -kappa lambda_t gives lambda_t(kappa) = -(S + kappa)^-1 s; kappa is where the cone is met.
/// mu lambda_n / |lambda_t| - 1 is nearly linear in kappa: Newton mostly needs three steps. It begins at 0 where the
/// cone is all but met, else at the answer for a round S. A bracket guards it; as kappa may lie orders of magnitude
/// below its upper bound, that is halved in the logarithm.
inline Eigen::Vector3d solve_local(const LocalContact& c, const Eigen::Vector3d& w) {
  if (w[0] >= 0 || c.normal <= 0) return Eigen::Vector3d::Zero();
  const double pressing = -w[0] / c.normal;
  if (c.mu <= 0) return {pressing, 0, 0};
  const Eigen::Vector2d s = w.tail<2>() + c.coupling * pressing;
  const auto friction = [&](double kappa) {
    return Eigen::Vector2d(-s.cwiseQuotient(c.stiffness + Eigen::Vector2d::Constant(kappa)));
  };
  const auto normal = [&](const Eigen::Vector2d& t) { return pressing - c.coupling.dot(t) / c.normal; };
  Eigen::Vector2d t = friction(0);
  if (t.norm() <= c.mu * normal(t)) return {normal(t), t[0], t[1]};

  double low = 0;
  double high = s.norm() * (1 + c.mu * c.coupling.norm() / c.normal) / (c.mu * pressing);
  const double stiffness = s.dot(c.stiffness.cwiseProduct(s)) / s.squaredNorm();
  const bool nearly_sticks = c.mu * normal(t) > 0.5 * t.norm();
  double kappa = nearly_sticks ? 0 : std::clamp(s.norm() / (c.mu * pressing) - stiffness, low, high);
  for (int i = 0; i < 100; ++i) {
    t = friction(kappa);
    const double length = t.norm(), n = normal(t), value = c.mu * n / length - 1;
    (value < 0 ? low : high) = kappa;
    const Eigen::Vector2d dt = -t.cwiseQuotient(c.stiffness + Eigen::Vector2d::Constant(kappa));
    const double slope = c.mu / length * (-c.coupling.dot(dt) / c.normal - n * t.dot(dt) / (length * length));
    double next = kappa - value / slope;
    if (!(next >= low && next <= high)) {
      next = std::min(std::sqrt(std::max(low, 1e-3 * c.stiffness.minCoeff()) * high), 0.5 * (low + high));
    }
    if (std::abs(value) < 1e-15 || next == kappa) break;
    kappa = next;
  }
  const double n = std::max(normal(t), 0.0);
  t *= c.mu * n / t.norm();
  return {n, t[0], t[1]};
}

/// How the sweeps are made faster; see docs/contact_solver.md.
enum class Acceleration { kNone, kConjugate, kNesterov, kAnderson };

struct GaussSeidelOptions {
  int max_sweeps = 10000;
  double tolerance = 1e-12;  ///< of the law's residual, relative to the problem's scale
  bool symmetric = false;    ///< every second sweep backwards
  double relaxation = 1;
  Acceleration acceleration = Acceleration::kNone;
  int depth = 5;  ///< Anderson's memory
};

/// Called after every sweep with the answer so far; false ends the run.
using Observer = std::function<bool(const ReferenceSolution&)>;

class GaussSeidel {
 public:
  explicit GaussSeidel(const ReferenceProblem& problem) : problem_(problem) {
    const SparseMatrix& Y = problem.response;
    for (int i = 0; i < problem.contacts(); ++i) {
      Contact contact;
      Eigen::Matrix2d turn;
      contact.local = make_local_contact(problem.delassus[static_cast<std::size_t>(i)], problem.mu[i], turn);
      contact.turn.setIdentity();
      contact.turn.bottomRightCorner<2, 2>() = turn;
      const SparseMatrix Jt = SparseRows(problem.J.middleRows(3 * i, 3)).transpose();
      contact.J = gather(Jt, contact.turn, contact.J_count);
      contact.Y = gather(Y.middleCols(3 * i, 3), contact.turn, contact.Y_count);
      contacts_.push_back(contact);
    }
  }

  /// From `start` (its v is recomputed) until `observe` says no or the sweeps are spent.
  ReferenceSolution solve(const Eigen::VectorXd& start, const GaussSeidelOptions& options, const Observer& observe);

  /// One sweep in place.
  void sweep(ReferenceSolution& x, bool backwards, double relaxation) const {
    const int n = problem_.contacts();
    for (int k = 0; k < n; ++k) update(x, backwards ? n - 1 - k : k, relaxation);
  }

 private:
  struct Entry {
    int dof;
    Eigen::Vector3d value;
  };
  struct Contact {
    LocalContact local;
    Eigen::Matrix3d turn;
    int J = 0, J_count = 0, Y = 0, Y_count = 0;  ///< ranges of `entries_`
  };

  /// The rows of a matrix of three columns that are not empty, with the columns turned to principal axes.
  int gather(const SparseMatrix& columns, const Eigen::Matrix3d& turn, int& count) {
    const auto begin = static_cast<int>(entries_.size());
    const SparseRows rows(columns);
    for (int dof = 0; dof < rows.outerSize(); ++dof) {
      Eigen::Vector3d value = Eigen::Vector3d::Zero();
      bool found = false;
      for (SparseRows::InnerIterator it(rows, dof); it; ++it, found = true) value[it.col()] = it.value();
      if (found) entries_.push_back({dof, turn.transpose() * value});
    }
    count = static_cast<int>(entries_.size()) - begin;
    return begin;
  }

  void update(ReferenceSolution& x, int i, double relaxation) const {
    const Contact& c = contacts_[static_cast<std::size_t>(i)];
    Eigen::Vector3d u(-problem_.b[i], 0, 0);
    for (int k = c.J; k < c.J + c.J_count; ++k) {
      u += entries_[static_cast<std::size_t>(k)].value * x.v[entries_[static_cast<std::size_t>(k)].dof];
    }
    const Eigen::Vector3d before = c.turn.transpose() * x.lambda.segment<3>(3 * i);
    const LocalContact& local = c.local;
    Eigen::Vector3d w = u;
    w[0] -= local.normal * before[0] + local.coupling.dot(before.tail<2>());
    const Eigen::Vector2d g = local.coupling;
    w.tail<2>() -=
        g * before[0] + local.stiffness.cwiseProduct(before.tail<2>()) + g * (g.dot(before.tail<2>()) / local.normal);
    Eigen::Vector3d change = solve_local(local, w) - before;
    if (relaxation != 1) change *= relaxation;
    if (change.isZero(0)) return;
    x.lambda.segment<3>(3 * i) += c.turn * change;
    for (int k = c.Y; k < c.Y + c.Y_count; ++k) {
      x.v[entries_[static_cast<std::size_t>(k)].dof] += entries_[static_cast<std::size_t>(k)].value.dot(change);
    }
  }

  const ReferenceProblem& problem_;
  std::vector<Contact> contacts_;
  std::vector<Entry> entries_;
};

namespace internal {

/// lambda and v are one vector to the accelerations: v follows lambda linearly, and so do all combinations.
inline void add(ReferenceSolution& x, double factor, const ReferenceSolution& y) {
  x.lambda += factor * y.lambda;
  x.v += factor * y.v;
}

inline ReferenceSolution difference(const ReferenceSolution& a, const ReferenceSolution& b) {
  return {a.v - b.v, a.lambda - b.lambda};
}

/// Extrapolates from sweep to sweep. `advance` gets what a sweep began with and what it gave, and moves the latter.
class Accelerator {
 public:
  Accelerator(const ReferenceProblem& problem, const GaussSeidelOptions& options)
      : kind_(options.acceleration), depth_(options.depth), weight_(3 * problem.contacts()) {
    for (int i = 0; i < problem.contacts(); ++i) weight_.segment<3>(3 * i).setConstant(problem.size[i]);
  }

  void advance(const ReferenceSolution& before, ReferenceSolution& x) {
    if (kind_ == Acceleration::kConjugate) conjugate(before, x);
    if (kind_ == Acceleration::kNesterov) nesterov(before, x);
    if (kind_ == Acceleration::kAnderson) anderson(before, x);
  }

 private:
  [[nodiscard]] double dot(const ReferenceSolution& a, const ReferenceSolution& b) const {
    return (a.lambda.cwiseProduct(weight_)).dot(b.lambda);
  }

  /// Nonsmooth nonlinear conjugate gradients: the sweep's change is the gradient (Silcowitz, Niebling, Erleben 2010).
  void conjugate(const ReferenceSolution& before, ReferenceSolution& x) {
    const ReferenceSolution change = difference(x, before);
    const double now = dot(change, change), ratio = squared_ > 0 ? now / squared_ : 2;
    squared_ = now;
    if (ratio > 1) {
      direction_ = change;
      return;
    }
    add(x, ratio, direction_);
    ReferenceSolution next = change;
    add(next, ratio, direction_);
    direction_ = std::move(next);
  }

  /// Momentum that starts anew when it points against the sweep's change (O'Donoghue and Candes 2015).
  void nesterov(const ReferenceSolution& before, ReferenceSolution& x) {
    if (last_.lambda.size() == 0) {
      last_ = x;
      return;
    }
    const ReferenceSolution step = difference(x, last_);
    if (dot(difference(before, x), step) > 0) theta_ = 1;
    last_ = x;
    const double next = 0.5 * (1 + std::sqrt(1 + 4 * theta_ * theta_));
    add(x, (theta_ - 1) / next, step);
    theta_ = next;
  }

  /// Anderson (1965), type II: the combination of past sweeps whose changes cancel best. A sweep that changes more than
  /// the one before ends the memory, and the next goes on from where that earlier one had come to.
  void anderson(const ReferenceSolution& before, ReferenceSolution& x) {
    const ReferenceSolution change = difference(x, before), result = x;
    const double now = dot(change, change);
    if (now > squared_ && extrapolated_) {
      changes_.clear();
      results_.clear();
      x = last_;
      extrapolated_ = false;
      fresh_ = true;
      return;
    }
    if (last_.lambda.size() != 0 && !fresh_) {
      changes_.push_back(difference(change, last_change_));
      results_.push_back(difference(result, last_));
      if (static_cast<int>(changes_.size()) > depth_) {
        changes_.erase(changes_.begin());
        results_.erase(results_.begin());
      }
    }
    fresh_ = false;
    squared_ = now;
    last_change_ = change;
    last_ = result;
    const auto n = static_cast<int>(changes_.size());
    if (n == 0) return;
    Eigen::MatrixXd A(n, n);
    Eigen::VectorXd rhs(n);
    for (int i = 0; i < n; ++i) {
      const auto I = static_cast<std::size_t>(i);
      rhs[i] = dot(changes_[I], change);
      for (int j = 0; j < n; ++j) A(i, j) = dot(changes_[I], changes_[static_cast<std::size_t>(j)]);
    }
    A.diagonal() *= 1 + 1e-12;
    const Eigen::VectorXd gamma = A.ldlt().solve(rhs);
    if (!gamma.allFinite()) return;
    for (int i = 0; i < n; ++i) add(x, -gamma[i], results_[static_cast<std::size_t>(i)]);
    extrapolated_ = true;
  }

  Acceleration kind_;
  int depth_;
  Eigen::VectorXd weight_;
  double squared_ = 0, theta_ = 1;
  bool extrapolated_ = false, fresh_ = true;
  ReferenceSolution direction_, last_, last_change_;
  std::vector<ReferenceSolution> changes_, results_;
};

}  // namespace internal

inline ReferenceSolution GaussSeidel::solve(const Eigen::VectorXd& start, const GaussSeidelOptions& options,
                                            const Observer& observe) {
  ReferenceSolution x = problem_.solution_of(start), answer = x;
  internal::Accelerator accelerator(problem_, options);
  for (int k = 0; k < options.max_sweeps; ++k) {
    const ReferenceSolution before = x;
    sweep(x, options.symmetric && k % 2 == 1, options.relaxation);
    answer = x;
    if (!observe(answer)) break;
    accelerator.advance(before, x);
  }
  return answer;
}

/// Until the law's residual is below the tolerance, relative to the problem's scale.
inline ReferenceSolution solve_gauss_seidel(const ReferenceProblem& problem, const GaussSeidelOptions& options = {}) {
  GaussSeidel solver(problem);
  return solver.solve(Eigen::VectorXd::Zero(3 * problem.contacts()), options, [&](const ReferenceSolution& x) {
    return residuals(problem, x).law > options.tolerance * problem.scale;
  });
}

}  // namespace manyhands::testing
