// The search for the joints' constraint states once contacts take part: the largest violation moves first, and the
// search ends with the best iterate that it saw if it goes round in circles or diverges. Iterations that are cut short,
// and friction that wedges, leave no guarantee that it ends by itself; what it ends with must still be a motion that
// motors can make.
#pragma once

#include "manyhands/physics/contact/joint_solver.h"

namespace manyhands {

/// The best iterate of a search, and how long it may go on. Scratch: nothing of it outlives a step.
template <Number T>
struct ActiveSetSearch {
  explicit ActiveSetSearch(int laws)
      : next_state(index(laws)), kept_dv(next_state), kept_rhs(next_state), best_set(next_state) {}

  mask_t<T> active{true};   ///< worlds that are not done
  mask_t<T> changed{true};  ///< worlds whose active set has just changed
  T iterations_left{};      ///< of Gauss-Seidel
  T batch{};                ///< iterations until the next look at the joints
  T looks{};                ///< at which the active set changed

  std::vector<T> next_state;           ///< (laws) the states to which the present iterate points
  std::vector<T> kept_dv, kept_rhs;    ///< (laws) of worlds that go on with their active set while others change theirs
  T best_merit{};                      ///< [rad/s or m/s]
  std::vector<T> best_set;             ///< (laws)
  std::vector<Vec3<T>> best_impulses;  ///< of contacts, torsions and equality constraints
};

namespace internal {

/// The largest impulse of a dof's motor, drive and dry friction together.
template <Number T>
MANYHANDS_INLINE T strength(const JointLaws<T>& laws, std::size_t i) {
  return laws.max_impulse[i] + laws.friction[i];
}

/// By how much a dof's impulse or velocity violates its state: the overload of a motor that holds, relative to its
/// largest impulse, else a constant.
template <Number T>
MANYHANDS_INLINE T violation(const ContactProblem<T>& problem, const Iterate<T>& iterate,
                             const std::vector<T>& next_state, std::size_t i) {
  const T zero = constant<T>(0), tiny = constant<T>(1e-6), little = constant<T>(2), state = iterate.active_set[i];
  const T overload = abs(iterate.joint_impulse[i]) / max(strength(problem.joints, i), tiny);
  const LawPiece<T> piece = law_piece(problem.tree->dof_drive[i] >= 0, state, i, problem.joints);
  const auto held = piece.sloped | (state == constant<T>(JointConstraintState::kAtTarget)) |
                    (state == constant<T>(JointConstraintState::kStuck));
  return select(next_state[i] == state, zero, select(held, overload, little));
}

/// Moves the most violated dof of each world, and those at least half as violated. Against contacts that have not
/// converged all motors seem overloaded: if they gave way together, the arm would be thrown about.
template <Number T>
MANYHANDS_INLINE void move_most_violated(const ContactProblem<T>& problem, mask_t<T> asked,
                                         const std::vector<T>& next_state, Iterate<T>& iterate) {
  T worst = constant<T>(0);
  for (std::size_t i = 0; i < next_state.size(); ++i) worst = max(worst, violation(problem, iterate, next_state, i));
  const T least = constant<T>(0.5) * worst;
  for (std::size_t i = 0; i < next_state.size(); ++i) {
    const auto moves = asked & (violation(problem, iterate, next_state, i) >= least);
    iterate.active_set[i] = select(moves, next_state[i], iterate.active_set[i]);
  }
}

/// The largest error in velocity of a dof whose state is wrong: by how much a saturated one has passed its goal, or
/// what the impulse beyond its motor's does to one that is held [rad/s or m/s].
template <Number T>
MANYHANDS_INLINE T merit(const ContactProblem<T>& problem, const Iterate<T>& iterate,
                         const std::vector<T>& next_state) {
  const T zero = constant<T>(0);
  const T tiny = constant<T>(SolverTraits<real_t<T>>::kSmallest);
  T worst = zero;
  for (std::size_t i = 0; i < next_state.size(); ++i) {
    const bool is_drive = problem.tree->dof_drive[i] >= 0;
    const T state = iterate.active_set[i], inertia = max(law_inertia(problem, i), tiny);
    const T excess = max(abs(iterate.joint_impulse[i]) - strength(problem.joints, i), zero) / inertia;
    const T passed = abs(iterate.dv[i] - law_piece(is_drive, next_state[i], i, problem.joints).held_dv);
    const T error = select(law_piece(is_drive, state, i, problem.joints).saturated, passed, excess);
    worst = max(worst, select(next_state[i] == state, zero, error));
  }
  return worst;
}

/// Calls body(index, impulse) for every impulse of contacts and equality constraints.
template <class Impulses, class Body>
MANYHANDS_INLINE void visit_impulses(Impulses& iterate, Body&& body) {
  std::size_t i = 0;
  for (auto& point : iterate.points) body(i++, point.impulse);
  for (auto& torsion : iterate.torsions) body(i++, torsion.impulse);
  for (auto& impulse : iterate.equalities) body(i++, impulse);
}

template <Number T>
MANYHANDS_INLINE void begin_search(const SolverSettings& settings, const Iterate<T>& iterate,
                                   ActiveSetSearch<T>& search) {
  using Traits = SolverTraits<real_t<T>>;
  search.active = search.changed = mask_t<T>(true);
  search.iterations_left = constant<T>(settings.max_iterations);
  search.batch = constant<T>(Traits::kIterationsPerLook);
  search.looks = constant<T>(0);
  search.best_merit = constant<T>(std::numeric_limits<double>::infinity());
  search.best_impulses.resize(iterate.points.size() + iterate.torsions.size() + iterate.equalities.size());
}

/// Keeps the active set and impulses of the worlds asked for in which `merit` is the best so far.
template <Number T>
MANYHANDS_INLINE void keep_best(mask_t<T> asked, T merit, const Iterate<T>& iterate, ActiveSetSearch<T>& search) {
  const auto better = asked & (merit < search.best_merit);
  search.best_merit = select(better, merit, search.best_merit);
  for (std::size_t i = 0; i < search.best_set.size(); ++i)
    search.best_set[i] = select(better, iterate.active_set[i], search.best_set[i]);
  visit_impulses(iterate, [&](std::size_t i, const Vec3<T>& impulse) {
    search.best_impulses[i] = select(better, impulse, search.best_impulses[i]);
  });
}

/// Goes back to them, for good.
template <Number T>
MANYHANDS_INLINE void take_best(mask_t<T> asked, const ActiveSetSearch<T>& search, Iterate<T>& iterate) {
  for (std::size_t i = 0; i < search.best_set.size(); ++i)
    iterate.active_set[i] = select(asked, search.best_set[i], iterate.active_set[i]);
  visit_impulses(iterate,
                 [&](std::size_t i, Vec3<T>& impulse) { impulse = select(asked, search.best_impulses[i], impulse); });
}

/// Changes the active set of worlds in `search.changed`, or ends their search with the best iterate where it has
/// diverged or gone on for too long. `change`: of the last iteration [m/s].
template <Number T>
MANYHANDS_INLINE void change_active_set(const ContactProblem<T>& problem, T change, ActiveSetSearch<T>& search,
                                        Iterate<T>& iterate) {
  namespace cs = contact_settings;
  const T zero = constant<T>(0), one = constant<T>(1), most = constant<T>(cs::kMaxLooks);
  const auto changed = search.changed;
  const T worst = max(change, merit(problem, iterate, search.next_state));
  keep_best(changed, worst, iterate, search);
  const auto diverges = worst > constant<T>(cs::kDivergence) * search.best_merit;
  search.looks = select(changed, select(diverges, most, search.looks + one), search.looks);
  search.batch = select(search.looks > constant<T>(cs::kEarlyLooks), constant<T>(cs::kIterationsPerLateLook),
                        constant<T>(SolverTraits<real_t<T>>::kIterationsPerLook));
  search.iterations_left = select(changed, max(search.iterations_left, search.batch), search.iterations_left);
  const auto ends = changed & (search.looks == most);
  move_most_violated(problem, changed & !ends, search.next_state, iterate);
  take_best(ends, search, iterate);
  search.iterations_left = select(ends, zero, search.iterations_left);
}

/// dv of the new active set under the present impulses, in the worlds where it changed. rhs stays that of the last look
/// elsewhere: by its size the next look tells what is rounding.
template <Number T>
MANYHANDS_INLINE void solve_changed(const ContactProblem<T>& problem, Factors<T>& factors, ActiveSetSearch<T>& search,
                                    Iterate<T>& iterate) {
  search.kept_dv = iterate.dv;
  search.kept_rhs = iterate.rhs;
  gather_impulses(problem, iterate);
  solve_active_set(problem, factors, iterate);
  for (std::size_t i = 0; i < iterate.dv.size(); ++i) {
    iterate.dv[i] = select(search.changed, iterate.dv[i], search.kept_dv[i]);
    iterate.rhs[i] = select(search.changed, iterate.rhs[i], search.kept_rhs[i]);
  }
}

}  // namespace internal

}  // namespace manyhands
