// Grasps and what they stand on, against closed forms.
#include <gtest/gtest.h>

#include <algorithm>

#include "manyhands/math/philox.h"
#include "manyhands/math/quaternion.h"
#include "manyhands/model/hull_depth.h"
#include "manyhands/physics/collision/general/collision_shape.h"
#include "manyhands/planning/grasp_quality.h"
#include "manyhands/planning/grasps.h"

namespace manyhands {
namespace {

using Vec = Vec3<double>;

TEST(HullDepth, OfACrossPolytopeAndACube) {
  for (const std::size_t n : {2u, 3u, 6u}) {
    std::vector<double> cross, cube;
    for (std::size_t i = 0; i < n; ++i) {
      for (const double x : {-1.0, 1.0}) {
        cross.resize(cross.size() + n);
        cross[cross.size() - n + i] = x;
      }
    }
    for (unsigned corner = 0; corner < 1u << n; ++corner) {
      for (std::size_t i = 0; i < n; ++i) cube.push_back((corner >> i & 1u) != 0 ? 1 : -1);
    }
    EXPECT_NEAR(depth_in_hull(cross, n), 1 / std::sqrt(static_cast<double>(n)), 1e-12);
    EXPECT_NEAR(depth_in_hull(cube, n), 1, 1e-12);
    for (double& x : cube) x += 1.5;
    EXPECT_EQ(depth_in_hull(cube, n), 0);
  }
  EXPECT_EQ(depth_in_hull({1, 0, -1, 0, 0.5, 0}, 2), 0);  // on a line
  EXPECT_EQ(depth_in_hull({1, 0, -1, 0}, 2), 0);
}

/// Two opposite fingers at distance s from the centre that do not turn. The wrench that is hardest to balance pulls
/// sideways at one of them: force x, moment x / s about the centre, and mu x along the line, so that
/// epsilon = mu / sqrt(1 + 1 / s^2 + mu^2), where mu is that of the friction polygon's sides.
TEST(EpsilonQuality, OfTwoOppositeFingers) {
  for (const double s : {0.3, 0.8, 1.0}) {
    for (const double friction : {0.2, 0.5, 1.0}) {
      for (const int edges : {4, 8, 13}) {
        const Vec a{-s, 0, 0}, b{s, 0, 0}, x{1, 0, 0};
        const GraspContact contacts[] = {{a, x, friction, 100}, {b, -x, friction, 100}};
        const double mu = friction * std::cos(std::numbers::pi / edges);
        const double closed = mu / std::sqrt(1 + 1 / (s * s) + mu * mu);
        const double found = epsilon_quality(contacts, Vec::zero(), 1, edges);
        if (edges % 2 == 0)
          EXPECT_NEAR(found, closed, 1e-4 * closed);  // 100 is not infinite
        else
          EXPECT_GE(found, closed * (1 - 1e-4));  // polygons of both fingers are no mirror images
        EXPECT_NEAR(epsilon_quality(contacts, Vec::zero(), 2, edges), mu / std::sqrt(1 + 4 / (s * s) + mu * mu),
                    edges % 2 == 0 ? 1e-4 : 0.1);
      }
    }
  }
}

TEST(EpsilonQuality, IsZeroWhereSomethingIsFree) {
  const Vec x{1, 0, 0};
  const GraspContact rubbing[] = {{-x, x, 0.5, 0}, {x, -x, 0.5, 0}};  // turns about the line
  EXPECT_EQ(epsilon_quality(rubbing, Vec::zero(), 1), 0);
  const GraspContact side[] = {{-x, x, 0.5, 0.1}, {-x, x, 0.5, 0.1}};  // falls off
  EXPECT_EQ(epsilon_quality(side, Vec::zero(), 1), 0);
  EXPECT_EQ(epsilon_quality({}, Vec::zero(), 1), 0);
  EXPECT_THROW((void)epsilon_quality(side, Vec::zero(), 1, 2), std::invalid_argument);
}

Mesh box_mesh(const Vec& half) {
  Mesh mesh;
  for (unsigned k = 0; k < 8; ++k) {
    const auto at = [&](unsigned bit, double h) { return static_cast<float>((k >> bit & 1u) != 0 ? h : -h); };
    mesh.vertices.push_back({at(0, half.x), at(1, half.y), at(2, half.z)});
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

TEST(Crossings, OfABoxAsSolidAndAsMesh) {
  const Vec half{0.25, 0.5, 0.125};
  const CollisionShape solid = CollisionShape::box(half), mesh = CollisionShape::mesh(box_mesh(half));
  RandomStream random(5, 0, 0);
  const auto vector = [&] { return Vec{random.normal<double>(), random.normal<double>(), random.normal<double>()}; };
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    const Transform<double> X{to_matrix(quat_from_rotation_vector(vector())), 0.1 * vector()};
    const Vec o = 0.2 * vector(), along = vector(), d = (1 / norm(along)) * along;
    const PlacedShape of_solid[] = {{solid.view(), X}}, of_mesh[] = {{mesh.view(), X}};
    const std::vector<Crossing> a = crossings(of_solid, o, d, 5), b = crossings(of_mesh, o, d, 5);
    ASSERT_EQ(a.size(), b.size()) << i;
    if (a.empty()) continue;
    ++hits;
    EXPECT_NEAR(a[0].from, b[0].from, 1e-12);
    EXPECT_NEAR(a[0].to, b[0].to, 1e-12);
    EXPECT_NEAR(norm(a[0].normal_from - b[0].normal_from), 0, 1e-9);
    EXPECT_NEAR(norm(a[0].normal_to - b[0].normal_to), 0, 1e-9);
    EXPECT_LT(dot(a[0].normal_from, d), 0);
    EXPECT_GT(dot(a[0].normal_to, d), 0);
  }
  EXPECT_GT(hits, 500);
}

TEST(Crossings, OverlappingShapesAreOneAndOthersApart) {
  const CollisionShape ball = CollisionShape::sphere(1);
  const auto at = [&](double x) { return PlacedShape{ball.view(), {Mat3<double>::identity(), {x, 0, 0}}}; };
  const PlacedShape shapes[] = {at(5), at(0), at(1.5)};
  const std::vector<Crossing> found = crossings(shapes, Vec::zero(), {1, 0, 0}, 10);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(found[0].from, -1, 1e-12);
  EXPECT_NEAR(found[0].to, 2.5, 1e-12);
  EXPECT_NEAR(found[1].from, 4, 1e-12);
  EXPECT_NEAR(found[1].to, 6, 1e-12);
  EXPECT_NEAR(found[1].normal_to.x, 1, 1e-12);
}

TEST(Crossings, EndWhereCoordinatesHaveNoDigitsLeft) {
  const CollisionShape mesh = CollisionShape::mesh(box_mesh({1, 1, 1}));
  for (const double far : {1e3, 1e9, 1e15}) {
    const PlacedShape shapes[] = {{mesh.view(), {Mat3<double>::identity(), {far, 0, 0}}}};
    const std::vector<Crossing> found = crossings(shapes, {far, 0.1, 0.2}, {1, 0, 0}, 4 * far);
    EXPECT_LE(found.size(), 1u);
  }
}

TEST(Grasps, OfAnOpenSurfaceAreNone) {
  Mesh sheet;
  sheet.vertices = {{0, 0, 0}, {0.05F, 0, 0}, {0, 0.05F, 0}};
  sheet.triangles = {{0, 1, 2}};
  const CollisionShape shape = CollisionShape::mesh(sheet);
  EXPECT_TRUE(find_grasps({{{shape.view()}}}, {}, {}, {.samples = 20}).empty());
}

/// The gripper's boxes at a grasp are apart from the object, and both jaws would touch it where the grasp says.
TEST(Grasps, OfABoxAreItsPairsOfFaces) {
  const Vec half{0.02, 0.03, 0.06};
  for (const CollisionShape& shape : {CollisionShape::box(half), CollisionShape::mesh(box_mesh(half))}) {
    const GraspObject object{{{shape.view()}}};
    const std::vector<Grasp> found = find_grasps(object, {}, {}, {.samples = 300});
    int across[2] = {};
    for (const Grasp& grasp : found) {
      const Vec y = grasp.X_OG.R.y;
      const bool is_x = abs(y.x) > 0.5;
      ++across[is_x ? 0 : 1];
      EXPECT_NEAR(abs(is_x ? y.x : y.y), 1, 1e-9);
      EXPECT_NEAR(grasp.width, is_x ? 0.04 : 0.06, 1e-8);  // 0.12 is too wide
      EXPECT_NEAR(grasp.margin, std::atan(0.5), 1e-7);
      EXPECT_GT(grasp.quality, 0);
      EXPECT_NEAR(norm(grasp.points[0] + 0.5 * grasp.width * y - grasp.X_OG.p), 0, 1e-12);
    }
    EXPECT_GT(across[0], 50);
    EXPECT_GT(across[1], 50);
    EXPECT_TRUE(std::ranges::is_sorted(found, {}, [](const Grasp& g) { return -std::round(1e6 * g.quality); }));
  }
}

/// Between the sides of a wedge a gripper holds while half its angle is less than that of friction.
TEST(Grasps, OfAWedgeNeedFriction) {
  for (const double degrees : {10.0, 25.0, 28.0}) {
    const double angle = degrees * std::numbers::pi / 180, h = 0.05, w = h * std::tan(angle);
    const std::vector<Vec> corners{{0, -0.1, h}, {0, 0.1, h}, {-w, -0.1, 0}, {-w, 0.1, 0}, {w, -0.1, 0}, {w, 0.1, 0}};
    const CollisionShape wedge = CollisionShape::convex(corners);
    const std::vector<Grasp> found = find_grasps({{{wedge.view()}}}, {}, {}, {.samples = 400});
    const bool holds = angle < std::atan(0.5);
    int sides = 0;
    for (const Grasp& grasp : found) {
      if (abs(grasp.X_OG.R.y.x) < 0.9) continue;
      ++sides;
      EXPECT_NEAR(grasp.margin, std::atan(0.5) - angle, 1e-4);
    }
    EXPECT_EQ(sides > 0, holds) << degrees;
  }
}

TEST(Grasps, KeepFromObstaclesAndThePalmFromTheObject) {
  const CollisionShape cube = CollisionShape::box({0.02, 0.02, 0.02}), table = CollisionShape::plane();
  const GraspObject object{{{cube.view(), {Mat3<double>::identity(), {0, 0, 0.02}}}}, {0, 0, 0.02}};
  const PlacedShape below[] = {{table.view()}};
  const ParallelGripper gripper;
  const std::vector<Grasp> found = find_grasps(object, below, gripper, {.samples = 300});
  const std::vector<Grasp> anywhere = find_grasps(object, {}, gripper, {.samples = 300});
  EXPECT_GT(found.size(), 50u);
  EXPECT_LT(found.size(), anywhere.size());
  for (const Grasp& grasp : found) {
    for (const double x : {-0.5, 0.5}) {
      for (const double y : {-1.0, 1.0}) {
        const Vec tip{x * gripper.width, y * (0.5 * grasp.width + 0.005 + gripper.thickness), gripper.reach};
        EXPECT_GT((grasp.X_OG * tip).z, 0);
      }
    }
    const Vec in_G = inverse(grasp.X_OG) * Vec{0, 0, 0.02};
    EXPECT_GT(in_G.z, -gripper.depth + 0.02);  // the palm would press on the cube
  }
}

TEST(Grasps, AreTheSameForTheSameSeedAndPointWhereTheyShould) {
  const CollisionShape shape = CollisionShape::cylinder(0.03, 0.1);
  const GraspObject object{{{shape.view()}}};
  const GraspSettings settings{.samples = 200, .approach = {0, 0, -3}, .tilt = 0.5, .seed = 7};
  const std::vector<Grasp> a = find_grasps(object, {}, {}, settings), b = find_grasps(object, {}, {}, settings);
  ASSERT_EQ(a.size(), b.size());
  ASSERT_GT(a.size(), 5u);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(norm(a[i].X_OG.p - b[i].X_OG.p), 0);
    EXPECT_LE(std::acos(-a[i].X_OG.R.z.z), 0.5 + 1e-9);
    EXPECT_NEAR(a[i].width, 0.06, 1e-9);  // the diameter
    EXPECT_NEAR(a[i].X_OG.p.x, 0, 1e-9);
    EXPECT_NEAR(a[i].X_OG.p.y, 0, 1e-9);
  }
}

TEST(Grasps, RefuseWhatMakesNoSense) {
  const CollisionShape ball = CollisionShape::sphere(0.03), plane = CollisionShape::plane();
  const GraspObject object{{{ball.view()}}};
  const auto refused = [&](const GraspObject& of, const ParallelGripper& gripper, const GraspSettings& settings) {
    EXPECT_THROW((void)find_grasps(of, {}, gripper, settings), std::invalid_argument);
  };
  const double nan = std::nan("");
  refused({}, {}, {});
  refused({{{plane.view()}}}, {}, {});
  refused(object, {.opening = 0}, {});
  refused(object, {.palm = {1, nan, 1}}, {});
  refused(object, {}, {.friction = nan});
  refused(object, {}, {.samples = 0});
  refused(object, {}, {.approach = {0, 0, 0}});
  refused(object, {}, {.clearance = -1});
  EXPECT_TRUE(find_grasps(object, {}, {.opening = 0.05}, {}).empty());  // too narrow
}

}  // namespace
}  // namespace manyhands
