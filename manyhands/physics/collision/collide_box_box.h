// Contact of two boxes: fifteen separating axes, then the overlap of two faces, or the crossing of two edges.
//
// The six face normals and the nine cross products of edges are all the normals that overlapping boxes may have, and
// all that separate ones may have except between corners, and between a corner and an edge (Gottschalk, Lin and
// Manocha, OBBTree, 1996). Those two are looked for by themselves where the found axis leads past the other box. Faces
// are preferred by a little, so that rounding does not turn resting boxes to their edges.
#pragma once

#include "manyhands/math/control_flow.h"
#include "manyhands/physics/collision/box_box_axes.h"
#include "manyhands/physics/collision/box_box_faces.h"
#include "manyhands/physics/collision/collide_sphere.h"
#include "manyhands/physics/collision/segment_and_box.h"

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

/// The nearest points of separate boxes whose nearest features include a corner: one coordinate of B's point after
/// another is moved to its best. At most one of them is free in the end, so that a few rounds are all.
template <Number T>
MANYHANDS_INLINE BoxPoint<T> nearest_corners(const BoxPair<T>& boxes, const Vec3<T>& otherwise) {
  using R = real_t<T>;
  constexpr int kRounds = 4;
  const std::array<Vec3<T>, 3> axis{boxes.R_AB.x, boxes.R_AB.y, boxes.R_AB.z};
  const std::array<T, 3> half{boxes.half_B.x, boxes.half_B.y, boxes.half_B.z};
  const auto start = -transpose_times(boxes.R_AB, boxes.p_AB);
  std::array<T, 3> y{clamp(start.x, -half[0], half[0]), clamp(start.y, -half[1], half[1]),
                     clamp(start.z, -half[2], half[2])};
  Vec3<T> x = boxes.p_AB + boxes.R_AB * Vec3<T>{y[0], y[1], y[2]};
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t j = 0; j < 3; ++j) {
      const Vec3<T> middle = fma(-y[j], axis[j], x);
      const SegmentAndBox<T> line{{middle.x, middle.y, middle.z},
                                  {axis[j].x, axis[j].y, axis[j].z},
                                  {boxes.half_A.x, boxes.half_A.y, boxes.half_A.z},
                                  half[j]};
      y[j] = line.nearest();
      x = fma(y[j], axis[j], middle);
    }
  }
  const Vec3<T>& h = boxes.half_A;
  const Vec3<T> on_A{clamp(x.x, -h.x, h.x), clamp(x.y, -h.y, h.y), clamp(x.z, -h.z, h.z)};
  const auto way = direction_or(x - on_A, otherwise);
  return {way.unit, T(R(0.5)) * (x + on_A), way.length};
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
    const mask_t<T> by_edge = near & (edge.separation > face.separation + boxes.bias);
    const T separation = select(by_edge, edge.separation, face.separation);

    const auto overlap = internal::overlap_of_faces(boxes, face, X_WA, X_WB, margin);
    m.normal = select(near, overlap.normal, m.normal);
    T lowest = far;
    for (std::size_t k = 0; k < m.phi.size(); ++k) {
      m.p[k] = select(near, overlap.p[k], m.p[k]);
      m.phi[k] = select(near, overlap.phi[k], far);
      lowest = min(overlap.phi[k], lowest);
    }
    mask_t<T> past = (near ^ by_edge) & (lowest > fma(T(R(1.001)), face.separation, boxes.bias));

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
