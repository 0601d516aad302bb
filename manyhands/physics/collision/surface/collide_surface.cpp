#include "manyhands/physics/collision/surface/collide_surface.h"

#include <algorithm>

#include "manyhands/physics/collision/general/manifold_points.h"
#include "manyhands/physics/collision/surface/height_grid.h"

namespace manyhands {
namespace {

using Vec = Vec3<double>;

constexpr double kSameNormal = 0.999;  // cosine: 2.6 degrees

/// Contact points sorted by normal, in fixed memory.
class ManifoldSet {
 public:
  explicit ManifoldSet(double scale) : apart_(1e-4 * scale) {}

  void add(const Manifold<double>& m) {
    const double depth = *std::min_element(m.phi.begin(), m.phi.end());
    if (!is_finite(depth)) return;
    for (std::size_t i = 0; i < size_; ++i) {
      if (dot(groups_[i].normal, m.normal) > kSameNormal) return merge(groups_[i], m, depth);
    }
    if (size_ < groups_.size()) return merge(groups_[size_++] = {}, m, depth);
    Group& shallowest = *std::max_element(groups_.begin(), groups_.end(), deeper);
    if (depth < shallowest.depth) merge(shallowest = {}, m, depth);
  }

  /// The deepest manifolds first.
  template <Real R>
  int write(const Transform<double>& X_W, std::span<Manifold<R>> out) {
    std::stable_sort(groups_.begin(), groups_.begin() + static_cast<std::ptrdiff_t>(size_), deeper);
    const std::size_t n = std::min(size_, out.size());
    for (std::size_t i = 0; i < n; ++i) {
      out[i] = posed<R>(X_W, choose_points(groups_[i].points.all(), groups_[i].normal));
    }
    return static_cast<int>(n);
  }

 private:
  struct Group {
    Vec normal{};
    double depth = std::numeric_limits<double>::infinity();  // phi of the deepest point, whose normal it is
    ManifoldPoints points{};
  };
  static bool deeper(const Group& a, const Group& b) { return a.depth < b.depth; }

  void merge(Group& into, const Manifold<double>& m, double depth) const {
    if (depth < into.depth) {
      into.depth = depth;
      into.normal = m.normal;
    }
    for (std::size_t k = 0; k < kManifoldPoints; ++k) {
      if (is_finite(m.phi[k])) add_point(into, {m.p[k], m.phi[k]});
    }
  }

  void add_point(Group& group, const ManifoldPoint& point) const {
    ManifoldPoints& points = group.points;
    for (std::size_t i = 0; i < points.size; ++i) {
      if (norm(points.point[i].p - point.p) > apart_) continue;
      if (point.phi < points.point[i].phi) points.point[i] = point;
      return;
    }
    if (points.size == points.point.size()) {
      const Manifold<double> chosen = choose_points(points.all(), group.normal);
      points.size = 0;
      for (std::size_t k = 0; k < kManifoldPoints; ++k) {
        if (is_finite(chosen.phi[k])) points.add({chosen.p[k], chosen.phi[k]});
      }
    }
    points.add(point);
  }

  std::array<Group, 8> groups_{};
  std::size_t size_ = 0;
  double apart_;
};

/// Which corners of a triangle lie farthest along m: a face (7), an edge (two bits) or a vertex (one).
unsigned supporting_corners(const SurfaceTriangle& t, const Vec& m) {
  const std::array<double, 3> h{dot(m, t.corner[0]), dot(m, t.corner[1]), dot(m, t.corner[2])};
  const double top = max(h[0], max(h[1], h[2]));
  const double size = norm(t.corner[1] - t.corner[0]) + norm(t.corner[2] - t.corner[0]);
  unsigned corners = 0;
  for (unsigned k = 0; k < 3; ++k) {
    if (top - h[k] <= 1e-5 * size) corners |= 1u << k;
  }
  return corners;
}

/// One triangle against the shape: all in the surface's frame.
class TriangleContact {
 public:
  TriangleContact(const ConvexShape& shape, const Transform<double>& X_MS, double margin, bool solid)
      : shape_(shape), X_MS_(X_MS), margin_(margin), solid_(solid) {}

