// Contact of a capsule with capsules, boxes and planes.
//
// A capsule is a segment with a radius, and the distance of a convex shape from the points of a segment is a convex
// function along it. Two contact points are the ends of the stretch that faces the other shape, each with its own
// distance, so that nothing jumps as a lying capsule tilts; a third is the nearest point where that is neither end
// (crossed capsules). The normal is the nearest point's.
#pragma once

#include "manyhands/math/control_flow.h"
#include "manyhands/physics/collision/closed_form/collide_sphere.h"
#include "manyhands/physics/collision/closed_form/segment_and_box.h"

namespace manyhands {

namespace internal {

/// A point of the capsule's segment, and the unit direction and distance from it to the other shape.
template <Number T>
struct SegmentPoint {
  Vec3<T> p, towards;
  T distance;
};

/// Contact of a segment's points, two ends and one between, each a sphere of radius r_A, with a shape that lies r_B
/// before the distances' far ends. Lengths below `rounding` are none; `stretch` is the length between the ends.
template <Number T>
MANYHANDS_INLINE Manifold<T> contact_along_segment(const std::array<SegmentPoint<T>, 3>& points, T r_A, T r_B,
                                                   T stretch, T rounding) {
  using R = real_t<T>;
  const T far(std::numeric_limits<R>::infinity());
  Manifold<T> m;
  m.normal = points[0].towards;
  T least = points[0].distance;
  for (std::size_t k = 1; k < points.size(); ++k) {
    m.normal = select(points[k].distance < least, points[k].towards, m.normal);
    least = min(points[k].distance, least);
  }
  for (std::size_t k = 0; k < points.size(); ++k) {
    const T phi = points[k].distance - (r_A + r_B);
    m.p[k] = fma(fma(T(R(0.5)), phi, r_A), points[k].towards, points[k].p);
    // One normal serves all points: where the way leads elsewhere is no contact of this kind.
    m.phi[k] = select(dot(points[k].towards, m.normal) >= T(R(0.7)), phi, far);
  }
  m.phi[1] = select(stretch > rounding, m.phi[1], far);
  m.phi[2] = select(min(m.phi[0], m.phi[1]) <= m.phi[2] + rounding, far, m.phi[2]);
  return m;
}

}  // namespace internal

/// sizes: (radius, half length, -). Axes that meet part across both, coinciding ones along A's x.
template <Number T>
Manifold<T> collide_capsule_capsule(const Vec3<T>& size_A, const Transform<T>& X_WA, const Vec3<T>& size_B,
                                    const Transform<T>& X_WB, T /*margin*/) {
  using R = real_t<T>;
  const T half_A = size_A.y, half_B = size_B.y;
  const Vec3<T>& a = X_WA.R.z;
  const Vec3<T>& b = X_WB.R.z;
  const Vec3<T> d = X_WB.p - X_WA.p;
  const Vec3<T> across = cross(a, b);
  const T ab = dot(a, b), ad = dot(a, d), bd = dot(b, d), sine_squared = squared_norm(across);
  const T rounding = T(R(8) * std::numeric_limits<R>::epsilon()) * (size_A.x + size_B.x + half_A + half_B);
  // Below this length the way between the axes says little about its direction.
  const T vague = T(R(0.1) * std::sqrt(std::numeric_limits<R>::epsilon())) * (half_A + half_B);
  const Vec3<T> apart =
      internal::direction_or(select(sine_squared > T(R(1e-12)), across, Vec3<T>::zero()), X_WA.R.x).unit;

  // The nearest points of two segments lie where an end of B projects to A, or where the lines are nearest.
  const T reach = half_B * abs(ab);
  const T crossing = dot(cross(b, across), d) / max(sine_squared, T(R(1e-20)));
  const std::array<T, 3> along_A{clamp(ad - reach, -half_A, half_A), clamp(ad + reach, -half_A, half_A),
                                 clamp(crossing, -half_A, half_A)};
  std::array<internal::SegmentPoint<T>, 3> points;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const T along_B = clamp(fma(ab, along_A[k], -bd), -half_B, half_B);
    const Vec3<T> p = along_A[k] * a;
    const Vec3<T> between = fma(along_B, b, d) - p;
    const auto way = internal::direction_or(between, apart);
    const Vec3<T> aside = copysign(T(R(1)), dot(between, apart)) * apart;
    points[k] = {X_WA.p + p, select(way.length > vague, way.unit, aside), way.length};
  }
  return internal::contact_along_segment(points, size_A.x, size_B.x, along_A[1] - along_A[0], rounding);
}

