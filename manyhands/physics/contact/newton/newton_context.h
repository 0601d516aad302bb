// What Newton's method sees of the solver. In double alone.
#pragma once

#include "manyhands/physics/contact/factors.h"

namespace manyhands {

/// The contact problem of one step, what was derived from it, and the iterate.
struct NewtonContext {
  const ContactProblem<double>& problem;
  const Factors<double>& factors;
  Iterate<double>& iterate;

  [[nodiscard]] const Tree<double>& tree() const { return *problem.tree; }
};

}  // namespace manyhands
