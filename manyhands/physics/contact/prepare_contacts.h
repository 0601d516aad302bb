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

/// How a point of a body moves: its velocity, and the acceleration that it has by the present velocities alone, gravity
/// taken off everywhere alike.
template <Number T>
struct PointMotion {
  Vec3<T> velocity, acceleration;
};

template <Number T>
MANYHANDS_INLINE PointMotion<T> point_motion(const Workspace<T>& ws, std::size_t body, const Vec3<T>& p) {
  if (body == 0) return {Vec3<T>::zero(), ws.A[0].v};
  const Motion<T>&A = ws.A[body], &V = ws.V[body];
  const Vec3<T> r = p - ws.p_WO[body];
  const Vec3<T> velocity = V.v + cross(V.w, r);
  return {velocity, A.v + cross(A.w, r) + cross(V.w, velocity)};
}

/// Of B's point at p (world) against A's.
template <Number T>
MANYHANDS_INLINE PointMotion<T> relative_motion(const Workspace<T>& ws, std::size_t a, std::size_t b,
                                                const Vec3<T>& p) {
  const PointMotion<T> of_A = point_motion(ws, a, p), of_B = point_motion(ws, b, p);
  return {of_B.velocity - of_A.velocity, of_B.acceleration - of_A.acceleration};
}

