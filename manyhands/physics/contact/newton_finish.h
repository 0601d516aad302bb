// The finish of the contact solver where Gauss-Seidel has a long tail: stacks, and heavy things on light ones.
#pragma once

#include <memory>

#include "manyhands/math/number.h"

namespace manyhands {

struct SolverSettings;
template <Real R>
struct Tree;
template <Number T>
struct Workspace;
template <Number T>
struct JointConstraints;
template <Number T>
struct LoopSet;
template <Number T>
struct ContactSet;

/// The contact problem of one step, and its answer so far: dv and the impulses.
struct ContactProblem {
  const Tree<double>& tree;
  const Workspace<double>& dynamics;
  JointConstraints<double>& joints;
  const LoopSet<double>& loops;
  ContactSet<double>& contacts;
};

/// The method of multipliers with a semismooth Newton method inside, in the velocities (Alart and Curnier 1991), taking
/// turns with Gauss-Seidel: see docs/contact_solver.md. It decides by the residual of the law of contact, in m/s: 0 if
/// and only if all contacts obey Signorini's and Coulomb's laws. What it keeps between steps is scratch.
class NewtonFinish {
 public:
  NewtonFinish();
  NewtonFinish(const NewtonFinish& other);
  NewtonFinish(NewtonFinish&& other) noexcept;
  NewtonFinish& operator=(const NewtonFinish& other);
  NewtonFinish& operator=(NewtonFinish&& other) noexcept;
  ~NewtonFinish();

  /// To be called when a step begins.
  void begin() noexcept;

  /// To be called when the problem is another than at the last look.
  void look_anew() noexcept;

  /// After some sweeps that did not settle: whether the law holds to the tolerance. Where sweeps gain so
  /// little that those allowed would not do, it first takes outer steps until it holds or the step's are spent. The
  /// joints' stances stay as they are. Adds the sweeps that it makes itself to `sweeps`.
  bool finish(const SolverSettings& settings, const ContactProblem& problem, int& sweeps);

  [[nodiscard]] int steps() const noexcept { return steps_; }  ///< outer steps since `begin`

 private:
  struct System;

  bool take_outer_steps(const SolverSettings& settings, const ContactProblem& problem, double residual, int& sweeps);

  std::unique_ptr<System> system_;  ///< made when it is needed first
  int steps_ = 0;
  double last_residual_ = 0;  ///< [m/s] at the last look
};

}  // namespace manyhands
