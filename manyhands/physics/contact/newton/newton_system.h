// One outer step of the method of multipliers. Internal to the contact solver.
#pragma once

#include <vector>

#include "manyhands/math/vec3.h"
#include "manyhands/physics/contact/newton/dense_lu.h"
#include "manyhands/physics/contact/newton/law_residual.h"
#include "manyhands/physics/contact/newton/minimum_degree.h"
#include "manyhands/physics/contact/newton/sparse_ldl.h"

namespace manyhands::internal {

/// The impulse of a contact's three rows at its velocity u, and how it falls with u.
struct MultiplierLaw {
  Vec3<double> impulse = Vec3<double>::zero();
  Mat3<double> slope{Vec3<double>::zero(), Vec3<double>::zero(), Vec3<double>::zero()};  ///< -d impulse / d u, by rows
  Vec3<double> on_normal = Vec3<double>::zero();  ///< -d impulse / d u_n of the point, where sliding follows it
};

/// Newton's method on H x = J^T (impulses(J (dv + x)) - impulses(J dv)), where H = M + diag(penalty) of the dofs in
/// trees whose contacts have not converged, and impulses follow the law softened by r about their present values, the
/// multipliers (n_0, y_0):
///   n = max(0, n_0 - (u_n + R n) / r_n),  y = P(y_0 - u_t / r_t), P onto the disc of radius n.
/// Equality constraints are rows without bounds. R: softness of the surface.
class NewtonSystem {
 public:
  /// Chooses the contacts: those of islands that violate the law by more than the tolerance.
  void choose(const NewtonContext& context, double tolerance);

  /// Writes down dv and impulses, and goes back to them.
  void keep(const NewtonContext& context);
  void take_back(const NewtonContext& context) const;

  /// From the present impulses; contacts yield by `softness` of what they give way to their own impulses.
  void outer_step(const NewtonContext& context, double softness, int most_factorisations);

 private:
  /// Two bodies with rows between them: `count` columns of the system, and the slots of H's triangle among them.
  struct Pair {
    std::size_t first_column{}, first_slot{}, count{};
  };

  void choose_islands(const NewtonContext& context, double tolerance);
  void find_dofs(const NewtonContext& context);
  void find_columns(const Tree<double>& tree);
  void find_pattern(const Tree<double>& tree);
  std::size_t pair_of(const RowBlock& rows);
  void find_yielding(const NewtonContext& context, double softness);
  void evaluate(const NewtonContext& context, const std::vector<double>& x);
  double find_defect(const NewtonContext& context, const std::vector<double>& x);
  const Vec3<double>* rows_of(const ContactProblem<double>& problem, const ContactPoint<double>& point,
                              std::size_t count);
  void assemble(const NewtonContext& context);
  void assemble_general(const NewtonContext& context);
  bool solve(const NewtonContext& context);
  void apply(const NewtonContext& context);
  int island_of(int cluster);

  std::vector<std::size_t> points_;  ///< that take part
  std::vector<std::size_t> equalities_;
  std::vector<int> island_;  ///< (nv) of a cluster's first dof: another in its island, nearer to the root
  std::vector<double> island_residual_;

  std::vector<bool> takes_part_;  ///< (nv)
  std::vector<RowBlock> pair_rows_;
  std::vector<std::size_t> point_pair_, equality_pair_;
  std::vector<std::size_t> key_, last_key_;  ///< what all that follows depends on

  std::vector<int> node_;           ///< (nv) of a tree's first dof: which of `trees_` it is
  std::vector<std::size_t> trees_;  ///< their first dofs
  MinimumDegree order_;
  std::vector<std::size_t> dofs_;  ///< of the system, as they are eliminated
  std::vector<int> column_;        ///< (nv) of the dof in the system, or -1
  std::vector<Pair> pairs_;
  std::vector<int> pair_columns_;
  std::vector<SparseLdl::Entry> entries_;  ///< of the mass matrix, then of the pairs
  std::vector<std::size_t> slots_;

  SparseLdl H_;
  DenseLu general_;
  std::vector<double> step_;
  bool slides_ = false;  ///< some contact does, and H is not symmetric for it

  struct Yield {
    double normal{}, tangent{};  ///< 1 / r of both; of torsion: about the normal, across it; 0: no such row
  };
  std::vector<Yield> point_yield_, torsion_yield_;  ///< (points that take part)
  std::vector<Vec3<double>> equality_yield_;        ///< (equalities that take part)
  std::vector<MultiplierLaw> point_law_, torsion_law_;
  std::vector<Vec3<double>> equality_change_;
  std::vector<Vec3<double>> rows_;  ///< of one point
  std::vector<double> x_, trial_, defect_, kept_dv_;
  std::vector<Vec3<double>> kept_impulses_;
};

}  // namespace manyhands::internal
