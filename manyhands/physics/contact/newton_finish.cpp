#include "manyhands/physics/contact/newton_finish.h"

#include "manyhands/physics/contact/contact_solver.h"
#include "manyhands/physics/contact/law_residual.h"
#include "manyhands/physics/contact/newton_system.h"

namespace manyhands {

namespace {

using internal::NewtonSystem;

// From a scan over towers, walls, arches and heavy on light, warm and cold.
constexpr double kFirstSoftness = 1e-4, kLeastSoftness = 1e-7, kMostSoftness = 0.1;
constexpr int kFirstFactorisations = 10,
              kMostFactorisations = 12;  // in an outer step; more after one that gains little
constexpr int kSweepsBetween = 3, kMostSweepsBetween = 48;

/// Sweeps that promise to do within this many times those allowed are cheaper than outer steps.
constexpr double kPatience = 2;

/// Sweeps that make the logarithm of the residual smaller by less from look to look gain too little.
constexpr double kLeastGain = 0.3;

/// An outer step that divides the residual by less gains little.
constexpr double kNewtonGain = 3;

void sweep(const ContactProblem& problem, int count, int& sweeps) {
  double budget = count;
  double change = 0;
  internal::sweep(problem.tree, problem.dynamics, 0.0, budget, problem.contacts, problem.joints, change);
  sweeps += count;
}

}  // namespace

struct NewtonFinish::System : NewtonSystem {};

NewtonFinish::NewtonFinish() = default;
NewtonFinish::NewtonFinish(const NewtonFinish&) {}
NewtonFinish::NewtonFinish(NewtonFinish&&) noexcept = default;
// NOLINTNEXTLINE(bugprone-unhandled-self-assignment): nothing is copied
NewtonFinish& NewtonFinish::operator=(const NewtonFinish&) { return *this; }
NewtonFinish& NewtonFinish::operator=(NewtonFinish&&) noexcept = default;
NewtonFinish::~NewtonFinish() = default;

void NewtonFinish::begin() noexcept { steps_ = 0; }

void NewtonFinish::look_anew() noexcept { last_residual_ = std::numeric_limits<double>::infinity(); }

bool NewtonFinish::finish(const SolverSettings& settings, const ContactProblem& problem, int& sweeps) {
  const double residual = internal::law_residual(problem), gain = std::log(last_residual_ / residual);
  last_residual_ = residual;
  if (residual <= settings.tolerance) return true;
  const double missing = std::log(residual / settings.newton_tolerance);
  if (gain > kLeastGain && gain * kPatience * settings.max_sweeps > missing * internal::kSweepsPerPivot<double>)
    return false;
  if (missing <= 0) return true;
  return take_outer_steps(settings, problem, residual, sweeps);
}

bool NewtonFinish::take_outer_steps(const SolverSettings& settings, const ContactProblem& problem, double residual,
                                    int& sweeps) {
  if (!system_) system_ = std::make_unique<System>();
  system_->choose(problem, settings.tolerance);
  double softness = kFirstSoftness;
  int factorisations = kFirstFactorisations, between = kSweepsBetween;
  while (steps_ < settings.newton_steps) {
    system_->keep(problem);
    system_->outer_step(problem, softness, factorisations);
    sweep(problem, 1, sweeps);
    ++steps_;
    const double reached = internal::law_residual(problem);
    const bool gains = reached * kNewtonGain < residual;
    factorisations = gains ? kFirstFactorisations : kMostFactorisations;
    if (reached < residual) {
      residual = reached;
      between = kSweepsBetween;
      softness = std::max(0.1 * softness, kLeastSoftness);
    } else {
      system_->take_back(problem);
      between = std::min(2 * between, kMostSweepsBetween);
      softness = std::min(10 * softness, kMostSoftness);
    }
    if (residual <= settings.tolerance) return true;
    sweep(problem, between, sweeps);
    residual = internal::law_residual(problem);
    if (residual <= settings.tolerance) return true;
  }
  return false;
}

}  // namespace manyhands
