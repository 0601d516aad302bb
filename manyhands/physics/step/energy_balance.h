// Motion that a step makes from nothing: it takes Coriolis, centrifugal and gyroscopic forces from where it begins, and
// where things turn by a radian or more in it, these drive them faster and faster.
//
// In a step bodies gain what joints, contacts and equality constraints do to them, all of it along their velocities,
// and what they fall. A tree of joints that moves fast and has more than that and what it had is slowed until it has no
// more. Where things turn by more than a turn and a step comes to ten times as much, it is beyond mending.
// Trees are judged one by one, and only where something moves fast: all others cost a comparison.
#pragma once

#include "manyhands/base/index.h"
#include "manyhands/math/control_flow.h"
#include "manyhands/physics/dynamics/rnea.h"
#include "manyhands/physics/dynamics/state.h"

namespace manyhands {

namespace energy_balance {

/// What moves less in a step keeps its bits [rad or m].
inline constexpr double kFast = 0.25;
/// By what part of all that is given and taken a fast tree's energy may be more than their balance.
inline constexpr double kSlack = 1e-3;
/// What moves less in a step is slowed, and no more: a turn [rad or m].
inline constexpr double kFar = 6.283;
/// By what factor energy may grow in one without a reason.
inline constexpr double kGrowth = 10;

}  // namespace energy_balance

/// What was found in a step in which something moves fast. (nb) each: by the body from which a tree starts [J]; of
/// others 0.
template <Number T>
struct EnergyBalance {
  std::vector<std::size_t> root;  ///< where each body's tree starts
  std::vector<T> before;          ///< kinetic energy before the step
  std::vector<T> after;           ///< with the velocities after it, where the bodies were before
  std::vector<T> moved;           ///< the same where they are after it
  std::vector<T> work;            ///< of the step's bias forces
  std::vector<T> fallen;          ///< potential energy lost
  std::vector<T> far;             ///< [rad or m] how far a dof moves at most
};

namespace internal {

/// By trees: the kinetic energy at the velocity v (nv), after the bodies are placed.
template <Number T, Number P>
MANYHANDS_INLINE void sum_kinetic(const Tree<real_t<T>>& tree, const Params<P>& params, const T* v, Workspace<T>& ws,
                                  const std::vector<std::size_t>& root, std::vector<T>& sums) {
  const T half = constant<T>(0.5);
  sums.assign(tree.bodies.size(), constant<T>(0));
  for (std::size_t b = 1; b < tree.bodies.size(); ++b) {
    if (tree.bodies[b].type == JointType::kMocap) continue;
    move(tree, b, v, ws);
    T& sum = sums[root[b]];
    sum = fma(half, dot(ws.V[b], ws.I[b] * ws.V[b]), sum);
    const TreeBody<real_t<T>>& body = tree.bodies[b];
    for (std::size_t i = index(body.iv); i < index(body.iv + body.nv); ++i)
      sum = fma(half * broadcast<T>(params.armature[i]), v[i] * v[i], sum);
  }
}

/// Places the bodies at q (nq), and counts sign times their potential energy as fallen, by trees.
template <Number T, Number P>
MANYHANDS_INLINE void add_fallen(const Tree<real_t<T>>& tree, const Params<P>& params, const T* q, T sign,
                                 Workspace<T>& ws, EnergyBalance<T>& balance) {
  for (std::size_t b = 1; b < tree.bodies.size(); ++b) {
    place(tree, b, q, ws);
    place_inertia(b, params, ws);
    T& fallen = balance.fallen[balance.root[b]];
    const Vec3<T> moment = fma(ws.I[b].m, ws.p_WO[b], ws.I[b].h);
    fallen = fma(-sign, dot(broadcast<T>(params.gravity[0]), moment), fallen);
  }
}

/// Where trees start, how far each moves in the step, and what its bias forces do.
template <Number T>
MANYHANDS_INLINE void sum_dofs(const Tree<real_t<T>>& tree, T h, const T* v, const std::vector<T>& bias,
                               const T* v_after, EnergyBalance<T>& balance) {
  const T half = constant<T>(0.5);
  for (std::size_t b = 1; b < tree.bodies.size(); ++b) {
    const TreeBody<real_t<T>>& body = tree.bodies[b];
    balance.root[b] = body.parent == 0 ? b : balance.root[index(body.parent)];
    T &far = balance.far[balance.root[b]], &work = balance.work[balance.root[b]];
    for (std::size_t i = index(body.iv); i < index(body.iv + body.nv); ++i) {
      far = max(far, h * abs(v_after[i]));
      work = fma(-half * h * bias[i], v[i] + v_after[i], work);
    }
  }
}

/// Whether the tree from body b has more energy than slowing it could mend.
template <Number T>
MANYHANDS_INLINE mask_t<T> gains(const EnergyBalance<T>& balance, std::size_t b) {
  const T zero = constant<T>(0), before = balance.before[b], after = balance.after[b];
  const T had = before + max(after - before - balance.work[b], zero) + max(balance.fallen[b], zero);
  const auto bounded = max(after, balance.moved[b]) <= constant<T>(energy_balance::kGrowth) * had;
  return (!bounded) & (balance.far[b] > constant<T>(energy_balance::kFar)) & is_finite(before);
}

/// By what factor the velocities of the tree from body b must shrink: 1 where its energy is no more than what it had,
/// what was done to it and what it fell.
template <Number T>
MANYHANDS_INLINE T slowed(const EnergyBalance<T>& balance, std::size_t b) {
  const T zero = constant<T>(0), one = constant<T>(1);
  const T before = balance.before[b], done = balance.after[b] - before - balance.work[b], fallen = balance.fallen[b];
  const T slack = constant<T>(energy_balance::kSlack) * (before + abs(done) + abs(fallen));
  const T most = max(before + done + fallen, zero) + slack, moved = balance.moved[b];
  const auto is_fast = balance.far[b] > constant<T>(energy_balance::kFast);
  return select(is_fast & (moved > most), sqrt(most / select(moved > zero, moved, one)), one);
}

/// Finds the balance of every tree.
template <Number T, Number P>
void weigh(const Tree<real_t<T>>& tree, const Params<P>& params, real_t<T> h, const T* q, const T* v,
           const std::vector<T>& bias, const State<T>& after, Workspace<T>& ws, EnergyBalance<T>& balance) {
  const T zero = constant<T>(0), one = constant<T>(1);
  balance.root.assign(tree.bodies.size(), 0);
  for (std::vector<T>* sums : {&balance.work, &balance.fallen, &balance.far}) sums->assign(tree.bodies.size(), zero);
  place_mocap(tree, after.mocap(), ws);
  sum_dofs(tree, T(h), v, bias, after.v(), balance);
  add_fallen(tree, params, q, one, ws, balance);
  sum_kinetic(tree, params, v, ws, balance.root, balance.before);
  sum_kinetic(tree, params, after.v(), ws, balance.root, balance.after);
  add_fallen(tree, params, after.q(), -one, ws, balance);
  sum_kinetic(tree, params, after.v(), ws, balance.root, balance.moved);
}

}  // namespace internal

/// Slows trees that a step of h [s] has given motion from nothing, and returns the worlds in which that could not mend
/// it. q (nq), v (nv): before the step; `bias` (nv): of that state, as the step has found it. `ws` is scratch; what was
/// found of each tree is in `balance`.
template <Number T, Number P>
mask_t<T> keep_balance(const Tree<real_t<T>>& tree, const Params<P>& params, real_t<T> h, const T* q, const T* v,
                       const std::vector<T>& bias, State<T>& after, Workspace<T>& ws, EnergyBalance<T>& balance) {
  T fastest = constant<T>(0);
  for (std::size_t i = 0; i < index(tree.nv); ++i) fastest = max(fastest, abs(after.v()[i]));
  mask_t<T> found = T(h) * fastest > constant<T>(energy_balance::kFast);
  if (none(found)) return found;
  internal::weigh(tree, params, h, q, v, bias, after, ws, balance);
  found = mask_t<T>(false);
  for (std::size_t b = 1; b < tree.bodies.size(); ++b) {
    const TreeBody<real_t<T>>& body = tree.bodies[b];
    const auto beyond = internal::gains(balance, balance.root[b]);
    const T factor = select(beyond, constant<T>(1), internal::slowed(balance, balance.root[b]));
    found = found | beyond;
    for (std::size_t i = index(body.iv); i < index(body.iv + body.nv); ++i) after.v()[i] = factor * after.v()[i];
  }
  return found;
}

}  // namespace manyhands
