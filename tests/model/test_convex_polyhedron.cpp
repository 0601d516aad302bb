#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "manyhands/model/convex_polyhedron.h"
#include "manyhands/model/model.h"

namespace manyhands {
namespace {

using Point = Vec3<double>;

ConvexPolyhedron hull_of(const std::vector<Point>& points) { return convex_polyhedron(std::span<const Point>(points)); }

std::vector<Point> ball(int n, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Point> points;
  for (int i = 0; i < n; ++i) {
    const Point p{normal(random), normal(random), normal(random)};
    points.push_back((1 / norm(p)) * p);
  }
  return points;
}

/// What holds of every closed convex polyhedron.
void expect_sound(const ConvexPolyhedron& hull, const std::vector<Point>& points) {
  std::size_t corners = 0;
  for (std::size_t f = 0; f < hull.faces.size(); ++f) {
    const FacePlane& plane = hull.planes[f];
    EXPECT_NEAR(norm(plane.normal), 1, 1e-12);
    for (const Point& p : points) EXPECT_LE(dot(plane.normal, p) - plane.offset, 1e-5 * hull.bound);
    const auto face = hull.faces[f];
    corners += face.size();
    for (std::size_t i = 0; i < face.size(); ++i) {
      const auto at = [&](std::size_t k) {
        return hull.vertices[static_cast<std::size_t>(face[(i + k) % face.size()])];
      };
      EXPECT_NEAR(dot(plane.normal, at(0)), plane.offset, 1e-5 * hull.bound);
      EXPECT_GE(dot(plane.normal, cross(at(1) - at(0), at(2) - at(1))), -1e-12) << "not counter-clockwise";
    }
  }
  EXPECT_EQ(hull.planes.size(), hull.faces.size());
  EXPECT_EQ(hull.neighbours.size(), hull.vertices.size());
  EXPECT_EQ(hull.faces_of.size(), hull.vertices.size());
  // Euler: V - E + F = 2; each edge lies on two faces.
  EXPECT_EQ(hull.vertices.size() + hull.faces.size(), corners / 2 + 2);
}

TEST(ConvexPolyhedron, ACubeHasSixFacesWhateverLiesInside) {
  std::vector<Point> points{{0, 0, 0}, {0.3, 0.2, 0.1}};
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-2.0, 2.0}) {
      for (const double z : {-3.0, 3.0}) points.push_back({x, y, z});
    }
  }
  const ConvexPolyhedron hull = hull_of(points);
  expect_sound(hull, points);
  EXPECT_EQ(hull.vertices.size(), 8u);
  EXPECT_EQ(hull.faces.size(), 6u);
  EXPECT_NEAR(hull.volume, 48, 1e-12);
  EXPECT_LT(norm(hull.centre), 1e-12);
  EXPECT_NEAR(hull.bound, std::sqrt(14.0), 1e-12);
}

TEST(ConvexPolyhedron, RoundedCoordinatesStillGiveWholeFaces) {
  std::vector<Vec3<float>> points;
  for (int i = 0; i < 64; ++i) {
    const auto angle = static_cast<float>(2 * std::numbers::pi * i / 64);
    for (const float z : {0.1f, 0.3f}) points.push_back({1 + 0.3f * std::cos(angle), 0.3f * std::sin(angle), z});
  }
  const ConvexPolyhedron hull = convex_polyhedron(std::span<const Vec3<float>>(points));
  EXPECT_EQ(hull.faces.size(), 66u);
  EXPECT_NEAR(hull.volume, 0.2 * 32 * 0.09 * std::sin(2 * std::numbers::pi / 64), 1e-7);
}

TEST(ConvexPolyhedron, ManyPointsOnABall) {
  const std::vector<Point> points = ball(2000, 1);
  const ConvexPolyhedron hull = hull_of(points);
  expect_sound(hull, points);
  EXPECT_EQ(hull.vertices.size(), points.size());
  EXPECT_NEAR(hull.volume, 4.0 / 3 * std::numbers::pi, 0.04);
}

TEST(ConvexPolyhedron, SlabsAndNeedles) {
  for (const Point s : {Point{1, 1, 1e-4}, {1, 1e-3, 1e-3}, {1e-3, 1e-3, 1e-3}, {10, 10, 1e-2}}) {
    std::vector<Point> points = ball(100, 2);
    for (Point& p : points) p = {s.x * p.x, s.y * p.y, s.z * p.z};
    const ConvexPolyhedron hull = hull_of(points);
    EXPECT_NEAR(hull.volume / (s.x * s.y * s.z), hull_of(ball(100, 2)).volume, 1e-9);
  }
}

TEST(ConvexPolyhedron, FlatAndStraightCloudsGetThickness) {
  const std::vector<Point> flat{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {0.5, 0.5, 1}};
  const ConvexPolyhedron plate = hull_of(flat);
  EXPECT_NEAR(plate.volume, std::sqrt(2.0) * 1e-4, 1e-9);
  EXPECT_EQ(plate.faces.size(), 6u);
  const ConvexPolyhedron rod = hull_of({{0, 0, 0}, {1, 1, 0}, {2, 2, 0}});
  EXPECT_NEAR(rod.volume, 8 * std::sqrt(8.0) * 1e-8, 1e-12);
}

TEST(ConvexPolyhedron, RefusesWhatHasNoExtent) {
  EXPECT_THROW((void)hull_of({}), ModelError);
  EXPECT_THROW((void)hull_of({{1, 1, 1}, {1, 1, 1}}), ModelError);
  EXPECT_THROW((void)hull_of({{1, 1, 1}, {std::nan(""), 1, 1}}), ModelError);
}

}  // namespace
}  // namespace manyhands
