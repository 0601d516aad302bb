// Joint motors and joint limits, solved together and exactly at the velocity level. See README.md in this folder.
//
// Each dof obeys a staircase: below its target velocity the motor pushes with +F, above it with -F, at it with whatever
// is needed in between; at a position limit any impulse back inside is allowed. The solver finds, for every dof, its
// place on the staircase (the `stance`), by pivoting: solve the linear system that the stances imply, move the dofs
// whose answer contradicts their stance, repeat (Júdice and Pires 1994, block principal pivoting for strictly convex
// box problems: all such dofs move while that makes them fewer, else the first alone, which is Murty's finite method).
#pragma once

#include "manyhands/math/control_flow.h"
#include "manyhands/physics/dynamics/ltdl.h"
#include "manyhands/physics/dynamics/state.h"
#include "manyhands/physics/dynamics/workspace.h"

namespace manyhands {

/// Scratch of the joint constraints; one row per dof. Velocities are changes over the step, forces are impulses.
template <Number T>
struct JointConstraints {
  explicit JointConstraints(int nv)
      : smooth(static_cast<std::size_t>(nv)),
        rhs(smooth),
        dv(rhs),
        held(rhs),
        impulse(rhs),
        max_impulse(rhs),
        slope(rhs.size(), T(real_t<T>(0))),
        touched(rhs),
        hold(rhs),
        anchor(rhs),
        spring(rhs),
        target(rhs),
        lower(rhs),
        upper(rhs),
        least(rhs),
        most(rhs),
        better(rhs),
        forced(rhs),
        is_forced(rhs.size()),
        forced_parent(rhs.size()) {
    forced_dofs.reserve(rhs.size());
  }

