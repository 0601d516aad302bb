// Motion that a step makes from nothing: it takes Coriolis, centrifugal and gyroscopic forces from where it begins, and
// where things turn by a radian or more in it, these drive them faster and faster.
//
// In a step bodies gain what joints, contacts and equality constraints do to them, all of it along their velocities,
// and what they fall. A tree of joints that moves fast and has more than that and what it had is slowed until it has no
// more. Where things turn by more than a turn and a step comes to ten times as much, it is beyond mending.
// Springs of tendons count as falling does: a step takes their forces along lines that bend while it lasts, and in one
// that is stiff any bend is much energy. Where they have gained ten times as much as there was to give, slowing is no
// help either.
// Trees are judged one by one, those that such a spring joins together, and only where something moves fast: all others
// cost a comparison.
#pragma once

#include <algorithm>

#include "manyhands/base/index.h"
#include "manyhands/math/control_flow.h"
#include "manyhands/physics/dynamics/lengths.h"
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
  std::vector<std::size_t> root;  ///< where each body's tree starts, or the first of those that springs join to it
  std::vector<T> before;          ///< kinetic energy before the step
  std::vector<T> after;           ///< with the velocities after it, where the bodies were before
  std::vector<T> moved;           ///< the same where they are after it
  std::vector<T> work;            ///< of the step's bias forces, and of tendons' springs
  std::vector<T> fallen;          ///< potential energy lost, of tendons' springs too
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

/// The body that tendon k moves first, or 0.
template <Real R>
std::size_t first_body(const Tree<R>& tree, std::size_t k) {
  const std::vector<int>& dofs = tree.lengths[k].dofs;
  for (std::size_t b = 1; b < tree.bodies.size() && !dofs.empty(); ++b)
    if (dofs[0] < tree.bodies[b].iv + tree.bodies[b].nv) return b;
  return 0;
}

/// Trees that the spring of a tendon joins have one root.
template <Real R, Number P>
void join_trees(const Tree<R>& tree, const Params<P>& params, std::vector<std::size_t>& root) {
  for (std::size_t k = 0; k < params.tendon_stiffness.size(); ++k) {
    if (!any(params.tendon_stiffness[k] > constant<P>(0))) continue;
    const std::size_t first = root[first_body(tree, k)];
    for (std::size_t b = 1; b < tree.bodies.size(); ++b) {
      const TreeBody<R>& body = tree.bodies[b];
      const bool moves_it =
          std::ranges::any_of(tree.lengths[k].dofs, [&](int dof) { return dof >= body.iv && dof < body.iv + body.nv; });
      if (moves_it && root[b] != first) std::ranges::replace(root, std::size_t(root[b]), first);
    }
  }
}

/// Where trees start.
template <Real R, Number P>
void find_roots(const Tree<R>& tree, const Params<P>& params, std::vector<std::size_t>& root) {
  root.assign(tree.bodies.size(), 0);
  for (std::size_t b = 1; b < tree.bodies.size(); ++b)
    root[b] = tree.bodies[b].parent == 0 ? b : root[index(tree.bodies[b].parent)];
  join_trees(tree, params, root);
}

/// What the springs of tendons do in the step, as it was assembled in `ws`.
template <Number T, Number P>
MANYHANDS_INLINE void add_spring_work(const Tree<real_t<T>>& tree, const Params<P>& params, T h, const T* v,
                                      const T* v_after, const Workspace<T>& ws, EnergyBalance<T>& balance) {
  const T half = constant<T>(0.5);
  visit_tendon_springs(params, ws, [&](std::size_t k, T stiffness, T stretch) {
    const T rate = along_length(tree, ws, k, v), rate_after = along_length(tree, ws, k, v_after);
    const T impulse = -fma(h * stiffness, stretch, ws.spring_inertia[k] * (rate_after - rate));
    T& work = balance.work[balance.root[first_body(tree, k)]];
    work = fma(half * impulse, rate + rate_after, work);
  });
}

/// Counts what the springs of tendons hold as lost, times sign, at the lengths of `ws`.
template <Number T, Number P>
MANYHANDS_INLINE void add_released(const Tree<real_t<T>>& tree, const Params<P>& params, T sign, const Workspace<T>& ws,
                                   EnergyBalance<T>& balance) {
  const T half = constant<T>(0.5);
  visit_tendon_springs(params, ws, [&](std::size_t k, T stiffness, T stretch) {
    T& fallen = balance.fallen[balance.root[first_body(tree, k)]];
    fallen = fma(sign * half * stiffness, stretch * stretch, fallen);
  });
}

