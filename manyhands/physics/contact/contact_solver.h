// Contacts, joint motors and limits of a step, solved together: block Gauss-Seidel over exact contact points, inside
// the pivoting of the joints. See README.md in this folder.
#pragma once

#include "manyhands/physics/contact/contact_pivots.h"

namespace manyhands {

/// How long the solver works. In lanes the worlds of a block share the sweeps, and a world that is done stays as it is.
struct SolverSettings {
  int max_sweeps = 100;            ///< over all contacts; a few more where a joint's motor or limit gives way
  double tolerance = 1e-9;         ///< stop when a sweep changes no contact's velocity by more [m/s]
  int newton_steps = 10;           ///< at most, in double alone, where sweeps gain too little
  double newton_tolerance = 1e-7;  ///< residual of the law of contact that is not worth a Newton step [m/s]
};

namespace internal {

/// The stiffness by G = J A J^T, the tangents turned so that what resists sliding is diagonal.
template <Number T>
MANYHANDS_INLINE ContactStiffness<T> diagonalise(const Mat3<T>& G, T softness) {
  using R = real_t<T>;
  const T zero(R(0)), one(R(1)), half(R(0.5)), tiny(std::numeric_limits<R>::min() * R(1e6));
  ContactStiffness<T> k;
  k.normal = G.x.x + softness;
  const auto moves = k.normal > tiny;
  k.normal_inverse = select(moves, one / max(k.normal, tiny), zero);
  const T g_1 = G.x.y, g_2 = G.x.z;
  const T slope_1 = g_1 * k.normal_inverse, slope_2 = g_2 * k.normal_inverse;
  const T s_11 = fma(-g_1, slope_1, G.y.y), s_22 = fma(-g_2, slope_2, G.z.z), s_12 = fma(-g_1, slope_2, G.y.z);
  // The Jacobi rotation of at most 45 degrees.
  const T d = half * (s_11 - s_22), r = sqrt(fma(d, d, s_12 * s_12));
  const auto turned = r > tiny;
  const T ratio = abs(d) / select(turned, r, one);
  k.c = select(turned, sqrt(half * (one + ratio)), one);
  k.s = select(turned, copysign(one, d) * s_12 / (max(r, tiny) * (k.c + k.c)), zero);
  const T mean = half * (s_11 + s_22), spread = copysign(r, d);
  // Where the surfaces cannot slide at all, as on a link that has two joints before it, rounding leaves less than this.
  const T least = T(R(8) * std::numeric_limits<R>::epsilon()) * (G.y.y + G.z.z);
  k.sigma_1 = max(mean + spread, least);
  k.sigma_2 = max(mean - spread, least);
  k.inverse_1 = one / max(k.sigma_1, tiny);
  k.inverse_2 = one / max(k.sigma_2, tiny);
  k.slope_1 = fma(k.c, slope_1, k.s * slope_2);
  k.slope_2 = fma(k.c, slope_2, -(k.s * slope_1));
  return k;
}

/// Y and the stiffness of every contact, for the stances whose factors are in ws.L. Of a world whose stances are still
/// the same they come out the same.
template <Number T>
MANYHANDS_INLINE void find_answers(const Tree<real_t<T>>& tree, const Workspace<T>& ws, LoopSet<T>& loops,
                                   ContactSet<T>& set) {
  using R = real_t<T>;
  const T zero(R(0)), one(R(1)), tiny(std::numeric_limits<R>::min() * R(1e6));
  const std::size_t nl = loops.x.size();
  loops.Z.resize(2 * nl * set.patches.size());
  Vec3<T>* Z = loops.Z.data();
  const auto answer = [&](const RowBlock& rows) {
    find_answer(tree, rows, ws, set.store);
    if (nl > 0) eliminate_loops(rows, loops, Z, set.store);
    Z += nl;
    return keep_answer(rows, set.store);
  };
  for (ContactPatch<T>& patch : set.patches) {
    patch.G_vf = answer(patch.linear);
    if (patch.turns) {
      patch.G_wn = answer(patch.angular);
      const std::array<Vec3<T>, 3> G_vn = multiply_answers(patch.linear, set.store, patch.angular, set.store.x);
      patch.G_wf = {G_vn[0], G_vn[1], G_vn[2]};
    }
    patch.closed_at = patch_force(set, patch);
  }
  for (ContactPoint<T>& point : set.points)
    point.stiffness = diagonalise(point_answer(set.patches[point.patch], point.lever), point.softness);
  for (ContactTorsion<T>& torsion : set.torsions) {
    const Mat3<T>& G = set.patches[set.points[torsion.point].patch].G_wn;
    // Spinning and rolling are solved apart: turn the rolling rows by their own block of G alone.
    const Mat3<T> rolling{{one, zero, zero}, {zero, G.y.y, G.y.z}, {zero, G.z.y, G.z.z}};
    torsion.stiffness = diagonalise(rolling, zero);
    torsion.spin_inverse = one / max(G.x.x, tiny);
  }
}

/// Changes of an impulse relative to itself below which a sweep has settled, whatever the tolerance.
template <Number T>
inline constexpr real_t<T> kResolved = std::same_as<real_t<T>, float> ? real_t<T>(3e-7) : real_t<T>(1e-14);

/// Solves one contact, which has the velocity u, given all others: the change of its impulse. `largest` is at least how
/// much that changed its velocity.
template <Number T>
MANYHANDS_INLINE Vec3<T> relax(mask_t<T> active, Vec3<T> u, ContactPoint<T>& point, T& largest) {
  const ContactStiffness<T>& k = point.stiffness;
  u.x = fma(point.softness, point.impulse.x, u.x);
  T x = point.slide_x;
  const Vec3<T> before = k.turned(point.impulse), after = solve_coulomb(k, k.turned(u), before, x);
  point.slide_x = select(active, x, point.slide_x);
  const Vec3<T> next = select(active, k.turned_back(after), point.impulse), change = next - point.impulse;
  point.impulse = next;
  // What an impulse of this size cannot resolve is no change.
  const Vec3<T> turned = after - before;
  const T least = T(kResolved<T>) * next.x;
  largest = max(max(largest, k.normal * (abs(turned.x) - least)),
                max(k.sigma_1 * (abs(turned.y) - least), k.sigma_2 * (abs(turned.z) - least)));
  return change;
}

/// The same for what resists spinning and rolling, limited by the normal impulse.
template <Number T>
MANYHANDS_INLINE Vec3<T> relax(mask_t<T> active, T normal_impulse, const Vec3<T>& velocity,
                               ContactTorsion<T>& torsion) {
  const ContactStiffness<T>& k = torsion.stiffness;
  const Vec3<T> u = k.turned(velocity);
  const T most = torsion.spinning * normal_impulse;
  T x = torsion.slide_x;
  Vec3<T> next = k.turned(torsion.impulse);
  next.x = clamp(fma(-u.x, torsion.spin_inverse, next.x), -most, most);
  solve_disc(k, u.y, u.z, torsion.rolling * normal_impulse, x, next.y, next.z);
  torsion.slide_x = select(active, x, torsion.slide_x);
  next = select(active, k.turned_back(next), torsion.impulse);
  const Vec3<T> change = next - torsion.impulse;
  torsion.impulse = next;
  return change;
}

/// Solves the contacts of one patch in turn.
template <Number T>
MANYHANDS_INLINE void relax(mask_t<T> active, const ContactPatch<T>& patch, ContactSet<T>& set, T& largest) {
  Motion<T> motion = patch.start + answered_motion(patch, set.store);
  Force<T> change = Force<T>::zero();
  const auto act = [&](const Force<T>& force) {
    change = change + force;
    motion = motion + own_answer(patch, force);
  };
  for (std::size_t i = patch.first; i < patch.first + patch.count; ++i) {
    ContactPoint<T>& point = set.points[i];
    const Vec3<T> u = point.offset + velocity_at(patch, point.lever, motion);
    act(force_at(patch, point.lever, relax(active, u, point, largest)));
    if (point.torsion < 0) continue;
    ContactTorsion<T>& torsion = set.torsions[static_cast<std::size_t>(point.torsion)];
    act({relax(active, point.impulse.x, torsion.offset + motion.w, torsion), Vec3<T>::zero()});
  }
  apply_patch_force(patch, change, set.store);
}

/// Sweeps over all contacts, always in the same order (orders that go back and forth converge more slowly, see
/// docs/contact_solver.md), until every world has settled or used up its `budget` of sweeps, which counts down. How
/// many sweeps there were; `change` is by how much a world's last one changed a contact's velocity [m/s].
template <Number T>
MANYHANDS_INLINE int sweep(const Tree<real_t<T>>& tree, const Workspace<T>& ws, T tolerance, T& budget,
                           ContactSet<T>& set, JointConstraints<T>& jc, T& change) {
  using R = real_t<T>;
  const T zero(R(0)), one(R(1));
  int sweeps = 0;
  change = set.points.empty() ? zero : T(std::numeric_limits<R>::infinity());
  for (ContactPatch<T>& patch : set.patches) patch.start = patch_motion(tree, patch, set.store, jc.dv.data());
  begin_change(set.store);
  for (auto moving = budget > zero; any(moving); moving = (change > tolerance) & (budget > zero)) {
    T largest = zero;
    for (const ContactPatch<T>& patch : set.patches) relax(moving, patch, set, largest);
    change = select(moving, largest, change);
    budget = select(moving, budget - one, budget);
    ++sweeps;
  }
  end_change(tree, ws, set.store, jc);
  return sweeps;
}

/// What the loops' impulses become by the contacts' changes since they were closed.
template <Number T>
MANYHANDS_INLINE void follow_contacts(ContactSet<T>& set, LoopSet<T>& loops) {
  const std::size_t nl = loops.x.size();
  if (nl == 0) return;
  const Vec3<T>* Z = loops.Z.data();
  const auto follow = [&](const Vec3<T>& change) {
    follow_contact(Z, change, loops);
    Z += nl;
  };
  for (ContactPatch<T>& patch : set.patches) {
    const Force<T> force = patch_force(set, patch), change = force - patch.closed_at;
    follow(change.f);
    if (patch.turns) follow(change.n);
    patch.closed_at = force;
  }
}

/// rhs = smooth + J^T impulses.
template <Number T>
MANYHANDS_INLINE void gather_impulses(const Tree<real_t<T>>& tree, const ContactSet<T>& set, const LoopSet<T>& loops,
                                      JointConstraints<T>& jc) {
  jc.rhs = jc.smooth;
  for (const ContactPatch<T>& patch : set.patches)
    add_patch_force(tree, patch, set.store, patch_force(set, patch), jc.rhs.data());
  for (const LoopRows<T>& block : loops.blocks)
    add_row_impulse(tree, block.rows, loops.store, block.impulse, jc.rhs.data());
}

/// The impulses of motors and limits at the present dv, in trees that touch: there every dof is pushed or gives way.
template <Number T>
MANYHANDS_INLINE void find_joint_impulses(const T* stances, JointConstraints<T>& jc) {
  using R = real_t<T>;
  const T zero(R(0)), one(R(1));
  for (std::size_t i = 0; i < jc.impulse.size(); ++i) {
    const auto pushed = abs(stances[i]) == one, held = jc.spring[i] > zero;
    const T pulled = fma(jc.spring[i], held_change(stances[i], i, jc) - jc.dv[i], jc.anchor[i]);
    const T impulse = select(pushed, stances[i] * jc.max_impulse[i], select(held, pulled, jc.impulse[i]));
    jc.impulse[i] = select(jc.touched[i] > zero, impulse, jc.impulse[i]);
  }
}

}  // namespace internal

/// dv of all dofs, and the impulses of contacts, loops, motors and limits, after `prepare_contacts`; the number of
/// sweeps.
template <Number T>
MANYHANDS_INLINE int solve_constraints(const Tree<real_t<T>>& tree, const SolverSettings& settings, State<T>& state,
                                       Workspace<T>& ws, JointConstraints<T>& jc, LoopSet<T>& loops,
                                       ContactSet<T>& set) {
  using R = real_t<T>;
  solve_joint_constraints(tree, state, ws, jc);
  const T zero(R(0)), one(R(1));
  set.sweeps = zero;
  if (set.points.empty() && loops.blocks.empty()) return 0;
  const T tolerance(static_cast<R>(settings.tolerance));
  const T few(static_cast<R>(internal::kSweepsPerPivot<T>)), many(static_cast<R>(internal::kSweepsPerLatePivot)),
      most(static_cast<R>(internal::kMostContactPivots));
  T* stances = state.stance();
  mask_t<T> active(true), moved(true);
  T left(static_cast<R>(settings.max_sweeps)), pivots = zero, batch = few;
  internal::forget_best(set, loops);
  if constexpr (std::same_as<T, double>) set.newton.begin();
  for (int sweeps = 0;;) {
    if (any(moved)) {
      find_roots(tree, ws);
      internal::find_loop_answers(tree, ws, loops);
      internal::find_answers(tree, ws, loops, set);
      internal::close_loops(tree, ws, moved, loops, jc);
      if constexpr (std::same_as<T, double>) set.newton.look_anew();
    }
    const T allowed = select(active, min(batch, left), zero);
    T budget = allowed;
    T change;
    sweeps += internal::sweep(tree, ws, tolerance, budget, set, jc, change);
    mask_t<T> settled = change <= tolerance;  // NOLINT(misc-const-correctness): Newton steps settle doubles
    if constexpr (std::same_as<T, double>) {
      if (!settled) settled = set.newton.finish(settings, {tree, ws, jc, loops, set}, sweeps);
    }
    left -= allowed - budget;
    set.sweeps += allowed - budget;
    internal::follow_contacts(set, loops);
    internal::find_joint_impulses(stances, jc);
    const auto wrong = internal::find_better_stances(tree, stances, jc) > zero;
    moved = active & wrong & (pivots < most);
    active = moved | (active & (!settled) & (left > zero));
    if (none(active)) {
      internal::remember_loops(loops, state.equality_impulses());
      return sweeps;
    }
    if (none(moved)) continue;
    const T wrongness = max(change, internal::wrongness(tree, ws, stances, jc));
    internal::keep_best(moved, wrongness, stances, set, loops);
    const auto hopeless = wrongness > T(static_cast<R>(internal::kHopeless)) * set.best.wrong;
    pivots = select(moved, select(hopeless, most, pivots + one), pivots);
    batch = select(pivots > T(R(internal::kEarlyPivots)), many, few);
    left = select(moved, max(left, batch), left);
    const auto last = moved & (pivots == most);
    internal::move_worst_stances(moved & !last, stances, jc);
    internal::take_best(last, stances, set, loops);
    left = select(last, zero, left);
    set.kept_dv = jc.dv;
    set.kept_rhs = jc.rhs;  // by its size the next look at the stances tells what is rounding
    internal::gather_impulses(tree, set, loops, jc);
    internal::solve_stances(tree, stances, ws, jc);
    for (std::size_t i = 0; i < jc.dv.size(); ++i) {
      jc.dv[i] = select(moved, jc.dv[i], set.kept_dv[i]);
      jc.rhs[i] = select(moved, jc.rhs[i], set.kept_rhs[i]);
    }
  }
}

}  // namespace manyhands
