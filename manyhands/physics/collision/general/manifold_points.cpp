#include "manyhands/physics/collision/general/manifold_points.h"

#include <algorithm>

namespace manyhands {
namespace {

using Vec = Vec3<double>;

struct Flat {
  double x, y;
};

Flat operator-(Flat a, Flat b) { return {a.x - b.x, a.y - b.y}; }
Flat mix(Flat a, Flat b, double t) { return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)}; }
double cross(Flat a, Flat b) { return a.x * b.y - a.y * b.x; }
double dot(Flat a, Flat b) { return a.x * b.x + a.y * b.y; }

struct Polygon {
  std::array<Flat, 2 * kFeatureCorners + 4> p;  // the first `size` of them
  std::size_t size = 0;

  void add(Flat q) {
    if (size < p.size()) p[size++] = q;
  }
};

/// Axes of the contact plane and its normal.
struct ContactFrame {
  Vec o, x, y, n;

  ContactFrame(const Vec& origin, const Vec& normal) : o(origin), x(), y(), n(normal) {
    const Vec e = std::abs(n.x) < 0.6 ? Vec{1, 0, 0} : Vec{0, 1, 0};
    const Vec across = manyhands::cross(n, e);
    x = (1 / norm(across)) * across;
    y = manyhands::cross(n, x);
  }
  [[nodiscard]] Flat flat(const Vec& p) const { return {manyhands::dot(p - o, x), manyhands::dot(p - o, y)}; }
  [[nodiscard]] double height(const Vec& p) const { return manyhands::dot(p - o, n); }
  [[nodiscard]] Vec at(Flat q, double height) const { return o + q.x * x + q.y * y + height * n; }
};

/// A feature seen along the normal, counter-clockwise, with its height as a function of place.
struct SeenFeature {
  Polygon outline;
  Flat slope{};
  double base{};  // height where outline.p[0] lies

  SeenFeature(const SupportingFeature& f, const ContactFrame& frame) {
    for (std::size_t i = 0; i < f.size; ++i) outline.add(frame.flat(f.corner[i]));
    base = frame.height(f.corner[0]);
    const Flat first = outline.p[0];
    if (f.size == 2) {
      const Flat along = outline.p[1] - first;
      const double length2 = dot(along, along);
      const double rise = length2 > 0 ? (frame.height(f.corner[1]) - base) / length2 : 0;
      slope = {rise * along.x, rise * along.y};
    } else if (f.size > 2) {
      const double up = manyhands::dot(f.normal, frame.n);
      if (std::abs(up) > 1e-3) {
        slope = {-manyhands::dot(f.normal, frame.x) / up, -manyhands::dot(f.normal, frame.y) / up};
        if (area() < 0) std::reverse(outline.p.begin(), outline.p.begin() + static_cast<std::ptrdiff_t>(f.size));
        base += dot(slope, outline.p[0] - first);
      } else {
        outline.size = 0;
      }
    }
  }
  [[nodiscard]] double area() const {
    double twice = 0;
    for (std::size_t i = 1; i + 1 < outline.size; ++i) {
      twice += cross(outline.p[i] - outline.p[0], outline.p[i + 1] - outline.p[0]);
    }
    return twice;
  }
  [[nodiscard]] double height(Flat q) const { return base + dot(slope, q - outline.p[0]); }
};

/// What of the polygon lies to the left of the line from a to b (Sutherland and Hodgman, 1974), into `result`.
void cut(const Polygon& polygon, Flat a, Flat b, Polygon& result) {
  result.size = 0;
  const Flat edge = b - a;
  for (std::size_t i = 0; i < polygon.size; ++i) {
    const Flat p = polygon.p[i], q = polygon.p[(i + 1) % polygon.size];
    const double at_p = cross(edge, p - a), at_q = cross(edge, q - a);
    if (at_p >= 0) result.add(p);
    if ((at_p > 0 && at_q < 0) || (at_p < 0 && at_q > 0)) result.add(mix(p, q, at_p / (at_p - at_q)));
  }
}

/// The part of a segment within a polygon.
Polygon cut_segment(const Polygon& segment, const Polygon& polygon) {
  const Flat p = segment.p[0], q = segment.p[1];
  double low = 0, high = 1;
  for (std::size_t i = 0; i < polygon.size; ++i) {
    const Flat a = polygon.p[i], edge = polygon.p[(i + 1) % polygon.size] - a;
    const double at_p = cross(edge, p - a), at_q = cross(edge, q - a);
    if (at_p < 0 && at_q < 0) return {};
    if (at_p < 0) low = max(low, at_p / (at_p - at_q));
    if (at_q < 0) high = min(high, at_p / (at_p - at_q));
  }
  Polygon result;
  if (low > high) return result;
  result.add(mix(p, q, low));
  result.add(mix(p, q, high));
  return result;
}

