// Newton's method, where Gauss-Seidel has a long tail: stacks, and heavy things on light ones. In double alone.
#pragma once

#include <memory>

#include "manyhands/physics/contact/newton/newton_context.h"

namespace manyhands {

/// The method of multipliers with a semismooth Newton method inside, in the velocities (Alart and Curnier 1991), taking
/// turns with Gauss-Seidel: see docs/contact_solver.md. It decides by the residual of the law of contact, in m/s: 0 if
/// and only if all contacts obey Signorini's and Coulomb's laws. What it keeps between steps is scratch.
class NewtonRefinement {
 public:
  NewtonRefinement();
  NewtonRefinement(const NewtonRefinement& other);
  NewtonRefinement(NewtonRefinement&& other) noexcept;
  NewtonRefinement& operator=(const NewtonRefinement& other);
  NewtonRefinement& operator=(NewtonRefinement&& other) noexcept;
  ~NewtonRefinement();

  /// To be called when a step begins.
  void begin() noexcept;

  /// To be called when the problem is another than at the last look.
  void look_anew() noexcept;

  /// After some iterations that did not converge: whether the law holds to the tolerance. Where iterations gain so
  /// little that those allowed would not do, it first takes outer steps until it holds or the step's are spent. The
  /// active set stays as it is. Adds the Gauss-Seidel iterations that it makes itself to `iterations`.
  bool refine(const SolverSettings& settings, const NewtonContext& context, int& iterations);

  [[nodiscard]] int steps() const noexcept { return steps_; }  ///< outer steps since `begin`

 private:
  struct Systems;

  bool refine_islands(const SolverSettings& settings, const NewtonContext& context, int& iterations);

  std::unique_ptr<Systems> systems_;  ///< made when they are needed first
  bool has_begun_ = false;            ///< they know the islands of this step
  int steps_ = 0;
  double last_violation_ = 0;  ///< at the last look, in parts of what is bearable
};

}  // namespace manyhands
