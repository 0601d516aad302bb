// One outer step of the method of multipliers, and the residual that judges it. Internal to the contact solver.
#pragma once

#include <Eigen/Sparse>
#include <vector>

#include "manyhands/math/vec3.h"
#include "manyhands/physics/contact/loops.h"
#include "manyhands/physics/contact/newton_finish.h"

namespace manyhands::internal {

/// The impulse of a contact's three rows at its velocity u, and how it falls with u.
struct MultiplierLaw {
  Vec3<double> impulse = Vec3<double>::zero();
  Mat3<double> slope{Vec3<double>::zero(), Vec3<double>::zero(), Vec3<double>::zero()};  ///< -d impulse / d u, by rows
  Vec3<double> on_normal = Vec3<double>::zero();  ///< -d impulse / d u_n of the point, where sliding follows it
};

/// The worst violation of the law of contact [m/s]: |min(G n, u_n)|, |G y - P(G y - u_t)| with P onto the disc of
/// radius G n, and the same of torsion, times its length.
[[nodiscard]] double law_residual(const ContactProblem& problem);

/// Newton's method on H x = J^T (impulses(J (dv + x)) - impulses(J dv)), where H = M + diag(spring) of the dofs in
/// trees whose contacts have not settled, and impulses follow the law softened by r about their present values (the
/// anchor):
///   n = max(0, n_0 - (u_n + R n) / r_n),  y = P(y_0 - u_t / r_t), P onto the disc of radius n.
/// Loops are rows without bounds. R: softness of the surface.
class NewtonSystem {
 public:
  /// Chooses the contacts: those of islands that violate the law by more than the tolerance.
  void choose(const ContactProblem& problem, double tolerance);

  /// Writes down dv and impulses, and goes back to them.
  void keep(const ContactProblem& problem);
  void take_back(const ContactProblem& problem) const;

  /// From the present impulses; contacts yield by `softness` of what they give way to their own impulses.
  void outer_step(const ContactProblem& problem, double softness, int most_factorisations);

 private:
  using SparseMatrix = Eigen::SparseMatrix<double>;

  /// Rows of the system: a contact with its torsion, or a loop; `slots` counts its entries of the matrix.
  struct Pair {
    RowBlock rows{};
    std::size_t first_slot{}, count{};
  };

  void choose_islands(const ContactProblem& problem, double tolerance);
  void find_columns(const ContactProblem& problem);
  void find_pattern(const ContactProblem& problem);
  std::size_t pair_of(const RowBlock& rows);
  void find_yielding(const ContactProblem& problem, double softness);
  void evaluate(const ContactProblem& problem, const std::vector<double>& x);
  double find_defect(const ContactProblem& problem, const std::vector<double>& x);
  void assemble(const ContactProblem& problem);
  bool solve();
  void apply(const ContactProblem& problem);
  int root(int cluster);

  std::vector<std::size_t> points_;  ///< that take part
  std::vector<std::size_t> loops_;
  std::vector<int> island_;  ///< (nv) of a cluster's first dof: another in its island, nearer to the root
  std::vector<double> island_residual_;
  std::vector<int> column_;        ///< (nv) of the dof in the system, or -1
  std::vector<std::size_t> dofs_;  ///< its dofs

  std::vector<std::size_t> key_, last_key_;  ///< what the pattern depends on
  std::vector<Pair> pairs_;
  std::vector<std::size_t> point_pair_, loop_pair_;
  std::vector<Eigen::Index> mass_slots_, slots_;
  SparseMatrix H_;
  Eigen::VectorXd rhs_, step_;
  Eigen::SimplicialLDLT<SparseMatrix> symmetric_;
  Eigen::SparseLU<SparseMatrix, Eigen::AMDOrdering<int>> general_;
  bool symmetric_ready_ = false, general_ready_ = false;
  bool slides_ = false;  ///< some contact does, and H is not symmetric for it

  struct Yield {
    double normal{}, tangent{};  ///< 1 / r of both; of torsion: about the normal, across it; 0: no such row
  };
  std::vector<Yield> point_yield_, torsion_yield_;  ///< (points that take part)
  std::vector<Vec3<double>> loop_yield_;            ///< (loops that take part)
  std::vector<MultiplierLaw> point_law_, torsion_law_;
  std::vector<Vec3<double>> loop_change_;
  std::vector<double> x_, trial_, defect_, kept_dv_;
  std::vector<Vec3<double>> kept_impulses_;
};

}  // namespace manyhands::internal
