// Points that lie near enough to touch within the step, but that nothing seems to bring together. They are left out of
// the problem, and taken in again where its solution reaches them after all: so they cost a look, not a constraint, and
// what comes out is the solution with all points.
#pragma once

#include <span>
#include <vector>

#include "manyhands/physics/collision/collide.h"
#include "manyhands/physics/contact/settings.h"
#include "manyhands/physics/dynamics/lengths.h"

namespace manyhands {

/// Scratch of a step.
template <Real R>
struct FarPoints {
  std::vector<Touch<R>> all;      ///< what touches, or may within the step
  std::vector<std::uint8_t> far;  ///< (all) a bit for each point that is left out
  std::vector<Motion<R>> change;  ///< (nb) of the bodies' velocities
  bool any = false;               ///< whether a point is left out
};

namespace internal {

/// What dv (nv) adds to the bodies' velocities.
template <Real R>
void find_velocity_changes(const Tree<R>& tree, const Workspace<R>& ws, const R* dv, std::vector<Motion<R>>& change) {
  change.assign(tree.bodies.size(), Motion<R>::zero());
  for (std::size_t b = 1; b < tree.bodies.size(); ++b) {
    const TreeBody<R>& body = tree.bodies[b];
    if (body.parent != 0) change[b] = change[index(body.parent)];
    for (int i = body.iv; i < body.iv + body.nv; ++i) change[b] = fma(dv[i], ws.S[index(i)], change[b]);
  }
}

/// The velocity of a body's point p (world) if its own changes by `change`; by how much its path may bend, as a
/// velocity.
template <Real R>
struct PointPath {
  Vec3<R> before, after;
  R bend;
};

template <Real R>
PointPath<R> point_path(const Workspace<R>& ws, std::size_t body, const Vec3<R>& p, const Motion<R>& change, R half_h) {
  if (body == 0) return {Vec3<R>::zero(), Vec3<R>::zero(), 0};
  const Vec3<R> r = p - ws.p_WO[body];
  const auto [velocity, acceleration] = motion_at(ws, body, r);
  return {velocity, velocity + change.v + cross(change.w, r), half_h * norm(acceleration)};
}

/// Which points of a touch between two bodies the step does not reach, a bit for each.
template <Real R>
unsigned far_points(const Manifold<R>& found, const Workspace<R>& ws, std::size_t a, std::size_t b,
                    const std::vector<Motion<R>>& change, R h) {
  unsigned far = 0;
  for (std::size_t k = 0; k < kManifoldPoints; ++k) {
    const R room = found.phi[k] - R(contact_settings::kFar);
    if (!is_finite(room) || room <= 0) continue;
    const PointPath<R> of_A = point_path(ws, a, found.p[k], change[a], h / 2);
    const PointPath<R> of_B = point_path(ws, b, found.p[k], change[b], h / 2);
    const R closing =
        std::max(dot(found.normal, of_A.before - of_B.before), dot(found.normal, of_A.after - of_B.after));
    const R bend = std::min(of_A.bend + of_B.bend, R(contact_settings::kMaxArc));
    if (h * (closing + bend) < room) far |= 1u << k;
  }
  return far;
}

/// Keeps in `touches` all points that are not left out.
template <Real R>
void take_near(const FarPoints<R>& points, std::vector<Touch<R>>& touches) {
  touches.clear();
  for (std::size_t i = 0; i < points.all.size(); ++i) {
    const Touch<R>& touch = points.all[i];
    if (points.far[i] == 0) {
      touches.push_back(touch);
      continue;
    }
    Touch<R> near = touch;
    bool any = false;
    for (std::size_t k = 0; k < kManifoldPoints; ++k) {
      if (((points.far[i] >> k) & 1u) != 0) near.contact.phi[k] = std::numeric_limits<R>::infinity();
      any = any || is_finite(near.contact.phi[k]);
    }
    if (any) touches.push_back(near);
  }
}

/// Of the points that are left out, those that the step reaches if the bodies' velocities change by dv (nv) are so no
/// more; whether there were any.
template <Real R>
bool find_reached(const Tree<R>& tree, const Colliders<R>& colliders, std::span<const ColliderPair> pairs,
                  const Workspace<R>& ws, R h, const R* dv, FarPoints<R>& points) {
  find_velocity_changes(tree, ws, dv, points.change);
  points.any = false;
  bool any_reached = false;
  for (std::size_t i = 0; i < points.all.size(); ++i) {
    if (points.far[i] == 0) continue;
    const ColliderPair& pair = pairs[points.all[i].pair];
    const std::size_t a = colliders.geoms[pair.a].body, b = colliders.geoms[pair.b].body;
    const unsigned far = points.far[i] & far_points(points.all[i].contact, ws, a, b, points.change, h);
    any_reached = any_reached || far != points.far[i];
    points.far[i] = static_cast<std::uint8_t>(far);
    points.any = points.any || far != 0;
  }
  return any_reached;
}

}  // namespace internal

/// Leaves out of `touches` the points that are not reached at present velocities, nor if they change once more as in
/// the last step, by dv (nv). `pairs`: those to which the touches refer.
template <Real R>
void leave_out_far_points(const Tree<R>& tree, const Colliders<R>& colliders, std::span<const ColliderPair> pairs,
                          const Workspace<R>& ws, R h, const R* dv, std::vector<Touch<R>>& touches,
                          FarPoints<R>& points) {
  constexpr std::uint8_t kAll = (1u << kManifoldPoints) - 1;
  points.any = false;
  if (touches.empty()) return;
  points.all = touches;
  points.far.assign(touches.size(), kAll);
  internal::find_reached(tree, colliders, pairs, ws, h, dv, points);
  if (points.any) internal::take_near(points, touches);
}

/// Takes into `touches` what the step reaches with dv (nv); false if that is nothing.
template <Real R>
[[nodiscard]] bool take_in_reached_points(const Tree<R>& tree, const Colliders<R>& colliders,
                                          std::span<const ColliderPair> pairs, const Workspace<R>& ws, R h, const R* dv,
                                          std::vector<Touch<R>>& touches, FarPoints<R>& points) {
  const bool any = points.any && internal::find_reached(tree, colliders, pairs, ws, h, dv, points);
  if (any) internal::take_near(points, touches);
  return any;
}

}  // namespace manyhands
