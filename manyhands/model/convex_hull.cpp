#include "manyhands/model/convex_hull.h"

#include <algorithm>
#include <set>
#include <utility>

namespace manyhands {

namespace {

struct Face {
  std::array<int, 3> corners;
  Vec3<double> normal;  // unit, outwards
  double offset;        // normal . p of its points
};

/// Points join the hull one after the other: the faces that see a point give way to those from their rim to it.
class Hull {
 public:
  explicit Hull(std::span<const Vec3<float>> points) : points_(points) {
    Vec3<double> low = at(0), high = at(0);
    for (int i = 1; i < std::ssize(points_); ++i) {
      const Vec3<double> p = at(i);
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    slack_ = 1e-7 * norm(high - low);
  }

  std::vector<std::array<int, 3>> triangles() {
    if (!start()) return {};
    for (int i = 0; i < std::ssize(points_); ++i) add(i);
    std::vector<std::array<int, 3>> result;
    for (const Face& face : faces_) result.push_back(face.corners);
    return result;
  }

 private:
  [[nodiscard]] Vec3<double> at(int i) const {
    const Vec3<float>& p = points_[static_cast<std::size_t>(i)];
    return {p.x, p.y, p.z};
  }

  template <class Measure>
  [[nodiscard]] int furthest(Measure measure) const {
    int best = 0;
    for (int i = 1; i < std::ssize(points_); ++i) {
      if (measure(at(i)) > measure(at(best))) best = i;
    }
    return best;
  }

  /// A tetrahedron of points far apart; false if there is none.
  bool start() {
    const int a = furthest([](const Vec3<double>& p) { return -p.x; });
    const int b = furthest([&](const Vec3<double>& p) { return norm(p - at(a)); });
    if (!(norm(at(b) - at(a)) > 10 * slack_)) return false;
    const Vec3<double> line = at(b) - at(a);
    const int c = furthest([&](const Vec3<double>& p) { return norm(cross(line, p - at(a))); });
    const Vec3<double> normal = cross(line, at(c) - at(a));
    if (!(norm(normal) > 10 * slack_ * norm(line))) return false;
    const int d = furthest([&](const Vec3<double>& p) { return abs(dot(normal, p - at(a))); });
    const double height = dot(normal, at(d) - at(a));
    if (!(abs(height) > 10 * slack_ * norm(normal))) return false;
    const auto [first, second] = height < 0 ? std::pair{b, c} : std::pair{c, b};
    add_face(a, first, second);
    add_face(a, second, d);
    add_face(second, first, d);
    add_face(first, a, d);
    return true;
  }

  void add_face(int a, int b, int c) {
    const Vec3<double> across = cross(at(b) - at(a), at(c) - at(a));
    const double length = norm(across);
    const Vec3<double> normal = length > 0 ? (1 / length) * across : Vec3<double>::zero();
    faces_.push_back({{a, b, c}, normal, dot(normal, at(a))});
  }

  void add(int i) {
    const Vec3<double> p = at(i);
    const auto hidden = std::partition(faces_.begin(), faces_.end(),
                                       [&](const Face& face) { return dot(face.normal, p) - face.offset <= slack_; });
    if (hidden == faces_.end()) return;
    std::set<std::pair<int, int>> edges;
    for (auto face = hidden; face != faces_.end(); ++face) {
      const auto [a, b, c] = face->corners;
      edges.insert({{a, b}, {b, c}, {c, a}});
    }
    faces_.erase(hidden, faces_.end());
    for (const auto& [from, to] : edges) {
      if (!edges.contains({to, from})) add_face(from, to, i);
    }
  }

  std::span<const Vec3<float>> points_;
  double slack_ = 0;
  std::vector<Face> faces_;
};

}  // namespace

std::vector<std::array<int, 3>> convex_hull(std::span<const Vec3<float>> points) {
  if (points.size() < 4) return {};
  return Hull(points).triangles();
}

}  // namespace manyhands
