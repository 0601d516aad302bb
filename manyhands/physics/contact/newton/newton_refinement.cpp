#include "manyhands/physics/contact/newton/newton_refinement.h"

#include "manyhands/math/functions.h"
#include "manyhands/physics/contact/newton/newton_system.h"

namespace manyhands {

namespace {

namespace cs = contact_settings;
using internal::ContactIsland;
using internal::NewtonSystem;

/// Multiplications of a Gauss-Seidel iteration over some patches, about.
template <class Patches>
double iteration_work(const ContactProblem<double>& problem, const Patches& patches) {
  double sum = 0;
  for (const std::size_t k : patches) {
    const ContactPatch<double>& patch = problem.patches[k];
    const std::size_t numbers = patch.linear.num_Y() + (patch.turns ? patch.angular.num_Y() : 0);
    sum += cs::kPointWork * static_cast<double>(patch.count) + 6.0 * static_cast<double>(numbers);
  }
  return sum;
}

/// What the outer steps over one island may still take, in a step of the world.
struct Budget {
  int steps = 0;    ///< outer steps
  double work = 0;  ///< multiplications, of all islands
};

/// By how much an island violates the law, and by how much it may before a Newton step is worth it [m/s].
struct Violation {
  double residual = 0, bearable = 0;
};

/// Outer steps over one island, each kept if the law is violated less.
class OuterSteps {
 public:
  OuterSteps(const SolverSettings& settings, const NewtonContext& context, const ContactIsland& island,
             NewtonSystem& system, const Violation& violation)
      : tolerance_(settings.tolerance),
        bearable_(violation.bearable),
        near_(std::max(violation.bearable, cs::kBearable * settings.newton_tolerance)),
        context_(context),
        island_(island),
        system_(system),
        residual_(violation.residual) {}

  /// Until the law holds or the budget is spent: whether it holds, or nearly. Adds the Gauss-Seidel iterations.
  bool run(Budget& budget, int& iterations) {
    system_.choose(context_, island_);
    const double overhead = cs::kNewtonOverhead * iteration_work(context_.problem, island_.patches);
    const double work = system_.work() + overhead;
    if (budget.work < cs::kFewestFactorisations * work) {
      budget.steps = 0;
      return false;
    }
    system_.keep(context_);
    while (budget.steps > 0 && budget.work > 0 && !is_stuck()) {
      budget.work -= work * system_.outer_step(context_, softness_, factorisations_);
      --budget.steps;
      if (holds_after_step()) return true;
      if (failures_ > 0) iterate_between(iterations);
    }
    system_.take_back(context_);
    budget.steps = 0;
    return residual_ < near_;
  }

 private:
  /// Looks at what the last outer step has reached, and takes it back if that is worse.
  bool holds_after_step() {
    const double reached = island_.residual(context_);
    const bool gains = reached * cs::kMinNewtonGain < residual_;
    factorisations_ = gains ? cs::kFactorisations : cs::kMaxFactorisations;
    const double softer = std::min(10 * softness_, cs::kMaxSoftness);
    const double stiffer = std::max(0.1 * softness_, cs::kMinSoftness);
    if (reached < residual_) {
      residual_ = reached;
      system_.keep(context_);
      softness_ = stiffer;
      failures_ = 0;
      between_ = cs::kIterationsBetween;
    } else {
      system_.take_back(context_);
      const bool is_slow = system_.is_solved() && reached < cs::kSlow * residual_;
      softness_ = is_slow ? stiffer : softer;
      ++failures_;
    }
    return residual_ <= tolerance_ || (residual_ <= bearable_ && !gains);
  }

  void iterate_between(int& iterations) {
    system_.iterate(context_, between_);
    iterations += between_;
    between_ = std::min(2 * between_, cs::kMaxIterationsBetween);
    const double after = island_.residual(context_);
    if (after >= residual_) return;
    residual_ = after;
    system_.keep(context_);
  }

  [[nodiscard]] bool is_stuck() const {
    const double enough = failures_ < cs::kManyFailures ? cs::kNearEnough * bearable_ : near_;
    return failures_ >= cs::kMaxFailures && residual_ < enough;
  }

