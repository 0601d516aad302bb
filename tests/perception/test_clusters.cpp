#include <gtest/gtest.h>

#include "manyhands/perception/clusters.h"
#include "tests/perception/points.h"

namespace manyhands {
namespace {

bool are_near(const Point& a, const Point& b, double reach) { return norm(a - b) <= reach; }

/// DBSCAN by its definition, every point beside every other: clusters grow from cores in the order of the points, and
/// what is no core takes the lowest of the clusters that it touches.
std::vector<int> by_definition(std::span<const Point> points, double reach, int least) {
  const auto is_core = [&](const Point& p) {
    int count = 0;
    for (const Point& other : points) count += are_near(p, other, reach);
    return count >= least;
  };
  std::vector<int> label(points.size(), -1);
  std::vector<bool> core;
  for (const Point& p : points) core.push_back(is_core(p));
  int clusters = 0;
  for (std::size_t first = 0; first < points.size(); ++first) {
    if (!core[first] || label[first] != -1) continue;
    std::vector<std::size_t> front{first};
    label[first] = clusters;
    while (!front.empty()) {
      const std::size_t i = front.back();
      front.pop_back();
      for (std::size_t j = 0; j < points.size(); ++j) {
        if (!core[j] || label[j] != -1 || !are_near(points[i], points[j], reach)) continue;
        label[j] = clusters;
        front.push_back(j);
      }
    }
    ++clusters;
  }
  for (std::size_t j = 0; j < points.size(); ++j) {
    if (core[j]) continue;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (core[i] && are_near(points[i], points[j], reach) && (label[j] == -1 || label[i] < label[j]))
        label[j] = label[i];
  }
  return label;
}

TEST(Clusters, AreThoseOfTheDefinition) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Cloud cloud(seed);
    std::vector<Point> points = cloud.in_box(40, {1, 1, 1});
    for (int blob = 0; blob < 4; ++blob) {
      const Point centre = cloud.in_box(Point{1, 1, 1});
      for (const Point& p : cloud.in_box(40, {0.12, 0.12, 0.12})) points.push_back(centre + p);
    }
    points.push_back({kNan, 0, 0});
    points.push_back({0, -kInfinity, 0});
    const int least = 1 + static_cast<int>(seed % 6);
    EXPECT_EQ(dbscan(points, 0.1, least), by_definition(points, 0.1, least)) << "seed " << seed;
  }
}

TEST(Clusters, PointsAtExactlyTheReachAreNeighbours) {
  std::vector<Point> grid;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) grid.push_back({i * 0.25, j * 0.25, 0});
  EXPECT_EQ(dbscan(grid, 0.25, 3), std::vector<int>(36, 0));  // corners have three, themselves included
  EXPECT_EQ(dbscan(grid, 0.2499, 2), std::vector<int>(36, -1));
}

TEST(Clusters, AChainIsOneAndAGapIsTwo) {
  std::vector<Point> chain;
  for (int i = 0; i < 1000; ++i) chain.push_back({i * 0.01, 0, 0});
  EXPECT_EQ(dbscan(chain, 0.011, 2), std::vector<int>(1000, 0));
  chain.erase(chain.begin() + 500);
  std::vector<int> two(999, 0);
  std::fill(two.begin() + 500, two.end(), 1);
  EXPECT_EQ(dbscan(chain, 0.011, 2), two);
}

TEST(Clusters, RefuseNonsense) {
  const std::vector<Point> one{{0, 0, 0}};
  EXPECT_TRUE(dbscan({}, 0.1, 1).empty());
  for (const double reach : {0.0, -1.0, kNan, kInfinity})
    EXPECT_THROW((void)dbscan(one, reach, 1), std::invalid_argument);
  EXPECT_THROW((void)dbscan(one, 0.1, 0), std::invalid_argument);
}

}  // namespace
}  // namespace manyhands