  /// `is_summit(k, m)`: whether m is in the normal cone of corner k. The normal of the result points to the shape.
  template <class IsSummit>
  [[nodiscard]] Manifold<double> operator()(const SurfaceTriangle& t, IsSummit&& is_summit) const {
    const ConvexShape face = ConvexShape::triangle(t.corner[0], t.corner[1], t.corner[2]);
    const ShapeDistance<double> d = core_distance(face, shape_, X_MS_, margin_);
    const Vec m = d.normal_AB;
    const double facing = dot(m, t.normal);
    if (facing < -1e-6) return solid_ ? raised(face, t.normal) : Manifold<double>{};
    if (d.phi > margin_) return {};
    const unsigned corners = supporting_corners(t, m);
    if (corners == 7u || belongs(t, corners, m, is_summit)) {
      return contact_manifold(face, shape_, X_MS_, d, margin_, false);
    }
    return nearest_normal_is_own(t, corners, m) ? upon(face, t.normal) : Manifold<double>{};
  }

 private:
  /// Whether a normal m at an edge or a vertex is one that the surface has there.
  template <class IsSummit>
  [[nodiscard]] static bool belongs(const SurfaceTriangle& t, unsigned corners, const Vec& m, IsSummit&& is_summit) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      if (corners == (1u << k)) return is_summit(k, m);
      if (corners != ((1u << k) | (1u << next))) continue;
      // In the plane of the triangle across the edge, m must lead away from that triangle.
      const Vec edge = t.corner[next] - t.corner[k];
      return dot(m, cross(t.beside[k], edge)) >= -1e-4 * norm(edge);
    }
    return false;
  }

  /// Whether the triangle's normal, rather than that of one across an edge m stands on, is the nearest to m, or as
  /// good as.
  [[nodiscard]] static bool nearest_normal_is_own(const SurfaceTriangle& t, unsigned corners, const Vec& m) {
    Vec nearest = t.normal;
    for (std::size_t k = 0; k < 3; ++k) {
      const unsigned edge = (1u << k) | (1u << ((k + 1) % 3));
      if ((corners & edge) != 0 && dot(t.beside[k], m) > dot(nearest, m)) nearest = t.beside[k];
    }
    return dot(nearest, t.normal) > 0.99;
  }

  /// The contact along the triangle's normal where the shape's supporting feature is above or below the triangle.
  [[nodiscard]] Manifold<double> upon(const ConvexShape& face, const Vec& normal) const {
    const Vec low = lowest(normal);
    const double phi = dot(normal, low - face.corners[0]);
    if (phi > margin_) return {};
    return contact_manifold(face, shape_, X_MS_, {phi, low - phi * normal, low, normal}, margin_, true);
  }

  /// The contact of a shape below a triangle of solid ground. Deep down, no triangle may lie along its own normal from
  /// the shape: then that counts which is straight above the shape's middle.
  [[nodiscard]] Manifold<double> raised(const ConvexShape& face, const Vec& normal) const {
    Manifold<double> m = upon(face, normal);
    if (is_finite(m.phi[0]) || !is_below(face.corners, X_MS_ * shape_.centre())) return m;
    const Vec low = lowest(normal);
    const double phi = dot(normal, low - face.corners[0]);
    m.normal = normal;
    m.set(0, low - phi * normal, phi);
    return m;
  }

  /// Whether the triangle covers the point, seen along z.
  [[nodiscard]] static bool is_below(const std::array<Vec, 3>& corners, const Vec& p) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec a = corners[k], edge = corners[(k + 1) % 3] - a;
      if (edge.x * (p.y - a.y) - edge.y * (p.x - a.x) < 0) return false;
    }
    return true;
  }

  /// The point of the shape that is farthest against the normal.
  [[nodiscard]] Vec lowest(const Vec& normal) const {
    return X_MS_ * shape_.support(-transpose_times(X_MS_.R, normal)) - shape_.radius * normal;
  }

  const ConvexShape& shape_;
  const Transform<double>& X_MS_;
  double margin_;
  bool solid_;
};

template <Real R>
struct Posed {
  Transform<double> X_WM;  // the surface
  Transform<double> X_MS;  // the shape on it
  Posed(const Transform<R>& X_WS, const Transform<R>& X_WM_)
      : X_WM(broadcast<double>(X_WM_)), X_MS(inverse(X_WM) * broadcast<double>(X_WS)) {}
};

}  // namespace

