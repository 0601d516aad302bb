#include "manyhands/physics/collision/surface/triangle_mesh.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "manyhands/model/model.h"

namespace manyhands {
namespace {

using Vec = Vec3<double>;

constexpr int kLeaf = 4;  // triangles

double along(const Vec& a, int axis) { return axis == 0 ? a.x : axis == 1 ? a.y : a.z; }

}  // namespace

double Bounds::entry(const Vec& o, const Vec& reciprocal, double far) const {
  double enter = 0, leave = far;
  const auto slab = [&](double from, double to, double at, double inverse) {
    const double s = (from - at) * inverse, t = (to - at) * inverse;
    enter = max(min(s, t), enter);
    leave = min(max(s, t), leave);
  };
  slab(low.x, high.x, o.x, reciprocal.x);
  slab(low.y, high.y, o.y, reciprocal.y);
  slab(low.z, high.z, o.z, reciprocal.z);
  return enter <= leave ? enter : kFar;
}

TriangleMesh::TriangleMesh(const Mesh& mesh) {
  std::vector<Corners> corners;
  weld(mesh, corners);
  if (corners.empty()) {
    throw ModelError("mesh '" + mesh.source + "': no triangle has an area; give it a surface, or remove the geom");
  }
  build(corners, 0, static_cast<int>(corners.size()));
  connect(corners);
}

void TriangleMesh::weld(const Mesh& mesh, std::vector<Corners>& corners) {
  std::map<std::tuple<float, float, float>, int> places;
  std::vector<int> number;
  for (const auto& p : mesh.vertices) {
    if (!is_finite(p.x + p.y + p.z)) throw ModelError("mesh '" + mesh.source + "': a vertex is not finite; mend it");
    const auto [place, fresh] = places.try_emplace({p.x, p.y, p.z}, static_cast<int>(vertices_.size()));
    if (fresh) vertices_.push_back(broadcast<double>(p));
    number.push_back(place->second);
  }
  for (const Vec& p : vertices_) bound_ = max(bound_, norm(p));
  for (const auto& t : mesh.triangles) {
    Corners c{};
    std::array<Vec, 3> p{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(t[k]);
      if (t[k] < 0 || v >= number.size()) {
        throw ModelError("mesh '" + mesh.source + "': a triangle names vertex " + std::to_string(t[k]) + " of " +
                         std::to_string(number.size()) + "; mend the file");
      }
      c.v[k] = number[v];
      p[k] = vertices_[static_cast<std::size_t>(c.v[k])];
    }
    c.middle = (1.0 / 3) * (p[0] + p[1] + p[2]);
    const Vec u = p[1] - p[0], v = p[2] - p[0];
    if (norm(cross(u, v)) > 1e-12 * norm(u) * norm(v)) corners.push_back(c);
  }
}

/// Appends the tree over corners[first, last), split at the median along the longest side.
void TriangleMesh::build(std::vector<Corners>& corners, int first, int last) {
  const std::size_t n = nodes_.size();
  nodes_.push_back({{}, first, last - first});
  Bounds middles;
  for (int i = first; i < last; ++i) {
    const Corners& c = corners[static_cast<std::size_t>(i)];
    for (const int v : c.v) nodes_[n].bounds.include(vertices_[static_cast<std::size_t>(v)]);
    middles.include(c.middle);
  }
  if (last - first <= kLeaf) return;
  const Vec side = middles.high - middles.low;
  const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
  const int half = first + (last - first) / 2;
  std::nth_element(corners.begin() + first, corners.begin() + half, corners.begin() + last,
                   [&](const Corners& a, const Corners& b) {
                     return std::tuple(along(a.middle, axis), a.v) < std::tuple(along(b.middle, axis), b.v);
                   });
  nodes_[n].count = 0;
  build(corners, first, half);
  nodes_[n].first = static_cast<int>(nodes_.size());
  build(corners, half, last);
}

void TriangleMesh::connect(const std::vector<Corners>& corners) {
  std::map<std::pair<int, int>, std::size_t> owner;
  std::vector<std::set<int>> ring(vertices_.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto& v = corners[i].v;
    SurfaceTriangle t;
    for (std::size_t k = 0; k < 3; ++k) {
      t.corner[k] = vertices_[static_cast<std::size_t>(v[k])];
      owner[{v[k], v[(k + 1) % 3]}] = i;
      ring[static_cast<std::size_t>(v[k])].insert({v[(k + 1) % 3], v[(k + 2) % 3]});
    }
    const Vec twice = cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0]);
    t.normal = (1 / norm(twice)) * twice;
    triangles_.push_back(t);
    corners_.push_back(v);
  }
  for (std::size_t i = 0; i < corners.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto across = owner.find({corners[i].v[(k + 1) % 3], corners[i].v[k]});
      if (across != owner.end()) triangles_[i].beside[k] = triangles_[across->second].normal;
    }
  }
  for (const auto& list : ring) ring_.append(std::vector<int>(list.begin(), list.end()));
}

bool TriangleMesh::is_summit(std::size_t i, std::size_t k, const Vec& m) const {
  const auto v = static_cast<std::size_t>(corners_[i][k]);
  const auto& others = ring_[v];
  return std::all_of(others.begin(), others.end(), [&](int other) {
    const Vec edge = vertices_[static_cast<std::size_t>(other)] - vertices_[v];
    return dot(edge, m) <= 1e-4 * norm(edge);
  });
}

}  // namespace manyhands
