#include "manyhands/physics/collision/general/gjk.h"

#include <limits>

namespace manyhands {
namespace {

using Vec = Vec3<double>;

constexpr int kIterations = 128;
constexpr double kGap = 1e-12;    // relative distance between the bounds at which they have met
constexpr double kTouch = 1e-11;  // of the size: nearer than this, the direction of the distance is noise

constexpr double kStuck = 1e-6;  // of the size: a gap between the bounds that no iteration on round shapes leaves

struct Simplex {
  std::array<MinkowskiVertex, 4> v{};
  std::array<double, 4> weight{};
  int size = 0;

  [[nodiscard]] Vec nearest() const {
    Vec sum = Vec::zero();
    for (std::size_t i = 0; i < static_cast<std::size_t>(size); ++i) sum = fma(weight[i], v[i].w, sum);
    return sum;
  }
  [[nodiscard]] Vec on_a() const {
    Vec sum = Vec::zero();
    for (std::size_t i = 0; i < static_cast<std::size_t>(size); ++i) sum = fma(weight[i], v[i].a, sum);
    return sum;
  }
};

Simplex nearest_on_segment(const MinkowskiVertex& p, const MinkowskiVertex& q) {
  const Vec d = q.w - p.w;
  const double along = -dot(p.w, d), length2 = dot(d, d);
  if (!(along > 0)) return {{p}, {1}, 1};
  if (along >= length2) return {{q}, {1}, 1};
  // From the nearer end, whose coordinates carry the smaller error.
  const double t = along < 0.5 * length2 ? along / length2 : 1 - dot(q.w, d) / length2;
  return {{p, q}, {1 - t, t}, 2};
}

/// The nearer of two candidates.
void keep_nearer(Simplex& best, double& distance2, const Simplex& other) {
  if (const double d2 = squared_norm(other.nearest()); d2 < distance2) {
    best = other;
    distance2 = d2;
  }
}

Simplex nearest_on_triangle(const MinkowskiVertex& p, const MinkowskiVertex& q, const MinkowskiVertex& r) {
  const Vec n = cross(q.w - p.w, r.w - p.w);
  const double n2 = squared_norm(n);
  const double u = dot(n, cross(q.w, r.w)), v = dot(n, cross(r.w, p.w)), w = dot(n, cross(p.w, q.w));
  Simplex best;
  double distance2 = std::numeric_limits<double>::infinity();
  if (u > 0 && v > 0 && w > 0 && n2 > 0) {
    const double sum = u + v + w;
    best = {{p, q, r}, {u / sum, v / sum, w / sum}, 3};
    distance2 = squared_norm(best.nearest());
    // A sliver's weights are noise; then an edge may do better.
    const double edge2 = max(squared_norm(q.w - p.w), squared_norm(r.w - p.w));
    if (n2 > 1e-16 * edge2 * edge2) return best;
  }
  keep_nearer(best, distance2, nearest_on_segment(p, q));
  keep_nearer(best, distance2, nearest_on_segment(q, r));
  keep_nearer(best, distance2, nearest_on_segment(r, p));
  return best;
}

/// Size 4 if the tetrahedron holds the origin.
Simplex nearest_on_tetrahedron(const std::array<MinkowskiVertex, 4>& v) {
  constexpr std::array<std::array<std::size_t, 4>, 4> kFaces{{{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 3, 2, 0}}};
  Simplex best;
  double distance2 = std::numeric_limits<double>::infinity();
  bool inside = true;
  for (const auto& f : kFaces) {
    const Vec a = v[f[0]].w, n = cross(v[f[1]].w - a, v[f[2]].w - a);
    const double origin = -dot(n, a), apex = dot(n, v[f[3]].w - a);
    const double noise = 1e-14 * norm(n) * norm(v[f[3]].w - a);
    if (std::abs(apex) > noise && origin * apex > 0) continue;
    inside = false;
    keep_nearer(best, distance2, nearest_on_triangle(v[f[0]], v[f[1]], v[f[2]]));
  }
  return inside ? Simplex{v, {0.25, 0.25, 0.25, 0.25}, 4} : best;
}

Simplex reduced(const Simplex& s) {
  switch (s.size) {
    case 1:
      return {{s.v[0]}, {1}, 1};
    case 2:
      return nearest_on_segment(s.v[0], s.v[1]);
    case 3:
      return nearest_on_triangle(s.v[0], s.v[1], s.v[2]);
    default:
      return nearest_on_tetrahedron(s.v);
  }
}

bool holds(const Simplex& s, const Vec& w) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(s.size); ++i) {
    const Vec& u = s.v[i].w;
    if (u.x == w.x && u.y == w.y && u.z == w.z) return true;
  }
  return false;
}

}  // namespace

MinkowskiVertex minkowski_support(const CorePair& pair, const Vec& d) {
  const Vec a = pair.a.support(d);
  const Vec b = pair.X_AB * pair.b.support(-transpose_times(pair.X_AB.R, d));
  return {a - b, a};
}

GjkResult gjk(const CorePair& pair, double far) {
  GjkResult result;
  const double touch = kTouch * pair.scale();
  Vec v = pair.a.centre() - pair.X_AB * pair.b.centre();
  Simplex s;
  s.v[0] = minkowski_support(pair, squared_norm(v) > 0 ? -v : Vec{1, 0, 0});
  s = {{s.v[0]}, {1}, 1};
  v = s.v[0].w;
  double bound = 0;  // by the last support
  for (int i = 0; i < kIterations; ++i) {
    const double distance = norm(v);
    if (distance <= touch) {
      result.overlap = true;
      break;
    }
    const MinkowskiVertex w = minkowski_support(pair, -v);
    bound = dot(v, w.w) / distance;
    result.lower_bound = max(result.lower_bound, bound);
    if (result.lower_bound > far || distance - result.lower_bound <= kGap * distance || holds(s, w.w)) break;
    Simplex grown = s;
    grown.v[static_cast<std::size_t>(grown.size++)] = w;
    grown = reduced(grown);
    if (grown.size == 4) {
      s = grown;
      result.overlap = true;
      break;
    }
    const Vec next = grown.nearest();
    if (squared_norm(next) >= squared_norm(v)) break;  // rounding allows no better
    s = grown;
    v = next;
  }
  // Stuck in rounding, as between plates thinner than their breadth's digits: the bounds have not met, v means nothing.
  if (result.lower_bound <= far && norm(v) - bound > kStuck * pair.scale()) result.overlap = true;
  result.simplex = s.v;
  result.size = s.size;
  result.a = s.on_a();
  if (!result.overlap) {
    result.distance = norm(v);
    result.normal = (-1 / result.distance) * v;
    result.b = result.a - v;
  }
  return result;
}

}  // namespace manyhands
