#include "manyhands/model/convex_polyhedron.h"

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <numeric>
#include <set>

#include "manyhands/model/model.h"
#include "manyhands/model/qhull_run.h"
#include "manyhands/model/support_vertex.h"

namespace manyhands {
namespace {

constexpr double kCoplanar = 1e-6;   // of the extent: float files round to 1e-7 of it
constexpr double kThickness = 1e-4;  // of the extent, given to clouds that have none

struct HullTriangle {
  std::array<int, 3> v;
  Vec3<double> normal;
  double area;
};

using Edge = std::pair<int, int>;

Vec3<double> unit(const Vec3<double>& a) { return (1 / norm(a)) * a; }

Vec3<double> any_across(const Vec3<double>& a) {
  const bool x = std::abs(a.x) < 0.6 * norm(a);
  return unit(cross(a, x ? Vec3<double>{1, 0, 0} : Vec3<double>{0, 1, 0}));
}

/// The point for which `measure` is largest, and that measure.
template <class Measure>
std::pair<std::size_t, double> farthest(std::span<const Vec3<double>> points, Measure&& measure) {
  std::pair<std::size_t, double> best{0, -1};
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (const double d = measure(points[i]); d > best.second) best = {i, d};
  }
  return best;
}

/// The points, doubled to both sides of each direction in which they have no extent.
std::vector<Vec3<double>> thickened(std::span<const Vec3<double>> points) {
  if (points.empty()) throw ModelError("convex hull: the mesh has no vertices; give it some, or remove the geom");
  for (const auto& p : points) {
    if (!is_finite(p.x + p.y + p.z)) throw ModelError("convex hull: a vertex is not finite; mend the mesh");
  }
  std::vector<Vec3<double>> result(points.begin(), points.end());
  const Vec3<double> o = points[0];
  const auto [far, extent] = farthest(points, [&](const Vec3<double>& p) { return norm(p - o); });
  if (!(extent > 1e-9)) {
    throw ModelError("convex hull: all vertices lie in one point; use a sphere, or check the mesh's scale");
  }
  const Vec3<double> u = unit(points[far] - o);
  const auto off_line = [&](const Vec3<double>& p) { return (p - o) - dot(p - o, u) * u; };
  const double enough = 1e-7 * extent, half = 0.5 * kThickness * extent;
  const auto [wide, width] = farthest(points, [&](const Vec3<double>& p) { return norm(off_line(p)); });
  const Vec3<double> v = width > enough ? unit(off_line(points[wide])) : any_across(u);
  const Vec3<double> n = cross(u, v);
  const double height = farthest(points, [&](const Vec3<double>& p) { return std::abs(dot(p - o, n)); }).second;
  const auto thicken = [&](const Vec3<double>& direction) {
    const std::size_t count = result.size();
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3<double> p = result[i];
      result[i] = p + half * direction;
      result.push_back(p - half * direction);
    }
  };
  if (width <= enough) thicken(v);
  if (height <= enough) thicken(n);
  return result;
}

/// The hull's triangles, counter-clockwise, as indices into `points`.
std::vector<HullTriangle> hull_triangles(std::vector<Vec3<double>>& points) {
  static_assert(sizeof(Vec3<double>) == 3 * sizeof(coordT));
  internal::QhullRun run;
  if (!run.build(&points[0].x, static_cast<int>(points.size()), 3, "qhull Qt Pp")) {
    throw ModelError("convex hull: no hull of the mesh's vertices can be built; simplify or thicken the mesh");
  }
  qhT* qh = run.get();
  std::vector<HullTriangle> triangles;
  for (facetT* facet : run.facets()) {
    HullTriangle t{{}, {facet->normal[0], facet->normal[1], facet->normal[2]}, 0};
    setT* corners = qh_facet3vertex(qh, facet);
    for (std::size_t k = 0; k < 3; ++k) {
      t.v[k] = qh_pointid(qh, static_cast<vertexT*>(corners->e[k].p)->point);
    }
    qh_settempfree(qh, &corners);
    const auto at = [&](std::size_t k) { return points[static_cast<std::size_t>(t.v[k])]; };
    const Vec3<double> twice = cross(at(1) - at(0), at(2) - at(0));
    if (dot(twice, t.normal) < 0) std::swap(t.v[1], t.v[2]);
    t.area = 0.5 * norm(twice);
    triangles.push_back(t);
  }
  return triangles;
}

