#include <gtest/gtest.h>

#include "manyhands/perception/nearest.h"
#include "tests/perception/points.h"

namespace manyhands {
namespace {

NearestPoints::Found by_looking_at_all(std::span<const Point> points, const Point& query) {
  NearestPoints::Found best{0, kInfinity};
  for (std::size_t i = 0; i < points.size(); ++i)
    if (const double d = norm(points[i] - query); d < best.distance) best = {i, d};
  return best;
}

void expect_as_by_looking_at_all(std::span<const Point> points, std::span<const Point> queries) {
  const NearestPoints cloud(points);
  for (const Point& query : queries) {
    const std::optional<NearestPoints::Found> found = cloud.find(query);
    const NearestPoints::Found expected = by_looking_at_all(points, query);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->index, expected.index);
    EXPECT_EQ(found->distance, expected.distance);
  }
}

TEST(NearestPoints, IsTheNearestOfAll) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Cloud cloud(seed);
    std::vector<Point> points = cloud.in_box(1 + 37 * seed, {1, 0.5, 0.01});
    points.push_back({kNan, 0, 0});
    expect_as_by_looking_at_all(points, cloud.in_box(200, {1.5, 1, 1}));
  }
}

/// Many at the same distance, many in the same place: the first of them.
TEST(NearestPoints, TheFirstOfSeveral) {
  std::vector<Point> grid;
  for (int i = 0; i < 512; ++i) grid.push_back({(i / 2) % 4 * 1.0, i / 8 % 8 * 1.0, i / 64 * 1.0});
  std::vector<Point> queries;
  for (int i = 0; i < 512; ++i) queries.push_back({i % 8 * 0.5, i / 8 % 8 * 0.5, i / 64 * 0.5});
  expect_as_by_looking_at_all(grid, queries);
}

TEST(NearestPoints, NoneOfNone) {
  EXPECT_FALSE(NearestPoints({}).find({0, 0, 0}));
  const std::vector<Point> nowhere{{kNan, 0, 0}, {0, kInfinity, 0}}, one{{0, 0, 0}};
  EXPECT_FALSE(NearestPoints(nowhere).find({0, 0, 0}));
  EXPECT_FALSE(NearestPoints(one).find({kNan, 0, 0}));
  EXPECT_EQ(NearestPoints(one).find({0, 3, 4})->distance, 5);
}

}  // namespace
}  // namespace manyhands
