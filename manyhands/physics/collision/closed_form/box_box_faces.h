// The overlap of a box's face with the opposite face of another box, thinned to four points.
#pragma once

#include "manyhands/physics/collision/closed_form/box_box_axes.h"

namespace manyhands::internal {

/// A point over the reference face: its place in the face's plane, and its distance from it.
template <Number T>
struct FacePoint {
  T u, v, phi;
};

template <Number T>
MANYHANDS_INLINE FacePoint<T> choose(mask_t<T> m, const FacePoint<T>& a, const FacePoint<T>& b) {
  return {select(m, a.u, b.u), select(m, a.v, b.v), select(m, a.phi, b.phi)};
}

/// All corners that the overlap of two faces may have: where the four incident edges enter and leave the reference
/// face, and the reference face's corners.
inline constexpr std::size_t kFaceCandidates = 12;
template <Number T>
using FaceCandidates = std::array<FacePoint<T>, kFaceCandidates>;

/// The incident face seen from the reference face: the rectangle centre + [-1, 1] edge_1 + [-1, 1] edge_2 over the one
/// with half extents u and v; the third coordinate is the distance.
template <Number T>
struct FacePair {
  T u, v;
  Vec3<T> centre, edge_1, edge_2;
  T slack;  ///< how far beside the reference face is still over it
};

template <Number T>
MANYHANDS_INLINE T safe_inverse(T a) {
  using R = real_t<T>;
  return T(R(1)) / copysign(max(abs(a), T(R(1e-12))), a);
}

/// Where the lines middle + s edge and -middle's counterparts enter and leave the reference face, |s| <= 1.
template <Number T>
MANYHANDS_INLINE void clip_edges(const FacePair<T>& f, const Vec3<T>& along, const Vec3<T>& aside, FacePoint<T>* to) {
  using R = real_t<T>;
  const T one(R(1)), far(std::numeric_limits<R>::infinity());
  const T inverse_u = safe_inverse(along.x), inverse_v = safe_inverse(along.y);
  const T reach_u = (f.u + f.slack) * abs(inverse_u), reach_v = (f.v + f.slack) * abs(inverse_v);
  for (int side = 0; side < 2; ++side) {
    const Vec3<T> middle = side == 0 ? f.centre + aside : f.centre - aside;
    const T s_u = -middle.x * inverse_u, s_v = -middle.y * inverse_v;
    const T enter = max(max(s_u - reach_u, s_v - reach_v), -one), leave = min(min(s_u + reach_u, s_v + reach_v), one);
    const mask_t<T> over = enter <= leave;
    for (const T& s : {enter, leave}) {
      *to++ = {fma(s, along.x, middle.x), fma(s, along.y, middle.y), select(over, fma(s, along.z, middle.z), far)};
    }
  }
}

template <Number T>
MANYHANDS_INLINE FaceCandidates<T> face_candidates(const FacePair<T>& f) {
  using R = real_t<T>;
  const T one(R(1)), far(std::numeric_limits<R>::infinity());
  FaceCandidates<T> points;
  clip_edges(f, f.edge_1, f.edge_2, &points[0]);
  clip_edges(f, f.edge_2, f.edge_1, &points[4]);
  // The reference corners' coordinates along the incident edges.
  const T inverse = safe_inverse(fma(f.edge_1.x, f.edge_2.y, -(f.edge_1.y * f.edge_2.x)));
  std::size_t k = 8;
  for (const R sign_u : {R(-1), R(1)}) {
    for (const R sign_v : {R(-1), R(1)}) {
      const T u = T(sign_u) * f.u, v = T(sign_v) * f.v;
      const T du = u - f.centre.x, dv = v - f.centre.y;
      const T s_1 = fma(du, f.edge_2.y, -(dv * f.edge_2.x)) * inverse;
      const T s_2 = fma(dv, f.edge_1.x, -(du * f.edge_1.y)) * inverse;
      const mask_t<T> over = (abs(s_1) <= one) & (abs(s_2) <= one);
      points[k++] = {u, v, select(over, fma(s_1, f.edge_1.z, fma(s_2, f.edge_2.z, f.centre.z)), far)};
    }
  }
  return points;
}

/// Where one of the faces lies all over the other, the overlap is that one: its four corners.
template <Number T>
struct WholeFace {
  mask_t<T> exists;
  std::array<FacePoint<T>, 4> corners;
};

template <Number T>
MANYHANDS_INLINE WholeFace<T> whole_face(const FacePair<T>& f) {
  using R = real_t<T>;
  const T one(R(1));
  const Vec3<T>& c = f.centre;
  const Vec3<T>&e = f.edge_1, &g = f.edge_2;
  const mask_t<T> incident =
      (abs(c.x) + abs(e.x) + abs(g.x) <= f.u + f.slack) & (abs(c.y) + abs(e.y) + abs(g.y) <= f.v + f.slack);
  // The reference face's centre and half edges along the incident edges.
  const T inverse = safe_inverse(fma(e.x, g.y, -(e.y * g.x)));
  const T s_1 = fma(c.y, g.x, -(c.x * g.y)) * inverse, s_2 = fma(c.x, e.y, -(c.y * e.x)) * inverse;
  const T u_1 = f.u * g.y * inverse, v_1 = -(f.v * g.x * inverse);
  const T u_2 = -(f.u * e.y * inverse), v_2 = f.v * e.x * inverse;
  const mask_t<T> reference = (abs(s_1) + abs(u_1) + abs(v_1) <= one) & (abs(s_2) + abs(u_2) + abs(v_2) <= one);

  const T height = fma(s_1, e.z, fma(s_2, g.z, c.z));
  const T rise_u = fma(u_1, e.z, u_2 * g.z), rise_v = fma(v_1, e.z, v_2 * g.z);
  WholeFace<T> whole{mask_t<T>(incident | reference), {}};
  std::size_t k = 0;
  for (const R a : {R(-1), R(1)}) {
    for (const R b : {R(-1), R(1)}) {
      const Vec3<T> p = fma(T(a), e, fma(T(b), g, c));
      const FacePoint<T> corner{T(a) * f.u, T(b) * f.v, fma(T(a), rise_u, fma(T(b), rise_v, height))};
      whole.corners[k++] = choose(incident, FacePoint<T>{p.x, p.y, p.z}, corner);
    }
  }
  return whole;
}

/// Of the points with phi <= limit the one farthest from `from`, and the square of how far; `from` if none is.
template <Number T>
struct Farthest {
  FacePoint<T> point;
  T squared;
};
template <Number T>
MANYHANDS_INLINE Farthest<T> farthest(const FaceCandidates<T>& points, const FacePoint<T>& from, T limit) {
  Farthest<T> best{from, T(real_t<T>(0))};
  for (const auto& point : points) {
    const T u = point.u - from.u, v = point.v - from.v;
    const T squared = fma(u, u, v * v);
    const mask_t<T> better = (point.phi <= limit) & (squared > best.squared);
    best = {choose(better, point, best.point), select(better, squared, best.squared)};
  }
  return best;
}

/// The deepest point, the one farthest from it, and the farthest to either side of the line between them; of points
/// farther away than the margin the deepest only. Points that are none have an infinite phi; so do those no farther
/// apart, or from the line, than `coincident`.
template <Number T>
MANYHANDS_INLINE std::array<FacePoint<T>, 4> thin_out(const FaceCandidates<T>& points, T margin, T rounding,
                                                      T coincident) {
  using R = real_t<T>;
  const T far(std::numeric_limits<R>::infinity()), most_finite(std::numeric_limits<R>::max());
  T least_phi = points[0].phi;
  FacePoint<T> first = points[0];
  for (std::size_t k = 1; k < points.size(); ++k) {
    first = choose(points[k].phi < least_phi, points[k], first);
    least_phi = min(points[k].phi, least_phi);
  }
  const T limit = min(max(margin, least_phi), most_finite);
  auto second = farthest(points, first, limit);
  // Of points that are as deep but for rounding, the one that spans most: on faces that coincide, a corner.
  const T as_deep = least_phi + fma(T(R(1e-6)), sqrt(second.squared), rounding);
  const auto opposite = farthest(points, second.point, min(as_deep, limit));
  first = opposite.point;
  const mask_t<T> apart = opposite.squared > coincident * coincident;

  const T u = second.point.u - first.u, v = second.point.v - first.v;
  const T least_area = coincident * sqrt(opposite.squared);
  FacePoint<T> left = first, right = first;
  T most = least_area, least = -least_area;
  for (const auto& point : points) {
    const T area = fma(u, point.v - first.v, -(v * (point.u - first.u)));
    const mask_t<T> usable = apart & (point.phi <= limit);
    const mask_t<T> on_left = usable & (area > most);
    const mask_t<T> on_right = usable & (area < least);
    left = choose(on_left, point, left);
    most = select(on_left, area, most);
    right = choose(on_right, point, right);
    least = select(on_right, area, least);
  }
  second.point.phi = select(apart, second.point.phi, far);
  left.phi = select(most > least_area, left.phi, far);
  right.phi = select(least < -least_area, right.phi, far);
  return {first, second.point, left, right};
}

/// Where the opposite face lies over the chosen one.
template <Number T>
MANYHANDS_INLINE Manifold<T> overlap_of_faces(const BoxPair<T>& boxes, const FaceAxis<T>& face,
                                              const Transform<T>& X_WA, const Transform<T>& X_WB, T margin) {
  using R = real_t<T>;
  // From here on the reference box has the chosen face, its axes turned round until that one is the last.
  const auto turned = [](const AxisChoice<T>& last, const Mat3<T>& m) -> Mat3<T> {
    return {select(last.is_x, m.y, select(last.is_y, m.z, m.x)), select(last.is_x, m.z, select(last.is_y, m.x, m.y)),
            pick(last, m)};
  };
  const auto turned_size = [](const AxisChoice<T>& last, const Vec3<T>& h) -> Vec3<T> {
    return {select(last.is_x, h.y, select(last.is_y, h.z, h.x)), select(last.is_x, h.z, select(last.is_y, h.x, h.y)),
            pick(last, h)};
  };
  const auto either = [&](const Mat3<T>& a, const Mat3<T>& b) -> Mat3<T> {
    return {select(face.of_B, a.x, b.x), select(face.of_B, a.y, b.y), select(face.of_B, a.z, b.z)};
  };
  Mat3<T> reference = turned(face.axis, either(X_WB.R, X_WA.R));
  const Vec3<T> half = turned_size(face.axis, select(face.of_B, boxes.half_B, boxes.half_A));
  const Vec3<T> origin = select(face.of_B, X_WB.p, X_WA.p);
  const Vec3<T> across = X_WB.p - X_WA.p;
  const Vec3<T> to_other = select(face.of_B, -across, across);
  const T side = copysign(T(R(1)), dot(reference.z, to_other));
  reference.z = side * reference.z;

  const Mat3<T> other = either(X_WA.R, X_WB.R);
  const auto facing = largest(magnitudes(transpose_times(other, reference.z)));
  const Mat3<T> incident = turned(facing, other);
  const Vec3<T> incident_half = turned_size(facing, select(face.of_B, boxes.half_A, boxes.half_B));
  const T down = -copysign(incident_half.z, dot(incident.z, reference.z));
  Vec3<T> centre = transpose_times(reference, fma(down, incident.z, to_other));
  centre.z -= half.z;

  const T coincident = T(R(1e-4)) * (half.x + half.y);
  const FacePair<T> faces{half.x,
                          half.y,
                          centre,
                          transpose_times(reference, incident_half.x * incident.x),
                          transpose_times(reference, incident_half.y * incident.y),
                          boxes.rounding};
  const auto whole = whole_face(faces);
  auto points = whole.corners;
  when(!whole.exists, [&] {
    const auto thinned = thin_out(face_candidates(faces), margin, boxes.rounding, coincident);
    for (std::size_t k = 0; k < points.size(); ++k) points[k] = choose(whole.exists, points[k], thinned[k]);
  });

  Manifold<T> m;
  m.normal = select(face.of_B, -reference.z, reference.z);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vec3<T> p{points[k].u, points[k].v, fma(T(R(0.5)), points[k].phi, half.z)};
    m.p[k] = origin + reference * p;
    m.phi[k] = points[k].phi;
  }
  return m;
}

}  // namespace manyhands::internal
