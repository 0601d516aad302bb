#include <gtest/gtest.h>

#include <array>

#include "manyhands/perception/plane.h"
#include "tests/perception/points.h"

namespace manyhands {
namespace {

/// A table of points within `roughness` of normal . p = offset, and others well off it.
struct Scene {
  Scene(std::uint64_t seed, double roughness) {
    Cloud cloud(seed);
    const Mat3<double> R = cloud.rotation();
    normal = R.z, offset = cloud.uniform(-1, 1);
    for (const Point& p : cloud.in_box(600, {0.5, 0.4, roughness})) points.push_back(R * p + offset * normal);
    for (const Point& p : cloud.in_box(300, {0.1, 0.1, 0.1}))
      points.push_back(R * (p + Point{0, 0, 0.3}) + offset * normal);
    points.push_back({kNan, 0, 0});
  }

  Point normal;
  double offset;
  std::vector<Point> points{};
};

TEST(Plane, IsFoundAmongWhatStandsOnIt) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Scene scene(seed, 0);
    const std::optional<FoundPlane> found = find_plane(scene.points, {.threshold = 0.005});
    ASSERT_TRUE(found) << "seed " << seed;
    const double side = dot(found->normal, scene.normal);
    EXPECT_NEAR(std::abs(side), 1, 1e-12) << "seed " << seed;
    EXPECT_NEAR(found->offset, std::copysign(scene.offset, side * scene.offset), 1e-12) << "seed " << seed;
    EXPECT_EQ(found->inlier_count, 600u) << "seed " << seed;
    for (std::size_t i = 0; i < scene.points.size(); ++i) EXPECT_EQ(found->inliers[i], i < 600) << i;
  }
}

/// z = a x + b y + c with four points off by +d, -d, +d, -d around a square: the fit is the plane between them,
/// whatever three of them say.
TEST(Plane, IsTheLeastSquaresFit) {
  constexpr double d = 0.004;
  std::vector<Point> points;
  for (int i = 0; i < 100; ++i) {
    points.push_back({1, 1, d}), points.push_back({-1, 1, -d});
    points.push_back({-1, -1, d}), points.push_back({1, -1, -d});
  }
  const std::optional<FoundPlane> found = find_plane(points, {.threshold = 0.05});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->normal.z, 1, 1e-12);
  EXPECT_NEAR(found->offset, 0, 1e-12);
}

TEST(Plane, NoneIsNone) {
  Cloud cloud(0);
  EXPECT_FALSE(find_plane({}, {}));
  EXPECT_FALSE(find_plane(std::array<Point, 2>{{{0, 0, 0}, {1, 0, 0}}}, {}));
  EXPECT_FALSE(find_plane(cloud.in_box(1000, {1, 1, 1}), {.threshold = 1e-5})) << "a tenth of them lies on no plane";
  const std::vector<Point> line(50, Point{1, 2, 3});
  EXPECT_FALSE(find_plane(line, {})) << "points in one place span none";
}

TEST(Plane, RefusesNonsense) {
  for (const double threshold : {0.0, -1.0, kNan, kInfinity})
    EXPECT_THROW((void)find_plane({}, {.threshold = threshold}), std::invalid_argument);
  EXPECT_THROW((void)find_plane({}, {.iterations = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace manyhands
