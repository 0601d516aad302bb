#include <gtest/gtest.h>

#include <limits>

#include "manyhands/physics/collision/queries/distance.h"
#include "tests/physics/collision/surface_testing.h"

namespace manyhands {
namespace {

using testing::Point;
using testing::ShapeSource;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// One shape of every type, and the data behind them.
struct World {
  explicit World(unsigned seed)
      : source(seed),
        hull(testing::cube_hull()),
        mesh(testing::surface_of(hull)),
        field(testing::rough_ground(9, 17, 0.05, source)),
        ground(testing::surface_of(field)) {}

  std::vector<ShapeView> all() const {
    using enum ShapeType;
    return {{kSphere, {0.3, 0, 0}},     {kCapsule, {0.1, 0.3, 0}},
            {kCylinder, {0.2, 0.3, 0}}, {kBox, {0.1, 0.2, 0.3}},
            {kConvex, {}, &hull},       {kPlane, {}},
            {kMesh, {}, {}, &mesh},     {kHeightField, {}, {}, {}, &field}};
  }
  ShapeSource source;
  ConvexPolyhedron hull;
  TriangleMesh mesh;
  HeightField field;
  TriangleMesh ground;
};

TEST(SignedDistance, EveryPairOfTypesIsSymmetricAndConsistent) {
  World world(3);
  const std::vector<ShapeView> shapes = world.all();
  for (const ShapeView& a : shapes) {
    for (const ShapeView& b : shapes) {
      for (int i = 0; i < 20; ++i) {
        const Transform<double> X_WA = world.source.pose(1), X_WB = world.source.pose(1);
        SCOPED_TRACE(::testing::Message() << static_cast<int>(a.type) << " " << static_cast<int>(b.type) << " " << i);
        const auto d = signed_distance(a, X_WA, b, X_WB), e = signed_distance(b, X_WB, a, X_WA);
        EXPECT_NEAR(norm(d.normal_AB), 1, 1e-12);
        if (d.phi == -kInfinity) {
          EXPECT_TRUE(a.type == ShapeType::kPlane && b.type == ShapeType::kPlane);
          continue;
        }
        EXPECT_LT(norm(d.p_A + d.phi * d.normal_AB - d.p_B), 1e-9);
        // Of two fields, each is ground to the triangles of the other: deep in each other, they may see it otherwise.
        const bool fields = a.type == ShapeType::kHeightField && b.type == ShapeType::kHeightField;
        if (fields && (d.phi < 0 || e.phi < 0)) continue;
        EXPECT_NEAR(d.phi, e.phi, 1e-6);
        const auto f = signed_distance(a, broadcast<float>(X_WA), b, broadcast<float>(X_WB));
        if (d.phi > 0) {
          EXPECT_NEAR(f.phi, static_cast<float>(d.phi), 2e-6f);
        }
      }
    }
  }
}

TEST(SignedDistance, PlanesSeeTheLowestPoint) {
  World world(4);
  for (const ShapeView& b : world.all()) {
    if (b.type == ShapeType::kPlane) continue;
    for (int i = 0; i < 20; ++i) {
      const Transform<double> X_WP = world.source.pose(1), X_WB = world.source.pose(1);
      const double phi = signed_distance({.type = ShapeType::kPlane}, X_WP, b, X_WB).phi;
      double truth = kInfinity;
      const auto see = [&](const Point& p) { truth = std::min(truth, dot(X_WP.R.z, X_WB * p - X_WP.p)); };
      if (b.type == ShapeType::kHeightField) {
        for (const Point& p : world.ground.vertices()) see(p);
      } else if (b.type == ShapeType::kMesh) {
        for (const Point& p : world.mesh.vertices()) see(p);
      } else {
        const ConvexShape shape = b.convex();
        const Point down = -transpose_times(X_WB.R, X_WP.R.z);
        see(shape.support(down) + shape.radius * down);
      }
      EXPECT_NEAR(phi, truth, 1e-12);
    }
  }
}

TEST(SignedDistance, FacingPlanesHaveAGap) {
  const Transform<double> X_WA = Transform<double>::identity(), X_WB{{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}, {3, 2, 1}};
  const ShapeView plane{.type = ShapeType::kPlane};
  EXPECT_EQ(signed_distance(plane, X_WA, plane, X_WB).phi, 1);
  EXPECT_EQ(signed_distance(plane, X_WA, plane, X_WA).phi, -kInfinity);
}

TEST(SignedDistance, OutsideAClosedMeshIsThatOfItsBody) {
  World world(5);
  const std::vector<ShapeView> shapes = world.all();
  const ShapeView body = shapes[4], mesh = shapes[6];
  int apart = 0;
  for (const ShapeView& a : shapes) {
    if (!a.is_convex_body()) continue;
    for (int i = 0; i < 100; ++i) {
      const Transform<double> X_WA = world.source.pose(1), X_WB = world.source.pose(1);
      const auto truth = signed_distance(a, X_WA, body, X_WB);
      if (truth.phi < 0) continue;
      ++apart;
      EXPECT_NEAR(signed_distance(a, X_WA, mesh, X_WB).phi, truth.phi, 1e-7);
      const auto on_mesh = signed_distance(mesh, X_WA, mesh, X_WB), on_body = signed_distance(body, X_WA, body, X_WB);
      if (on_body.phi > 0) {
        EXPECT_NEAR(on_mesh.phi, on_body.phi, 1e-7);
      }
    }
  }
  EXPECT_GT(apart, 50);
}

// Above the ground, a height field is its triangles; below, a ball's way out leads up.
TEST(SignedDistance, HeightFieldIsItsSurfaceAboveAndSolidBelow) {
  World world(6);
  const ShapeView field{ShapeType::kHeightField, {}, {}, {}, &world.field};
  const ShapeView ground{ShapeType::kMesh, {}, {}, &world.ground};
  const Transform<double> here = Transform<double>::identity();
  for (const ShapeView& b : world.all()) {
    if (!b.is_convex_body()) continue;
    for (int i = 0; i < 100; ++i) {
      Transform<double> X_WB = world.source.pose(1.5);
      X_WB.p.z = std::abs(X_WB.p.z) + 0.06 + b.size.x + b.size.y + b.size.z + (b.hull ? 0.9 : 0);
      const double truth = signed_distance(ground, here, b, X_WB).phi;
      EXPECT_NEAR(signed_distance(field, here, b, X_WB).phi, truth, 1e-9) << i;
    }
  }
  const ShapeView ball{ShapeType::kSphere, {0.01, 0, 0}};
  for (int i = 0; i < 100; ++i) {
    Transform<double> X_WB = world.source.pose(0.3);
    X_WB.p.z = -world.source.uniform(0.06, 1);
    const auto d = signed_distance(field, here, ball, X_WB);
    EXPECT_LT(d.phi, 0);
    EXPECT_GT(d.normal_AB.z, 0.3);
  }
}

}  // namespace
}  // namespace manyhands
