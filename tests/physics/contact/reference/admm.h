// The alternating direction method of multipliers with De Saxce's correction (Carpentier, Le Lidec, Montaut 2024, "From
// Compliant to Rigid Contact Simulation"; Acary, Cadoux, Lemarechal, Malick 2011).
//
// Were s = mu |u_t| on the normals known, the exact law would be the optimality of a convex problem,
//   min 1/2 lambda' G lambda + lambda' (J v_f - b + s), lambda in the cones K,
// with the corrected velocity y = u - b + s in the dual cones. ADMM solves it, and s follows y at every iteration.
// The linear system (G + R) lambda = ... is solved in the velocities, (M + J' R^-1 J) v = ..., which is as sparse as M
// and does not mind redundant contacts.
#pragma once

#include "tests/physics/contact/reference/gauss_seidel.h"

namespace manyhands::testing {

struct AdmmOptions {
  int max_iterations = 20000;
  double tolerance = 1e-12;  ///< of the law's residual, relative to the problem's scale
  double rho = 0.1;          ///< first weight of lambda - z, relative to each contact's own size
  bool adaptive = true;
  double relaxation = 1.6;
};

/// The impulse nearest to `x` in Coulomb's cone.
inline Eigen::Vector3d nearest_in_cone(const Eigen::Vector3d& x, double mu) {
  const double t = x.tail<2>().norm();
  if (t <= mu * x[0]) return x;
  if (mu * t <= -x[0]) return Eigen::Vector3d::Zero();
  const double n = (x[0] + mu * t) / (1 + mu * mu);
  Eigen::Vector3d nearest(n, 0, 0);
  if (t > 0) nearest.tail<2>() = x.tail<2>() * (mu * n / t);
  return nearest;
}

class Admm {
 public:
  explicit Admm(const ReferenceProblem& problem) : problem_(problem), inverse_size_(3 * problem.contacts()) {
    for (int i = 0; i < problem.contacts(); ++i) inverse_size_.segment<3>(3 * i).setConstant(1 / problem.size[i]);
    JtJ_ = SparseMatrix(problem.J.transpose()) * inverse_size_.asDiagonal() * problem.J;
    factor_.analyzePattern(problem.M + JtJ_);
  }

  /// Factorisations made so far.
  [[nodiscard]] int factorisations() const { return factorisations_; }

  /// From `start` (impulses, and the velocities that follow from them) until `observe` says no.
  ReferenceSolution solve(const ReferenceSolution& start, const AdmmOptions& options, const Observer& observe) {
    const int n = problem_.contacts();
    Eigen::VectorXd z = start.lambda, y = corrected(start.v), s = Eigen::VectorXd::Zero(3 * n);
    factor(options.rho);
    ReferenceSolution answer = start;
    for (int k = 1; k <= options.max_iterations; ++k) {
      for (int i = 0; i < n; ++i) s[3 * i] = problem_.mu[i] * y.segment<2>(3 * i + 1).norm() - problem_.b[i];
      const Eigen::VectorXd R = rho_ * inverse_size_.cwiseInverse();
      const Eigen::VectorXd target = z + (y - s).cwiseQuotient(R);
      const Eigen::VectorXd v = factor_.solve(problem_.M * problem_.free_velocity + problem_.J.transpose() * target);
      const Eigen::VectorXd exact = target - (problem_.J * v).cwiseQuotient(R);
      const Eigen::VectorXd lambda = options.relaxation * exact + (1 - options.relaxation) * z;
      const Eigen::VectorXd before = z;
      for (int i = 0; i < n; ++i) {
        z.segment<3>(3 * i) = nearest_in_cone(
            lambda.segment<3>(3 * i) - y.segment<3>(3 * i).cwiseQuotient(R.segment<3>(3 * i)), problem_.mu[i]);
      }
      y -= R.cwiseProduct(lambda - z);
      answer = problem_.solution_of(z);
      if (!observe(answer)) break;
      if (options.adaptive)
        adapt(k, (exact - z).cwiseQuotient(inverse_size_), (z - before).cwiseQuotient(inverse_size_));
    }
    return answer;
  }

 private:
  /// u - b + mu |u_t| n.
  [[nodiscard]] Eigen::VectorXd corrected(const Eigen::VectorXd& v) const {
    Eigen::VectorXd y = problem_.contact_velocity(v);
    for (int i = 0; i < problem_.contacts(); ++i) y[3 * i] += problem_.mu[i] * y.segment<2>(3 * i + 1).norm();
    return y;
  }

  void factor(double rho) {
    rho_ = rho;
    factor_.factorize(problem_.M + JtJ_ / rho);
    ++factorisations_;
  }

  /// Moves rho towards where both residuals, as velocities, fall alike; now and then, for that costs a factorisation.
  void adapt(int k, const Eigen::VectorXd& primal, const Eigen::VectorXd& change) {
    const double p = primal.norm(), d = rho_ * change.norm();
    if (k % 10 != 0 || !(p > 0) || !(d > 0)) return;
    const double ratio = std::sqrt(p / d);
    if (ratio > 2 || ratio < 0.5) factor(std::clamp(rho_ * std::clamp(ratio, 0.1, 10.0), 1e-9, 1e6));
  }

  const ReferenceProblem& problem_;
  Eigen::VectorXd inverse_size_;
  SparseMatrix JtJ_;
  Eigen::SimplicialLLT<SparseMatrix> factor_;
  double rho_ = 0;
  int factorisations_ = 0;
};

inline ReferenceSolution solve_admm(const ReferenceProblem& problem, const AdmmOptions& options = {}) {
  Admm solver(problem);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(3 * problem.contacts());
  return solver.solve(problem.solution_of(zero), options, [&](const ReferenceSolution& x) {
    return residuals(problem, x).law > options.tolerance * problem.scale;
  });
}

}  // namespace manyhands::testing
