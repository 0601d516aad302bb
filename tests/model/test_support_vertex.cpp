// The search for a supporting vertex finds what a look at every vertex finds.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "manyhands/model/support_vertex.h"

namespace manyhands {
namespace {

using Point = Vec3<double>;

struct Cloud {
  const char* name;
  std::vector<Point> points;
};

/// Balls, needles, plates, prisms and slabs, from micrometres to kilometres, some far from their origin.
std::vector<Cloud> clouds() {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  const auto ellipsoid = [&](int n, const Point& half, const Point& middle) {
    std::vector<Point> points;
    for (int i = 0; i < n; ++i) {
      const Point p{normal(random), normal(random), normal(random)};
      const double r = 1 / norm(p);
      points.push_back(middle + Point{half.x * r * p.x, half.y * r * p.y, half.z * r * p.z});
    }
    return points;
  };
  const auto prism = [](int sides, double radius, double half) {
    std::vector<Point> points;
    for (int i = 0; i < sides; ++i) {
      const double angle = 2 * std::numbers::pi * i / sides;
      for (const double z : {-half, half}) points.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
    }
    return points;
  };
  std::vector<Cloud> all{
      {"ball of few", ellipsoid(12, {1, 1, 1}, Point::zero())},
      {"ball at the limit", ellipsoid(21, {1, 1, 1}, Point::zero())},
      {"ball", ellipsoid(400, {1, 1, 1}, Point::zero())},
      {"ball of many", ellipsoid(6000, {1, 1, 1}, Point::zero())},
      {"needle", ellipsoid(300, {1, 1e-3, 1e-3}, Point::zero())},
      {"slab", ellipsoid(300, {1, 1, 1e-4}, Point::zero())},
      {"tiny", ellipsoid(300, {1e-6, 2e-6, 1e-6}, Point::zero())},
      {"vast", ellipsoid(300, {1e3, 2e3, 1e3}, Point::zero())},
      {"far off", ellipsoid(300, {0.1, 0.1, 0.1}, {10, -20, 5})},
      {"prism", prism(64, 0.3, 0.1)},
      {"disc", prism(100, 1, 1e-5)},
      {"flat", prism(40, 1, 0)},
      {"straight", {{0, 0, 0}, {0.1, 0.2, 0.3}, {0.2, 0.4, 0.6}}},
  };
  std::vector<Point> grid;
  for (int i = 0; i < 11; ++i) {
    for (int j = 0; j < 11; ++j) {
      for (const double z : {-0.1, 0.1}) grid.push_back({0.1 * i, 0.1 * j, z + 1e-9 * normal(random)});
    }
  }
  all.push_back({"nearly flat faces of many vertices", grid});
  return all;
}

/// Random directions, the normals of faces, where vertices tie, and what lies between cells of the table.
std::vector<Point> directions(const ConvexPolyhedron& hull) {
  std::mt19937_64 random(12);
  std::normal_distribution<double> normal;
  std::vector<Point> all;
  for (int i = 0; i < 2000; ++i) all.push_back({normal(random), normal(random), normal(random)});
  for (const FacePlane& plane : hull.planes) all.push_back(plane.normal);
  for (const double x : {-1.0, 0.0, 1.0}) {
    for (const double y : {-1.0, 0.0, 1.0}) {
      for (const double z : {-1.0, -0.0, 0.0, 1.0}) all.push_back({x, y, z});
    }
  }
  return all;
}

TEST(SupportVertex, IsAsHighAsAScanOfAllVerticesFinds) {
  for (const Cloud& cloud : clouds()) {
    const ConvexPolyhedron hull = convex_polyhedron(std::span<const Point>(cloud.points));
    // The hull itself is convex to this only: a plane of Qhull's may lie a few roundings within a vertex.
    const double rounding = 1e-14 * hull.bound;
    for (const Point& direction : directions(hull)) {
      for (const double length : {1.0, 1e-12, 1e12}) {
        const Point d = length * direction;
        double highest = -std::numeric_limits<double>::infinity();
        for (const Point& p : hull.vertices) highest = std::max(highest, dot(p, d));
        const std::size_t found = support_vertex(hull, d);
        ASSERT_LT(found, hull.vertices.size());
        ASSERT_GE(dot(hull.vertices[found], d), highest - rounding * norm(d))
            << cloud.name << ", d = " << d.x << " " << d.y << " " << d.z;
      }
    }
  }
}

TEST(SupportVertex, DependsOnTheDirectionAloneAndNotOnItsLength) {
  for (const Cloud& cloud : clouds()) {
    const ConvexPolyhedron hull = convex_polyhedron(std::span<const Point>(cloud.points));
    for (const Point& d : directions(hull)) EXPECT_EQ(support_vertex(hull, d), support_vertex(hull, 1024.0 * d));
  }
}

TEST(SupportVertex, IsSomeVertexWhereThereIsNoDirection) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();
  for (const Cloud& cloud : clouds()) {
    const ConvexPolyhedron hull = convex_polyhedron(std::span<const Point>(cloud.points));
    for (const Point& d : {Point::zero(), Point{kNan, 0, 1}, Point{kInf, -kInf, 1}, Point{0, 0, -kInf},
                           Point{1e-310, 0, -1e-312}, Point{1e308, 1e308, -1e308}}) {
      EXPECT_LT(support_vertex(hull, d), hull.vertices.size()) << cloud.name;
    }
  }
}

}  // namespace
}  // namespace manyhands