  std::vector<T> smooth;        ///< h (tau - bias - damping v): the impulse that acts without constraints
  std::vector<T> rhs;           ///< smooth, and the impulses of contacts and loops
  std::vector<T> dv;            ///< the answer: M dv = rhs + impulse
  std::vector<T> held;          ///< dv where the stance prescribes it, else 0
  std::vector<T> impulse;       ///< of motor and limit
  std::vector<T> max_impulse;   ///< F = h max_force
  std::vector<T> slope;         ///< of a drive: impulse = slope (target - dv) while held; 0 where it is rigid
  std::vector<T> touched;       ///< 1 where the dof's tree has contacts or loops, else 0
  std::vector<T> hold;          ///< impulses of the last step: what a dof that gives way pushes with at its goal
  std::vector<T> anchor;        ///< that, for the present stance
  std::vector<T> spring;        ///< how the present stance gives way: impulse = spring (its dv - dv); 0: rigid
  std::vector<T> target;        ///< dv that brings the dof to its motor's velocity, kept within the limits
  std::vector<T> lower, upper;  ///< dv that brings the dof just to a position limit by the step's end
  std::vector<T> least, most;   ///< the impulses that can hold the dof at `target`
  std::vector<T> better;        ///< the stances to which the present answer points
  std::vector<T> forced;        ///< 1 where the stance prescribes the impulse, 0 where it prescribes dv
  std::vector<std::uint8_t> is_forced;  ///< whether the dof is forced in some lane
  std::vector<int> forced_parent;       ///< the next dof towards the root that is forced in some lane, or -1
  std::vector<int> forced_dofs;         ///< those dofs, leaves first
};

namespace internal {

// Stances. Between limits: pushed (|stance| = 1) or held at the motor's target (0).
inline constexpr int kHeld = 0, kPushedUp = 1, kPushedDown = -1, kAtLower = 2, kAtUpper = -2;

/// How much of a limit's violation a step removes, as PyBullet does.
inline constexpr double kLimitRecovery = 0.2;

/// The violation beyond which the way back is no faster [rad or m]: a joint far outside returns, it is not shot back.
inline constexpr double kMostRecovered = 0.04;

/// Block pivots without progress before dofs move one by one.
inline constexpr int kPatience = 6;
inline constexpr int kMaxPivots = 400;

template <Number T>
inline constexpr real_t<T> kPivotTolerance = std::same_as<real_t<T>, float> ? real_t<T>(1e-5) : real_t<T>(1e-12);

/// dv that brings the dof from `gap` outside (> 0) or inside (< 0) its limit to the limit, or part of the way.
template <Number T>
MANYHANDS_INLINE T limit_velocity(T gap, T inverse_h) {
  const T recovery = T(static_cast<real_t<T>>(kLimitRecovery));
  const T back = recovery * min(gap, T(static_cast<real_t<T>>(kMostRecovered)));
  return select(gap > T(real_t<T>(0)), back, gap) * inverse_h;
}

/// The impulse that no drive exceeds: finite, because a held drive multiplies it by 0.
inline constexpr double kMostImpulse = 1e30;

/// How stiffly motors and limits hold a dof of a tree that touches something, in multiples of its inertia: so stiff
/// that a held joint stays, and soft enough that a body between two held ones can be squeezed.
inline constexpr double kGrip = 1e4;

/// The actuators' part: a motor's force joins the smooth impulse; a drive, implicit in the velocity v+ at the step's
/// end, gives h gear (kp (ctrl - gear (q + h v+)) - kd gear v+) = slope (target - v+), limited by its force.
template <Number T, Number P>
MANYHANDS_INLINE void prepare_drives(const Tree<real_t<T>>& tree, const Params<P>& params, real_t<T> h,
                                     const State<T>& state, JointConstraints<T>& jc) {
  using R = real_t<T>;
  const T step(h), zero(R(0)), most(static_cast<R>(kMostImpulse));
  for (std::size_t k = 0; k < tree.actuators.size(); ++k) {
    const TreeActuator& actuator = tree.actuators[k];
    const std::size_t i = actuator.dof;
    const T gear = broadcast<T>(params.gear[k]), kp = broadcast<T>(params.drive_kp[k]);
    const T kd = broadcast<T>(params.drive_kd[k]), force = broadcast<T>(params.drive_max_force[k]);
    const T ctrl = state.ctrl()[k];
    if (actuator.type == ActuatorType::kForce) {
      jc.smooth[i] = fma(step, clamp(gear * ctrl, -force, force), jc.smooth[i]);
      continue;
    }
    const bool position = actuator.type == ActuatorType::kPosition;
    const T pull = position ? kp * (ctrl - gear * state.q()[actuator.q]) : kd * ctrl;
    const T slope = step * (gear * gear) * fma(step, kp, kd);
    const auto drives = slope > zero;
    jc.slope[i] = slope;
    jc.target[i] = select(drives, step * gear * pull / select(drives, slope, step), zero);
    jc.max_impulse[i] = select(drives, min(step * force, most), zero);
  }
}

}  // namespace internal

/// Fills the rows from the state, after bias_and_mass_matrix, and adds h damping to M's diagonal: damping is implicit.
/// A motor wants v* = kp (target_q - q) / h + v' + kd (target_v - v'), where v' is the velocity that the step would
/// reach without constraints, and pushes with at most max_force (PyBullet's position and velocity control).
template <Number T, Number P>
MANYHANDS_INLINE void prepare_joint_constraints(const Tree<real_t<T>>& tree, const Params<P>& params, real_t<T> h,
                                                State<T>& state, Workspace<T>& ws, JointConstraints<T>& jc) {
  using R = real_t<T>;
  const T step(h), inverse_h(R(1) / h), zero(R(0)), one(R(1)), infinity(std::numeric_limits<R>::infinity());
  const auto nv = static_cast<std::size_t>(tree.nv);
  mask_t<T> needs_free_velocity(false);
  for (std::size_t i = 0; i < nv; ++i) {
    const T damping = broadcast<T>(params.damping[i]), max_force = broadcast<T>(params.motor_max_force[i]);
    jc.smooth[i] = step * (state.tau()[i] - ws.bias[i] - damping * state.v()[i]);
    T& M = (ws.M.data() + tree.M_row[i])[i];
    M = fma(step, damping, M);
    jc.max_impulse[i] = step * select(max_force > zero, max_force, broadcast<T>(params.friction[i]));
    needs_free_velocity = needs_free_velocity | ((broadcast<T>(params.motor_kd[i]) != one) & (max_force > zero));
    jc.dv[i] = zero;
    jc.touched[i] = zero;
    jc.hold[i] = state.hold()[i];
  }
  internal::prepare_drives(tree, params, h, state, jc);
  when(needs_free_velocity, [&] {
    ws.L = ws.M;
    jc.dv = jc.smooth;
    factor_ltdl(tree.dofs_from_leaves, tree.dof_parent.data(), tree.M_row.data(), ws.L.data());
    solve_ltdl(tree.dofs_from_leaves, tree.dof_parent.data(), tree.M_row.data(), ws.L.data(), jc.dv.data());
  });
  for (std::size_t i = 0; i < nv; ++i) {
    const T v = state.v()[i];
    const T kd = broadcast<T>(params.motor_kd[i]), F = jc.max_impulse[i];
    const auto motor = broadcast<T>(params.motor_max_force[i]) > zero;
    const auto holds = F > zero;  // a motor, a drive, or dry friction, which holds at 0
    T wanted = fma(kd, state.target_v()[i], select(kd == one, zero, (one - kd) * (v + jc.dv[i])));
    jc.lower[i] = -infinity;
    jc.upper[i] = infinity;
    if (tree.dof_q[i] >= 0) {
      const T q = state.q()[static_cast<std::size_t>(tree.dof_q[i])];
      const T lower = broadcast<T>(params.lower[i]), upper = broadcast<T>(params.upper[i]);
      const T goal = tree.dof_limited[i] ? clamp(state.target_q()[i], lower, upper) : state.target_q()[i];
      wanted = fma(broadcast<T>(params.motor_kp[i]) * inverse_h, goal - q, wanted);
      if (tree.dof_limited[i]) {
        jc.lower[i] = internal::limit_velocity(lower - q, inverse_h) - v;
        jc.upper[i] = -internal::limit_velocity(q - upper, inverse_h) - v;
      }
    }
    if (tree.dof_drive[i] >= 0) {
      jc.target[i] = jc.target[i] - v;
    } else {
      const T free_target = select(holds, select(motor, wanted, zero) - v, infinity);
      jc.target[i] = clamp(free_target, jc.lower[i], jc.upper[i]);
      jc.most[i] = select(free_target < jc.lower[i], infinity, F);
      jc.least[i] = select(free_target > jc.upper[i], -infinity, -F);
    }
    T& stance = state.stance()[i];
    // A motor that is pushing arrives when a change like the last one would pass its target. Without a motor the target
    // may be infinite: the search must not begin where that holds or comes next.
    const auto arrives = (abs(stance) == one) & (stance * (state.dv()[i] - jc.target[i]) > zero);
    const T pushed = select(abs(stance) <= one, T(R(internal::kPushedUp)), stance);
    stance = select(holds, select(arrives, T(R(internal::kHeld)), stance), pushed);
  }
  jc.rhs = jc.smooth;
}

namespace internal {

/// The dofs that are forced in some lane, leaves first, each with its nearest such ancestor: what must be factored.
template <Number T>
MANYHANDS_INLINE void find_forced(const Tree<real_t<T>>& tree, JointConstraints<T>& jc) {
  const T one(real_t<T>(1));
  jc.forced_dofs.clear();
  for (int k = tree.nv - 1; k >= 0; --k) {
    const auto i = static_cast<std::size_t>(k);
    const bool forced = any(jc.forced[i] == one);
    if (forced) jc.forced_dofs.push_back(k);
    jc.is_forced[i] = forced;
  }
  for (std::size_t i = 0; i < jc.is_forced.size(); ++i) {
    const int parent = tree.dof_parent[i];
    jc.forced_parent[i] = parent < 0 || jc.is_forced[static_cast<std::size_t>(parent)]
                              ? parent
                              : jc.forced_parent[static_cast<std::size_t>(parent)];
  }
}

/// The dv at which stance s holds dof i.
template <Number T>
MANYHANDS_INLINE T held_change(T s, std::size_t i, const JointConstraints<T>& jc) {
  const T zero(real_t<T>(0));
  return select(s == zero, jc.target[i], select(s > zero, jc.lower[i], jc.upper[i]));
}

/// dv of the forced dofs, given impulse = M held. A dof that is held in a lane has a row of the identity there, and
/// zeros beside it: lanes with different stances share one factorisation.
template <Number T>
MANYHANDS_INLINE void solve_forced(const Tree<real_t<T>>& tree, const T* stances, Workspace<T>& ws,
                                   JointConstraints<T>& jc) {
  using R = real_t<T>;
  const T zero(R(0)), one(R(1));
  const int* parent = jc.forced_parent.data();
  for (const int k : jc.forced_dofs) {
    const auto i = static_cast<std::size_t>(k);
    const T* M = ws.M.data() + tree.M_row[i];
    T* L = ws.L.data() + tree.M_row[i];
    const auto forced = jc.forced[i] == one;
    const auto soft = jc.spring[i] > zero;
    const T pushed = fma(stances[i], jc.max_impulse[i], jc.rhs[i]);
    const T held = fma(jc.spring[i], held_change(stances[i], i, jc), jc.rhs[i] + jc.anchor[i]);
    const T push = select(soft, held, pushed) - jc.impulse[i], inertia = M[i] + jc.spring[i];
    jc.dv[i] = select(forced, push, zero);
    L[i] = select(forced, inertia, one);
    for (int j = parent[k]; j >= 0; j = parent[j])
      L[j] = M[j] * (jc.forced[i] * jc.forced[static_cast<std::size_t>(j)]);
  }
  factor_ltdl(jc.forced_dofs, parent, tree.M_row.data(), ws.L.data());
  solve_ltdl(jc.forced_dofs, parent, tree.M_row.data(), ws.L.data(), jc.dv.data());
}

/// dv and impulses that the stances imply.
template <Number T>
MANYHANDS_INLINE void solve_stances(const Tree<real_t<T>>& tree, const T* stances, Workspace<T>& ws,
                                    JointConstraints<T>& jc) {
  using R = real_t<T>;
  const T zero(R(0)), one(R(1));
  const auto nv = static_cast<std::size_t>(tree.nv);
  mask_t<T> any_forced(false);
  for (std::size_t i = 0; i < nv; ++i) {
    const T s = stances[i];
    const auto pushed = abs(s) == one;
    const T grip = jc.touched[i] * (static_cast<R>(kGrip) * (ws.M.data() + tree.M_row[i])[i]);
    const T spring = tree.dof_drive[i] >= 0 ? select(s == zero, jc.slope[i], grip) : grip;
    jc.spring[i] = select(pushed, zero, spring);
    jc.anchor[i] = jc.hold[i];
    if (tree.dof_drive[i] >= 0) jc.anchor[i] = select(s == zero, zero, jc.hold[i]);
    const auto forced = pushed | (jc.spring[i] > zero);
    any_forced = any_forced | forced;
    jc.forced[i] = select(forced, one, zero);
    jc.held[i] = select(forced, zero, held_change(s, i, jc));
    jc.dv[i] = zero;
  }
  multiply_tree_matrix<T>(tree, ws.M.data(), jc.held.data(), jc.impulse.data());
  when(any_forced, [&] {
    find_forced(tree, jc);
    solve_forced(tree, stances, ws, jc);
    for (const int k : jc.forced_dofs)
      add_tree_column<T>(tree, ws.M.data(), k, jc.dv[static_cast<std::size_t>(k)], jc.impulse.data());
  });
  for (std::size_t i = 0; i < nv; ++i) {
    jc.impulse[i] = jc.impulse[i] - jc.rhs[i];
    jc.dv[i] = (jc.dv[i] + jc.held[i]) + zero;  // + 0: a zero's sign would tell which other lanes were solved
  }
}

/// The stance to which dof i should move, given what its present one led to: of a drive, whose tread has a slope.
template <Number T>
MANYHANDS_INLINE T better_drive_stance(T s, std::size_t i, const JointConstraints<T>& jc) {
  using R = real_t<T>;
  const T tolerance(kPivotTolerance<T>), one(R(1)), F = jc.max_impulse[i], impulse = jc.impulse[i], dv = jc.dv[i];
  const T slack = tolerance * (one + abs(jc.rhs[i])), speed_slack = tolerance * (one + abs(dv));
  const T up{R(kPushedUp)}, down{R(kPushedDown)}, held{R(kHeld)}, at_lower{R(kAtLower)}, at_upper{R(kAtUpper)};
  const auto below = dv<jc.lower[i] - speed_slack, above = dv> jc.upper[i] + speed_slack;
  const T from_held =
      select(below, at_lower,
             select(above, at_upper, select(impulse > F + slack, up, select(impulse < -F - slack, down, held))));
  const T reach = jc.slope[i] * (jc.target[i] - dv);
  const T from_up = select(below, at_lower, select(reach < F - slack, held, s));
  const T from_down = select(above, at_upper, select(reach > slack - F, held, s));
  const T lowest = clamp(jc.slope[i] * (jc.target[i] - jc.lower[i]), -F, F);
  const T highest = clamp(jc.slope[i] * (jc.target[i] - jc.upper[i]), -F, F);
  const T from_lower = select(impulse < lowest - slack, held, s);
  const T from_upper = select(impulse > highest + slack, held, s);
  return select(s == held, from_held,
                select(s == up, from_up, select(s == down, from_down, select(s > one, from_lower, from_upper))));
}

/// The stance to which dof i should move, given what its present one led to.
template <Number T>
MANYHANDS_INLINE T better_stance(T s, std::size_t i, const JointConstraints<T>& jc) {
  using R = real_t<T>;
  const T tolerance(kPivotTolerance<T>), one(R(1)), F = jc.max_impulse[i], impulse = jc.impulse[i], dv = jc.dv[i];
  const T slack = tolerance * (F + abs(jc.rhs[i])), speed_slack = tolerance * (one + abs(dv));
  const T held = select(impulse > jc.most[i] + slack, T(R(kPushedUp)),
                        select(impulse < jc.least[i] - slack, T(R(kPushedDown)), T(R(kHeld))));
  const T pushed_up =
      select(dv > jc.target[i] + speed_slack, T(R(kHeld)), select(dv < jc.lower[i] - speed_slack, T(R(kAtLower)), s));
  const T pushed_down =
      select(dv < jc.target[i] - speed_slack, T(R(kHeld)), select(dv > jc.upper[i] + speed_slack, T(R(kAtUpper)), s));
  const T at_lower = select(impulse < F - slack, T(R(kPushedUp)), s);
  const T at_upper = select(impulse > slack - F, T(R(kPushedDown)), s);
  return select(s == T(R(kHeld)), held,
                select(s == one, pushed_up, select(s == -one, pushed_down, select(s > one, at_lower, at_upper))));
}

/// Tells every dof its better stance; the number of those that should move.
template <Number T>
MANYHANDS_INLINE T find_better_stances(const Tree<real_t<T>>& tree, const T* stances, JointConstraints<T>& jc) {
  using R = real_t<T>;
  T wrong(R(0));
  for (std::size_t i = 0; i < jc.better.size(); ++i) {
    jc.better[i] = tree.dof_drive[i] >= 0 ? better_drive_stance(stances[i], i, jc) : better_stance(stances[i], i, jc);
    wrong += select(jc.better[i] != stances[i], T(R(1)), T(R(0)));
  }
  return wrong;
}

}  // namespace internal

/// dv and impulses of all dofs after `prepare_joint_constraints`, given `rhs`. The answer depends on the state and the
/// stances it starts from (kept in the state), not on the other lanes.
template <Number T>
MANYHANDS_INLINE void solve_joint_constraints(const Tree<real_t<T>>& tree, State<T>& state, Workspace<T>& ws,
                                              JointConstraints<T>& jc) {
  using R = real_t<T>;
  const auto nv = static_cast<std::size_t>(tree.nv);
  const T zero(R(0)), one(R(1));
  T* stances = state.stance();
  T fewest(std::numeric_limits<R>::infinity()), patience = zero;
  for (int pivot = 0; pivot < internal::kMaxPivots; ++pivot) {
    internal::solve_stances(tree, stances, ws, jc);
    const T wrong = internal::find_better_stances(tree, stances, jc);
    if (none(wrong > zero)) break;
    patience = select(wrong < fewest, T(R(internal::kPatience)), patience - one);
    fewest = min(wrong, fewest);
    mask_t<T> may_move(true);
    for (std::size_t i = 0; i < nv; ++i) {
      const auto moves = (jc.better[i] != stances[i]) & may_move;
      stances[i] = select(moves, jc.better[i], stances[i]);
      may_move = may_move & !(moves & (patience < zero));
    }
  }
}

}  // namespace manyhands
