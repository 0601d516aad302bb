#include "manyhands/physics/contact/newton/newton_refinement.h"

#include "manyhands/physics/contact/gauss_seidel.h"
#include "manyhands/physics/contact/newton/law_residual.h"
#include "manyhands/physics/contact/newton/newton_system.h"

namespace manyhands {

namespace {

namespace cs = contact_settings;
using internal::NewtonSystem;

void run_iterations(const NewtonContext& context, int count, int& iterations) {
  double budget = count;
  internal::IterationChanges<double> changes{};
  internal::iterate_contacts(context.problem, context.factors, 0.0, budget, context.iterate, changes);
  iterations += count;
}

/// Multiplications of a Gauss-Seidel iteration, about.
double iteration_work(const ContactProblem<double>& problem) {
  double sum = cs::kPointWork * static_cast<double>(problem.points.size());
  for (const ContactPatch<double>& patch : problem.patches)
    sum += 6.0 * static_cast<double>(patch.linear.num_Y() + (patch.turns ? patch.angular.num_Y() : 0));
  return sum;
}

}  // namespace

struct NewtonRefinement::System : NewtonSystem {};

NewtonRefinement::NewtonRefinement() = default;
NewtonRefinement::NewtonRefinement(const NewtonRefinement&) {}
NewtonRefinement::NewtonRefinement(NewtonRefinement&&) noexcept = default;
// NOLINTNEXTLINE(bugprone-unhandled-self-assignment): nothing is copied
NewtonRefinement& NewtonRefinement::operator=(const NewtonRefinement&) { return *this; }
NewtonRefinement& NewtonRefinement::operator=(NewtonRefinement&&) noexcept = default;
NewtonRefinement::~NewtonRefinement() = default;

void NewtonRefinement::begin() noexcept { steps_ = 0; }

void NewtonRefinement::look_anew() noexcept { last_residual_.reset(); }

bool NewtonRefinement::refine(const SolverSettings& settings, const NewtonContext& context, double first_change,
                              int& iterations) {
  const double residual = internal::law_residual(context);
  const double gain = std::log(last_residual_.value_or(first_change) / residual);
  last_residual_ = residual;
  if (residual <= settings.tolerance) return true;
  const double missing = std::log(residual / settings.newton_tolerance);
  if (missing <= 0) return gain < cs::kFastGain;
  const double left = cs::kNewtonPatience * settings.max_iterations / SolverTraits<double>::kIterationsPerLook;
  if (gain > cs::kMinGain && gain * left > missing) return false;
  if (steps_ >= settings.newton_steps) return false;
  return take_outer_steps(settings, context, residual, iterations);
}

bool NewtonRefinement::take_outer_steps(const SolverSettings& settings, const NewtonContext& context, double residual,
                                        int& iterations) {
  if (!system_) system_ = std::make_unique<System>();
  system_->choose(context, settings.tolerance);
  const double iteration = iteration_work(context.problem), work = system_->work() + cs::kNewtonOverhead * iteration;
  double affordable = std::max(cs::kNewtonShare * settings.max_iterations * iteration, cs::kLittleWork) / work;
  if (affordable < cs::kFewestFactorisations) {
    steps_ = settings.newton_steps;
    return false;
  }
  system_->keep(context);
  double softness = cs::kFirstSoftness;
  int factorisations = cs::kFactorisations, between = cs::kIterationsBetween, failures = 0;
  const auto is_stuck = [&] {
    const double enough = failures < cs::kManyFailures ? cs::kNearEnough : cs::kBearable;
    return failures >= cs::kMaxFailures && residual < enough * settings.newton_tolerance;
  };
  while (steps_ < settings.newton_steps && affordable > 0 && !is_stuck()) {
    affordable -= system_->outer_step(context, softness, factorisations);
    ++steps_;
    const double reached = internal::law_residual(context);
    const bool gains = reached * cs::kMinNewtonGain < residual;
    factorisations = gains ? cs::kFactorisations : cs::kMaxFactorisations;
    if (reached < residual) {
      residual = reached;
      system_->keep(context);
      softness = std::max(0.1 * softness, cs::kMinSoftness);
      failures = 0;
      between = cs::kIterationsBetween;
    } else {
      system_->take_back(context);
      softness = std::min(10 * softness, cs::kMaxSoftness);
      ++failures;
    }
    if (residual <= settings.tolerance || (residual <= settings.newton_tolerance && !gains)) return true;
    if (failures == 0) continue;
    run_iterations(context, between, iterations);
    between = std::min(2 * between, cs::kMaxIterationsBetween);
    const double after = internal::law_residual(context);
    if (after < residual) {
      residual = after;
      system_->keep(context);
    }
  }
  system_->take_back(context);
  steps_ = settings.newton_steps;
  return residual < cs::kBearable * settings.newton_tolerance;
}

}  // namespace manyhands