/// How far each tree moves in the step, and what its bias forces do.
template <Number T>
MANYHANDS_INLINE void sum_dofs(const Tree<real_t<T>>& tree, T h, const T* v, const std::vector<T>& bias,
                               const T* v_after, EnergyBalance<T>& balance) {
  const T half = constant<T>(0.5);
  for (std::size_t b = 1; b < tree.bodies.size(); ++b) {
    const TreeBody<real_t<T>>& body = tree.bodies[b];
    T &far = balance.far[balance.root[b]], &work = balance.work[balance.root[b]];
    for (std::size_t i = index(body.iv); i < index(body.iv + body.nv); ++i) {
      far = max(far, h * abs(v_after[i]));
      work = fma(-half * h * bias[i], v[i] + v_after[i], work);
    }
  }
}

/// The energy of the tree from body b that is from nothing even if it stood still [J]: what its weight and springs have
/// gained beyond all that was given; less than 0 where more was.
template <Number T>
MANYHANDS_INLINE T risen(const EnergyBalance<T>& balance, std::size_t b) {
  return balance.work[b] - balance.after[b] - balance.fallen[b];
}

/// Whether the tree from body b has more energy than slowing it could mend.
template <Number T>
MANYHANDS_INLINE mask_t<T> gains(const EnergyBalance<T>& balance, std::size_t b) {
  const T zero = constant<T>(0), before = balance.before[b], after = balance.after[b];
  const T done = after - before - balance.work[b], fallen = balance.fallen[b], far = balance.far[b];
  const T most = constant<T>(energy_balance::kGrowth) * (before + max(done, zero) + max(fallen, zero));
  const auto flung = (!(max(after, balance.moved[b]) <= most)) & (far > constant<T>(energy_balance::kFar));
  const auto lifted = (!(risen(balance, b) <= most)) & (far > constant<T>(energy_balance::kFast));
  return (flung | lifted) & is_finite(before);
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
           const Workspace<T>& stepped, const State<T>& after, Workspace<T>& ws, EnergyBalance<T>& balance) {
  const T zero = constant<T>(0), one = constant<T>(1);
  find_roots(tree, params, balance.root);
  for (std::vector<T>* sums : {&balance.work, &balance.fallen, &balance.far}) sums->assign(tree.bodies.size(), zero);
  place_mocap(tree, after.mocap(), ws);
  sum_dofs(tree, T(h), v, stepped.bias, after.v(), balance);
  add_spring_work(tree, params, T(h), v, after.v(), stepped, balance);
  add_fallen(tree, params, q, one, ws, balance);
  sum_kinetic(tree, params, v, ws, balance.root, balance.before);
  sum_kinetic(tree, params, after.v(), ws, balance.root, balance.after);
  add_fallen(tree, params, after.q(), -one, ws, balance);
  sum_kinetic(tree, params, after.v(), ws, balance.root, balance.moved);
  add_released(tree, params, one, stepped, balance);
  place_lengths(tree, after.q(), after.v(), ws);
  add_released(tree, params, -one, ws, balance);
}

}  // namespace internal

/// Slows trees that a step of h [s] has given motion from nothing, and returns the worlds in which that could not mend
/// it. q (nq), v (nv): before the step; `stepped`: what the step has found there. `ws` is scratch; what was found of
/// each tree is in `balance`.
template <Number T, Number P>
mask_t<T> keep_balance(const Tree<real_t<T>>& tree, const Params<P>& params, real_t<T> h, const T* q, const T* v,
                       const Workspace<T>& stepped, State<T>& after, Workspace<T>& ws, EnergyBalance<T>& balance) {
  T fastest = constant<T>(0);
  for (std::size_t i = 0; i < index(tree.nv); ++i) fastest = max(fastest, abs(after.v()[i]));
  mask_t<T> found = T(h) * fastest > constant<T>(energy_balance::kFast);
  if (none(found)) return found;
  internal::weigh(tree, params, h, q, v, stepped, after, ws, balance);
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
