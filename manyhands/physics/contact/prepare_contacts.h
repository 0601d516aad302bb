// The rows of every contact point: what it couples, what it asks for, and where it starts from.
#pragma once

#include "manyhands/physics/contact/contact_memory.h"
#include "manyhands/physics/contact/contact_surface.h"
#include "manyhands/physics/contact/joint_constraints.h"

namespace manyhands {

namespace internal {

/// How much of a penetration a step removes, and the fastest that it pushes surfaces apart [m/s].
inline constexpr double kContactRecovery = 0.2;
inline constexpr double kFastestRecovery = 0.5;

/// Surfaces this near count as touching [m], all alike. Without it the corners of a resting or gripped box, whose
/// distances differ by microns, would take turns in carrying it: on one corner a thing turns.
inline constexpr double kTouching = 3e-5;

/// The most that the curvature of a path counts for in a step [m/s]: where it were more, the step is too long to
/// follow.
inline constexpr double kMostArc = 0.1;

template <Number T>
MANYHANDS_INLINE T bounded_arc(T velocity) {
  const T most(static_cast<real_t<T>>(kMostArc));
  return clamp(velocity, -most, most);
}

/// The velocity of B's point at p (world) against A's.
template <Number T>
MANYHANDS_INLINE Vec3<T> relative_velocity(const Workspace<T>& ws, std::size_t a, std::size_t b, const Vec3<T>& p) {
  const auto at = [&](std::size_t body) { return ws.V[body].v + cross(ws.V[body].w, p - ws.p_WO[body]); };
  if (a == 0) return at(b);
  if (b == 0) return -at(a);
  return at(b) - at(a);
}

/// The acceleration that the point p of a body has by its present velocity alone, gravity taken off everywhere alike.
template <Number T>
MANYHANDS_INLINE Vec3<T> point_acceleration(const Workspace<T>& ws, std::size_t b, const Vec3<T>& p) {
  const Motion<T>&A = ws.A[b], &V = ws.V[b];
  const Vec3<T> r = p - ws.p_WO[b];
  return A.v + cross(A.w, r) + cross(V.w, V.v + cross(V.w, r));
}

/// J of the point p along the three directions d: what each dof adds to the velocity of B's point against A's.
template <Number T>
MANYHANDS_INLINE void fill_point_rows(const Tree<real_t<T>>& tree, const Workspace<T>& ws, const RowBlock& rows,
                                      const Vec3<T>& p, const std::array<Vec3<T>, 3>& d, RowStore<T>& store) {
  // d . (v + w x r) = d . v + (r x d) . w, the r being that of the tree the dof is in.
  std::array<Vec3<T>, 3> moment_a, moment_b;
  for (std::size_t k = 0; k < 3; ++k) {
    moment_a[k] = cross(p - ws.p_WO[rows.body_a], d[k]);
    moment_b[k] = cross(p - ws.p_WO[rows.body_b], d[k]);
  }
  visit_rows<T>(tree, rows, [&](std::size_t entry, std::size_t i, real_t<T> sign) {
    const std::array<Vec3<T>, 3>& moment = sign < 0 ? moment_a : moment_b;
    const Motion<T>& S = ws.S[i];
    const auto along = [&](std::size_t k) { return dot(Motion<T>{S.w, S.v}, Force<T>{moment[k], d[k]}); };
    const Vec3<T> column{along(0), along(1), along(2)};
    store.J[entry] = sign < 0 ? -column : column;
  });
}

/// J of the relative rotation about the three directions.
template <Number T>
MANYHANDS_INLINE void fill_rotation_rows(const Tree<real_t<T>>& tree, const Workspace<T>& ws, const RowBlock& rows,
                                         const std::array<Vec3<T>, 3>& d, RowStore<T>& store) {
  visit_rows<T>(tree, rows, [&](std::size_t entry, std::size_t i, real_t<T> sign) {
    const Vec3<T>& w = ws.S[i].w;
    const Vec3<T> column{dot(d[0], w), dot(d[1], w), dot(d[2], w)};
    store.J[entry] = sign < 0 ? -column : column;
  });
}

/// The normal velocity that the point asks for at the step's end: not to go through a surface ahead, to leave one that
/// it has entered, slowly, or what restitution gives back (Moreau's law, gravity acting on during the step). `arc` is
/// what the gap's own curvature in time adds to its mean velocity.
template <Number T>
MANYHANDS_INLINE void set_target(const CombinedSurface<T>& surface, T inverse_h, T u_n, T free_change, T arc,
                                 ContactPoint<T>& point) {
  using R = real_t<T>;
  const T zero(R(0)), one(R(1)), phi = point.phi;
  const T slack(static_cast<R>(kTouching));
  const T depth = max(-phi - slack, zero), gap = select(phi > slack, phi, zero);
  const T out = min(T(static_cast<R>(kContactRecovery)) * (depth * inverse_h), T(static_cast<R>(kFastestRecovery)));
  const T hard = fma(-gap, inverse_h, out) - arc;
  const T back = fma(-surface.restitution, u_n, free_change);
  const auto lossless = surface.restitution >= one;
  const auto bounces = (surface.restitution > zero) & (lossless | ((u_n < zero) & (back > zero)));
  // A surface ahead does not stop what will bounce off it: the bounce comes once they touch.
  const T bounce = select(phi > zero, T(-std::numeric_limits<R>::max()), back);
  const auto soft = surface.softness > zero;
  point.softness = surface.softness;
  point.bounces = select(bounces & !soft, one, zero);
  point.target = select(soft, -(surface.push * phi), select(bounces, bounce, hard));
}

template <Number T>
MANYHANDS_INLINE void add_torsion(const Tree<real_t<T>>& tree, const Workspace<T>& ws, std::size_t index,
                                  const CombinedSurface<T>& surface, const Vec3<T>& moment, ContactSet<T>& set) {
  ContactPoint<T>& point = set.points[index];
  point.torsion = static_cast<int>(set.torsions.size());
  ContactTorsion<T> torsion{.point = index,
                            .rows = add_row_block(tree, point.rows.body_a, point.rows.body_b, set.store)};
  torsion.spinning = surface.spinning;
  torsion.rolling = surface.rolling;
  torsion.t_1 = surface.t_1;
  torsion.t_2 = surface.t_2;
  torsion.impulse = {dot(moment, point.normal), dot(moment, torsion.t_1), dot(moment, torsion.t_2)};
  const Vec3<T> w = ws.V[point.rows.body_b].w - ws.V[point.rows.body_a].w;
  torsion.offset = {dot(w, point.normal), dot(w, torsion.t_1), dot(w, torsion.t_2)};
  fill_rotation_rows(tree, ws, torsion.rows, {point.normal, torsion.t_1, torsion.t_2}, set.store);
  set.torsions.push_back(torsion);
}

/// The friction impulse of the last step within the cone of this one.
template <Number T>
MANYHANDS_INLINE Vec3<T> within_cone(const Vec3<T>& impulse) {
  const T zero(real_t<T>(0)), n = max(impulse.x, zero);
  const T length = sqrt(fma(impulse.y, impulse.y, impulse.z * impulse.z));
  const T scale = select(length > n, n / select(length > n, length, T(real_t<T>(1))), T(real_t<T>(1)));
  return {n, scale * impulse.y, scale * impulse.z};
}

/// M^-1 smooth: what the velocities gain without contacts, motors and limits. Uses ws.L.
template <Number T>
MANYHANDS_INLINE void find_free_dv(const Tree<real_t<T>>& tree, const JointConstraints<T>& jc, Workspace<T>& ws,
                                   std::vector<T>& free_dv) {
  ws.L = ws.M;
  free_dv = jc.smooth;
  factor_ltdl(tree.dofs_from_leaves, tree.dof_parent.data(), tree.M_row.data(), ws.L.data());
  solve_ltdl(tree.dofs_from_leaves, tree.dof_parent.data(), tree.M_row.data(), ws.L.data(), free_dv.data());
}

/// The second derivative of the gap by the present velocities alone. A round side keeps its distance to its axis or
/// centre as it turns, so that it is this that counts; a flat side moves with the body.
template <Number T>
MANYHANDS_INLINE T gap_acceleration(const Workspace<T>& ws, const RowBlock& bodies, const CombinedSurface<T>& surface,
                                    const ContactPoint<T>& point) {
  const T zero(real_t<T>(0));
  const Vec3<T> centre_A = fma(-surface.radius_A, point.normal, point.p);
  const Vec3<T> centre_B = fma(surface.radius_B, point.normal, point.p);
  const Vec3<T> at_A = select(surface.radius_A > zero, centre_A, centre_B);
  const Vec3<T> at_B = select(surface.radius_B > zero, centre_B, centre_A);
  return dot(point.normal, point_acceleration(ws, bodies.body_b, at_B) - point_acceleration(ws, bodies.body_a, at_A));
}

/// One point of a touch, and the impulse it begins with.
template <Number T>
MANYHANDS_INLINE void add_point(const Tree<real_t<T>>& tree, const Workspace<T>& ws, T inverse_h,
                                const CombinedSurface<T>& surface, const Touch<T>& touch, std::size_t k,
                                const RowBlock& bodies, const Vec3<T>& impulse, ContactSet<T>& set) {
  using R = real_t<T>;
  const T zero(R(0));
  const Manifold<T>& found = touch.contact;
  const auto exists = is_finite(found.phi[k]);
  ContactPoint<T>& point = set.points.emplace_back();
  point.pair = touch.pair;
  point.manifold = touch.manifold;
  point.index = k;
  point.rows = add_row_block(tree, bodies.body_a, bodies.body_b, set.store);
  point.p = select(exists, found.p[k], Vec3<T>::zero());
  point.normal = found.normal;
  point.phi = found.phi[k];
  point.e_1 = surface.friction_1 * surface.t_1;
  point.e_2 = surface.friction_2 * surface.t_2;
  fill_point_rows(tree, ws, point.rows, point.p, {point.normal, point.e_1, point.e_2}, set.store);
  const Vec3<T> u = relative_velocity(ws, bodies.body_a, bodies.body_b, point.p);
  const T u_n = dot(u, point.normal);
  T free_change = zero;
  when(surface.restitution > zero,
       [&] { free_change = multiply_rows(tree, point.rows, set.store, set.free_dv.data()).x; });
  const T half_h = T(R(0.5)) / inverse_h;
  set_target(surface, inverse_h, u_n, free_change, bounded_arc(half_h * gap_acceleration(ws, bodies, surface, point)),
             point);
  // Points that stick shall stay together along the arcs on which the step carries them: u + h / 2 gamma = 0.
  const Vec3<T> gamma = point_acceleration(ws, bodies.body_b, point.p) - point_acceleration(ws, bodies.body_a, point.p);
  const Vec3<T> slip =
      u + Vec3<T>{bounded_arc(half_h * gamma.x), bounded_arc(half_h * gamma.y), bounded_arc(half_h * gamma.z)};
  point.offset = {u_n - point.target, dot(slip, point.e_1), dot(slip, point.e_2)};
  const auto along = [&](const Vec3<T>& t, T friction) {
    return select(friction > zero, dot(impulse, t) / max(friction, T(R(1e-12))), zero);
  };
  point.impulse = select(exists & (point.bounces == zero),
                         within_cone(Vec3<T>{dot(impulse, point.normal), along(surface.t_1, surface.friction_1),
                                             along(surface.t_2, surface.friction_2)}),
                         Vec3<T>::zero());
}

/// Marks the trees that a point of the block couples, in the worlds in which it exists, and adds its impulse to rhs.
template <Number T>
MANYHANDS_INLINE void couple(const Tree<real_t<T>>& tree, const RowBlock& rows, mask_t<T> exists,
                             const Vec3<T>& impulse, const RowStore<T>& store, JointConstraints<T>& jc) {
  const T one(real_t<T>(1));
  const auto mark = [&](int begin, int end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
      jc.touched[i] = select(exists, one, jc.touched[i]);
  };
  mark(rows.begin_a, rows.end_a);
  mark(rows.begin_b, rows.end_b);
  add_row_impulse(tree, rows, store, impulse, jc.rhs.data());
}

}  // namespace internal

/// Fills `set` from what touches, marks the trees that touch, and adds the impulses with which the contacts start to
/// `jc.rhs`. After `prepare_joint_constraints`.
template <Number T, Number P>
MANYHANDS_INLINE void prepare_contacts(const Tree<real_t<T>>& tree, const Colliders<real_t<T>>& colliders,
                                       std::span<const ColliderPair> pairs, const Params<P>& params, real_t<T> h,
                                       std::type_identity_t<std::span<const RememberedManifold<T>>> memory,
                                       const CollisionWorkspace<T>& cw, Workspace<T>& ws, JointConstraints<T>& jc,
                                       ContactSet<T>& set) {
  using R = real_t<T>;
  const T inverse_h(R(1) / h);
  set.points.clear();
  set.torsions.clear();
  set.store.J.clear();
  set.store.W.clear();
  bool has_free_dv = false;
  for (const Touch<T>& touch : cw.touches) {
    const ColliderPair& pair = pairs[touch.pair];
    const RowBlock bodies{.body_a = colliders.geoms[pair.a].body, .body_b = colliders.geoms[pair.b].body};
    const CombinedSurface<T> surface = combine_surfaces(colliders, pair, params, h, touch.contact.normal, cw.X_WG);
    if (!has_free_dv && any(surface.restitution > T(R(0)))) {
      internal::find_free_dv(tree, jc, ws, set.free_dv);
      has_free_dv = true;
    }
    std::array<Vec3<T>, kManifoldPoints> impulse, moment;
    match_points(memory[touch.manifold], touch.contact, impulse, moment);
    for (std::size_t k = 0; k < kManifoldPoints; ++k) {
      if (none(is_finite(touch.contact.phi[k]))) continue;
      internal::add_point(tree, ws, inverse_h, surface, touch, k, bodies, impulse[k], set);
      const ContactPoint<T>& point = set.points.back();
      internal::couple(tree, point.rows, is_finite(point.phi), point.impulse, set.store, jc);
      if (!pair.torsion) continue;
      internal::add_torsion(tree, ws, set.points.size() - 1, surface, moment[k], set);
      const ContactTorsion<T>& torsion = set.torsions.back();
      internal::couple(tree, torsion.rows, is_finite(point.phi), torsion.impulse, set.store, jc);
    }
  }
}

}  // namespace manyhands
