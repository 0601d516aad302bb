#include <gtest/gtest.h>

#include "manyhands/physics/collision/general/collide_convex.h"
#include "manyhands/physics/collision/queries/ray_cast.h"
#include "tests/physics/collision/surface_testing.h"

namespace manyhands {
namespace {

using testing::Point;
using testing::ShapeSource;

constexpr double kFar = 4;

struct Ray {
  Point origin, direction;
};

/// Half of the rays run along an axis; the others point roughly at the middle.
Ray random_ray(ShapeSource& source, int i) {
  Ray ray{{source.uniform(-2, 2), source.uniform(-2, 2), source.uniform(-2, 2)}, {}};
  if (i % 2) {
    const Point aim = Point{source.uniform(-1, 1), source.uniform(-1, 1), source.uniform(-1, 1)} - ray.origin;
    ray.direction = (1 / norm(aim)) * aim;
  } else {
    ray.direction = i % 4 ? Point{0, 0, i % 8 < 4 ? 1.0 : -1.0} : Point{i % 8 ? 1.0 : -1.0, 0, 0};
    ray.origin = {0.4 * ray.origin.x, 0.4 * ray.origin.y, 0.4 * ray.origin.z};
    ray.origin = ray.origin - 1.5 * ray.direction;
  }
  return ray;
}

// The point hit is on the surface, nothing before it is inside, and the normal leads straight away from the shape.
TEST(RayCast, SolidsAgainstMarching) {
  ShapeSource source(11);
  std::vector<Point> cloud;
  for (int i = 0; i < 40; ++i) cloud.push_back(0.6 * source.direction());
  const std::vector<ConvexPolyhedron> hulls{convex_polyhedron(std::span<const Point>(cloud))};
  using enum ShapeType;
  for (const ShapeView& view :
       {ShapeView{kSphere, {0.7, 0, 0}}, ShapeView{kCapsule, {0.3, 0.5, 0}}, ShapeView{kCylinder, {0.6, 0.4, 0}},
        ShapeView{kBox, {0.5, 0.7, 0.2}}, ShapeView{kConvex, {}, &hulls[0]}}) {
    const ConvexShape shape = view.convex();
    int hits = 0, inside = 0;
    for (int i = 0; i < 1000; ++i) {
      const Ray ray = random_ray(source, i);
      const auto hit = ray_cast(view, Transform<double>::identity(), ray.origin, ray.direction, kFar);
      SCOPED_TRACE(::testing::Message() << "type " << static_cast<int>(view.type) << " ray " << i);
      const double end = hit ? hit->distance : kFar;
      if (testing::outside(shape, ray.origin) == 0) {
        ++inside;
        ASSERT_TRUE(hit.has_value());
        EXPECT_EQ(hit->distance, 0);
        EXPECT_LT(norm(hit->normal + ray.direction), 1e-12);
        continue;
      }
      for (int k = 0; k < 500; ++k) {
        const double t = k / 500.0 * (end - 1e-9);
        ASSERT_GT(testing::outside(shape, ray.origin + t * ray.direction), 0) << t << " of " << end;
      }
      if (!hit) continue;
      ++hits;
      const Point p = ray.origin + end * ray.direction;
      EXPECT_LT(testing::outside(shape, p), 1e-12);
      EXPECT_NEAR(norm(hit->normal), 1, 1e-12);
      EXPECT_LE(dot(hit->normal, ray.direction), 1e-9);
      Transform<double> X = Transform<double>::identity();
      X.p = p + 1e-3 * hit->normal;
      EXPECT_NEAR(convex_distance(shape, Transform<double>::identity(), ConvexShape::sphere(0), X).phi, 1e-3, 1e-9);
    }
    EXPECT_GT(hits, 200);
    if (view.type != kConvex) {
      EXPECT_GT(inside, 0);
    }
  }
}

TEST(RayCast, ClosedForms) {
  const auto here = Transform<double>::identity();
  const auto cast = [&](const ShapeView& s, const Point& o, const Point& d) { return ray_cast(s, here, o, d, 100.0); };
  using enum ShapeType;
  EXPECT_NEAR(cast({kSphere, {0.5, 0, 0}}, {-3, 0.3, 0}, {1, 0, 0})->distance, 3 - 0.4, 1e-15);
  EXPECT_NEAR(cast({kCapsule, {0.5, 1, 0}}, {0.3, 0, 9}, {0, 0, -1})->distance, 9 - 1 - 0.4, 1e-14);
  EXPECT_NEAR(cast({kCylinder, {0.5, 1, 0}}, {0.3, 0, 9}, {0, 0, -1})->distance, 8, 1e-14);
  EXPECT_NEAR(cast({kBox, {0.5, 1, 2}}, {5, 1, 2}, {-1, 0, 0})->distance, 4.5, 1e-15) << "along an edge";
  EXPECT_NEAR(cast({kPlane}, {0, 0, 2}, {0.6, 0, -0.8})->distance, 2.5, 1e-15);
  EXPECT_FALSE(cast({kPlane}, {0, 0, 2}, {0.6, 0, 0.8}).has_value());
  EXPECT_EQ(cast({kPlane}, {0, 0, -2}, {0, 0, 1})->distance, 0);
  EXPECT_FALSE(ray_cast<double>({kSphere, {0.5, 0, 0}}, here, {-3, 0, 0}, {1, 0, 0}, 2.4).has_value());
  EXPECT_FALSE(cast({kSphere, {0.5, 0, 0}}, {3, 0, 0}, {1, 0, 0}).has_value()) << "behind the ray";
}

TEST(RayCast, PosesAndFloatAreHonoured) {
  ShapeSource source(2);
  const ShapeView box{ShapeType::kBox, {0.5, 0.7, 0.2}};
  for (int i = 0; i < 200; ++i) {
    const Ray ray = random_ray(source, i);
    const Transform<double> X = source.pose(1);
    const auto here = ray_cast(box, Transform<double>::identity(), ray.origin, ray.direction, kFar);
    const auto there = ray_cast(box, X, X * ray.origin, X.R * ray.direction, kFar);
    ASSERT_EQ(here.has_value(), there.has_value()) << i;
    if (!here) continue;
    EXPECT_NEAR(here->distance, there->distance, 1e-12);
    EXPECT_LT(norm(X.R * here->normal - there->normal), 1e-12);
    const auto in_float = ray_cast(box, broadcast<float>(X), broadcast<float>(X * ray.origin),
                                   broadcast<float>(X.R * ray.direction), static_cast<float>(kFar));
    if (in_float && dot(here->normal, ray.direction) < -0.1) {
      EXPECT_NEAR(in_float->distance, here->distance, 3e-5);
    }
  }
}

// A mesh by its tree against the body's planes; a field by its walk against the tree over its triangles.
TEST(RayCast, MeshesAndFieldsAgainstOtherWays) {
  ShapeSource source(8);
  std::vector<Point> cloud;
  for (int i = 0; i < 300; ++i) cloud.push_back(broadcast<double>(broadcast<float>(source.direction())));
  const ConvexPolyhedron hull = convex_polyhedron(std::span<const Point>(cloud));
  const TriangleMesh mesh(testing::surface_of(hull));
  const HeightField field = testing::rough_ground(20, 30, 0.2, source);
  const TriangleMesh ground(testing::surface_of(field));
  const auto here = Transform<double>::identity();
  int hits = 0, below = 0, field_hits = 0;
  for (int i = 0; i < 4000; ++i) {
    const Ray ray = random_ray(source, i);
    SCOPED_TRACE(::testing::Message() << "ray " << i);
    const auto truth = ray_cast<double>({ShapeType::kConvex, {}, &hull}, here, ray.origin, ray.direction, kFar);
    const auto found = ray_cast<double>({ShapeType::kMesh, {}, {}, &mesh}, here, ray.origin, ray.direction, kFar);
    if (truth && truth->distance > 0) {
      ++hits;
      ASSERT_TRUE(found.has_value());
      EXPECT_NEAR(found->distance, truth->distance, 1e-9);
      EXPECT_GT(dot(found->normal, truth->normal), 1 - 1e-9);
    } else if (!truth) {
      EXPECT_FALSE(found.has_value());
    }
    const auto walked =
        ray_cast<double>({ShapeType::kHeightField, {}, {}, {}, &field}, here, ray.origin, ray.direction, kFar);
    const auto searched = ray_cast<double>({ShapeType::kMesh, {}, {}, &ground}, here, ray.origin, ray.direction, kFar);
    if (walked && walked->distance == 0) {
      ++below;
      // Straight up from within the ground there is a surface.
      EXPECT_TRUE(ray_cast<double>({ShapeType::kMesh, {}, {}, &ground}, here, ray.origin, {0, 0, 1}, kFar).has_value());
      continue;
    }
    ASSERT_EQ(walked.has_value(), searched.has_value());
    if (!walked) continue;
    ++field_hits;
    EXPECT_NEAR(walked->distance, searched->distance, 1e-12);
    EXPECT_LT(norm(walked->normal - searched->normal), 1e-9);
  }
  EXPECT_GT(hits, 1000);
  EXPECT_GT(below, 50);
  EXPECT_GT(field_hits, 500);
}

}  // namespace
}  // namespace manyhands
