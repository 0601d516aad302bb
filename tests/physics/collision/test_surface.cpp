#include <gtest/gtest.h>

#include <algorithm>

#include "manyhands/model/model.h"
#include "manyhands/physics/collision/surface/collide_surface.h"
#include "tests/physics/collision/surface_testing.h"

namespace manyhands {
namespace {

using testing::Point;
using testing::ShapeSource;

const Transform<double> kHere = Transform<double>::identity();

double deepest(const Manifold<double>& m) { return *std::min_element(m.phi.begin(), m.phi.end()); }

/// A shape standing upright on z = 0 but for `depth`, somewhere and turned somehow about z.
Transform<double> standing(ShapeSource& source, double half_height, double depth) {
  return {to_matrix(quat_from_rotation_vector(Point{0, 0, source.uniform(-3, 3)})),
          {source.uniform(-0.5, 0.5), source.uniform(-0.5, 0.5), half_height - depth}};
}

struct Standing {
  ConvexShape shape;
  double half_height;
  double breadth;  // of the base
};

const std::array<Standing, 4> kStanding{{{ConvexShape::sphere(0.1), 0.1, 0},
                                         {ConvexShape::capsule(0.05, 0.1), 0.15, 0},
                                         {ConvexShape::box({0.1, 0.2, 0.05}), 0.05, 0.2},
                                         {ConvexShape::cylinder(0.1, 0.2), 0.2, 0.14}}};

/// One manifold, straight down, as deep as the shape is in the plane z = 0, with points under the whole base.
void expect_flat(const Standing& s, const Transform<double>& X, double depth, std::span<const Manifold<double>> found) {
  ASSERT_EQ(found.size(), 1u);
  const Manifold<double>& m = found[0];
  EXPECT_NEAR(m.normal.z, -1, 1e-9);
  EXPECT_NEAR(deepest(m), -depth, 1e-9);
  double low = 1e9, high = -1e9;
  for (std::size_t k = 0; k < kManifoldPoints; ++k) {
    if (!is_finite(m.phi[k])) continue;
    EXPECT_NEAR(m.phi[k], -depth, 1e-9);
    const double x = dot(m.p[k] - X.p, X.R.x);
    low = std::min(low, x), high = std::max(high, x);
  }
  EXPECT_GE(high - low, 0.99 * s.breadth);
}

TEST(CollideMesh, FlatGroundHasNoSeams) {
  ShapeSource source(5);
  for (const int n : {4, 13, 40}) {
    const TriangleMesh mesh(testing::flat_ground(n, source));
    for (int i = 0; i < 200; ++i) {
      for (const Standing& s : kStanding) {
        SCOPED_TRACE(::testing::Message() << "n " << n << " i " << i << " half height " << s.half_height);
        const double depth = source.uniform(-0.004, 0.01);
        const Transform<double> X = standing(source, s.half_height, depth);
        std::array<Manifold<double>, 4> out;
        const int count = collide_mesh<double>(s.shape, X, mesh, kHere, 0.005, out);
        expect_flat(s, X, depth, {out.data(), static_cast<std::size_t>(count)});
        if (HasFailure()) return;
      }
    }
  }
}

TEST(CollideHeightField, FlatGroundHasNoSeamsAndIsSolid) {
  ShapeSource source(5);
  const HeightField field = testing::rough_ground(24, 48, 0, source);
  for (int i = 0; i < 300; ++i) {
    for (const Standing& s : kStanding) {
      SCOPED_TRACE(::testing::Message() << "i " << i << " half height " << s.half_height);
      // From above the ground to wholly below it.
      const double depth = i % 2 ? source.uniform(-0.004, 0.01) : source.uniform(0.01, 1);
      const Transform<double> X = standing(source, s.half_height, depth);
      std::array<Manifold<double>, 4> out;
      const int count = collide_height_field<double>(s.shape, X, field, kHere, 0.005, out);
      expect_flat(s, X, depth, {out.data(), static_cast<std::size_t>(count)});
      if (HasFailure()) return;
    }
  }
}

// The surface of a convex body touches what the body touches, with the body's normal: as long as it is not in so deep
// that one triangle does not tell what is behind the next.
TEST(CollideMesh, AConvexSurfaceIsItsBody) {
  ShapeSource source(9);
  std::vector<Point> cloud;
  for (int i = 0; i < 60; ++i) cloud.push_back(broadcast<double>(broadcast<float>(0.5 * source.direction())));
  const ConvexPolyhedron ball = convex_polyhedron(std::span<const Point>(cloud)), cube = testing::cube_hull();
  for (const ConvexPolyhedron* body : {&ball, &cube}) {
    const TriangleMesh mesh(testing::surface_of(*body));
    const ConvexShape solid = ConvexShape::polyhedron(*body);
    int touching = 0;
    for (int i = 0; i < 3000; ++i) {
      ConvexShape shape = ConvexShape::sphere(0.1);
      if (i % 3 == 1) shape = ConvexShape::capsule(0.05, 0.2);
      if (i % 3 == 2) shape = ConvexShape::box({0.1, 0.1, 0.1});
      const Transform<double> X_WB = source.pose(1);
      const Transform<double> X_WA{source.rotation(), X_WB.p + source.uniform(0.45, 0.85) * source.direction()};
      const auto truth = convex_distance(shape, X_WA, solid, X_WB);
      if (truth.phi < -0.003) continue;
      std::array<Manifold<double>, 4> out;
      const int count = collide_mesh<double>(shape, X_WA, mesh, X_WB, 0.02, out);
      SCOPED_TRACE(::testing::Message() << "pair " << i << " phi " << truth.phi);
      if (truth.phi > 0.02) {
        EXPECT_EQ(count, 0);
        continue;
      }
      ++touching;
      ASSERT_GT(count, 0);
      EXPECT_NEAR(deepest(out[0]), truth.phi, 1e-6);
      EXPECT_GT(dot(out[0].normal, truth.normal_AB), truth.phi > 1e-3 ? 1 - 1e-6 : 0.99);
      if (HasFailure()) return;
    }
    EXPECT_GT(touching, 100);
  }
}

TEST(CollideMesh, TheBackOfATriangleIsOpen) {
  ShapeSource source(1);
  const TriangleMesh mesh(testing::flat_ground(4, source));
  Transform<double> X = kHere;
  X.p.z = -0.099;
  std::array<Manifold<double>, 4> out;
  EXPECT_EQ(collide_mesh<double>(ConvexShape::sphere(0.1), X, mesh, kHere, 0.005, out), 0);
}

TEST(CollideMesh, ABoxInACornerTouchesBothWalls) {
  Mesh corner{"corner"};
  corner.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {1, -1, 2}, {1, 1, 2}};
  corner.triangles = {{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}};
  const TriangleMesh mesh(corner);
  Transform<double> X = kHere;
  X.p = {0.9 + 0.001, 0.1, 0.1 - 0.002};
  std::array<Manifold<double>, 4> out;
  ASSERT_EQ(collide_mesh<double>(ConvexShape::box({0.1, 0.1, 0.1}), X, mesh, kHere, 0.005, out), 2);
  EXPECT_NEAR(out[0].normal.z, -1, 1e-9);
  EXPECT_NEAR(deepest(out[0]), -0.002, 1e-9);
  EXPECT_NEAR(out[1].normal.x, 1, 1e-9);
  EXPECT_NEAR(deepest(out[1]), -0.001, 1e-9);
}

// A ball above rough ground: its nearest point by brute force over a fine grid of the same triangles.
TEST(CollideHeightField, RoughGroundAgreesWithSampling) {
  ShapeSource source(2);
  const HeightField field = testing::rough_ground(12, 12, 0.04, source);
  for (int i = 0; i < 60; ++i) {
    Transform<double> X = source.pose(0.2);
    const double r = 0.06;
    X.p.z = source.uniform(0.05, 0.12);
    double nearest = 1e9;
    for (int cell_y = 0; cell_y < 11; ++cell_y) {
      for (int cell_x = 0; cell_x < 11; ++cell_x) {
        const auto h = [&](int dx, int dy) {
          return field.height[static_cast<std::size_t>((cell_y + dy) * 12 + cell_x + dx)];
        };
        for (int k = 0; k <= 40; ++k) {
          for (int l = 0; l <= 40; ++l) {
            const double u = k / 40.0, v = l / 40.0;
            const double z = u > v ? (1 - u) * h(0, 0) + (u - v) * h(1, 0) + v * h(1, 1)
                                   : (1 - v) * h(0, 0) + u * h(1, 1) + (v - u) * h(0, 1);
            const Point p{(cell_x + u - 5.5) * field.dx, (cell_y + v - 5.5) * field.dy, z};
            nearest = std::min(nearest, norm(p - X.p));
          }
        }
      }
    }
    std::array<Manifold<double>, 4> out;
    const int count = collide_height_field<double>(ConvexShape::sphere(r), X, field, kHere, 0.1, out);
    ASSERT_GT(count, 0);
    EXPECT_LE(deepest(out[0]), nearest - r + 1e-9) << i;
    EXPECT_NEAR(deepest(out[0]), nearest - r, 1e-4) << i;
  }
}

// However deep and however rough: what is under the grid is found, and pushed up.
TEST(CollideHeightField, NothingIsLostInTheGround) {
  ShapeSource source(12);
  const HeightField field = testing::rough_ground(12, 20, 0.1, source);
  for (int i = 0; i < 500; ++i) {
    const Standing& s = kStanding[static_cast<std::size_t>(i) % kStanding.size()];
    Transform<double> X = source.pose(0.5);
    X.p.z = -source.uniform(0.1, 2);
    std::array<Manifold<double>, 4> out;
    ASSERT_GT(collide_height_field<double>(s.shape, X, field, kHere, 0.005, out), 0) << i;
    EXPECT_LT(deepest(out[0]), 0);
    EXPECT_LT(out[0].normal.z, -0.1);
  }
}

TEST(CollidePlane, AgreesWithAVastBox) {
  ShapeSource source(4);
  const std::vector<Point> cloud = source.cloud(40);
  const std::vector<ConvexPolyhedron> hulls{convex_polyhedron(std::span<const Point>(cloud))};
  using enum ConvexShape::Core;
  for (const auto core : {kPoint, kSegment, kBox, kCylinder, kHull}) {
    for (int i = 0; i < 100; ++i) {
      const ConvexShape shape = source.shape(core, hulls);
      const Transform<double> X_WA = source.pose(0.3), X_WP = source.pose(0.3);
      const ConvexShape vast = ConvexShape::box({100, 100, 100});
      Transform<double> X_WB = X_WP;
      X_WB.p = X_WP.p - 100 * X_WP.R.z;
      const auto plane = collide_plane(shape, X_WA, X_WP, 0.1);
      const double phi = convex_distance(shape, X_WA, vast, X_WB).phi;
      if (phi < 0.1) {
        EXPECT_NEAR(deepest(plane), phi, 1e-6);
        EXPECT_LT(norm(plane.normal + X_WP.R.z), 1e-12);
      } else {
        EXPECT_FALSE(is_finite(deepest(plane)));
      }
    }
  }
}

TEST(TriangleMesh, RefusesNonsense) {
  Mesh mesh{"m"};
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  mesh.triangles = {{0, 1, 2}};
  EXPECT_THROW(TriangleMesh{mesh}, ModelError);
  mesh.triangles = {{0, 1, 3}};
  EXPECT_THROW(TriangleMesh{mesh}, ModelError);
  mesh.triangles = {{0, -1, 2}};
  EXPECT_THROW(TriangleMesh{mesh}, ModelError);
}

}  // namespace
}  // namespace manyhands
