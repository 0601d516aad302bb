// The method of multipliers with a semismooth Newton method inside (Alart and Curnier 1991), in the velocities.
//
// An outer step anchors the impulses at the last ones and lets them yield a little, r = softness * size of the contact:
//   lambda_n(u) = max(0, anchor_n - (u_n - b) / r),  lambda_t(u) = nearest to anchor_t - u_t / r in the disc mu
//   lambda_n.
// Newton solves M (v - v_f) = J' lambda(J v); its matrix M + J' A J joins what touches, bears redundant contacts, and
// is not symmetric where contacts slide. The yielding vanishes as the anchors settle: the fixed point is the exact law.
#pragma once

#include "tests/physics/contact/reference/gauss_seidel.h"

namespace manyhands::testing {

struct NewtonOptions {
  int max_factorisations = 300;
  int max_inner = 3;             ///< factorisations of an outer step; doubled after one that helps little
  double tolerance = 1e-12;      ///< of the law's residual, relative to the problem's scale
  double softness = 1e-3;        ///< of the first outer step; falls tenfold with each that helps
  double least_softness = 1e-7;  ///< far above rounding, far below what the outer steps must gain
  int sweeps = 3;                ///< of Gauss-Seidel before each outer step: they find who touches and who slides
};

class Newton {
 public:
  explicit Newton(const ReferenceProblem& problem)
      : problem_(problem), gauss_seidel_(problem), Jt_(problem.J.transpose()) {}

  /// From `start` until `observe`, called after every sweep and outer step, says no. An outer step that does not help
  /// is taken back, and more sweeps and a softer, longer step follow.
  ReferenceSolution solve(const Eigen::VectorXd& start, const NewtonOptions& options, const Observer& observe) {
    ReferenceSolution x = problem_.solution_of(start);
    softness_ = options.softness;
    int sweeps = options.sweeps, inner = options.max_inner;
    for (factorisations_ = sweeps_ = 0; factorisations_ < options.max_factorisations;) {
      for (int k = 0; k < sweeps; ++k, ++sweeps_) {
        gauss_seidel_.sweep(x, false, 1);
        if (!observe(x)) return x;
      }
      const double law = residuals(problem_, x).law;
      ReferenceSolution trial = outer(x, inner);
      gauss_seidel_.sweep(trial, false, 1);
      ++sweeps_;
      const double reached = residuals(problem_, trial).law;
      inner = reached < 0.3 * law ? options.max_inner : std::min(2 * inner, 24);
      if (reached < law) {
        x = problem_.solution_of(trial.lambda);
        sweeps = options.sweeps;
        softness_ = std::max(0.1 * softness_, options.least_softness);
        if (!observe(x)) return x;
      } else {
        sweeps = std::min(2 * sweeps, 200);
        softness_ = std::min(10 * softness_, 0.1);
      }
    }
    return x;
  }

  [[nodiscard]] int factorisations() const { return factorisations_; }
  [[nodiscard]] int sweeps() const { return sweeps_; }

 private:
  /// The impulses at velocity v about the anchor and, if asked, A = -d lambda / du, block by block.
  Eigen::VectorXd impulses(const Eigen::VectorXd& v, const Eigen::VectorXd& anchor, SparseMatrix* A) const {
    const int n = problem_.contacts();
    const Eigen::VectorXd u = problem_.contact_velocity(v);
    Eigen::VectorXd lambda = Eigen::VectorXd::Zero(3 * n);
    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i < n; ++i) {
      const double give = 1 / (softness_ * problem_.size[i]);
      const Eigen::Vector3d trial = anchor.segment<3>(3 * i) - give * u.segment<3>(3 * i);
      if (trial[0] <= 0) continue;
      const double radius = problem_.mu[i] * trial[0], length = trial.tail<2>().norm();
      Eigen::Matrix3d slope = give * Eigen::Matrix3d::Identity();
      lambda.segment<3>(3 * i) = trial;
      if (length > radius) {
        const Eigen::Vector2d d = trial.tail<2>() / length;
        lambda.segment<2>(3 * i + 1) = radius * d;
        slope.bottomRightCorner<2, 2>() = give * radius / length * (Eigen::Matrix2d::Identity() - d * d.transpose());
        slope.block<2, 1>(1, 0) = give * problem_.mu[i] * d;
      }
      if (A == nullptr) continue;
      for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) entries.emplace_back(3 * i + r, 3 * i + c, slope(r, c));
      }
    }
    if (A != nullptr) {
      A->resize(3 * n, 3 * n);
      A->setFromTriplets(entries.begin(), entries.end());
    }
    return lambda;
  }

  /// Newton about the impulses of `from`.
  ReferenceSolution outer(const ReferenceSolution& from, int max_inner) {
    const auto defect = [&](const Eigen::VectorXd& v, const Eigen::VectorXd& lambda) {
      return Eigen::VectorXd(problem_.M * (problem_.free_velocity - v) + Jt_ * lambda);
    };
    Eigen::VectorXd v = from.v;
    SparseMatrix A;
    for (int inner = 0; inner < max_inner; ++inner) {
      const Eigen::VectorXd rhs = defect(v, impulses(v, from.lambda, &A));
      const SparseMatrix JtA = Jt_ * A, JtAJ = JtA * SparseMatrix(problem_.J);
      const Eigen::SparseLU<SparseMatrix> lu(problem_.M + JtAJ);
      ++factorisations_;
      const Eigen::VectorXd step = lu.solve(rhs);
      const double before = rhs.norm();
      double length = 1, best = INFINITY;
      for (const double trial : {1.0, 0.5, 0.25, 0.125, 0.0625, 0.03125}) {
        const Eigen::VectorXd at = v + trial * step;
        const double norm = defect(at, impulses(at, from.lambda, nullptr)).norm();
        if (norm < best) {
          best = norm;
          length = trial;
        }
        if (norm < (1 - 0.1 * trial) * before) break;
      }
      v += length * step;
      if (best < 1e-3 * before) break;
    }
    return problem_.solution_of(impulses(v, from.lambda, nullptr));
  }

  const ReferenceProblem& problem_;
  GaussSeidel gauss_seidel_;
  SparseMatrix Jt_;
  double softness_ = 0;
  int factorisations_ = 0, sweeps_ = 0;
};

inline ReferenceSolution solve_newton(const ReferenceProblem& problem, const NewtonOptions& options = {}) {
  Newton solver(problem);
  return solver.solve(Eigen::VectorXd::Zero(3 * problem.contacts()), options, [&](const ReferenceSolution& x) {
    return residuals(problem, x).law > options.tolerance * problem.scale;
  });
}

}  // namespace manyhands::testing
