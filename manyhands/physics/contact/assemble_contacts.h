// From manifolds to rows: what every contact point couples, and the velocity that it asks for.
#pragma once

#include "manyhands/physics/collision/collide.h"
#include "manyhands/physics/contact/contact_problem.h"
#include "manyhands/physics/contact/contact_surface.h"
#include "manyhands/physics/contact/motion_rows.h"

namespace manyhands {

namespace internal {

/// The second derivative of the gap by the present velocities alone, where that of the point itself is `flat`. A round
/// side keeps its distance to its axis or centre as it turns, so that it is this that counts; a flat side moves with
/// the body.
template <Number T>
MANYHANDS_INLINE T gap_acceleration(const Workspace<T>& ws, const ContactPatch<T>& patch,
                                    const CombinedSurface<T>& surface, const Vec3<T>& p, T flat) {
  const T zero = constant<T>(0);
  const auto round_A = surface.radius_A > zero, round_B = surface.radius_B > zero;
  T gap = flat;
  when(round_A | round_B, [&] {
    const Vec3<T> centre_A = fma(-surface.radius_A, patch.normal, p);
    const Vec3<T> centre_B = fma(surface.radius_B, patch.normal, p);
    const Vec3<T> at_A = select(round_A, centre_A, centre_B), at_B = select(round_B, centre_B, centre_A);
    const Vec3<T> gamma =
        point_motion(ws, patch.body_b(), at_B).acceleration - point_motion(ws, patch.body_a(), at_A).acceleration;
    gap = select(round_A | round_B, dot(patch.normal, gamma), flat);
  });
  return gap;
}

/// The law of a surface with a compliance, u_n + softness n = target, which acts once it is entered.
template <Number T>
[[gnu::noinline]] T yielding_target(const CombinedSurface<T>& surface, real_t<T> h, T u_n, ContactPoint<T>& point) {
  const T zero = constant<T>(0), phi = min(point.phi, zero);
  const T impedance = impedance_at(*surface.compliance, phi);
  const T least = constant<T>(SolverTraits<real_t<T>>::kSmallest);
  const YieldingRow<T> row = yielding_row(*surface.compliance, h, impedance, T(surface.mobility), least, phi, u_n);
  point.softness = constant<T>(1) / row.slope;
  point.bounces = zero;
  return select(point.phi < zero, fma(row.pull, point.softness, u_n),
                constant<T>(-std::numeric_limits<real_t<T>>::max()));
}

/// The normal velocity that the point asks for at the step's end: not to go through a surface ahead, to leave one that
/// it has entered, no faster than `fastest`, or what restitution gives back (Moreau's law, gravity acting on during the
/// step). `arc` is what the gap's own curvature in time adds to its mean velocity. Tells the point whether it bounces.
template <Number T>
MANYHANDS_INLINE T target_velocity(const CombinedSurface<T>& surface, T inverse_h, T u_n, T free_change, T arc,
                                   T fastest, ContactPoint<T>& point) {
  const T zero = constant<T>(0), one = constant<T>(1), phi = point.phi;
  const T slack = constant<T>(contact_settings::kTouching);
  const T depth = max(-phi - slack, zero), gap = select(phi > slack, phi, zero);
  const T out = min(constant<T>(contact_settings::kPenetrationRecovery) * (depth * inverse_h), fastest);
  const T hard = fma(-gap, inverse_h, out) - arc;
  const T back = fma(-surface.restitution, u_n, free_change);
  const auto lossless = surface.restitution >= one;
  const auto bounces = (surface.restitution > zero) & (lossless | ((u_n < zero) & (back > zero)));
  // A surface ahead does not stop what will bounce off it: the bounce comes once they touch.
  const T bounce = select(phi > zero, constant<T>(-std::numeric_limits<real_t<T>>::max()), back);
  const auto soft = surface.softness > zero;
  point.softness = surface.softness;
  point.bounces = select(bounces & !soft, one, zero);
  return select(soft, -(surface.push * phi), select(bounces, bounce, hard));
}

/// The rows that a touch's points share; their origin is the first of them.
template <Number T>
MANYHANDS_INLINE const ContactPatch<T>& add_patch(const Workspace<T>& ws, const CombinedSurface<T>& surface,
                                                  const Touch<T>& touch, bool torsion, const RowBlock& bodies,
                                                  ContactProblem<T>& problem) {
  const Manifold<T>& found = touch.contact;
  ContactPatch<T>& patch = problem.patches.emplace_back();
  patch.pair = touch.pair;
  patch.manifold = touch.manifold;
  patch.first = problem.points.size();
  patch.normal = found.normal;
  patch.t_1 = surface.t_1;
  patch.t_2 = surface.t_2;
  patch.friction_1 = surface.friction_1;
  patch.friction_2 = surface.friction_2;
  patch.e_1 = surface.friction_1 * surface.t_1;
  patch.e_2 = surface.friction_2 * surface.t_2;
  patch.spinning = surface.spinning;
  patch.rolling = surface.rolling;
  patch.origin = Vec3<T>::zero();
  for (std::size_t k = kManifoldPoints; k-- > 0;) {
    const auto exists = is_finite(found.phi[k]);
    patch.origin = select(exists, found.p[k], patch.origin);
    if (any(exists)) ++patch.count;
  }
  patch.linear = add_rows(bodies, problem.rows);
  fill_point_rows(*problem.tree, ws, patch.linear, patch.origin, {patch.normal, patch.e_1, patch.e_2}, problem.rows);
  patch.turns = torsion || patch.count > 1;
  if (!patch.turns) return patch;
  patch.angular = add_rows(bodies, problem.rows);
  fill_rotation_rows(*problem.tree, ws, patch.angular, {patch.normal, patch.t_1, patch.t_2}, problem.rows);
  return patch;
}

template <Number T>
MANYHANDS_INLINE void add_torsion(const Workspace<T>& ws, const ContactPatch<T>& patch, ContactProblem<T>& problem) {
  problem.points.back().torsion = static_cast<int>(problem.torsions.size());
  const Vec3<T> w = ws.V[patch.body_b()].w - ws.V[patch.body_a()].w;
  problem.torsions.push_back({.point = problem.points.size() - 1,
                              .patch = problem.patches.size() - 1,
                              .offset = {dot(w, patch.normal), dot(w, patch.t_1), dot(w, patch.t_2)}});
}

/// Point k of a touch.
template <Number T>
MANYHANDS_INLINE void add_point(const Workspace<T>& ws, real_t<T> h, const CombinedSurface<T>& surface,
                                const Manifold<T>& found, std::size_t k, const ContactPatch<T>& patch,
                                ContactProblem<T>& problem) {
  const auto exists = is_finite(found.phi[k]);
  ContactPoint<T>& point = problem.points.emplace_back();
  point.patch = problem.patches.size() - 1;
  point.index = k;
  point.p = select(exists, found.p[k], Vec3<T>::zero());
  point.phi = found.phi[k];
  const Vec3<T> r = select(exists, point.p - patch.origin, Vec3<T>::zero());
  point.lever = {dot(r, patch.normal), dot(r, patch.t_1), dot(r, patch.t_2)};
  const auto [u, gamma] = relative_motion(ws, patch.body_a(), patch.body_b(), point.p);
  const T u_n = dot(u, patch.normal);
  T free_change = constant<T>(0);
  when(surface.restitution > constant<T>(0),
       [&] { free_change = point_velocity(problem, point, problem.free_dv.data()).x; });
  const T inverse_h(real_t<T>(1) / h), half_h = constant<T>(0.5) / inverse_h;
  const T curvature = gap_acceleration(ws, patch, surface, point.p, dot(patch.normal, gamma));
  const T arc = bounded_arc(half_h * curvature),
          fastest = constant<T>(touches_mocap(*problem.tree, patch) ? contact_settings::kMaxMocapRecovery
                                                                    : contact_settings::kMaxPenetrationRecovery);
  point.target = surface.compliance ? yielding_target(surface, h, u_n, point)
                                    : target_velocity(surface, inverse_h, u_n, free_change, arc, fastest, point);
  // Points that stick shall stay together along the arcs on which the step carries them: u + h / 2 gamma = 0.
  const Vec3<T> slip =
      u + Vec3<T>{bounded_arc(half_h * gamma.x), bounded_arc(half_h * gamma.y), bounded_arc(half_h * gamma.z)};
  point.offset = {u_n, dot(slip, patch.e_1), dot(slip, patch.e_2)};
}

}  // namespace internal

/// Adds the rows of what touches, and marks the trees that touch. After `assemble_joint_laws`. `free_change(dv)` writes
/// M^-1 smooth (nv), and is called only where something bounces.
template <Number T, Number P, class FreeChange>
MANYHANDS_INLINE void assemble_contacts(const Colliders<real_t<T>>& colliders, std::span<const ColliderPair> pairs,
                                        const Params<P>& params, real_t<T> h, const CollisionWorkspace<T>& collision,
                                        const Workspace<T>& ws, FreeChange&& free_change, ContactProblem<T>& problem) {
  bool has_free_dv = false;
  for (const Touch<T>& touch : collision.touches) {
    const ColliderPair& pair = pairs[touch.pair];
    const RowBlock bodies = rows_between<T>(*problem.tree, colliders.geoms[pair.a].body, colliders.geoms[pair.b].body);
    const CombinedSurface<T> surface =
        combine_surfaces(colliders, pair, params, h, touch.contact.normal, collision.X_WG);
    if (!has_free_dv && any(surface.restitution > constant<T>(0))) {
      free_change(problem.free_dv);
      has_free_dv = true;
    }
    const ContactPatch<T>& patch = internal::add_patch(ws, surface, touch, pair.torsion, bodies, problem);
    mask_t<T> touches(false);
    for (std::size_t k = 0; k < kManifoldPoints; ++k) {
      const auto exists = is_finite(touch.contact.phi[k]);
      if (none(exists)) continue;
      touches = touches | exists;
      internal::add_point(ws, h, surface, touch.contact, k, patch, problem);
      if (pair.torsion) internal::add_torsion(ws, patch, problem);
    }
    internal::mark_constrained(bodies, touches, problem.joints.constrained);
  }
}

}  // namespace manyhands