  double tolerance_, bearable_, near_;  ///< [m/s] where it ends; if it gains little; after many failures
  const NewtonContext& context_;
  const ContactIsland& island_;
  NewtonSystem& system_;
  double residual_;  ///< [m/s] of what is kept
  double softness_ = cs::kFirstSoftness;
  int factorisations_ = cs::kFactorisations, between_ = cs::kIterationsBetween, failures_ = 0;
};

}  // namespace

/// One for each island.
struct NewtonRefinement::Systems {
  internal::ContactIslands islands;
  std::vector<NewtonSystem> systems;
  std::vector<Violation> violations;
  std::vector<int> steps_left;
  double work_left = 0;

  void begin(const SolverSettings& settings, const NewtonContext& context) {
    islands.find(context);
    if (systems.size() < islands.size()) systems.resize(islands.size());
    violations.resize(islands.size());
    steps_left.assign(islands.size(), settings.newton_steps);
    double iteration = 0;
    for (std::size_t k = 0; k < islands.size(); ++k) iteration += iteration_work(context.problem, islands[k].patches);
    work_left = std::max(cs::kNewtonShare * settings.max_iterations * iteration, cs::kLittleWork);
  }

  struct Look {
    double worst = 0;         ///< the largest ratio of violation to what is bearable; 0 where all hold the tolerance
    bool is_precise = false;  ///< whether one that does not hold it is to be solved precisely: nothing in it overlaps
  };

  Look look(const SolverSettings& settings, const NewtonContext& context) {
    Look found;
    for (std::size_t k = 0; k < islands.size(); ++k) {
      const double residual = islands[k].residual(context), opening = islands[k].opening(context);
      const bool corrects = opening > cs::kSlowCorrection;
      const double bearable = std::max(settings.newton_tolerance, corrects ? cs::kOpeningPrecision * opening : 0.0);
      violations[k] = {residual, bearable};
      if (residual <= settings.tolerance) continue;
      found.worst = std::max(found.worst, residual / bearable);
      found.is_precise = found.is_precise || !corrects;
    }
    return found;
  }
};

NewtonRefinement::NewtonRefinement() = default;
NewtonRefinement::NewtonRefinement(const NewtonRefinement&) {}
NewtonRefinement::NewtonRefinement(NewtonRefinement&&) noexcept = default;
// NOLINTNEXTLINE(bugprone-unhandled-self-assignment): nothing is copied
NewtonRefinement& NewtonRefinement::operator=(const NewtonRefinement&) { return *this; }
NewtonRefinement& NewtonRefinement::operator=(NewtonRefinement&&) noexcept = default;
NewtonRefinement::~NewtonRefinement() = default;

void NewtonRefinement::begin() noexcept {
  steps_ = 0;
  has_begun_ = false;
}

void NewtonRefinement::look_anew() noexcept { last_violation_ = std::numeric_limits<double>::infinity(); }

bool NewtonRefinement::refine(const SolverSettings& settings, const NewtonContext& context, int& iterations) {
  if (!systems_) systems_ = std::make_unique<Systems>();
  if (!has_begun_) systems_->begin(settings, context);
  has_begun_ = true;
  const auto [violation, is_precise] = systems_->look(settings, context);
  const double gain = log(last_violation_ / violation);
  last_violation_ = violation;
  if (violation == 0) return true;
  const double missing = log(violation);
  if (missing <= 0) return !is_precise || gain < cs::kFastGain;
  const double left = cs::kNewtonPatience * settings.max_iterations / SolverTraits<double>::kIterationsPerLook;
  if (gain > cs::kMinGain && gain * left > missing) return false;
  return refine_islands(settings, context, iterations);
}

bool NewtonRefinement::refine_islands(const SolverSettings& settings, const NewtonContext& context, int& iterations) {
  Systems& all = *systems_;
  bool holds = true;
  for (std::size_t k = 0; k < all.islands.size(); ++k) {
    const Violation& violation = all.violations[k];
    if (violation.residual <= violation.bearable) continue;
    if (all.steps_left[k] == 0) {
      holds = false;
      continue;
    }
    Budget budget{all.steps_left[k], all.work_left};
    OuterSteps steps(settings, context, all.islands[k], all.systems[k], violation);
    holds = steps.run(budget, iterations) && holds;
    steps_ += all.steps_left[k] - budget.steps;
    all.steps_left[k] = budget.steps;
    all.work_left = budget.work;
  }
  return holds;
}

}  // namespace manyhands