/// Numbers the vertices that the triangles use from zero, in the order of the points.
void compact(const std::vector<Vec3<double>>& points, std::vector<HullTriangle>& triangles, ConvexPolyhedron& hull) {
  std::vector<int> number(points.size(), -1);
  for (const HullTriangle& t : triangles) {
    for (const int v : t.v) number[static_cast<std::size_t>(v)] = 0;
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (number[i] < 0) continue;
    number[i] = static_cast<int>(hull.vertices.size());
    hull.vertices.push_back(points[i]);
    hull.bound = std::max(hull.bound, norm(points[i]));
  }
  for (HullTriangle& t : triangles) {
    for (int& v : t.v) v = number[static_cast<std::size_t>(v)];
  }
}

/// Grows faces over coplanar neighbours, the largest triangles first.
class FaceMerger {
 public:
  FaceMerger(ConvexPolyhedron& hull, const std::vector<HullTriangle>& triangles, double tolerance)
      : hull_(hull), triangles_(triangles), tolerance_(tolerance), taken_(triangles.size(), false) {
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) owner_[{triangles[i].v[k], triangles[i].v[(k + 1) % 3]}] = i;
    }
  }

  void merge() {
    std::vector<std::size_t> order(triangles_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return triangles_[a].area > triangles_[b].area; });
    for (const std::size_t seed : order) {
      if (!taken_[seed]) add_face(grow(seed));
    }
    for (const std::set<int>& faces : faces_of_) hull_.faces_of.append(std::vector<int>(faces.begin(), faces.end()));
  }

 private:
  [[nodiscard]] bool coplanar(const HullTriangle& seed, const HullTriangle& t) const {
    const double offset = dot(seed.normal, vertex(seed.v[0]));
    return std::all_of(t.v.begin(), t.v.end(),
                       [&](int v) { return std::abs(dot(seed.normal, vertex(v)) - offset) < tolerance_; }) &&
           (t.area < square(tolerance_) || dot(t.normal, seed.normal) > 0.9);
  }

  std::vector<std::size_t> grow(std::size_t seed) {
    std::vector<std::size_t> region{seed};
    taken_[seed] = true;
    for (std::size_t next = 0; next < region.size(); ++next) {
      const HullTriangle& t = triangles_[region[next]];
      for (std::size_t k = 0; k < 3; ++k) {
        const auto found = owner_.find({t.v[(k + 1) % 3], t.v[k]});
        if (found == owner_.end() || taken_[found->second]) continue;
        if (!coplanar(triangles_[seed], triangles_[found->second])) continue;
        taken_[found->second] = true;
        region.push_back(found->second);
      }
    }
    return region;
  }

  void add_face(const std::vector<std::size_t>& region) {
    const std::vector<int> loop = outline(region);
    Vec3<double> twice = Vec3<double>::zero();
    for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
      twice += cross(vertex(loop[i]) - vertex(loop[0]), vertex(loop[i + 1]) - vertex(loop[0]));
    }
    const bool sliver = norm(twice) < square(1e-3 * tolerance_);
    const Vec3<double> normal = sliver ? triangles_[region[0]].normal : unit(twice);
    double offset = -std::numeric_limits<double>::infinity();
    for (const auto& p : hull_.vertices) offset = std::max(offset, dot(normal, p));
    for (const std::size_t i : region) {
      for (const int v : triangles_[i].v) {
        faces_of_[static_cast<std::size_t>(v)].insert(static_cast<int>(hull_.planes.size()));
      }
    }
    hull_.planes.push_back({normal, offset});
    hull_.faces.append(loop);
  }

  /// The outline of a region, which has no holes because the hull is convex; should rounding tear one, the outline of
  /// its first triangle.
  [[nodiscard]] std::vector<int> outline(const std::vector<std::size_t>& region) const {
    std::set<Edge> edges;
    for (const std::size_t i : region) {
      for (std::size_t k = 0; k < 3; ++k) edges.insert({triangles_[i].v[k], triangles_[i].v[(k + 1) % 3]});
    }
    std::map<int, int> next;
    for (const Edge& e : edges) {
      if (!edges.contains({e.second, e.first})) next[e.first] = e.second;
    }
    std::vector<int> loop;
    for (auto step = next.begin(); step != next.end() && loop.size() < next.size(); step = next.find(step->second)) {
      loop.push_back(step->first);
      if (step->second == loop.front()) break;
    }
    if (loop.size() == next.size() && loop.size() >= 3) return loop;
    const auto& t = triangles_[region[0]].v;
    return {t.begin(), t.end()};
  }

  [[nodiscard]] const Vec3<double>& vertex(int i) const { return hull_.vertices[static_cast<std::size_t>(i)]; }

  ConvexPolyhedron& hull_;
  const std::vector<HullTriangle>& triangles_;
  double tolerance_;
  std::vector<bool> taken_;
  std::map<Edge, std::size_t> owner_{};
  std::vector<std::set<int>> faces_of_ = std::vector<std::set<int>>(hull_.vertices.size());
};