/// Where two segments that are nearly parallel run beside each other, taken on the first.
Polygon beside(const Polygon& a, const Polygon& b) {
  const Flat u = a.p[1] - a.p[0], v = b.p[1] - b.p[0];
  const double length2 = dot(u, u);
  Polygon result;
  if (std::abs(cross(u, v)) > 0.1 * std::sqrt(length2 * dot(v, v))) return result;
  const double s = dot(b.p[0] - a.p[0], u) / length2, t = dot(b.p[1] - a.p[0], u) / length2;
  const double low = max(0.0, min(s, t)), high = min(1.0, max(s, t));
  if (!(low < high)) return result;
  result.add(mix(a.p[0], a.p[1], low));
  result.add(mix(a.p[0], a.p[1], high));
  return result;
}

/// The point, if the polygon holds it.
Polygon cut_point(const Polygon& point, const Polygon& polygon) {
  for (std::size_t i = 0; i < polygon.size; ++i) {
    const Flat a = polygon.p[i];
    if (cross(polygon.p[(i + 1) % polygon.size] - a, point.p[0] - a) < 0) return {};
  }
  return point;
}

Polygon shared(const Polygon& a, const Polygon& b) {
  if (a.size == 1 && b.size > 2) return cut_point(a, b);
  if (b.size == 1 && a.size > 2) return cut_point(b, a);
  if (a.size < 2 || b.size < 2) return {};
  if (a.size == 2 && b.size == 2) return beside(a, b);
  if (a.size == 2) return cut_segment(a, b);
  if (b.size == 2) return cut_segment(b, a);
  std::array<Polygon, 2> parts;  // of odd and of even cuts
  const Polygon* left = &a;
  for (std::size_t i = 0; i < b.size && left->size > 0; ++i) {
    cut(*left, b.p[i], b.p[(i + 1) % b.size], parts[i % 2]);
    left = &parts[i % 2];
  }
  return *left;
}

/// The index that maximises a measure; the first of equals.
template <class Measure>
std::size_t best_of(std::size_t n, Measure&& measure) {
  std::size_t best = 0;
  double most = measure(std::size_t{0});
  for (std::size_t i = 1; i < n; ++i) {
    if (const double m = measure(i); m > most) best = i, most = m;
  }
  return best;
}

}  // namespace

ManifoldPoints clip_features(const SupportingFeature& a, const SupportingFeature& b, const Vec& normal, double radius_a,
                             double radius_b) {
  const ContactFrame frame(a.corner[0], normal);
  const SeenFeature seen_a(a, frame), seen_b(b, frame);
  const Polygon polygon = shared(seen_a.outline, seen_b.outline);
  ManifoldPoints result;
  for (std::size_t i = 0; i < polygon.size; ++i) {
    const Flat q = polygon.p[i];
    const double low = seen_a.height(q) + radius_a, high = seen_b.height(q) - radius_b;
    result.add({frame.at(q, 0.5 * (low + high)), high - low});
  }
  return result;
}

Manifold<double> choose_points(std::span<const ManifoldPoint> points, const Vec& normal) {
  Manifold<double> m;
  m.normal = normal;
  const auto take = [&](std::size_t k, std::size_t i) {
    m.p[k] = points[i].p;
    m.phi[k] = points[i].phi;
  };
  if (points.size() <= kManifoldPoints) {
    for (std::size_t i = 0; i < points.size(); ++i) take(i, i);
    return m;
  }
  const auto p = [&](std::size_t i) { return points[i].p; };
  const auto area = [&](std::size_t i, std::size_t j, std::size_t k) {
    return manyhands::dot(normal, manyhands::cross(p(j) - p(i), p(k) - p(i)));
  };
  const std::size_t n = points.size();
  // Of points as deep as the deepest, the one farthest out: the others are then spread the most.
  Vec middle = Vec::zero();
  for (std::size_t i = 0; i < n; ++i) middle += (1.0 / static_cast<double>(n)) * p(i);
  const auto out = [&](std::size_t i) { return norm(p(i) - middle); };
  const double least = points[best_of(n, [&](std::size_t i) { return -points[i].phi; })].phi;
  const double deep = least + 1e-6 * out(best_of(n, out));
  const std::size_t deepest = best_of(n, [&](std::size_t i) { return points[i].phi <= deep ? out(i) : -1; });
  const std::size_t far = best_of(n, [&](std::size_t i) { return squared_norm(p(i) - p(deepest)); });
  const std::size_t left = best_of(n, [&](std::size_t i) { return std::abs(area(deepest, far, i)); });
  const double side = std::copysign(1.0, area(deepest, far, left));
  // What a fourth point adds lies beyond one of the triangle's edges.
  const std::size_t right = best_of(n, [&](std::size_t i) {
    return max(-side * area(deepest, far, i), max(-side * area(far, left, i), -side * area(left, deepest, i)));
  });
  take(0, deepest);
  take(1, far);
  take(2, left);
  const bool distinct = right != deepest && right != far && right != left;
  if (distinct) take(3, right);
  return m;
}

}  // namespace manyhands
