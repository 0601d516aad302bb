// Contacts, joint motors and limits of a step, solved together: block Gauss-Seidel over exact contact points, inside
// the pivoting of the joints. See README.md in this folder.
#pragma once

#include "manyhands/physics/contact/loops.h"

namespace manyhands {

/// How long the solver works. In lanes the worlds of a block share the sweeps, and a world that is done stays as it is.
struct SolverSettings {
  int max_sweeps = 100;     ///< over all contacts; a few more where a joint's motor or limit gives way
  double tolerance = 1e-9;  ///< stop when a sweep changes no contact's velocity by more [m/s]
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

/// W, G and the basis of every contact, for the stances whose factors are in ws.L. `active` worlds change their basis.
template <Number T>
MANYHANDS_INLINE void find_responses(const Tree<real_t<T>>& tree, const Workspace<T>& ws, mask_t<T> active,
                                     LoopSet<T>& loops, ContactSet<T>& set) {
  using R = real_t<T>;
  const T zero(R(0)), one(R(1));
  const std::size_t nl = loops.x.size();
  loops.Z.resize(nl * (set.points.size() + set.torsions.size()));
  Vec3<T>* Z = loops.Z.data();
  const auto turn_answer = [&](T c, T s) {
    for (std::size_t i = 0; i < nl; ++i) Z[i] = turned_rows(Z[i], c, s);
    Z += nl;
  };
  for (ContactPoint<T>& point : set.points) {
    Mat3<T> G = respond(tree, point.rows, ws, set.store);
    if (nl > 0) eliminate_loops(tree, point.rows, loops, Z, set.store, G);
    T c, s;
    const ContactStiffness<T> stiffness = diagonalise(G, point.softness, c, s);
    c = select(active, c, one);
    s = select(active, s, zero);
    point.stiffness = stiffness;
    turn_rows(tree, point.rows, c, s, set.store);
    const Vec3<T> e_1 = fma(c, point.e_1, s * point.e_2), e_2 = fma(c, point.e_2, -s * point.e_1);
    point.e_1 = e_1;
    point.e_2 = e_2;
    point.offset = turned_rows(point.offset, c, s);
    point.impulse = turned_rows(point.impulse, c, s);
    point.closed_at = point.impulse;
    turn_answer(c, s);
  }
  for (ContactTorsion<T>& torsion : set.torsions) {
    Mat3<T> G = respond(tree, torsion.rows, ws, set.store);
    if (nl > 0) eliminate_loops(tree, torsion.rows, loops, Z, set.store, G);
    // Spinning and rolling are solved apart: turn the rolling rows by their own block of G alone.
    T c, s;
    torsion.stiffness = diagonalise(Mat3<T>{{one, zero, zero}, {zero, G.y.y, G.y.z}, {zero, G.z.y, G.z.z}}, zero, c, s);
    torsion.spin_inverse = one / max(G.x.x, T(std::numeric_limits<R>::min() * R(1e6)));
    c = select(active, c, one);
    s = select(active, s, zero);
    turn_rows(tree, torsion.rows, c, s, set.store);
    const Vec3<T> t_1 = fma(c, torsion.t_1, s * torsion.t_2), t_2 = fma(c, torsion.t_2, -s * torsion.t_1);
    torsion.t_1 = t_1;
    torsion.t_2 = t_2;
    torsion.offset = turned_rows(torsion.offset, c, s);
    torsion.impulse = turned_rows(torsion.impulse, c, s);
    torsion.closed_at = torsion.impulse;
    turn_answer(c, s);
  }
}

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
  const ContactStiffness<T>& k = point.stiffness;
  return max(k.normal * abs(change.x), max(k.sigma_1 * abs(change.y), k.sigma_2 * abs(change.z)));
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

/// Up to `most` sweeps over all contacts, always in the same order, in worlds that are not yet `settled`. Orders that
/// go back and forth converge more slowly (docs/contact_solver.md).
template <Number T>
MANYHANDS_INLINE int sweep(const Tree<real_t<T>>& tree, T tolerance, int most, mask_t<T> active, ContactSet<T>& set,
                           T* dv, mask_t<T>& settled) {
  int sweeps = 0;
  const std::size_t n = set.points.size();
  settled = !active;
  while (sweeps < most && !all(settled)) {
    T largest(real_t<T>(0));
    const auto moving = !settled;
    for (std::size_t k = 0; k < n; ++k) {
      ContactPoint<T>& point = set.points[k];
      largest = max(largest, relax(tree, moving, point, set.store, dv));
      if (point.torsion < 0) continue;
      relax(tree, moving, point.impulse.x, set.torsions[static_cast<std::size_t>(point.torsion)], set.store, dv);
    }
    settled = settled | (largest <= tolerance);
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
  const T tolerance(static_cast<R>(settings.tolerance));
  T* stances = state.stance();
  mask_t<T> active(true);
  int sweeps = 0, left = settings.max_sweeps;
  bool moved = true;
  for (int pivots = 0;;) {
    if (moved) {
      internal::find_loop_responses(tree, ws, loops);
      internal::find_responses(tree, ws, active, loops, set);
      internal::close_loops(tree, active, loops, jc.dv.data());
    }
    mask_t<T> settled;
    const int done =
        internal::sweep(tree, tolerance, std::min(internal::kSweepsPerPivot, left), active, set, jc.dv.data(), settled);
    sweeps += done;
    left -= done;
    internal::follow_contacts(set, loops);
    internal::find_joint_impulses(stances, jc);
    const auto wrong = internal::find_better_stances(tree, stances, jc) > T(R(0));
    active = active & (wrong | !settled);
    moved = any(active & wrong) && pivots < internal::kMostContactPivots;
    if (none(active) || (!moved && left <= 0)) break;
    if (!moved) continue;
    ++pivots;
    left = std::max(left, internal::kSweepsPerPivot);
    for (std::size_t i = 0; i < jc.dv.size(); ++i) stances[i] = select(active, jc.better[i], stances[i]);
    set.kept_dv = jc.dv;
    internal::gather_impulses(tree, set, loops, jc);
    internal::solve_stances(tree, stances, ws, jc);
    for (std::size_t i = 0; i < jc.dv.size(); ++i) jc.dv[i] = select(active, jc.dv[i], set.kept_dv[i]);
  }
  internal::remember_loops(loops, state.loops());
  return sweeps;
}

}  // namespace manyhands
