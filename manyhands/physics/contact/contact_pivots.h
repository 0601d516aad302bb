// How the joints' stances move once contacts take part: the most urgent first, and back to the best that were found if
// they go round in circles. Sweeps that are cut short, and friction that wedges, leave no guarantee that a search ends;
// what it ends with must still be a motion that motors could make.
#pragma once

#include "manyhands/physics/contact/loops.h"

namespace manyhands::internal {

/// How often the stances may change.
inline constexpr int kMostContactPivots = 12;

/// Sweeps between two looks at the stances: few where a block waits for its slowest world, but more where they have
/// changed often, since contacts that have not settled mislead them.
template <Number T>
inline constexpr int kSweepsPerPivot = std::same_as<real_t<T>, float> ? 2 : 8;
inline constexpr int kSweepsPerLatePivot = 8, kEarlyPivots = 3;

/// A search that becomes so many times worse than it was has left the ground.
inline constexpr double kHopeless = 1000;

/// How urgently a dof should leave its stance: the overload of a motor that holds, else a little.
template <Number T>
MANYHANDS_INLINE T urgency(const T* stances, std::size_t i, const JointConstraints<T>& jc) {
  using R = real_t<T>;
  const T zero(R(0)), tiny(R(1e-6)), little(R(2));
  const T overload = abs(jc.impulse[i]) / max(jc.max_impulse[i], tiny);
  return select(jc.better[i] == stances[i], zero, select(stances[i] == T(R(kHeld)), overload, little));
}

/// Moves the most urgent dof of each world, and those at least half as urgent. Against contacts that have not settled
/// all motors seem overloaded: if they gave way together, the arm would be thrown about.
template <Number T>
MANYHANDS_INLINE void move_worst_stances(mask_t<T> moved, T* stances, const JointConstraints<T>& jc) {
  T worst(real_t<T>(0));
  for (std::size_t i = 0; i < jc.dv.size(); ++i) worst = max(worst, urgency(stances, i, jc));
  const T least = T(real_t<T>(0.5)) * worst;
  for (std::size_t i = 0; i < jc.dv.size(); ++i)
    stances[i] = select(moved & (urgency(stances, i, jc) >= least), jc.better[i], stances[i]);
}

/// The largest error in velocity of a dof whose stance is wrong: by how much one that is pushed has passed its goal, or
/// what the impulse beyond its motor's does to one that is held.
template <Number T>
MANYHANDS_INLINE T wrongness(const Tree<real_t<T>>& tree, const Workspace<T>& ws, const T* stances,
                             const JointConstraints<T>& jc) {
  using R = real_t<T>;
  const T zero(R(0)), one(R(1)), tiny(std::numeric_limits<R>::min() * R(1e6));
  T worst = zero;
  for (std::size_t i = 0; i < jc.dv.size(); ++i) {
    const T inertia = max((ws.M.data() + tree.M_row[i])[i], tiny);
    const T excess = max(abs(jc.impulse[i]) - jc.max_impulse[i], zero) / inertia;
    const T passed = abs(jc.dv[i] - held_change(jc.better[i], i, jc));
    const T error = select(abs(stances[i]) == one, passed, excess);
    worst = max(worst, select(jc.better[i] == stances[i], zero, error));
  }
  return worst;
}

/// Calls body(index, impulse) for every impulse of contacts and loops.
template <Number T, class Body>
MANYHANDS_INLINE void visit_impulses(ContactSet<T>& set, LoopSet<T>& loops, Body&& body) {
  std::size_t i = 0;
  // NOLINTBEGIN(misc-const-correctness): some bodies write
  for (ContactPoint<T>& point : set.points) body(i++, point.impulse);
  for (ContactTorsion<T>& torsion : set.torsions) body(i++, torsion.impulse);
  for (LoopRows<T>& block : loops.blocks) body(i++, block.impulse);
  // NOLINTEND(misc-const-correctness)
}

/// Before a search.
template <Number T>
MANYHANDS_INLINE void forget_best(ContactSet<T>& set, const LoopSet<T>& loops) {
  set.best.wrong = T(std::numeric_limits<real_t<T>>::infinity());
  set.best.impulses.resize(set.points.size() + set.torsions.size() + loops.blocks.size());
}

/// Keeps the stances and impulses of worlds in which they are the least wrong so far.
template <Number T>
MANYHANDS_INLINE void keep_best(mask_t<T> asked, T wrong, const T* stances, ContactSet<T>& set, LoopSet<T>& loops) {
  const auto better = asked & (wrong < set.best.wrong);
  set.best.wrong = select(better, wrong, set.best.wrong);
  for (std::size_t i = 0; i < set.best.stances.size(); ++i)
    set.best.stances[i] = select(better, stances[i], set.best.stances[i]);
  visit_impulses(set, loops, [&](std::size_t i, const Vec3<T>& impulse) {
    set.best.impulses[i] = select(better, impulse, set.best.impulses[i]);
  });
}

/// Goes back to them, for good.
template <Number T>
MANYHANDS_INLINE void take_best(mask_t<T> asked, T* stances, ContactSet<T>& set, LoopSet<T>& loops) {
  for (std::size_t i = 0; i < set.best.stances.size(); ++i) stances[i] = select(asked, set.best.stances[i], stances[i]);
  visit_impulses(set, loops,
                 [&](std::size_t i, Vec3<T>& impulse) { impulse = select(asked, set.best.impulses[i], impulse); });
}

}  // namespace manyhands::internal
