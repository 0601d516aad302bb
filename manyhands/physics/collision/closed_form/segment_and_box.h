// A segment beside a box: where it is nearest, and how it gets out.
#pragma once

#include <array>
#include <limits>

#include "manyhands/math/vec3.h"

namespace manyhands::internal {

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
    std::array<T, 8> bends{-half, half};
    for (std::size_t i = 0; i < 3; ++i) {
      const T inverse_d = inverse_slope(i);
      const T middle = -p[i] * inverse_d, reach = half_extent[i] * inverse_d;
      bends[2 * i + 2] = clamp(middle - reach, -half, half);
      bends[2 * i + 3] = clamp(middle + reach, -half, half);
    }
    T low = -half, high = half;
    T slope_low(-std::numeric_limits<R>::max() / 4), slope_high(std::numeric_limits<R>::max() / 4);
    for (const T& t : bends) {
      const Vec3<T> w = way(t);
      const T slope = -fma(d[0], w.x, fma(d[1], w.y, d[2] * w.z));
      const mask_t<T> before = slope <= zero;
      const mask_t<T> after = slope >= zero;
      low = select(before, max(t, low), low);
      slope_low = select(before, max(slope, slope_low), slope_low);
      high = select(after, min(t, high), high);
      slope_high = select(after, min(slope, slope_high), slope_high);
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
      const mask_t<T> better = slanted & (depth < least);
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
  /// The part of the segment that lies over the box seen along the normal; over its edge or corner, if t does.
  MANYHANDS_INLINE Stretch facing(const Vec3<T>& normal, T t, T slack) const {
    const std::array<T, 3> n{abs(normal.x), abs(normal.y), abs(normal.z)};
    const T largest = max(n[0], max(n[1], n[2]));
    Stretch s{-half, half};
    for (std::size_t i = 0; i < 3; ++i) {
      const T inverse_d = inverse_slope(i);
      const T at_t = abs(fma(t, d[i], p[i]));
      const T bound = select(at_t > half_extent[i], at_t + slack, half_extent[i]);
      const T middle = -p[i] * inverse_d, reach = bound * abs(inverse_d);
      const mask_t<T> across = n[i] < largest;
      s.low = select(across, max(middle - reach, s.low), s.low);
      s.high = select(across, min(middle + reach, s.high), s.high);
    }
    return {min(s.low, t), max(s.high, t)};
  }
};

}  // namespace manyhands::internal