/// J of the point p along the three directions d: what each dof adds to the velocity of B's point against A's.
template <Number T>
MANYHANDS_INLINE void fill_point_rows(const Tree<real_t<T>>& tree, const Workspace<T>& ws, const RowBlock& rows,
                                      const Vec3<T>& p, const std::array<Vec3<T>, 3>& d, RowStore<T>& store) {
  // d . (v + w x r) = d . v + (r x d) . w, the r being that of the tree the dof is in.
  std::array<Force<T>, 3> along_a, along_b;
  for (std::size_t k = 0; k < 3; ++k) {
    along_a[k] = {cross(d[k], p - ws.p_WO[rows.body_a]), -d[k]};
    along_b[k] = {cross(p - ws.p_WO[rows.body_b], d[k]), d[k]};
  }
  visit_rows<T>(tree, rows, [&](std::size_t entry, std::size_t i, real_t<T> sign) {
    const std::array<Force<T>, 3>& along = sign < 0 ? along_a : along_b;
    store.J[entry] = {dot(ws.S[i], along[0]), dot(ws.S[i], along[1]), dot(ws.S[i], along[2])};
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
/// what the gap's own curvature in time adds to its mean velocity. Tells the point whether it bounces.
template <Number T>
MANYHANDS_INLINE T target_velocity(const CombinedSurface<T>& surface, T inverse_h, T u_n, T free_change, T arc,
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
  return select(soft, -(surface.push * phi), select(bounces, bounce, hard));
}

/// The rows that a touch's points share; their origin is the first of them.
template <Number T>
MANYHANDS_INLINE ContactPatch<T>& add_patch(const Tree<real_t<T>>& tree, const Workspace<T>& ws,
                                            const CombinedSurface<T>& surface, const Manifold<T>& found, bool torsion,
                                            const RowBlock& bodies, ContactSet<T>& set) {
  ContactPatch<T>& patch = set.patches.emplace_back();
  patch.first = set.points.size();
  patch.friction_1 = surface.friction_1;
  patch.friction_2 = surface.friction_2;
  patch.origin = Vec3<T>::zero();
  for (std::size_t k = kManifoldPoints; k-- > 0;) {
    const auto exists = is_finite(found.phi[k]);
    patch.origin = select(exists, found.p[k], patch.origin);
    if (any(exists)) ++patch.count;
  }
  const Vec3<T>& n = found.normal;
  patch.linear = add_row_block(bodies, set.store);
  fill_point_rows(tree, ws, patch.linear, patch.origin,
                  {n, surface.friction_1 * surface.t_1, surface.friction_2 * surface.t_2}, set.store);
  patch.turns = torsion || patch.count > 1;
  if (!patch.turns) return patch;
  patch.angular = add_row_block(bodies, set.store);
  fill_rotation_rows(tree, ws, patch.angular, {n, surface.t_1, surface.t_2}, set.store);
  return patch;
}

template <Number T>
MANYHANDS_INLINE void add_torsion(const Workspace<T>& ws, const CombinedSurface<T>& surface, const Vec3<T>& moment,
                                  ContactSet<T>& set) {
  ContactPoint<T>& point = set.points.back();
  point.torsion = static_cast<int>(set.torsions.size());
  ContactTorsion<T> torsion{.point = set.points.size() - 1, .rows = set.patches.back().angular};
  torsion.spinning = surface.spinning;
  torsion.rolling = surface.rolling;
  torsion.t_1 = surface.t_1;
  torsion.t_2 = surface.t_2;
  torsion.impulse = {dot(moment, point.normal), dot(moment, torsion.t_1), dot(moment, torsion.t_2)};
  const Vec3<T> w = ws.V[point.rows.body_b].w - ws.V[point.rows.body_a].w;
  torsion.offset = {dot(w, point.normal), dot(w, torsion.t_1), dot(w, torsion.t_2)};
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

/// The second derivative of the gap by the present velocities alone, where that of the point itself is `flat`. A round
/// side keeps its distance to its axis or centre as it turns, so that it is this that counts; a flat side moves with
/// the body.
template <Number T>
MANYHANDS_INLINE T gap_acceleration(const Workspace<T>& ws, const RowBlock& bodies, const CombinedSurface<T>& surface,
                                    const ContactPoint<T>& point, T flat) {
  const T zero(real_t<T>(0));
  const auto round_A = surface.radius_A > zero, round_B = surface.radius_B > zero;
  T gap = flat;
  when(round_A | round_B, [&] {
    const Vec3<T> centre_A = fma(-surface.radius_A, point.normal, point.p);
    const Vec3<T> centre_B = fma(surface.radius_B, point.normal, point.p);
    const Vec3<T> at_A = select(round_A, centre_A, centre_B), at_B = select(round_B, centre_B, centre_A);
    const Vec3<T> gamma =
        point_motion(ws, bodies.body_b, at_B).acceleration - point_motion(ws, bodies.body_a, at_A).acceleration;
    gap = select(round_A | round_B, dot(point.normal, gamma), flat);
  });
  return gap;
}

/// One point of a touch, and the impulse it begins with.
template <Number T>
MANYHANDS_INLINE void add_point(const Tree<real_t<T>>& tree, const Workspace<T>& ws, T inverse_h,
                                const CombinedSurface<T>& surface, const Touch<T>& touch, std::size_t k,
                                const ContactPatch<T>& patch, const Vec3<T>& impulse, ContactSet<T>& set) {
  using R = real_t<T>;
  const T zero(R(0));
  const Manifold<T>& found = touch.contact;
  const auto exists = is_finite(found.phi[k]);
  ContactPoint<T>& point = set.points.emplace_back();
  point.pair = touch.pair;
  point.manifold = touch.manifold;
  point.index = k;
  point.patch = set.patches.size() - 1;
  point.rows = patch.linear;
  point.p = select(exists, found.p[k], Vec3<T>::zero());
  point.normal = found.normal;
  point.phi = found.phi[k];
  point.e_1 = surface.friction_1 * surface.t_1;
  point.e_2 = surface.friction_2 * surface.t_2;
  const Vec3<T> r = select(exists, point.p - patch.origin, Vec3<T>::zero());
  point.lever = {dot(r, point.normal), dot(r, surface.t_1), dot(r, surface.t_2)};
  const auto [u, gamma] = relative_motion(ws, point.rows.body_a, point.rows.body_b, point.p);
  const T u_n = dot(u, point.normal);
  T free_change = zero;
  when(surface.restitution > zero, [&] { free_change = point_velocity(tree, set, point, set.free_dv.data()).x; });
  const T half_h = T(R(0.5)) / inverse_h;
  const T arc = bounded_arc(half_h * gap_acceleration(ws, point.rows, surface, point, dot(point.normal, gamma)));
  const T target = target_velocity(surface, inverse_h, u_n, free_change, arc, point);
  // Points that stick shall stay together along the arcs on which the step carries them: u + h / 2 gamma = 0.
  const Vec3<T> slip =
      u + Vec3<T>{bounded_arc(half_h * gamma.x), bounded_arc(half_h * gamma.y), bounded_arc(half_h * gamma.z)};
  point.offset = {u_n - target, dot(slip, point.e_1), dot(slip, point.e_2)};
  const auto along = [&](const Vec3<T>& t, T friction) {
    return select(friction > zero, dot(impulse, t) / max(friction, T(R(1e-12))), zero);
  };
  point.slide_x = zero;
  point.impulse = select(exists & (point.bounces == zero),
                         within_cone(Vec3<T>{dot(impulse, point.normal), along(surface.t_1, surface.friction_1),
                                             along(surface.t_2, surface.friction_2)}),
                         Vec3<T>::zero());
}

/// Marks the trees that rows couple in the worlds of the mask.
template <Number T>
MANYHANDS_INLINE void touch_trees(const RowBlock& rows, mask_t<T> where, JointConstraints<T>& jc) {
  const T one(real_t<T>(1));
  const auto mark = [&](int begin, int end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
      jc.touched[i] = select(where, one, jc.touched[i]);
  };
  mark(rows.begin_a, rows.end_a);
  mark(rows.begin_b, rows.end_b);
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
  set.patches.clear();
  set.points.clear();
  set.torsions.clear();
  set.store.clear();
  bool has_free_dv = false;
  for (const Touch<T>& touch : cw.touches) {
    const ColliderPair& pair = pairs[touch.pair];
    const RowBlock bodies = rows_between<T>(tree, colliders.geoms[pair.a].body, colliders.geoms[pair.b].body);
    const CombinedSurface<T> surface = combine_surfaces(colliders, pair, params, h, touch.contact.normal, cw.X_WG);
    if (!has_free_dv && any(surface.restitution > T(R(0)))) {
      internal::find_free_dv(tree, jc, ws, set.free_dv);
      has_free_dv = true;
    }
    std::array<Vec3<T>, kManifoldPoints> impulse, moment;
    match_points(memory[touch.manifold], touch.contact, impulse, moment);
    const ContactPatch<T>& patch = internal::add_patch(tree, ws, surface, touch.contact, pair.torsion, bodies, set);
    mask_t<T> touches(false);
    for (std::size_t k = 0; k < kManifoldPoints; ++k) {
      const auto exists = is_finite(touch.contact.phi[k]);
      if (none(exists)) continue;
      touches = touches | exists;
      internal::add_point(tree, ws, inverse_h, surface, touch, k, patch, impulse[k], set);
      if (pair.torsion) internal::add_torsion(ws, surface, moment[k], set);
    }
    add_patch_force(tree, patch, set.store, patch_force(set, patch), jc.rhs.data());
    internal::touch_trees(bodies, touches, jc);
  }
}

}  // namespace manyhands
