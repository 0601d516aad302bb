// Contact of two boxes: fifteen separating axes, then the overlap of two faces, or the crossing of two edges.
//
// The six face normals and the nine cross products of edges are all the normals that overlapping boxes may have, and
// all that separate ones may have except between corners, and between a corner and an edge (Gottschalk, Lin and
// Manocha, OBBTree, 1996). Those two are looked for by themselves where the found axis leads past the other box. Faces
// are preferred by a little, so that rounding does not turn resting boxes to their edges.
#pragma once

#include "manyhands/math/control_flow.h"
#include "manyhands/physics/collision/closed_form/box_box_axes.h"
#include "manyhands/physics/collision/closed_form/box_box_faces.h"
#include "manyhands/physics/collision/closed_form/collide_sphere.h"

namespace manyhands {

namespace internal {

/// One contact point in A's frame.
template <Number T>
struct BoxPoint {
  Vec3<T> normal, p;
  T phi;
};

template <Number T>
struct EdgeContact {
  BoxPoint<T> point;
  mask_t<T> past_end;  ///< whether the edges' lines are nearest beyond one of the edges
};

/// The crossing of the best pair of edges.
template <Number T>
MANYHANDS_INLINE EdgeContact<T> cross_edges(const BoxPair<T>& boxes, const EdgeAxis<T>& axis) {
  using R = real_t<T>;
  const T zero(R(0));
  const Vec3<T>& n = axis.normal;
  const auto& B = boxes.R_AB;
  const auto &h_A = boxes.half_A, &h_B = boxes.half_B;
  const Vec3<T> p_A{select(axis.of_A.is_x, zero, copysign(h_A.x, n.x)),
                    select(axis.of_A.is_y, zero, copysign(h_A.y, n.y)),
                    select(axis.of_A.is_z(), zero, copysign(h_A.z, n.z))};
  const T x = select(axis.of_B.is_x, zero, copysign(h_B.x, dot(B.x, n)));
  const T y = select(axis.of_B.is_y, zero, copysign(h_B.y, dot(B.y, n)));
  const T z = select(axis.of_B.is_z(), zero, copysign(h_B.z, dot(B.z, n)));
  const Vec3<T> p_B = boxes.p_AB - (B * Vec3<T>{x, y, z});
  const Vec3<T> a = pick(axis.of_A, Mat3<T>::identity()), b = pick(axis.of_B, B);
  const T half_a = pick(axis.of_A, h_A), half_b = pick(axis.of_B, h_B);

  const Vec3<T> d = p_B - p_A;
  const Vec3<T> across = cross(a, b);
  const T along_a = dot(cross(b, across), d) / squared_norm(across);
  const T on_a = clamp(along_a, -half_a, half_a);
  const T along_b = fma(dot(a, b), on_a, -dot(b, d));
  const T on_b = clamp(along_b, -half_b, half_b);
  const Vec3<T> x_A = fma(on_a, a, p_A), x_B = fma(on_b, b, p_B);
  const mask_t<T> past_end = (abs(along_a) > half_a + boxes.bias) | (abs(along_b) > half_b + boxes.bias);
  return {{n, T(R(0.5)) * (x_A + x_B), axis.separation}, past_end};
}

/// Of the corners of a box the one nearest to another box: the shortest way from there to the other box.
template <Number T>
struct CornerWay {
  Vec3<T> corner, way;
  T squared;
};

/// All in the frame of the box with the half extents `to`: the other one's centre and half edges.
template <Number T>
MANYHANDS_INLINE CornerWay<T> nearest_corner(const Vec3<T>& centre, const Mat3<T>& half_edges, const Vec3<T>& to) {
  using R = real_t<T>;
  CornerWay<T> best{Vec3<T>::zero(), Vec3<T>::zero(), T(std::numeric_limits<R>::infinity())};
  for (const R x : {R(-1), R(1)}) {
    const Vec3<T> middle = fma(T(x), half_edges.x, centre);
    for (const R y : {R(-1), R(1)}) {
      const Vec3<T> end = fma(T(y), half_edges.y, middle);
      for (const R z : {R(-1), R(1)}) {
        const Vec3<T> p = fma(T(z), half_edges.z, end);
        const Vec3<T> way = Vec3<T>{clamp(p.x, -to.x, to.x), clamp(p.y, -to.y, to.y), clamp(p.z, -to.z, to.z)} - p;
        const T squared = squared_norm(way);
        const mask_t<T> better = squared < best.squared;
        best = {select(better, p, best.corner), select(better, way, best.way), min(squared, best.squared)};
      }
    }
  }
  return best;
}

/// The nearest points of separate boxes where one of them is a corner.
template <Number T>
MANYHANDS_INLINE BoxPoint<T> nearest_corners(const BoxPair<T>& boxes, const Vec3<T>& otherwise) {
  using R = real_t<T>;
  const auto& M = boxes.R_AB;
  const Vec3<T>& h_A = boxes.half_A;
  const Vec3<T>& h_B = boxes.half_B;
  const auto of_B = nearest_corner(boxes.p_AB, Mat3<T>{h_B.x * M.x, h_B.y * M.y, h_B.z * M.z}, h_A);
  const Mat3<T> back = transpose(M);
  const Mat3<T> edges_A{h_A.x * back.x, h_A.y * back.y, h_A.z * back.z};
  const auto of_A = nearest_corner(-transpose_times(M, boxes.p_AB), edges_A, h_B);
  const mask_t<T> by_A = of_A.squared < of_B.squared;
  const Vec3<T> from = select(by_A, M * of_A.corner + boxes.p_AB, of_B.corner);
  const Vec3<T> way = select(by_A, M * of_A.way, of_B.way);
  const auto direction = direction_or(select(by_A, way, -way), otherwise);
  return {direction.unit, fma(T(R(0.5)), way, from), direction.length};
}

}  // namespace internal

/// sizes: half extents. Faces: up to four corners of their overlap, the deepest among them; edges: one point.
/// No points where the boxes are more than the margin apart.
template <Number T>
Manifold<T> collide_box_box(const Vec3<T>& size_A, const Transform<T>& X_WA, const Vec3<T>& size_B,
                            const Transform<T>& X_WB, T margin) {
  using R = real_t<T>;
  const T zero(R(0)), far(std::numeric_limits<R>::infinity());
  const internal::BoxPair<T> boxes(size_A, X_WA, size_B, X_WB);
  const auto face = internal::best_face(boxes);
  Manifold<T> m;
  m.normal = {zero, zero, T(R(1))};
  m.p.fill(Vec3<T>::zero());
  const mask_t<T> near = face.separation <= margin;
  when(near, [&] {
    const auto edge = internal::best_edge(boxes);
    // Between boxes that are apart the distance must be true.
    const T preference = max(boxes.bias - max(face.best, zero), boxes.rounding);
    const mask_t<T> crosses = near & (edge.separation > face.best + preference);
    const T separation = select(crosses, edge.separation, face.separation);

    const auto overlap = internal::overlap_of_faces(boxes, face, X_WA, X_WB, margin);
    m.normal = select(near, overlap.normal, m.normal);
    const T least = select(crosses, edge.separation, -far);
    T lowest = far;
    for (std::size_t k = 0; k < m.phi.size(); ++k) {
      m.p[k] = select(near, overlap.p[k], m.p[k]);
      m.phi[k] = select(near, max(overlap.phi[k], least), far);
      lowest = min(overlap.phi[k], lowest);
    }
    // A box that lands flat, but for rounding, lands on its face and not where two edges cross first.
    const mask_t<T> flat = (edge.separation <= face.best + boxes.bias) & (lowest <= edge.separation + boxes.bias);
    const mask_t<T> by_edge = crosses & !flat;
    mask_t<T> past = (near ^ crosses) & (lowest > fma(T(R(1.0001)), face.best, T(R(0.5)) * boxes.bias));

    const auto put = [&](mask_t<T> where, const internal::BoxPoint<T>& point) {
      m.normal = select(where, X_WA.R * point.normal, m.normal);
      m.p[0] = select(where, X_WA * point.p, m.p[0]);
      m.phi[0] = select(where, point.phi, m.phi[0]);
      for (std::size_t k = 1; k < m.phi.size(); ++k) m.phi[k] = select(where, far, m.phi[k]);
    };
    when(by_edge, [&] {
      const auto crossing = internal::cross_edges(boxes, edge);
      put(by_edge, crossing.point);
      past = past | (by_edge & crossing.past_end);
    });
    const mask_t<T> at_corner = past & (separation > zero) & (separation <= margin);
    when(at_corner, [&] { put(at_corner, internal::nearest_corners(boxes, m.normal)); });
  });
  return m;
}

}  // namespace manyhands
