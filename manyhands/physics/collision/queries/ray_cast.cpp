#include "manyhands/physics/collision/queries/ray_cast.h"

#include <algorithm>
#include <cmath>

#include "manyhands/physics/collision/surface/height_grid.h"

namespace manyhands {
namespace {

using Vec = Vec3<double>;
using Hit = std::optional<RayHit<double>>;

constexpr double kFar = std::numeric_limits<double>::infinity();

struct Ray {
  Vec o, d;
  double far;
  [[nodiscard]] Vec at(double t) const { return fma(t, d, o); }
};

/// The part of a ray inside a convex solid, cut down by one surface after the other.
struct Inside {
  double enter = -kFar, leave = kFar;
  Vec normal{};  // where it enters

  /// Inside normal . x <= offset.
  void half_space(const Ray& ray, const Vec& n, double offset) {
    const double speed = dot(n, ray.d), gap = offset - dot(n, ray.o);
    if (speed == 0) {
      if (gap < 0) leave = -kFar;
    } else if (speed < 0) {
      if (const double t = gap / speed; t > enter) enter = t, normal = n;
    } else {
      leave = min(leave, gap / speed);
    }
  }
  void slab(const Ray& ray, const Vec& n, double half) {
    half_space(ray, n, half);
    half_space(ray, -n, half);
  }
  /// Inside a ball about c, or where `ball` is false, inside a round pillar along z.
  void round(const Ray& ray, const Vec& c, double r, bool ball) {
    Vec o = ray.o - c, d = ray.d;
    if (!ball) o.z = d.z = 0;
    const double a = dot(d, d), b = dot(o, d);
    if (a < 1e-30) {
      if (dot(o, o) > r * r) leave = -kFar;
      return;
    }
    // The nearest point of the line to the axis keeps the digits of distant origins.
    const Vec nearest = o - (b / a) * d;
    const double rest = r * r - dot(nearest, nearest);
    if (rest < 0) {
      leave = -kFar;
      return;
    }
    const double half = std::sqrt(rest / a), t = -b / a - half;
    if (t > enter) enter = t, normal = (1 / r) * (o + t * d);
    leave = min(leave, -b / a + half);
  }
  [[nodiscard]] Hit hit(const Ray& ray) const {
    if (enter > leave || leave < 0 || enter > ray.far) return {};
    if (enter < 0) return RayHit<double>{0, -ray.d};
    return RayHit<double>{enter, normal};
  }
};

Hit nearer(const Hit& a, const Hit& b) {
  if (!a || !b) return a ? a : b;
  return a->distance <= b->distance ? a : b;
}

Hit cast_capsule(const Ray& ray, double r, double half) {
  Hit best;
  Inside side;
  side.round(ray, Vec::zero(), r, false);
  side.slab(ray, {0, 0, 1}, half);
  best = side.hit(ray);
  for (const double z : {-half, half}) {
    Inside end;
    end.round(ray, {0, 0, z}, r, true);
    best = nearer(best, end.hit(ray));
  }
  return best;
}

/// Both sides of a triangle (Moeller and Trumbore, 1997); a hair beyond its edges, that no ray slips between two.
Hit cast_triangle(const Ray& ray, const SurfaceTriangle& t) {
  const Vec u = t.corner[1] - t.corner[0], v = t.corner[2] - t.corner[0];
  const Vec p = cross(ray.d, v), s = ray.o - t.corner[0];
  const double det = dot(u, p);
  if (det == 0) return {};
  const double a = dot(s, p) / det;
  const Vec q = cross(s, u);
  const double b = dot(ray.d, q) / det, at = dot(v, q) / det;
  constexpr double kHair = 1e-12;
  if (!(a >= -kHair && b >= -kHair && a + b <= 1 + kHair && at >= 0 && at <= ray.far)) return {};
  return RayHit<double>{at, dot(t.normal, ray.d) > 0 ? -t.normal : t.normal};
}

Vec reciprocal(const Vec& d) {
  const auto one = [](double x) { return std::abs(x) > 1e-300 ? 1 / x : std::copysign(1e300, x); };
  return {one(d.x), one(d.y), one(d.z)};
}

Hit cast_mesh(const Ray& ray, const TriangleMesh& mesh) {
  const Vec inverse = reciprocal(ray.d);
  Ray rest = ray;
  Hit best;
  mesh.visit([&](const Bounds& b) { return is_finite(b.entry(ray.o, inverse, rest.far * (1 + 1e-12))); },
             [&](std::size_t i) {
               if (const Hit hit = cast_triangle(rest, mesh.triangle(i))) {
                 best = hit;
                 rest.far = hit->distance;
               }
             });
  return best;
}

/// Whether the point lies in the ground.
bool is_below(const HeightGrid& grid, const Vec& p, double dx, double dy) {
  const double x = p.x / dx + 0.5 * (grid.columns() - 1), y = p.y / dy + 0.5 * (grid.rows() - 1);
  if (!(x >= 0 && y >= 0 && x <= grid.columns() - 1 && y <= grid.rows() - 1)) return false;
  const int i = std::min(static_cast<int>(x), grid.columns() - 2), j = std::min(static_cast<int>(y), grid.rows() - 2);
  const SurfaceTriangle t = grid.triangle(i, j, x - i >= y - j ? 0 : 1);
  return dot(t.normal, p - t.corner[0]) < 0;
}

/// Walks from cell to cell below the ray (Amanatides and Woo, A Fast Voxel Traversal Algorithm for Ray Tracing, 1987).
Hit cast_height_field(const Ray& ray, const HeightField& field) {
  const HeightGrid grid(field);
  if (is_below(grid, ray.o, field.dx, field.dy)) return RayHit<double>{0, -ray.d};
  const Vec low = grid.vertex(0, 0), high = grid.vertex(grid.columns() - 1, grid.rows() - 1);
  Inside box;
  box.half_space(ray, {1, 0, 0}, high.x);
  box.half_space(ray, {-1, 0, 0}, -low.x);
  box.half_space(ray, {0, 1, 0}, high.y);
  box.half_space(ray, {0, -1, 0}, -low.y);
  const double start = max(0.0, box.enter), end = min(ray.far, box.leave);
  if (start > end) return {};

  const auto walk = [](double at, double speed, double spacing, int vertices, int& cell, double& next, double& every) {
    const double x = at / spacing + 0.5 * (vertices - 1);
    cell = static_cast<int>(clamp(std::floor(x), 0.0, static_cast<double>(vertices - 2)));
    every = speed != 0 ? spacing / std::abs(speed) : kFar;
    const double left = speed > 0 ? cell + 1 - x : x - cell;
    next = speed != 0 ? max(0.0, left) * every : kFar;
    return speed > 0 ? 1 : -1;
  };
  const Vec first = ray.at(start);
  int i = 0, j = 0;
  double next_i = 0, next_j = 0, every_i = 0, every_j = 0;
  const int step_i = walk(first.x, ray.d.x, field.dx, grid.columns(), i, next_i, every_i);
  const int step_j = walk(first.y, ray.d.y, field.dy, grid.rows(), j, next_j, every_j);
  double from = 0;
  while (i >= 0 && j >= 0 && i + 1 < grid.columns() && j + 1 < grid.rows() && start + from <= end) {
    const double to = min(next_i, next_j);
    const double z = min(first.z + from * ray.d.z, first.z + min(to, end - start) * ray.d.z);
    if (z <= grid.highest(i, j) + 1e-9 * (1 + std::abs(z))) {
      const Hit hit = nearer(cast_triangle(ray, grid.triangle(i, j, 0)), cast_triangle(ray, grid.triangle(i, j, 1)));
      if (hit) return hit;
    }
    from = to;
    if (next_i <= next_j) {
      i += step_i;
      next_i += every_i;
    } else {
      j += step_j;
      next_j += every_j;
    }
  }
  return {};
}

Hit cast(const ShapeView& shape, const Ray& ray) {
  Inside inside;
  const Vec& size = shape.size;
  switch (shape.type) {
    case ShapeType::kSphere:
      inside.round(ray, Vec::zero(), size.x, true);
      break;
    case ShapeType::kCapsule:
      return cast_capsule(ray, size.x, size.y);
    case ShapeType::kCylinder:
      inside.round(ray, Vec::zero(), size.x, false);
      inside.slab(ray, {0, 0, 1}, size.y);
      break;
    case ShapeType::kBox:
      inside.slab(ray, {1, 0, 0}, size.x);
      inside.slab(ray, {0, 1, 0}, size.y);
      inside.slab(ray, {0, 0, 1}, size.z);
      break;
    case ShapeType::kPlane:
      inside.half_space(ray, {0, 0, 1}, 0);
      break;
    case ShapeType::kConvex:
      for (const FacePlane& plane : shape.hull->planes) inside.half_space(ray, plane.normal, plane.offset);
      break;
    case ShapeType::kMesh:
      return cast_mesh(ray, *shape.mesh);
    case ShapeType::kHeightField:
      return cast_height_field(ray, *shape.field);
  }
  return inside.hit(ray);
}

}  // namespace

template <Real R>
std::optional<RayHit<R>> ray_cast(const ShapeView& shape, const Transform<R>& X_WG, const Vec3<R>& origin,
                                  const Vec3<R>& direction, R far) {
  const Transform<double> X = broadcast<double>(X_WG);
  const Ray ray{transpose_times(X.R, broadcast<double>(origin) - X.p),
                transpose_times(X.R, broadcast<double>(direction)), static_cast<double>(far)};
  const Hit hit = cast(shape, ray);
  if (!hit) return {};
  return RayHit<R>{static_cast<R>(hit->distance), broadcast<R>(X.R * hit->normal)};
}

#define MANYHANDS_INSTANTIATE(R) \
  template std::optional<RayHit<R>> ray_cast(const ShapeView&, const Transform<R>&, const Vec3<R>&, const Vec3<R>&, R);
MANYHANDS_INSTANTIATE(double)
MANYHANDS_INSTANTIATE(float)
#undef MANYHANDS_INSTANTIATE

}  // namespace manyhands
