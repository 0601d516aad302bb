#include "manyhands/physics/collision/queries/distance.h"

#include <algorithm>

#include "manyhands/physics/collision/surface/collide_surface.h"
#include "manyhands/physics/collision/surface/height_grid.h"

namespace manyhands {
namespace {

using Vec = Vec3<double>;
using Pose = Transform<double>;
using Distance = ShapeDistance<double>;

constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr Distance kNothing{kFar, {}, {}, {0, 0, 1}};

Distance swapped(const Distance& d) { return {d.phi, d.p_B, d.p_A, -d.normal_AB}; }

Distance moved(const Pose& X, const Distance& d) { return {d.phi, X * d.p_A, X * d.p_B, X.R * d.normal_AB}; }

/// Keeps the smaller distance of a triangle and a shape; all in the surface's frame, which is A's.
void try_triangle(const SurfaceTriangle& t, const ConvexShape& shape, const Pose& X_MS, Distance& best) {
  const ConvexShape face = ConvexShape::triangle(t.corner[0], t.corner[1], t.corner[2]);
  const Distance d = core_distance(face, shape, X_MS, max(best.phi, 0.0));
  if (d.phi < best.phi) best = d;
}

void try_mesh(const TriangleMesh& mesh, const ConvexShape& shape, const Pose& X_MS, Distance& best) {
  const Bounds box = shape_bounds(shape, X_MS);
  const auto try_one = [&](std::size_t i) {
    const SurfaceTriangle& t = mesh.triangle(i);
    if (t.bounds().distance(box) <= max(best.phi, 0.0)) try_triangle(t, shape, X_MS, best);
  };
  // What is found near by bounds the search.
  mesh.visit_best_leaf([&](const Bounds& b) { return norm(0.5 * (b.low + b.high) - X_MS.p); }, try_one);
  mesh.visit([&](const Bounds& b) { return b.distance(box) <= max(best.phi, 0.0); }, try_one);
}

void try_field(const HeightField& field, const ConvexShape& shape, const Pose& X_MS, Distance& best) {
  std::array<Manifold<double>, 1> touching;
  if (collide_height_field<double>(shape, X_MS, field, Pose::identity(), 0.0, touching) > 0) {
    const Manifold<double>& m = touching[0];
    const auto k = static_cast<std::size_t>(std::min_element(m.phi.begin(), m.phi.end()) - m.phi.begin());
    if (m.phi[k] >= best.phi) return;
    const Vec up = -m.normal;
    best = {m.phi[k], fma(-0.5 * m.phi[k], up, m.p[k]), fma(0.5 * m.phi[k], up, m.p[k]), up};
    return;
  }
  const HeightGrid grid(field);
  Bounds box = shape_bounds(shape, X_MS);
  const auto try_cells = [&](const HeightGrid::Cells& cells) {
    for (int j = cells.j0; j < cells.j1; ++j) {
      for (int i = cells.i0; i < cells.i1; ++i) {
        Bounds cell;
        cell.include(grid.vertex(i, j));
        cell.include(grid.vertex(i + 1, j + 1));
        cell.low.z = grid.lowest(i, j);
        cell.high.z = grid.highest(i, j);
        if (cell.distance(box) > max(best.phi, 0.0)) continue;
        for (const int half : {0, 1}) try_triangle(grid.triangle(i, j, half), shape, X_MS, best);
      }
    }
  };
  // The cell nearest to the shape bounds the search.
  const Vec low = grid.vertex(0, 0), high = grid.vertex(grid.columns() - 2, grid.rows() - 2);
  Bounds under;
  under.include({clamp(X_MS.p.x, low.x, high.x), clamp(X_MS.p.y, low.y, high.y), 0});
  try_cells(grid.cells(under));
  if (!is_finite(best.phi)) return try_cells({0, grid.columns() - 1, 0, grid.rows() - 1});
  box.grow(max(best.phi, 0.0));
  const HeightGrid::Cells near = grid.cells(box);
  box.grow(-max(best.phi, 0.0));
  try_cells(near);
}

/// From the plane z = 0 to a shape, by the lowest of its points.
template <class Points>
Distance above_plane(const Points& points) {
  Distance best = kNothing;
  points([&](const Vec& p) {
    if (p.z < best.phi) best = {p.z, {p.x, p.y, 0}, p, {0, 0, 1}};
  });
  return best;
}

void for_vertices(const HeightField& field, auto&& f) {
  const HeightGrid grid(field);
  for (int j = 0; j < grid.rows(); ++j) {
    for (int i = 0; i < grid.columns(); ++i) f(grid.vertex(i, j));
  }
}

/// Calls f(triangle as a shape) for each triangle of a mesh or a height field.
void for_triangles(const ShapeView& surface, auto&& f) {
  const auto call = [&](const SurfaceTriangle& t) { f(ConvexShape::triangle(t.corner[0], t.corner[1], t.corner[2])); };
  if (surface.mesh) {
    for (std::size_t i = 0; i < surface.mesh->size(); ++i) call(surface.mesh->triangle(i));
    return;
  }
  const HeightGrid grid(*surface.field);
  for (int j = 0; j + 1 < grid.rows(); ++j) {
    for (int i = 0; i + 1 < grid.columns(); ++i) {
      for (const int half : {0, 1}) call(grid.triangle(i, j, half));
    }
  }
}

Distance from_plane(const ShapeView& b, const Pose& X_PB) {
  const Vec down = -transpose_times(X_PB.R, Vec{0, 0, 1});
  switch (b.type) {
    case ShapeType::kPlane: {
      const double gap = X_PB.p.z;
      if (X_PB.R.z.z > -1 + 1e-12) return {-kFar, Vec::zero(), X_PB.p, {0, 0, 1}};
      return {gap, {X_PB.p.x, X_PB.p.y, 0}, X_PB.p, {0, 0, 1}};
    }
    case ShapeType::kMesh:
      return above_plane([&](auto&& f) {
        for (const Vec& p : b.mesh->vertices()) f(X_PB * p);
      });
    case ShapeType::kHeightField:
      return above_plane([&](auto&& f) { for_vertices(*b.field, [&](const Vec& p) { f(X_PB * p); }); });
    default: {
      const ConvexShape shape = b.convex();
      Vec p = X_PB * shape.support(down);
      p.z -= shape.radius;
      return above_plane([&](auto&& f) { f(p); });
    }
  }
}

/// From a mesh or a height field A to B.
Distance from_surface(const ShapeView& a, const ShapeView& b, const Pose& X_AB) {
  Distance best = kNothing;
  const auto take = [&](const ConvexShape& shape) {
    if (a.mesh) {
      try_mesh(*a.mesh, shape, X_AB, best);
    } else {
      try_field(*a.field, shape, X_AB, best);
    }
  };
  if (b.is_convex_body()) {
    take(b.convex());
  } else {
    for_triangles(b, take);
  }
  return best;
}

/// In A's frame.
Distance between(const ShapeView& a, const ShapeView& b, const Pose& X_AB) {
  if (a.is_convex_body() && b.is_convex_body()) return core_distance(a.convex(), b.convex(), X_AB, kFar);
  if (a.type == ShapeType::kPlane) return from_plane(b, X_AB);
  if (b.type == ShapeType::kPlane) return moved(X_AB, swapped(from_plane(a, inverse(X_AB))));
  // Of a mesh and a field, the field's solid ground decides.
  const bool a_first = !a.is_convex_body() && (b.is_convex_body() || a.type == ShapeType::kHeightField);
  if (a_first) return from_surface(a, b, X_AB);
  return moved(X_AB, swapped(from_surface(b, a, inverse(X_AB))));
}

}  // namespace

template <Real R>
ShapeDistance<R> signed_distance(const ShapeView& a, const Transform<R>& X_WA, const ShapeView& b,
                                 const Transform<R>& X_WB) {
  const Pose X_A = broadcast<double>(X_WA), X_B = broadcast<double>(X_WB);
  const Distance d = moved(X_A, between(a, b, inverse(X_A) * X_B));
  return {static_cast<R>(d.phi), broadcast<R>(d.p_A), broadcast<R>(d.p_B), broadcast<R>(d.normal_AB)};
}

#define MANYHANDS_INSTANTIATE(R)                                                                     \
  template ShapeDistance<R> signed_distance(const ShapeView&, const Transform<R>&, const ShapeView&, \
                                            const Transform<R>&);
MANYHANDS_INSTANTIATE(double)
MANYHANDS_INSTANTIATE(float)
#undef MANYHANDS_INSTANTIATE

}  // namespace manyhands
