// Balls that stand for links: they hold every point, and stick out by no more than they may.
#include <gtest/gtest.h>

#include <algorithm>

#include "manyhands/math/philox.h"
#include "manyhands/math/quaternion.h"
#include "manyhands/physics/collision/general/collide_convex.h"
#include "manyhands/planning/ball_cover.h"

namespace manyhands {
namespace {

using Vec = Vec3<double>;

Vec random_point(RandomStream& random, double half) {
  return {random.uniform(-half, half), random.uniform(-half, half), random.uniform(-half, half)};
}

/// The signed distance of a point from a shape, by the collision code.
double distance(const PlacedConvex& placed, const Vec& p) {
  const Transform<double> X_WP{Mat3<double>::identity(), p};
  return convex_distance(placed.shape, placed.X, ConvexShape::sphere(1e-9), X_WP).phi;
}

double distance(const std::vector<PlacedConvex>& shapes, const Vec& p) {
  double least = distance(shapes[0], p);
  for (const PlacedConvex& placed : shapes) least = std::min(least, distance(placed, p));
  return least;
}

void expect_covered(const std::vector<PlacedConvex>& shapes, double overshoot, double cell) {
  const std::vector<Ball> balls = cover_with_balls(shapes, overshoot);
  RandomStream random(1, 0, 0);
  int inside = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec p = random_point(random, 0.2);
    if (distance(shapes, p) > 0) continue;
    ++inside;
    EXPECT_TRUE(std::ranges::any_of(balls, [&](const Ball& b) { return norm(b.centre - p) <= b.radius; }));
  }
  EXPECT_GT(inside, 100);
  for (const Ball& ball : balls) {
    const double depth = -distance(shapes, ball.centre);
    EXPECT_LE(ball.inner, depth + 1e-6);
    EXPECT_LE(ball.radius - depth, std::max(overshoot, 2 * cell) + 1e-5);
  }
}

Transform<double> somewhere() {
  return {to_matrix(quat_from_rotation_vector(Vec{0.4, -0.7, 0.2})), {0.03, -0.02, 0.05}};
}

TEST(BallCover, HoldsCylindersBoxesCapsulesAndBalls) {
  for (const ConvexShape& shape : {ConvexShape::cylinder(0.055, 0.1), ConvexShape::box({0.1, 0.04, 0.02}),
                                   ConvexShape::capsule(0.04, 0.1), ConvexShape::sphere(0.07)}) {
    expect_covered({{shape, somewhere()}}, 0.01, 0.01 / 3);
  }
}

TEST(BallCover, HoldsAHull) {
  RandomStream random(2, 0, 0);
  std::vector<Vec> points;
  for (int i = 0; i < 40; ++i) points.push_back(random_point(random, 0.1));
  const ConvexPolyhedron hull = convex_polyhedron(std::span<const Vec>(points));
  expect_covered({{ConvexShape::polyhedron(hull), somewhere()}}, 0.01, 0.01 / 3);
}

TEST(BallCover, HoldsShapesThatCross) {
  const Transform<double> lying{to_matrix(quat_from_rotation_vector(Vec{1.5707963267948966, 0, 0})), {0, 0.05, 0}};
  expect_covered(
      {{ConvexShape::cylinder(0.05, 0.1), Transform<double>::identity()}, {ConvexShape::cylinder(0.05, 0.09), lying}},
      0.01, 0.01 / 3);
}

TEST(BallCover, TakesFewBallsForABall) {
  const std::vector<PlacedConvex> one{{ConvexShape::sphere(0.1), Transform<double>::identity()}};
  EXPECT_LE(cover_with_balls(one, 0.01).size(), 2U);
}

}  // namespace
}  // namespace manyhands
