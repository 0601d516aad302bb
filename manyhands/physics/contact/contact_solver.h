// Contacts, joint motors and limits of a step, solved together: block Gauss-Seidel over exact contact points, inside
// the pivoting of the joints. See README.md in this folder.
#pragma once

#include "manyhands/physics/contact/loops.h"

namespace manyhands {

/// How long the solver works. In lanes the worlds of a block share the sweeps, and a world that is done stays as it is.
struct SolverSettings {
  int max_sweeps = 100;            ///< over all contacts; a few more where a joint's motor or limit gives way
  double tolerance = 1e-9;         ///< stop when a sweep changes no contact's velocity by more [m/s]
  int newton_steps = 10;           ///< at most, in double alone, where sweeps gain too little
  double newton_tolerance = 1e-7;  ///< residual of the law of contact that is not worth a Newton step [m/s]
};

namespace internal {

/// Sweeps between two looks at the joints' stances.
inline constexpr int kSweepsPerPivot = 8;

/// How often the joints' stances may change once contacts take part.
inline constexpr int kMostContactPivots = 12;

/// Turns the tangent rows of G = J W so that what resists sliding is diagonal; the angle's cosine and sine.
template <Number T>
MANYHANDS_INLINE ContactStiffness<T> diagonalise(const Mat3<T>& G, T softness, T& c, T& s) {
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
  c = select(turned, sqrt(half * (one + ratio)), one);
  s = select(turned, copysign(one, d) * s_12 / (max(r, tiny) * (c + c)), zero);
  const T mean = half * (s_11 + s_22), spread = copysign(r, d);
  k.sigma_1 = max(mean + spread, zero);
  k.sigma_2 = max(mean - spread, zero);
  k.slope_1 = fma(c, slope_1, s * slope_2);
  k.slope_2 = fma(c, slope_2, -(s * slope_1));
  return k;
}

/// Where the stiffness is that of the mask's worlds, else the one before.
template <Number T>
MANYHANDS_INLINE ContactStiffness<T> chosen(mask_t<T> m, const ContactStiffness<T>& a, const ContactStiffness<T>& b) {
  return {select(m, a.normal, b.normal),   select(m, a.normal_inverse, b.normal_inverse),
          select(m, a.slope_1, b.slope_1), select(m, a.slope_2, b.slope_2),
          select(m, a.sigma_1, b.sigma_1), select(m, a.sigma_2, b.sigma_2)};
}

/// What a row of a contact's block does to it: W and G for the stances whose factors are in ws.L, and the turn that
/// makes its basis diagonal.
template <Number T>
MANYHANDS_INLINE Mat3<T> answer(const Tree<real_t<T>>& tree, const Workspace<T>& ws, const LoopSet<T>& loops,
                                const RowBlock& rows, Vec3<T>* Z, RowStore<T>& store) {
  respond(tree, rows, ws, store);
  if (!loops.x.empty()) eliminate_loops(tree, rows, loops, Z, store);
  return multiply_response(tree, rows, store);
}

/// Turns a block's rows 2 and 3 and keeps its W in the worlds of the mask.
template <Number T, class Block>
MANYHANDS_INLINE void turn_block(const Tree<real_t<T>>& tree, mask_t<T> where, T c, T s, const LoopSet<T>& loops,
                                 Vec3<T>* Z, Block& block, Vec3<T>& e_1, Vec3<T>& e_2, RowStore<T>& store) {
  c = select(where, c, T(real_t<T>(1)));
  s = select(where, s, T(real_t<T>(0)));
  keep_response(block.rows, where, c, s, store);
  turn_rows(tree, block.rows, c, s, store);
  const Vec3<T> turned_1 = fma(c, e_1, s * e_2), turned_2 = fma(c, e_2, -s * e_1);
  e_1 = turned_1;
  e_2 = turned_2;
  block.offset = turned_rows(block.offset, c, s);
  block.impulse = turned_rows(block.impulse, c, s);
  block.closed_at = block.impulse;
  for (std::size_t i = 0; i < loops.x.size(); ++i) Z[i] = select(where, turned_rows(Z[i], c, s), loops.kept_Z[i]);
}

/// W, G and the basis of every contact in the worlds of the mask; the others keep theirs to the bit.
template <Number T>
MANYHANDS_INLINE void find_responses(const Tree<real_t<T>>& tree, const Workspace<T>& ws, mask_t<T> where,
                                     LoopSet<T>& loops, ContactSet<T>& set) {
  using R = real_t<T>;
  const T zero(R(0)), one(R(1)), tiny(std::numeric_limits<R>::min() * R(1e6));
  const std::size_t nl = loops.x.size();
  loops.Z.resize(nl * (set.points.size() + set.torsions.size()));
  Vec3<T>* Z = loops.Z.data();
  T c, s;
  for (ContactPoint<T>& point : set.points) {
    std::copy_n(Z, nl, loops.kept_Z.begin());
    const Mat3<T> G = answer(tree, ws, loops, point.rows, Z, set.store);
    point.stiffness = chosen(where, diagonalise(G, point.softness, c, s), point.stiffness);
    turn_block(tree, where, c, s, loops, Z, point, point.e_1, point.e_2, set.store);
    Z += nl;
  }
  for (ContactTorsion<T>& torsion : set.torsions) {
    std::copy_n(Z, nl, loops.kept_Z.begin());
    const Mat3<T> G = answer(tree, ws, loops, torsion.rows, Z, set.store);
    // Spinning and rolling are solved apart: turn the rolling rows by their own block of G alone.
    const Mat3<T> rolling{{one, zero, zero}, {zero, G.y.y, G.y.z}, {zero, G.z.y, G.z.z}};
    torsion.stiffness = chosen(where, diagonalise(rolling, zero, c, s), torsion.stiffness);
    torsion.spin_inverse = select(where, one / max(G.x.x, tiny), torsion.spin_inverse);
    turn_block(tree, where, c, s, loops, Z, torsion, torsion.t_1, torsion.t_2, set.store);
    Z += nl;
  }
}

/// Changes of an impulse relative to itself below which a sweep has settled, whatever the tolerance.
template <Number T>
inline constexpr real_t<T> kResolved = std::same_as<real_t<T>, float> ? real_t<T>(3e-7) : real_t<T>(1e-14);

/// Solves one contact given all others; how much its velocity changed by it.
template <Number T>
MANYHANDS_INLINE T relax(const Tree<real_t<T>>& tree, mask_t<T> active, ContactPoint<T>& point,
                         const RowStore<T>& store, T* dv) {
  Vec3<T> u = point.offset + multiply_rows(tree, point.rows, store, dv);
  u.x = fma(point.softness, point.impulse.x, u.x);
  const Vec3<T> next = select(active, solve_coulomb(point.stiffness, u, point.impulse), point.impulse);
  const Vec3<T> change = next - point.impulse;
  point.impulse = next;
  apply_row_impulse(point.rows, store, change, dv);
  // What an impulse of this size cannot resolve is no change.
  const ContactStiffness<T>& k = point.stiffness;
  const T least = T(kResolved<T>) * next.x;
  return max(k.normal * (abs(change.x) - least),
             max(k.sigma_1 * (abs(change.y) - least), k.sigma_2 * (abs(change.z) - least)));
}

/// The same for what resists spinning and rolling, limited by the normal impulse.
template <Number T>
MANYHANDS_INLINE T relax(const Tree<real_t<T>>& tree, mask_t<T> active, T normal_impulse, ContactTorsion<T>& torsion,
                         const RowStore<T>& store, T* dv) {
  const Vec3<T> u = torsion.offset + multiply_rows(tree, torsion.rows, store, dv);
  const T most = torsion.spinning * normal_impulse;
  Vec3<T> next{clamp(fma(-u.x, torsion.spin_inverse, torsion.impulse.x), -most, most), torsion.impulse.y,
               torsion.impulse.z};
  solve_disc(torsion.stiffness, u.y, u.z, torsion.rolling * normal_impulse, next.y, next.z);
  next = select(active, next, torsion.impulse);
  const Vec3<T> change = next - torsion.impulse;
  torsion.impulse = next;
  apply_row_impulse(torsion.rows, store, change, dv);
  return T(real_t<T>(0));
}

/// Sweeps over all contacts, always in the same order (orders that go back and forth converge more slowly, see
/// docs/contact_solver.md), until every world has settled or used up its `budget` of sweeps, which counts down. How
/// many sweeps there were.
template <Number T>
MANYHANDS_INLINE int sweep(const Tree<real_t<T>>& tree, T tolerance, T& budget, ContactSet<T>& set, T* dv,
                           mask_t<T>& settled) {
  using R = real_t<T>;
  const T zero(R(0)), one(R(1));
  int sweeps = 0;
  settled = set.points.empty();
  for (auto moving = budget > zero; any(moving); moving = (!settled) & (budget > zero)) {
    T largest = zero;
    for (ContactPoint<T>& point : set.points) {
      largest = max(largest, relax(tree, moving, point, set.store, dv));
      if (point.torsion < 0) continue;
      relax(tree, moving, point.impulse.x, set.torsions[static_cast<std::size_t>(point.torsion)], set.store, dv);
    }
    settled = settled | (moving & (largest <= tolerance));
    budget = select(moving, budget - one, budget);
    ++sweeps;
  }
  return sweeps;
}

/// What the loops' impulses become by the contacts' changes since they were closed.
template <Number T>
MANYHANDS_INLINE void follow_contacts(ContactSet<T>& set, LoopSet<T>& loops) {
  const std::size_t nl = loops.x.size();
  const Vec3<T>* Z = loops.Z.data();
  for (ContactPoint<T>& point : set.points) {
    follow_contact(Z, point.impulse - point.closed_at, loops);
    point.closed_at = point.impulse;
    Z += nl;
  }
  for (ContactTorsion<T>& torsion : set.torsions) {
    follow_contact(Z, torsion.impulse - torsion.closed_at, loops);
    torsion.closed_at = torsion.impulse;
    Z += nl;
  }
}

/// rhs = smooth + J^T impulses.
template <Number T>
MANYHANDS_INLINE void gather_impulses(const Tree<real_t<T>>& tree, const ContactSet<T>& set, const LoopSet<T>& loops,
                                      JointConstraints<T>& jc) {
  jc.rhs = jc.smooth;
  const auto add = [&](const auto& blocks, const RowStore<T>& store) {
    for (const auto& block : blocks) add_row_impulse(tree, block.rows, store, block.impulse, jc.rhs.data());
  };
  add(set.points, set.store);
  add(set.torsions, set.store);
  add(loops.blocks, loops.store);
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

/// How urgently a dof should leave its stance: the overload of a motor that holds, else a little.
template <Number T>
MANYHANDS_INLINE T urgency(const T* stances, std::size_t i, const JointConstraints<T>& jc) {
  using R = real_t<T>;
  const T zero(R(0)), tiny(R(1e-6)), little(R(2));
  const T overload = abs(jc.impulse[i]) / max(jc.max_impulse[i], tiny);
  return select(jc.better[i] == stances[i], zero, select(stances[i] == T(R(kHeld)), overload, little));
}

/// Moves the most urgent dof of each world, or the several that are equally so. Against contacts that have not settled
/// all motors seem overloaded: if they gave way together, the arm would be thrown about.
template <Number T>
MANYHANDS_INLINE void move_worst_stances(mask_t<T> moved, T* stances, const JointConstraints<T>& jc) {
  T worst(real_t<T>(0));
  for (std::size_t i = 0; i < jc.dv.size(); ++i) worst = max(worst, urgency(stances, i, jc));
  for (std::size_t i = 0; i < jc.dv.size(); ++i)
    stances[i] = select(moved & (urgency(stances, i, jc) >= worst), jc.better[i], stances[i]);
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
  if (set.points.empty() && loops.blocks.empty()) return 0;
  const T zero(R(0)), one(R(1)), batch(R(internal::kSweepsPerPivot)), tolerance(static_cast<R>(settings.tolerance));
  T* stances = state.stance();
  mask_t<T> active(true), moved(true);
  T left(static_cast<R>(settings.max_sweeps)), pivots = zero;
  if constexpr (std::same_as<T, double>) set.newton.begin();
  for (int sweeps = 0;;) {
    if (any(moved)) {
      internal::find_loop_responses(tree, ws, loops);
      internal::find_responses(tree, ws, moved, loops, set);
      internal::close_loops(tree, moved, loops, jc.dv.data());
      if constexpr (std::same_as<T, double>) set.newton.look_anew();
    }
    const T allowed = select(active, min(batch, left), zero);
    T budget = allowed;
    mask_t<T> settled;
    sweeps += internal::sweep(tree, tolerance, budget, set, jc.dv.data(), settled);
    if constexpr (std::same_as<T, double>) {
      if (!settled) settled = set.newton.finish(settings, {tree, ws, jc, loops, set}, sweeps);
    }
    left -= allowed - budget;
    internal::follow_contacts(set, loops);
    internal::find_joint_impulses(stances, jc);
    const auto wrong = internal::find_better_stances(tree, stances, jc) > zero;
    moved = active & wrong & (pivots < T(R(internal::kMostContactPivots)));
    active = moved | (active & (!settled) & (left > zero));
    if (none(active)) {
      internal::remember_loops(loops, state.loops());
      return sweeps;
    }
    if (none(moved)) continue;
    pivots = select(moved, pivots + one, pivots);
    left = select(moved, max(left, batch), left);
    internal::move_worst_stances(moved, stances, jc);
    set.kept_dv = jc.dv;
    internal::gather_impulses(tree, set, loops, jc);
    internal::solve_stances(tree, stances, ws, jc);
    for (std::size_t i = 0; i < jc.dv.size(); ++i) jc.dv[i] = select(moved, jc.dv[i], set.kept_dv[i]);
  }
}

}  // namespace manyhands