Bounds shape_bounds(const ConvexShape& a, const Transform<double>& X_BA) {
  const Mat3<double> R_AB = transpose(X_BA.R);
  const auto reach = [&](const Vec& d) { return dot(d, a.support(d)); };
  Bounds box;
  box.low = {-reach(-R_AB.x), -reach(-R_AB.y), -reach(-R_AB.z)};
  box.high = {reach(R_AB.x), reach(R_AB.y), reach(R_AB.z)};
  box.low = box.low + X_BA.p;
  box.high = box.high + X_BA.p;
  box.grow(a.radius);
  return box;
}

template <Real R>
Manifold<R> collide_plane(const ConvexShape& a, const Transform<R>& X_WA, const Transform<R>& X_WP, R margin) {
  const Posed<R> pose(X_WA, X_WP);
  const Vec up{0, 0, 1};
  SupportingFeature f = supporting_feature(a, -transpose_times(pose.X_MS.R, up));
  const Vec lowest = pose.X_MS * a.support(-transpose_times(pose.X_MS.R, up));
  const auto far = static_cast<double>(margin);
  ManifoldPoints points;
  const auto add = [&](const Vec& p) {
    const double phi = p.z - a.radius;
    if (phi <= far) points.add({{p.x, p.y, 0.5 * phi}, phi});
  };
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < f.size; ++i) {
    const Vec p = pose.X_MS * f.corner[i];
    least = min(least, p.z);
    add(p);
  }
  if (least > lowest.z + 1e-6 * a.bound()) add(lowest);
  return posed<R>(pose.X_WM, choose_points(points.all(), -up));
}

template <Real R>
int collide_mesh(const ConvexShape& a, const Transform<R>& X_WA, const TriangleMesh& mesh, const Transform<R>& X_WB,
                 R margin, std::span<Manifold<R>> out) {
  const Posed<R> pose(X_WA, X_WB);
  const auto far = static_cast<double>(margin);
  Bounds box = shape_bounds(a, pose.X_MS);
  box.grow(far);
  const TriangleContact contact(a, pose.X_MS, far, false);
  ManifoldSet set(a.bound());
  mesh.visit([&](const Bounds& b) { return b.meets(box); },
             [&](std::size_t i) {
               if (!mesh.triangle(i).bounds().meets(box)) return;
               set.add(swapped(
                   contact(mesh.triangle(i), [&](std::size_t k, const Vec& m) { return mesh.is_summit(i, k, m); })));
             });
  return set.write(pose.X_WM, out);
}

template <Real R>
int collide_height_field(const ConvexShape& a, const Transform<R>& X_WA, const HeightField& field,
                         const Transform<R>& X_WB, R margin, std::span<Manifold<R>> out) {
  const Posed<R> pose(X_WA, X_WB);
  const auto far = static_cast<double>(margin);
  Bounds box = shape_bounds(a, pose.X_MS);
  box.grow(far);
  const TriangleContact contact(a, pose.X_MS, far, true);
  const HeightGrid grid(field);
  const HeightGrid::Cells cells = grid.cells(box);
  ManifoldSet set(a.bound());
  for (int j = cells.j0; j < cells.j1; ++j) {
    for (int i = cells.i0; i < cells.i1; ++i) {
      if (grid.highest(i, j) < box.low.z) continue;
      for (const int half : {0, 1}) {
        set.add(swapped(contact(grid.triangle(i, j, half),
                                [&](std::size_t k, const Vec& m) { return grid.is_summit(i, j, half, k, m); })));
      }
    }
  }
  return set.write(pose.X_WM, out);
}

#define MANYHANDS_INSTANTIATE(R)                                                                                      \
  template Manifold<R> collide_plane(const ConvexShape&, const Transform<R>&, const Transform<R>&, R);                \
  template int collide_mesh(const ConvexShape&, const Transform<R>&, const TriangleMesh&, const Transform<R>&, R,     \
                            std::span<Manifold<R>>);                                                                  \
  template int collide_height_field(const ConvexShape&, const Transform<R>&, const HeightField&, const Transform<R>&, \
                                    R, std::span<Manifold<R>>);
MANYHANDS_INSTANTIATE(double)
MANYHANDS_INSTANTIATE(float)
#undef MANYHANDS_INSTANTIATE

}  // namespace manyhands
