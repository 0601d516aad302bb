#include <gtest/gtest.h>

#include "manyhands/perception/oriented_box.h"
#include "manyhands/perception/principal_axes.h"
#include "tests/perception/points.h"

namespace manyhands {
namespace {

bool holds(const OrientedBox& box, const Point& p) {
  constexpr double kHair = 1e-12;
  const Point at = transpose_times(box.X_WB.R, p - box.X_WB.p);
  return std::abs(at.x) <= box.half_extents.x + kHair && std::abs(at.y) <= box.half_extents.y + kHair &&
         std::abs(at.z) <= box.half_extents.z + kHair;
}

TEST(OrientedBox, OfABoxIsThatBox) {
  const Point half{0.2, 0.1, 0.05};
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Cloud cloud(seed);
    std::vector<Point> points = corners(half);
    for (const Point& p : cloud.in_box(50, half)) points.push_back(p), points.push_back(-p);
    const Transform<double> X{about_z(cloud.uniform(-3, 3)), cloud.in_box(Point{1, 1, 1})};
    points = moved(points, X);
    points.push_back({0, kNan, 0});
    const OrientedBox box = oriented_box(points, true);
    EXPECT_NEAR(norm(box.X_WB.p - X.p), 0, 1e-12);
    EXPECT_NEAR(norm(box.half_extents - half), 0, 1e-12);
    EXPECT_NEAR(std::abs(dot(box.X_WB.R.x, X.R.x)), 1, 1e-12);
  }
}

/// By symmetry the corners' principal axes are the edges.
TEST(OrientedBox, AlongPrincipalAxesOfABoxThatLeansIsThatBox) {
  const Point half{0.2, 0.1, 0.05};
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Cloud cloud(seed);
    const Transform<double> X{cloud.rotation(), cloud.in_box(Point{1, 1, 1})};
    const OrientedBox box = oriented_box(moved(corners(half), X), false);
    EXPECT_NEAR(norm(box.X_WB.p - X.p), 0, 1e-12);
    EXPECT_NEAR(norm(box.half_extents - half), 0, 1e-12);
    EXPECT_NEAR(dot(cross(box.X_WB.R.x, box.X_WB.R.y), box.X_WB.R.z), 1, 1e-12) << "right-handed";
  }
}

/// No rectangle around the points is smaller, of any angle.
TEST(OrientedBox, HoldsAllPointsInTheLeastRectangle) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Cloud cloud(seed);
    const std::vector<Point> points = moved(cloud.in_box(30, {0.3, 0.2, 0.1}), {cloud.rotation(), {1, 2, 3}});
    const OrientedBox box = oriented_box(points, true);
    for (const Point& p : points) EXPECT_TRUE(holds(box, p));
    EXPECT_EQ(box.X_WB.R.z.z, 1);
    EXPECT_GE(box.half_extents.x, box.half_extents.y);
    const double area = 4 * box.half_extents.x * box.half_extents.y;
    for (int k = 0; k < 3600; ++k) {
      const Mat3<double> R = about_z(k * std::numbers::pi / 7200);
      double low[2] = {kInfinity, kInfinity}, high[2] = {-kInfinity, -kInfinity};
      for (const Point& p : points) {
        const Point at = transpose_times(R, p);
        low[0] = std::min(low[0], at.x), high[0] = std::max(high[0], at.x);
        low[1] = std::min(low[1], at.y), high[1] = std::max(high[1], at.y);
      }
      ASSERT_GE((high[0] - low[0]) * (high[1] - low[1]), area * (1 - 1e-12)) << "seed " << seed << ", turn " << k;
    }
  }
}

TEST(OrientedBox, OfLittle) {
  for (const bool upright : {true, false}) {
    const std::vector<Point> one{{1, 2, 3}}, line{{0, 0, 0}, {3, 4, 0}}, none{{kNan, 0, 0}};
    EXPECT_EQ(norm(oriented_box(one, upright).X_WB.p - one[0]), 0);
    EXPECT_EQ(norm(oriented_box(one, upright).half_extents), 0);
    const OrientedBox box = oriented_box(line, upright);
    EXPECT_NEAR(norm(box.half_extents - Point{2.5, 0, 0}), 0, 1e-12);
    EXPECT_NEAR(norm(box.X_WB.p - Point{1.5, 2, 0}), 0, 1e-12);
    EXPECT_THROW((void)oriented_box(none, upright), std::invalid_argument);
    EXPECT_THROW((void)oriented_box({}, upright), std::invalid_argument);
  }
}

/// The variances of a box's corners are the squares of its half extents.
TEST(PrincipalAxes, OfABoxsCorners) {
  const Point half{0.3, 0.2, 0.1};
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Cloud cloud(seed);
    const Transform<double> X{cloud.rotation(), cloud.in_box(Point{1, 1, 1})};
    const PrincipalAxes found = principal_axes(moved(corners(half), X));
    EXPECT_NEAR(norm(found.mean - X.p), 0, 1e-12);
    EXPECT_NEAR(norm(found.variance - Point{0.09, 0.04, 0.01}), 0, 1e-12);
    EXPECT_NEAR(std::abs(dot(found.axes.x, X.R.x)), 1, 1e-12);
    EXPECT_NEAR(std::abs(dot(found.axes.y, X.R.y)), 1, 1e-12);
  }
}

}  // namespace
}  // namespace manyhands
