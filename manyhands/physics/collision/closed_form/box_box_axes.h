// The separating axes of two boxes.
#pragma once

#include "manyhands/math/control_flow.h"
#include "manyhands/physics/collision/manifold.h"

namespace manyhands::internal {

/// One of three axes in each lane.
template <Number T>
struct AxisChoice {
  mask_t<T> is_x, is_y;
  MANYHANDS_INLINE mask_t<T> is_z() const { return !(is_x | is_y); }
};

template <Number T>
MANYHANDS_INLINE T pick(const AxisChoice<T>& axis, const Vec3<T>& of) {
  return select(axis.is_x, of.x, select(axis.is_y, of.y, of.z));
}
template <Number T>
MANYHANDS_INLINE Vec3<T> pick(const AxisChoice<T>& axis, const Mat3<T>& of) {
  return select(axis.is_x, of.x, select(axis.is_y, of.y, of.z));
}

template <Number T>
MANYHANDS_INLINE AxisChoice<T> choose(mask_t<T> m, const AxisChoice<T>& a, const AxisChoice<T>& b) {
  return {mask_t<T>((m & a.is_x) | ((!m) & b.is_x)), mask_t<T>((m & a.is_y) | ((!m) & b.is_y))};
}

/// The axis of the largest of three.
template <Number T>
MANYHANDS_INLINE AxisChoice<T> largest(const Vec3<T>& of) {
  const mask_t<T> is_x = (of.x >= of.y) & (of.x >= of.z);
  return {is_x, mask_t<T>((!is_x) & (of.y >= of.z))};
}

template <Number T>
MANYHANDS_INLINE Vec3<T> magnitudes(const Vec3<T>& a) {
  return {abs(a.x), abs(a.y), abs(a.z)};
}

/// Two boxes, B seen from A.
template <Number T>
struct BoxPair {
  Vec3<T> half_A, half_B;
  Mat3<T> R_AB;
  Vec3<T> p_AB;
  T rounding;  ///< how large rounding errors of a separation may be [m]
  T bias;      ///< by how much one axis must beat a preferred one [m]

  MANYHANDS_INLINE BoxPair(const Vec3<T>& size_A, const Transform<T>& X_WA, const Vec3<T>& size_B,
                           const Transform<T>& X_WB)
      : half_A(size_A), half_B(size_B) {
    using R = real_t<T>;
    R_AB = {transpose_times(X_WA.R, X_WB.R.x), transpose_times(X_WA.R, X_WB.R.y), transpose_times(X_WA.R, X_WB.R.z)};
    p_AB = transpose_times(X_WA.R, X_WB.p - X_WA.p);
    const T thin = min(min(min(size_A.x, size_A.y), size_A.z), min(min(size_B.x, size_B.y), size_B.z));
    const T all = (size_A.x + size_A.y + size_A.z) + (size_B.x + size_B.y + size_B.z);
    rounding = T(R(4) * std::numeric_limits<R>::epsilon()) * all;
    bias = fma(T(R(2e-4)), thin, rounding);
  }
};

/// The face whose plane keeps the boxes apart best.
template <Number T>
struct FaceAxis {
  T separation;  ///< across the chosen face: less than the best by a little where A's face is preferred to B's
  T best;
  mask_t<T> of_B;
  AxisChoice<T> axis;
};

template <Number T>
MANYHANDS_INLINE FaceAxis<T> best_face(const BoxPair<T>& boxes) {
  const auto& M = boxes.R_AB;
  const Vec3<T> x = magnitudes(M.x), y = magnitudes(M.y), z = magnitudes(M.z);
  const Vec3<T>& h_A = boxes.half_A;
  const Vec3<T>& h_B = boxes.half_B;
  const Vec3<T> of_A = magnitudes(boxes.p_AB) - h_A - fma(h_B.x, x, fma(h_B.y, y, h_B.z * z));
  const Vec3<T> of_B =
      magnitudes(transpose_times(M, boxes.p_AB)) - h_B - Vec3<T>{dot(h_A, x), dot(h_A, y), dot(h_A, z)};
  const auto axis_A = largest(of_A), axis_B = largest(of_B);
  const T best_A = pick(axis_A, of_A), best_B = pick(axis_B, of_B);
  const mask_t<T> by_B = best_B > best_A + boxes.bias;
  return {select(by_B, best_B, best_A), max(best_A, best_B), by_B, choose(by_B, axis_B, axis_A)};
}

/// The pair of edges, one of each box, across which the boxes are kept apart best.
template <Number T>
struct EdgeAxis {
  T separation;    ///< -infinity where all edges are parallel
  Vec3<T> normal;  ///< unit, from A to B, in A
  AxisChoice<T> of_A, of_B;
};

template <Number T>
MANYHANDS_INLINE EdgeAxis<T> best_edge(const BoxPair<T>& boxes) {
  using R = real_t<T>;
  const T zero(R(0)), one(R(1));
  const auto& M = boxes.R_AB;
  const std::array<std::array<T, 3>, 3> b{{{M.x.x, M.x.y, M.x.z}, {M.y.x, M.y.y, M.y.z}, {M.z.x, M.z.y, M.z.z}}};
  const std::array<T, 3> h_A{boxes.half_A.x, boxes.half_A.y, boxes.half_A.z};
  const std::array<T, 3> h_B{boxes.half_B.x, boxes.half_B.y, boxes.half_B.z};
  const std::array<T, 3> p{boxes.p_AB.x, boxes.p_AB.y, boxes.p_AB.z};

  // Along the cross product c of two edges: separation times |c|. Kept squared with its sign, to compare without roots.
  T best_square(-std::numeric_limits<R>::infinity()), best_length(one);
  EdgeAxis<T> best{
      best_square, Vec3<T>::zero(), {mask_t<T>(true), mask_t<T>(false)}, {mask_t<T>(true), mask_t<T>(false)}};
#pragma GCC unroll 3
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = (i + 1) % 3, l = (i + 2) % 3;
#pragma GCC unroll 3
    for (std::size_t j = 0; j < 3; ++j) {
      const std::size_t m = (j + 1) % 3, n = (j + 2) % 3;
      const T c_k = -b[j][l], c_l = b[j][k];
      const T squared_length = fma(c_k, c_k, c_l * c_l);
      const T offset = fma(p[k], c_k, p[l] * c_l);
      const T extent_A = fma(h_A[k], abs(c_k), h_A[l] * abs(c_l));
      const T extent_B =
          fma(h_B[m], abs(fma(b[m][k], c_k, b[m][l] * c_l)), h_B[n] * abs(fma(b[n][k], c_k, b[n][l] * c_l)));
      const T gap = abs(offset) - (extent_A + extent_B);
      const T square = gap * abs(gap);
      const mask_t<T> better = (squared_length > T(R(1e-6))) & (square * best_length > best_square * squared_length);
      best_square = select(better, square, best_square);
      best_length = select(better, squared_length, best_length);
      std::array<T, 3> c{zero, zero, zero};
      c[k] = copysign(one, offset) * c_k;
      c[l] = copysign(one, offset) * c_l;
      best.normal = select(better, Vec3<T>{c[0], c[1], c[2]}, best.normal);
      best.of_A = choose(better, {mask_t<T>(i == 0), mask_t<T>(i == 1)}, best.of_A);
      best.of_B = choose(better, {mask_t<T>(j == 0), mask_t<T>(j == 1)}, best.of_B);
    }
  }
  const T inverse_length = one / sqrt(best_length);
  best.normal = inverse_length * best.normal;
  best.separation = copysign(sqrt(abs(best_square)), best_square) * inverse_length;
  return best;
}

}  // namespace manyhands::internal
