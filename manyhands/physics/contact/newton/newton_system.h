// One outer step of the method of multipliers. Internal to the contact solver.
#pragma once

#include <vector>

#include "manyhands/physics/contact/newton/contact_islands.h"
#include "manyhands/physics/contact/newton/dense_lu.h"
#include "manyhands/physics/contact/newton/minimum_degree.h"
#include "manyhands/physics/contact/newton/newton_laws.h"
#include "manyhands/physics/contact/newton/sparse_ldl.h"

namespace manyhands::internal {

/// Newton's method on H x = J^T (impulses(J (dv + x)) - impulses(J dv)), where H = M + penalties of the dofs of one
/// island, and impulses follow the laws of newton_laws.h.
class NewtonSystem {
 public:
  /// Chooses the contacts. What it has found out about an island that has the same bodies it keeps.
  void choose(const NewtonContext& context, const ContactIsland& island);

  /// Multiplications of a factorisation, about.
  [[nodiscard]] double work() const { return H_.work(); }

  /// Writes down the island's dv and impulses, and goes back to them.
  void keep(const NewtonContext& context);
  void take_back(const NewtonContext& context) const;

  /// From the present impulses; contacts yield by `softness` of what they give way to their own impulses.
  /// How many factorisations it took.
  int outer_step(const NewtonContext& context, double softness, int most_factorisations);
  /// Whether the last outer step has solved its equations.
  [[nodiscard]] bool is_solved() const { return is_solved_; }

  /// Gauss-Seidel iterations over the island.
  void iterate(const NewtonContext& context, int count) const;

 private:
  /// Two bodies with rows between them: `count` columns of the system, and the slots of H's triangle among them.
  struct Pair {
    std::size_t first_column{}, first_slot{}, count{};
  };

  void make_room(const NewtonContext& context);
  void find_dofs(const NewtonContext& context);
  void find_columns(const Tree<double>& tree);
  void find_pattern(const Tree<double>& tree);
  std::size_t pair_of(const RowBlock& rows);
  const double* inertia(const NewtonContext& context);
  void assemble(const NewtonContext& context);
  void add_products(const Pair& pair, const Vec3<double>* v, const Vec3<double>* w, const PatchSlope& slope);
  bool solve(const NewtonContext& context);
  void follow_normals(const NewtonContext& context);
  template <class VisitDofs>
  bool find_correction(const VisitDofs& visit_dofs);
  void multiply_M(const NewtonContext& context, const std::vector<double>& x, std::vector<double>& y);
  double find_defect(const NewtonContext& context, double t);
  double search_line(const NewtonContext& context, double before, double& length);
  void add_velocities(double t);
  void apply_change(const NewtonContext& context) const;

  NewtonLaws laws_;
  bool is_solved_ = false;

  std::vector<bool> takes_part_;  ///< (nv)
  std::vector<RowBlock> pair_rows_;
  std::vector<std::size_t> patch_pair_, equality_pair_;
  std::vector<std::size_t> key_, last_key_;  ///< what all that follows depends on

  std::vector<int> node_;           ///< (nv) of a tree's first dof: which of `trees_` it is
  std::vector<std::size_t> trees_;  ///< their first dofs
  MinimumDegree order_;
  std::vector<std::size_t> dofs_;  ///< of the system, as they are eliminated
  std::vector<int> free_dofs_;     ///< those of them that are free, in the order of Factors::free_dofs
  std::vector<int> column_;        ///< (nv) of the dof in the system, or -1
  std::vector<Pair> pairs_;
  std::vector<int> pair_columns_;
  std::vector<SparseLdl::Entry> entries_;  ///< of the mass matrix, then of the pairs
  std::vector<std::size_t> slots_;

  SparseLdl H_;
  RowVelocities velocities_, step_velocities_;    ///< at x, of which laws ask; J step
  std::vector<double> momentum_, step_momentum_;  ///< (nv) (M + penalty) x, and the same of the step
  std::vector<double> step_, defect_;             ///< (nv) of the step 0, of the others anything, for dofs elsewhere
  std::vector<double> solution_;                  ///< (dofs)

  std::vector<Following> following_;
  std::vector<double> answers_;     ///< (blocks of kSeveral following, dofs, kSeveral) what H answers to each of them
  std::vector<double> correction_;  ///< (following)
  DenseLu small_;

  std::vector<double> kept_dv_;  ///< (dofs)
  std::vector<Vec3<double>> kept_impulses_;
  std::vector<double> M_;  ///< with the penalties of held tendons
};

}  // namespace manyhands::internal