void connect(const std::vector<HullTriangle>& triangles, ConvexPolyhedron& hull) {
  std::vector<std::set<int>> neighbours(hull.vertices.size());
  for (const HullTriangle& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      neighbours[static_cast<std::size_t>(t.v[k])].insert({t.v[(k + 1) % 3], t.v[(k + 2) % 3]});
    }
  }
  for (const std::set<int>& list : neighbours) hull.neighbours.append(std::vector<int>(list.begin(), list.end()));
}

void measure(const std::vector<HullTriangle>& triangles, ConvexPolyhedron& hull) {
  const Vec3<double> o = hull.vertices[0];
  Vec3<double> moment = Vec3<double>::zero();
  for (const HullTriangle& t : triangles) {
    const auto at = [&](std::size_t k) { return hull.vertices[static_cast<std::size_t>(t.v[k])] - o; };
    const double volume = dot(at(0), cross(at(1), at(2))) / 6;
    hull.volume += volume;
    moment += (0.25 * volume) * (at(0) + at(1) + at(2));
  }
  hull.centre = o + (1 / hull.volume) * moment;
}

}  // namespace

void IndexLists::append(std::span<const int> list) {
  items.insert(items.end(), list.begin(), list.end());
  start.push_back(static_cast<int>(items.size()));
}

ConvexPolyhedron convex_polyhedron(std::span<const Vec3<double>> points) {
  std::vector<Vec3<double>> cloud = thickened(points);
  std::vector<HullTriangle> triangles = hull_triangles(cloud);
  const Vec3<double> o = cloud[0];
  const double extent = farthest(cloud, [&](const Vec3<double>& p) { return norm(p - o); }).second;
  ConvexPolyhedron hull;
  compact(cloud, triangles, hull);
  FaceMerger(hull, triangles, kCoplanar * extent).merge();
  connect(triangles, hull);
  measure(triangles, hull);
  hull.support = support_table(hull);
  return hull;
}

ConvexPolyhedron convex_polyhedron(std::span<const Vec3<float>> points) {
  std::vector<Vec3<double>> cloud;
  cloud.reserve(points.size());
  for (const auto& p : points) cloud.push_back(broadcast<double>(p));
  return convex_polyhedron(std::span<const Vec3<double>>(cloud));
}

}  // namespace manyhands