/// size_A: (radius, half length, -); size_B: half extents.
template <Number T>
Manifold<T> collide_capsule_box(const Vec3<T>& size_A, const Transform<T>& X_WA, const Vec3<T>& size_B,
                                const Transform<T>& X_WB, T /*margin*/) {
  using R = real_t<T>;
  const Vec3<T> centre = transpose_times(X_WB.R, X_WA.p - X_WB.p), axis = transpose_times(X_WB.R, X_WA.R.z);
  const internal::SegmentAndBox<T> s{
      {centre.x, centre.y, centre.z}, {axis.x, axis.y, axis.z}, {size_B.x, size_B.y, size_B.z}, size_A.y};
  const T rounding = T(R(8) * std::numeric_limits<R>::epsilon()) * (size_A.x + size_A.y + norm(size_B));

  T t = s.nearest();
  const auto nearest = internal::direction_or(s.way(t), Vec3<T>::zero());
  const mask_t<T> inside = nearest.length <= rounding;
  Vec3<T> normal = nearest.unit;
  mask_t<T> by_edge(false);
  when(inside, [&] {
    const auto out = s.way_out();
    normal = select(inside, out.normal, normal);
    by_edge = inside & out.by_edge;
    t = select(by_edge, out.at_edge, t);
  });

  const T slack = select(inside, T(R(0)), T(R(0.01)) * size_A.x);
  auto facing = s.facing(normal, t, slack);
  facing.low = select(by_edge | (facing.low >= t - T(R(2)) * slack), t, facing.low);
  facing.high = select(by_edge | (facing.high <= t + T(R(2)) * slack), t, facing.high);
  const T box_face = fma(size_B.x, abs(normal.x), fma(size_B.y, abs(normal.y), size_B.z * abs(normal.z)));
  std::array<internal::SegmentPoint<T>, 3> points;
  const std::array<T, 3> along{facing.low, facing.high, t};
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vec3<T> p = s.at(along[k]);
    const auto way = internal::direction_or(s.way(along[k]), normal);
    points[k] = {p, select(inside, normal, way.unit), select(inside, -box_face - dot(p, normal), way.length)};
  }
  auto m = internal::contact_along_segment(points, size_A.x, T(R(0)), facing.high - facing.low, rounding);
  m.normal = X_WB.R * m.normal;
  for (std::size_t k = 0; k < points.size(); ++k) m.p[k] = X_WB * m.p[k];
  return m;
}

/// size_A: (radius, half length, -); B is the half-space z <= 0 of its frame. Both ends.
template <Number T>
Manifold<T> collide_capsule_plane(const Vec3<T>& size_A, const Transform<T>& X_WA, const Vec3<T>& /*size_B*/,
                                  const Transform<T>& X_WB, T /*margin*/) {
  Manifold<T> m;
  m.normal = -X_WB.R.z;
  const Vec3<T> to_end = size_A.y * X_WA.R.z;
  const T height = dot(X_WB.R.z, X_WA.p - X_WB.p) - size_A.x, rise = dot(X_WB.R.z, to_end);
  const Vec3<T> lowest = fma(size_A.x, m.normal, X_WA.p);
  m.set(0, lowest - to_end, height - rise);
  m.set(1, lowest + to_end, height + rise);
  return m;
}

}  // namespace manyhands
