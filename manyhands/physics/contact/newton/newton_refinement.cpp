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
  double change = 0;
  internal::iterate_contacts(context.problem, context.factors, 0.0, budget, context.iterate, change);
  iterations += count;
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

void NewtonRefinement::look_anew() noexcept { last_residual_ = std::numeric_limits<double>::infinity(); }

bool NewtonRefinement::refine(const SolverSettings& settings, const NewtonContext& context, int& iterations) {
  const double residual = internal::law_residual(context), gain = std::log(last_residual_ / residual);
  last_residual_ = residual;
  if (residual <= settings.tolerance) return true;
  const double missing = std::log(residual / settings.newton_tolerance);
  if (gain > cs::kMinGain &&
      gain * cs::kNewtonPatience * settings.max_iterations > missing * SolverTraits<double>::kIterationsPerLook)
    return false;
  if (missing <= 0) return true;
  return take_outer_steps(settings, context, residual, iterations);
}

bool NewtonRefinement::take_outer_steps(const SolverSettings& settings, const NewtonContext& context, double residual,
                                        int& iterations) {
  if (!system_) system_ = std::make_unique<System>();
  system_->choose(context, settings.tolerance);
  double softness = cs::kFirstSoftness;
  int factorisations = cs::kFactorisations, between = cs::kIterationsBetween;
  while (steps_ < settings.newton_steps) {
    system_->keep(context);
    system_->outer_step(context, softness, factorisations);
    run_iterations(context, 1, iterations);
    ++steps_;
    const double reached = internal::law_residual(context);
    const bool gains = reached * cs::kMinNewtonGain < residual;
    factorisations = gains ? cs::kFactorisations : cs::kMaxFactorisations;
    if (reached < residual) {
      residual = reached;
      between = cs::kIterationsBetween;
      softness = std::max(0.1 * softness, cs::kMinSoftness);
    } else {
      system_->take_back(context);
      between = std::min(2 * between, cs::kMaxIterationsBetween);
      softness = std::min(10 * softness, cs::kMaxSoftness);
    }
    if (residual <= settings.tolerance) return true;
    run_iterations(context, between, iterations);
    residual = internal::law_residual(context);
    if (residual <= settings.tolerance) return true;
  }
  return false;
}

}  // namespace manyhands
