// Contact of a capsule with capsules, boxes and planes.
//
// A capsule is a segment with a radius, and the distance of a convex shape from the points of a segment is a convex
// function along it. Two contact points are the ends of the stretch that faces the other shape, each with its own
// distance, so that nothing jumps as a lying capsule tilts; a third is the nearest point where that is neither end
// (crossed capsules). The normal is the nearest point's.
#pragma once

#include "manyhands/math/control_flow.h"
#include "manyhands/physics/collision/collide_sphere.h"

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
    const auto way = internal::direction_or(fma(along_B, b, d) - p, apart);
    points[k] = {X_WA.p + p, select(way.length > rounding, way.unit, apart), way.length};
  }
  return internal::contact_along_segment(points, size_A.x, size_B.x, along_A[1] - along_A[0], rounding);
}

namespace internal {

/// A segment p + t d, |t| <= half, in the frame of a box; p, d and the half extents by axis.
template <Number T>
struct SegmentAndBox {
  using R = real_t<T>;
  std::array<T, 3> p, d, half_extent;
  T half;

  MANYHANDS_INLINE Vec3<T> at(T t) const { return {fma(t, d[0], p[0]), fma(t, d[1], p[1]), fma(t, d[2], p[2])}; }

  /// From the segment's point at t to the nearest one of the solid box.
  MANYHANDS_INLINE Vec3<T> way(T t) const {
    const auto part = [&](std::size_t i) {
      const T x = fma(t, d[i], p[i]);
      return clamp(x, -half_extent[i], half_extent[i]) - x;
    };
    return {part(0), part(1), part(2)};
  }

  /// 1 / d_i, finite.
  MANYHANDS_INLINE T inverse_slope(std::size_t i) const {
    return T(R(1)) / copysign(max(abs(d[i]), T(R(1e-12))), d[i]);
  }

  /// The t nearest to the box: the root of the distance's slope, which rises in straight pieces between the faces.
  MANYHANDS_INLINE T nearest() const {
    const T zero(R(0));
    T low = -half, high = half;
    T slope_low(R(-1)), slope_high(R(1));
    const auto narrow = [&](T t) {
      const Vec3<T> w = way(t);
      const T slope = -fma(d[0], w.x, fma(d[1], w.y, d[2] * w.z));
      const mask_t<T> before = (slope <= zero) & (t >= low);
      const mask_t<T> after = (slope >= zero) & (t <= high);
      low = select(before, t, low);
      slope_low = select(before, slope, slope_low);
      high = select(after, t, high);
      slope_high = select(after, slope, slope_high);
    };
    narrow(-half);
    narrow(half);
    for (std::size_t i = 0; i < 3; ++i) {
      const T inverse_d = inverse_slope(i);
      const T middle = -p[i] * inverse_d, reach = half_extent[i] * inverse_d;
      narrow(clamp(middle - reach, -half, half));
      narrow(clamp(middle + reach, -half, half));
    }
    const T rise = slope_high - slope_low;
    const mask_t<T> flat = rise <= zero;
    const T part = select(flat, T(R(0.5)), -slope_low / select(flat, T(R(1)), rise));
    return clamp(fma(part, high - low, low), -half, half);
  }

  /// The shortest way out for a segment that meets the box. The faces of the swept box are the box's own and those
  /// between one of its edges and the segment, so six directions are all. `at_edge` is the meeting point's t for the
  /// latter.
  struct WayOut {
    Vec3<T> normal;
    T at_edge;
    mask_t<T> by_edge;
  };
  MANYHANDS_INLINE WayOut way_out() const {
    const T zero(R(0)), one(R(1));
    WayOut out{Vec3<T>::zero(), zero, mask_t<T>(false)};
    T least(std::numeric_limits<R>::infinity());
    for (std::size_t i = 0; i < 3; ++i) {
      const T depth = half_extent[i] + half * abs(d[i]) - abs(p[i]);
      Vec3<T> n = Vec3<T>::zero();
      (i == 0 ? n.x : i == 1 ? n.y : n.z) = -copysign(one, p[i]);
      out.normal = select(depth < least, n, out.normal);
      least = min(depth, least);
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
      const T squared = fma(d[j], d[j], d[k] * d[k]);
      const mask_t<T> slanted = squared > T(R(1e-6));
      const T inverse_length = one / sqrt(select(slanted, squared, one));
      const T along = fma(d[j], p[k], -(d[k] * p[j])) * inverse_length;
      const T sign = -copysign(inverse_length, along);
      const T n_j = -sign * d[k], n_k = sign * d[j];
      const T depth = fma(half_extent[j], abs(n_j), half_extent[k] * abs(n_k)) - abs(along);
      const mask_t<T> better = slanted & (depth < T(R(0.98)) * least);
      Vec3<T> n = Vec3<T>::zero();
      (j == 0 ? n.x : j == 1 ? n.y : n.z) = n_j;
      (k == 0 ? n.x : k == 1 ? n.y : n.z) = n_k;
      const T edge_j = -copysign(half_extent[j], n_j) - p[j], edge_k = -copysign(half_extent[k], n_k) - p[k];
      const T t = fma(d[j], edge_j, d[k] * edge_k) * (inverse_length * inverse_length);
      out.normal = select(better, n, out.normal);
      out.at_edge = select(better, clamp(t, -half, half), out.at_edge);
      out.by_edge = out.by_edge | better;
      least = select(better, depth, least);
    }
    return out;
  }

  struct Stretch {
    T low, high;
  };
  /// The part of the segment, t included, that lies beside the box seen along the normal.
  MANYHANDS_INLINE Stretch facing(const Vec3<T>& normal, T t, T slack) const {
    const std::array<T, 3> n{abs(normal.x), abs(normal.y), abs(normal.z)};
    const T largest = max(n[0], max(n[1], n[2]));
    Stretch s{-half, half};
    for (std::size_t i = 0; i < 3; ++i) {
      const T inverse_d = inverse_slope(i);
      const T bound = max(half_extent[i], abs(fma(t, d[i], p[i]))) + slack;
      const T middle = -p[i] * inverse_d, reach = bound * abs(inverse_d);
      const mask_t<T> across = n[i] < largest;
      s.low = select(across, max(middle - reach, s.low), s.low);
      s.high = select(across, min(middle + reach, s.high), s.high);
    }
    return {min(s.low, t), max(s.high, t)};
  }
};

}  // namespace internal

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

  auto facing = s.facing(normal, t, select(inside, T(R(0)), T(R(0.01)) * size_A.x));
  facing = {select(by_edge, t, facing.low), select(by_edge, t, facing.high)};
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
