// The frictional contact problem of one time step, and how far an answer is from obeying the law of contact.
//
// Given M, v_f, J, mu and b: find v = v_f + M^-1 J^T lambda and u = J v such that, at every contact,
//   0 <= lambda_n, u_n >= b, one of the two an equality             (Signorini)
//   |lambda_t| <= mu lambda_n, and u_t = -kappa lambda_t, kappa >= 0, with kappa = 0 inside the cone   (Coulomb)
// This is the exact law: sliding does not lift contacts, as it does in convex relaxations. Nothing here shares code
// with the product.
#pragma once

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace manyhands::testing {

using SparseMatrix = Eigen::SparseMatrix<double>;
using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// An answer: generalised velocity (nv) and impulses (3 contacts; normal, tangent 1, tangent 2) [N s].
struct ReferenceSolution {
  Eigen::VectorXd v, lambda;
};

/// One step's problem with what follows from it. Velocities in m/s and rad/s, impulses in N s.
class ReferenceProblem {
 public:
  /// M (nv, nv) positive definite; v_f (nv); J (3 contacts, nv), rows n, t1, t2; mu and b (contacts).
  ReferenceProblem(const SparseMatrix& mass, Eigen::VectorXd free, const SparseRows& jacobian, Eigen::VectorXd friction,
                   Eigen::VectorXd targets)
      : M(mass),
        free_velocity(std::move(free)),
        J(jacobian),
        mu(std::move(friction)),
        b(std::move(targets)),
        response(Eigen::SimplicialLDLT<SparseMatrix>(M).solve(SparseMatrix(J.transpose()))),
        delassus(static_cast<std::size_t>(contacts())),
        size(contacts()) {
    response.prune(1.0, 1e-15);
    const Eigen::VectorXd u = contact_velocity(free_velocity);
    for (int i = 0; i < contacts(); ++i) {
      const SparseMatrix columns = response.middleCols(3 * i, 3);
      Eigen::Matrix3d& G = delassus[static_cast<std::size_t>(i)];
      G = Eigen::MatrixXd(J.middleRows(3 * i, 3) * columns);
      G = (0.5 * (G + G.transpose())).eval();
      size[i] = G.trace() / 3;
      scale = std::max(scale, u.segment<3>(3 * i).norm());
    }
  }

  [[nodiscard]] int contacts() const { return static_cast<int>(mu.size()); }
  [[nodiscard]] int nv() const { return static_cast<int>(free_velocity.size()); }

  /// u, less b along the normals (3 contacts).
  [[nodiscard]] Eigen::VectorXd contact_velocity(const Eigen::VectorXd& v) const {
    Eigen::VectorXd u = J * v;
    for (int i = 0; i < contacts(); ++i) u[3 * i] -= b[i];
    return u;
  }

  [[nodiscard]] ReferenceSolution solution_of(Eigen::VectorXd lambda) const {
    Eigen::VectorXd v = free_velocity + response * lambda;
    return {std::move(v), std::move(lambda)};
  }

  SparseMatrix M;
  Eigen::VectorXd free_velocity;
  SparseRows J;
  Eigen::VectorXd mu, b;

  SparseMatrix response;                  ///< M^-1 J^T (nv, 3 contacts)
  std::vector<Eigen::Matrix3d> delassus;  ///< diagonal blocks of J M^-1 J^T [1/kg]
  Eigen::VectorXd size;                   ///< mean diagonal of each such block: turns impulses into velocities
  double scale = 1e-12;                   ///< the largest contact velocity without impulses, less b [m/s]
};

/// Worst violations over all contacts, all in m/s (impulses times the contact's `size`).
struct ContactResiduals {
  double signorini = 0;    ///< |min(lambda_n, u_n - b)|
  double dual = 0;         ///< how fast a contact closes that must not: max(0, b - u_n)
  double cone = 0;         ///< max(0, |lambda_t| - mu lambda_n)
  double dissipation = 0;  ///< what friction fails to oppose: |u_t| + u_t . lambda_t / (mu lambda_n)
  double consistency = 0;  ///< |v - v_f - M^-1 J^T lambda|
  double law = 0;          ///< all laws at once: zero if and only if the answer obeys them (Alart and Curnier 1991)
};

/// The point nearest to `x` in the disc of radius `radius` >= 0.
inline Eigen::Vector2d nearest_in_disc(const Eigen::Vector2d& x, double radius) {
  const double length = x.norm();
  return length <= radius ? x : Eigen::Vector2d(x * (radius / length));
}

inline ContactResiduals residuals(const ReferenceProblem& problem, const ReferenceSolution& solution) {
  ContactResiduals worst;
  const auto take = [](double& most, double value) { most = std::max(most, std::isnan(value) ? INFINITY : value); };
  const Eigen::VectorXd u = problem.contact_velocity(solution.v);
  for (int i = 0; i < problem.contacts(); ++i) {
    const Eigen::Vector3d impulse = problem.size[i] * solution.lambda.segment<3>(3 * i);
    const double normal = impulse[0], mu = problem.mu[i], closing = u[3 * i];
    const Eigen::Vector2d friction = impulse.tail<2>(), slip = u.segment<2>(3 * i + 1);
    take(worst.signorini, std::abs(std::min(normal, closing)));
    take(worst.dual, -closing);
    take(worst.cone, friction.norm() - mu * normal);
    if (mu * normal > 1e-9 * problem.scale) {
      take(worst.dissipation, slip.norm() + slip.dot(friction) / (mu * normal));
    }
    const double radius = mu * std::max(normal, 0.0);
    take(worst.law, (friction - nearest_in_disc(friction - slip, radius)).norm());
  }
  take(worst.law, worst.signorini);
  take(worst.consistency, (solution.v - problem.solution_of(solution.lambda).v).lpNorm<Eigen::Infinity>());
  return worst;
}

}  // namespace manyhands::testing
