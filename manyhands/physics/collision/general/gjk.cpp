#include "manyhands/physics/collision/general/gjk.h"

#include <limits>
#include <optional>

namespace manyhands {
namespace {

using Vec = Vec3<double>;

constexpr int kIterations = 128;
constexpr double kGap = 1e-12;    // relative distance between the bounds at which they have met
constexpr double kTouch = 1e-11;  // of the size: nearer than this, the direction of the distance is noise

constexpr double kStuck = 1e-6;  // of the size: a gap between the bounds that no iteration on round shapes leaves

/// A part of a simplex: which of its vertices, and the weights by which they make the part's nearest point.
struct Part {
  std::array<std::size_t, 3> index{};
  std::array<double, 3> weight{};
  std::size_t size = 0;
  Vec nearest{};
  double distance2 = std::numeric_limits<double>::infinity();
};

struct Simplex {
  std::array<MinkowskiVertex, 4> v;  // the first `size` of them
  std::array<double, 4> weight{};
  std::size_t size = 0;

  [[nodiscard]] Vec on_a() const {
    Vec sum = Vec::zero();
    for (std::size_t i = 0; i < size; ++i) sum = fma(weight[i], v[i].a, sum);
    return sum;
  }
  /// Becomes the part of another simplex.
  void take(const std::array<MinkowskiVertex, 4>& from, const Part& part) {
    size = part.size;
    for (std::size_t i = 0; i < size; ++i) {
      v[i] = from[part.index[i]];
      weight[i] = part.weight[i];
    }
  }
  /// The part nearest to the origin; none if that lies in the simplex, a tetrahedron.
  [[nodiscard]] std::optional<Part> nearest_part() const {
    if (size == 2) return on_segment(0, 1);
    if (size == 3) return on_triangle(0, 1, 2);
    return on_tetrahedron();
  }

 private:
  [[nodiscard]] Part on_segment(std::size_t i, std::size_t j) const {
    const Vec &p = w(i), &q = w(j), d = q - p;
    const double along = -dot(p, d), length2 = dot(d, d);
    if (!(along > 0)) return part<1>({i}, {1});
    if (along >= length2) return part<1>({j}, {1});
    // From the nearer end, whose coordinates carry the smaller error.
    const double t = along < 0.5 * length2 ? along / length2 : 1 - dot(q, d) / length2;
    return part<2>({i, j}, {1 - t, t});
  }

  [[nodiscard]] Part on_triangle(std::size_t i, std::size_t j, std::size_t k) const {
    const Vec &p = w(i), &q = w(j), &r = w(k);
    const Vec n = cross(q - p, r - p);
    const double n2 = squared_norm(n);
    const double a = dot(n, cross(q, r)), b = dot(n, cross(r, p)), c = dot(n, cross(p, q));
    Part best;
    if (a > 0 && b > 0 && c > 0 && n2 > 0) {
      const double sum = a + b + c;
      best = part<3>({i, j, k}, {a / sum, b / sum, c / sum});
      // A sliver's weights are noise; then an edge may do better.
      const double edge2 = max(squared_norm(q - p), squared_norm(r - p));
      if (n2 > 1e-16 * edge2 * edge2) return best;
    }
    keep_nearer(best, on_segment(i, j));
    keep_nearer(best, on_segment(j, k));
    keep_nearer(best, on_segment(k, i));
    return best;
  }

  [[nodiscard]] std::optional<Part> on_tetrahedron() const {
    constexpr std::array<std::array<std::size_t, 4>, 4> kFaces{
        {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 3, 2, 0}}};
    std::optional<Part> best;
    for (const auto& f : kFaces) {
      const Vec &a = w(f[0]), to_apex = w(f[3]) - a, n = cross(w(f[1]) - a, w(f[2]) - a);
      const double origin = -dot(n, a), apex = dot(n, to_apex);
      const double noise2 = 1e-28 * squared_norm(n) * squared_norm(to_apex);
      if (apex * apex > noise2 && origin * apex > 0) continue;
      if (!best) best.emplace();
      keep_nearer(*best, on_triangle(f[0], f[1], f[2]));
    }
    return best;
  }

  [[nodiscard]] const Vec& w(std::size_t i) const { return v[i].w; }

  template <std::size_t N>
  [[nodiscard]] Part part(const std::array<std::size_t, N>& index, const std::array<double, N>& weights) const {
    Part result;
    result.size = N;
    for (std::size_t i = 0; i < N; ++i) {
      result.index[i] = index[i];
      result.weight[i] = weights[i];
      result.nearest = fma(weights[i], w(index[i]), result.nearest);
    }
    result.distance2 = squared_norm(result.nearest);
    return result;
  }

  static void keep_nearer(Part& best, const Part& other) {
    if (other.distance2 < best.distance2) best = other;
  }
};

bool holds(const Simplex& s, const Vec& w) {
  for (std::size_t i = 0; i < s.size; ++i) {
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
  if (!(squared_norm(v) > 0)) v = {-1, 0, 0};
  Simplex s;
  s.v[0] = minkowski_support(pair, -v);
  s.weight[0] = 1;
  s.size = 1;
  result.lower_bound = max(0.0, dot(v, s.v[0].w) / norm(v));
  v = s.v[0].w;
  double bound = 0;  // by the last support
  for (int i = 0; i < kIterations && !(result.lower_bound > far); ++i) {
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
    grown.v[grown.size++] = w;
    const std::optional<Part> part = grown.nearest_part();
    if (!part) {
      s = grown;
      s.weight.fill(0.25);
      result.overlap = true;
      break;
    }
    if (part->distance2 >= squared_norm(v)) break;  // rounding allows no better
    s.take(grown.v, *part);
    v = part->nearest;
  }
  // Stuck in rounding, as between plates thinner than their breadth's digits: the bounds have not met, v means nothing.
  if (result.lower_bound <= far && norm(v) - bound > kStuck * pair.scale()) result.overlap = true;
  result.simplex = s.v;
  result.size = static_cast<int>(s.size);
  result.a = s.on_a();
  if (!result.overlap) {
    result.distance = norm(v);
    result.normal = (-1 / result.distance) * v;
    result.b = result.a - v;
  }
  return result;
}

}  // namespace manyhands
