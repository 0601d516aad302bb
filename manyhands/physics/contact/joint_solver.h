// Motors, drives, dry friction and limits, solved exactly given all other impulses.
//
// Given the state of every dof the problem is linear. Block principal pivoting (Júdice and Pires 1994) solves it, moves
// the dofs whose solution contradicts their state, and repeats: all of them while that makes them fewer, else the first
// alone, which is Murty's finite method.
#pragma once

#include "manyhands/physics/contact/length_solver.h"

namespace manyhands {

namespace internal {

/// The dofs that are free in some lane, leaves first, each with its nearest such ancestor: what must be factored.
template <Number T>
MANYHANDS_INLINE void list_free_dofs(const Tree<real_t<T>>& tree, Factors<T>& factors) {
  const T one = constant<T>(1);
  factors.free_dofs.clear();
  for (int k = tree.nv - 1; k >= 0; --k) {
    const bool is_free = any(factors.free[index(k)] == one);
    if (is_free) factors.free_dofs.push_back(k);
    factors.is_free[index(k)] = is_free;
  }
  for (std::size_t i = 0; i < factors.is_free.size(); ++i) {
    const int parent = tree.M_parent[i];
    factors.free_parent[i] = parent < 0 || factors.is_free[index(parent)] ? parent : factors.free_parent[index(parent)];
  }
}

/// How each dof behaves in its state: free or held, and what it yields by.
template <Number T>
MANYHANDS_INLINE mask_t<T> prescribe_dofs(const ContactProblem<T>& problem, const std::vector<T>& active_set,
                                          Factors<T>& factors) {
  const Tree<real_t<T>>& tree = *problem.tree;
  const JointLaws<T>& laws = problem.joints;
  const T zero = constant<T>(0), one = constant<T>(1), stiff = constant<T>(contact_settings::kPenalty);
  mask_t<T> any_free(false);
  for (std::size_t i = 0; i < index(tree.nv); ++i) {
    const bool drive = tree.dof_drive[i] >= 0;
    const LawPiece<T> piece = law_piece(drive, active_set[i], i, laws);
    const T yields = laws.constrained[i] * (stiff * tree_row(tree, problem.M(), i)[i]);
    const T penalty = drive ? select(piece.sloped, laws.slope[i], yields) : yields;
    factors.penalty[i] = select(piece.saturated, zero, penalty);
    factors.multiplier[i] = drive ? select(piece.sloped, piece.impulse, laws.last_impulse[i]) : laws.last_impulse[i];
    const auto free =
        piece.saturated | (factors.penalty[i] != zero);  // a lane whose M is not a number is factored, too
    any_free = any_free | free;
    factors.free[i] = select(free, one, zero);
    factors.held_dv[i] = select(free, zero, piece.held_dv);
  }
  return any_free;
}

/// dv of the free dofs, where joint_impulse holds M held_dv. A dof that is held in a lane has a row of the identity
/// there, and zeros beside it: lanes with different states share one factorisation.
template <Number T>
MANYHANDS_INLINE void solve_free_dofs(const ContactProblem<T>& problem, Factors<T>& factors, Iterate<T>& iterate) {
  const Tree<real_t<T>>& tree = *problem.tree;
  const T zero = constant<T>(0), one = constant<T>(1);
  const int* parent = factors.free_parent.data();
  for (const int k : factors.free_dofs) {
    const std::size_t i = index(k);
    const T* M = tree_row(tree, problem.M(), i);
    T* L = tree_row(tree, factors.L.data(), i);
    const LawPiece<T> piece = law_piece(tree.dof_drive[i] >= 0, iterate.active_set[i], i, problem.joints);
    const T rhs = iterate.rhs[i], penalty = factors.penalty[i];
    const T yielding = fma(penalty, piece.held_dv, rhs + factors.multiplier[i]);
    const T impulse = select(penalty > zero, yielding, rhs + piece.impulse) - iterate.joint_impulse[i];
    const auto free = factors.free[i] == one;
    iterate.dv[i] = select(free, impulse, zero);
    L[i] = select(free, M[i] + penalty, one);
    for (int j = parent[k]; j >= 0; j = parent[j]) L[j] = M[j] * (factors.free[i] * factors.free[index(j)]);
  }
  add_length_penalties(problem, factors);
  factor_ltdl(factors.free_dofs, parent, tree.M_row.data(), factors.L.data());
  solve_ltdl(factors.free_dofs, parent, tree.M_row.data(), factors.L.data(), iterate.dv.data());
}

/// dv and impulses of the joints that the active set implies, given rhs.
template <Number T>
MANYHANDS_INLINE void solve_active_set(const ContactProblem<T>& problem, Factors<T>& factors, Iterate<T>& iterate) {
  const Tree<real_t<T>>& tree = *problem.tree;
  const T zero = constant<T>(0);
  const mask_t<T> any_free = prescribe_dofs(problem, iterate.active_set, factors);
  for (T& dv : iterate.dv) dv = zero;
  multiply_tree_matrix<T>(tree, problem.M(), factors.held_dv.data(), iterate.joint_impulse.data());
  begin_lengths(problem, factors, iterate);
  when(any_free, [&] {
    list_free_dofs(tree, factors);
    solve_free_dofs(problem, factors, iterate);
    finish_lengths(problem, factors, iterate);
    for (const int k : factors.free_dofs)
      add_tree_column<T>(tree, problem.M(), k, iterate.dv[index(k)], iterate.joint_impulse.data());
  });
  for (std::size_t i = 0; i < index(tree.nv); ++i) {
    iterate.joint_impulse[i] = iterate.joint_impulse[i] - iterate.rhs[i];
    // + 0: a zero's sign would tell which other lanes were solved
    iterate.dv[i] = (iterate.dv[i] + factors.held_dv[i]) + zero;
  }
}

/// Where a drive is on its law when its dof changes its velocity by dv; one that does nothing is saturated, by no
/// force.
template <Number T>
MANYHANDS_INLINE T place_at(const JointLaws<T>& laws, T dv, std::size_t i) {
  using S = JointConstraintState;
  const T reach = laws.slope[i] * (laws.target[i] - dv), F = laws.max_impulse[i];
  return select(reach >= F, constant<T>(S::kSaturatedUp),
                select(reach <= -F, constant<T>(S::kSaturatedDown), constant<T>(S::kAtTarget)));
}

/// Where on its drive's law a dof should move, given what its present place led to. `impulse` is the drive's alone.
template <Number T>
MANYHANDS_INLINE T next_place(const JointLaws<T>& laws, T s, T impulse, T dv, T slack, T speed_slack, std::size_t i) {
  using S = JointConstraintState;
  const T one = constant<T>(1), F = laws.max_impulse[i], lower = laws.lower[i], upper = laws.upper[i];
  const T up = constant<T>(S::kSaturatedUp), down = constant<T>(S::kSaturatedDown), held = constant<T>(S::kAtTarget);
  const auto below = dv<lower - speed_slack, above = dv> upper + speed_slack;
  const T reach = laws.slope[i] * (laws.target[i] - dv);
  const T from_held = select(impulse > F + slack, up, select(impulse < -F - slack, down, held));
  const T from_up = select(reach < F - slack, held, s), from_down = select(reach > slack - F, held, s);
  const T inner = select(s == held, from_held, select(s == up, from_up, from_down));
  const T within = select(below, constant<T>(S::kAtLower), select(above, constant<T>(S::kAtUpper), inner));
  const T lowest = clamp(laws.slope[i] * (laws.target[i] - lower), -F, F);
  const T highest = clamp(laws.slope[i] * (laws.target[i] - upper), -F, F);
  const T from_lower = select(impulse < lowest - slack, place_at(laws, lower, i), s);
  const T from_upper = select(impulse > highest + slack, place_at(laws, upper, i), s);
  return select(abs(s) <= one, within, select(s > one, from_lower, from_upper));
}

/// The state to which a drive with dry friction should move: off rest where the impulse is more than drive and friction
/// can hold, to rest where the motion would turn round.
template <Number T>
MANYHANDS_INLINE T next_rubbing_state(const JointLaws<T>& laws, const DriveState<T>& s, T impulse, T dv, T slack,
                                      T speed_slack, std::size_t i) {
  using S = JointConstraintState;
  const T zero = constant<T>(0), one = constant<T>(1), rubs = constant<T>(S::kRubs), stuck = constant<T>(S::kStuck);
  const T F = laws.max_impulse[i], friction = laws.friction[i], stop = laws.stop[i];
  // Off a limit the dof moves inwards, and may still come nearer to rest.
  const T push_lower = select(laws.lower[i] < stop, one, -one), push_upper = select(laws.upper[i] > stop, -one, one);
  const T push = select(abs(s.place) <= one, s.push, select(s.place > zero, push_lower, push_upper));
  const T place = next_place(laws, s.place, impulse - push * friction, dv, slack, speed_slack, i);
  const auto turns = (push * (dv - stop) > speed_slack) & (abs(s.place) <= one);
  const T turned = select(stop < laws.lower[i], constant<T>(S::kAtLower),
                          select(stop > laws.upper[i], constant<T>(S::kAtUpper), stuck));
  const T moving = select(turns, turned, select(abs(place) > one, place, fma(push, rubs, place)));
  const T drive = clamp(laws.slope[i] * (laws.target[i] - stop), -F, F), start = place_at(laws, stop, i);
  const T from_rest = select(impulse > drive + friction + slack, start + rubs,
                             select(impulse < drive - friction - slack, start - rubs, stuck));
  const T resting = select(stop < laws.lower[i] - speed_slack, constant<T>(S::kAtLower),
                           select(stop > laws.upper[i] + speed_slack, constant<T>(S::kAtUpper), from_rest));
  return select(s.place == stuck, resting, moving);
}

/// What a dof's velocity and impulse may contradict its state by besides rounding.
template <Number T>
struct StateNoise {
  T speed, impulse;
};

/// The state to which dof i should move, given what its present one led to: of a drive, whose law has a slope.
template <Number T>
MANYHANDS_INLINE T next_drive_state(const JointLaws<T>& laws, const Iterate<T>& iterate, std::size_t i,
                                    const StateNoise<T>& noise) {
  const T tolerance(SolverTraits<real_t<T>>::kStateTolerance), one = constant<T>(1);
  const T impulse = iterate.joint_impulse[i], dv = iterate.dv[i];
  const T slack = fma(tolerance, one + abs(iterate.rhs[i]), noise.impulse);
  const T speed_slack = fma(tolerance, one + abs(dv), noise.speed);
  const auto rubs = laws.friction[i] > constant<T>(0);
  const DriveState<T> s = drive_state(iterate.active_set[i]);
  T next = next_place(laws, s.place, impulse, dv, slack, speed_slack, i);
  when(rubs, [&] { next = select(rubs, next_rubbing_state(laws, s, impulse, dv, slack, speed_slack, i), next); });
  return next;
}

/// The same of any other dof.
template <Number T>
MANYHANDS_INLINE T next_vertical_state(const JointLaws<T>& laws, const Iterate<T>& iterate, std::size_t i,
                                       const StateNoise<T>& noise) {
  using S = JointConstraintState;
  const T tolerance(SolverTraits<real_t<T>>::kStateTolerance), one = constant<T>(1);
  const T s = iterate.active_set[i], F = laws.max_impulse[i], impulse = iterate.joint_impulse[i], dv = iterate.dv[i];
  const T slack = fma(tolerance, F + abs(iterate.rhs[i]), noise.impulse);
  const T speed_slack = fma(tolerance, one + abs(dv), noise.speed);
  const T up = constant<T>(S::kSaturatedUp), down = constant<T>(S::kSaturatedDown), held = constant<T>(S::kAtTarget);
  const T from_held =
      select(impulse > laws.max_held[i] + slack, up, select(impulse < laws.min_held[i] - slack, down, held));
  const T from_up = select(dv > laws.target[i] + speed_slack, held,
                           select(dv < laws.lower[i] - speed_slack, constant<T>(S::kAtLower), s));
  const T from_down = select(dv < laws.target[i] - speed_slack, held,
                             select(dv > laws.upper[i] + speed_slack, constant<T>(S::kAtUpper), s));
  const T from_lower = select(impulse < F - slack, up, s);
  const T from_upper = select(impulse > slack - F, down, s);
  return select(s == held, from_held,
                select(s == one, from_up, select(s == -one, from_down, select(s > one, from_lower, from_upper))));
}

/// Writes every dof's next state; the number of those that contradict their present one. `unsettled`: how precisely
/// contacts are known, where there are any [m/s].
template <Number T>
MANYHANDS_INLINE T check_joints(const ContactProblem<T>& problem, const Iterate<T>& iterate, T unsettled,
                                std::vector<T>& next_state) {
  const T zero = constant<T>(0), one = constant<T>(1);
  T wrong = zero;
  for (std::size_t i = 0; i < next_state.size(); ++i) {
    const T speed = unsettled * problem.joints.constrained[i];
    const StateNoise<T> noise{speed, speed * law_inertia(problem, i)};
    next_state[i] = problem.tree->dof_drive[i] >= 0 ? next_drive_state(problem.joints, iterate, i, noise)
                                                    : next_vertical_state(problem.joints, iterate, i, noise);
    wrong += select(next_state[i] != iterate.active_set[i], one, zero);
  }
  return wrong;
}

}  // namespace internal

/// dv and impulses of all dofs under the joints' laws alone, given rhs. The solution depends on the state and the
/// active set it starts from, not on the other lanes.
template <Number T>
MANYHANDS_INLINE void solve_joints(const ContactProblem<T>& problem, Factors<T>& factors, Iterate<T>& iterate,
                                   std::vector<T>& next_state) {
  const T zero = constant<T>(0), one = constant<T>(1), patient = constant<T>(contact_settings::kPatience);
  T fewest = constant<T>(std::numeric_limits<double>::infinity()), patience = zero;
  for (int pivot = 0; pivot < contact_settings::kMaxStateChanges; ++pivot) {
    internal::solve_active_set(problem, factors, iterate);
    const T wrong = internal::check_joints(problem, iterate, zero, next_state);
    if (none(wrong > zero)) break;
    patience = select(wrong < fewest, patient, patience - one);
    fewest = min(wrong, fewest);
    mask_t<T> may_move(true);
    for (std::size_t i = 0; i < next_state.size(); ++i) {
      const auto moves = (next_state[i] != iterate.active_set[i]) & may_move;
      iterate.active_set[i] = select(moves, next_state[i], iterate.active_set[i]);
      may_move = may_move & !(moves & (patience < zero));
    }
  }
}

}  // namespace manyhands
