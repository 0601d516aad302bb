// Bounds hold their shapes tightly, and the broad phase finds exactly the pairs that trying all of them finds.
#include <gtest/gtest.h>

#include "manyhands/physics/collision/broad/broad_phase.h"
#include "tests/physics/collision/convex_truth.h"

namespace manyhands::testing {
namespace {

using enum ShapeType;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Bounds, AreWhatTheShapesReach) {
  RandomBodies random(31);
  for (const ShapeType type : {kSphere, kCapsule, kCylinder, kBox}) {
    for (int trial = 0; trial < 500; ++trial) {
      Body body = random.body(type);
      body.X_WB.p = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
      const auto bounds = world_bounds(type, body.size, body.X_WB);
      EXPECT_NEAR(bounds.high.x, support(body, {1, 0, 0}), 1e-12);
      EXPECT_NEAR(bounds.high.y, support(body, {0, 1, 0}), 1e-12);
      EXPECT_NEAR(bounds.high.z, support(body, {0, 0, 1}), 1e-12);
      EXPECT_NEAR(bounds.low.x, -support(body, {-1, 0, 0}), 1e-12);
      EXPECT_NEAR(bounds.low.y, -support(body, {0, -1, 0}), 1e-12);
      EXPECT_NEAR(bounds.low.z, -support(body, {0, 0, -1}), 1e-12);
    }
  }
}

TEST(Bounds, SphereReachesTheFarthestPoint) {
  RandomBodies random(32);
  for (const ShapeType type : {kSphere, kCapsule, kCylinder, kBox}) {
    for (int trial = 0; trial < 50; ++trial) {
      const Body body = random.body(type);
      double farthest = 0;
      for (int i = 0; i < 20000; ++i) {
        const Vec n = unit(Vec{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
        farthest = std::max(farthest, support(body, n));
      }
      const double radius = bounding_radius(type, body.size);
      EXPECT_LE(farthest, radius + 1e-12);
      EXPECT_GT(farthest, 0.995 * radius);
    }
  }
}

TEST(Bounds, OfAPlaneAreEndless) {
  const auto bounds = world_bounds(kPlane, Vec::zero(), Pose::identity());
  EXPECT_EQ(bounds.low.z, -kInfinity);
  EXPECT_EQ(bounds.high.x, kInfinity);
  EXPECT_EQ(bounding_radius(kPlane, Vec::zero()), kInfinity);
}

std::vector<NearPair> every_pair(const std::vector<Aabb<double>>& bounds, const std::vector<bool>& is_static) {
  std::vector<NearPair> pairs;
  for (std::uint32_t a = 0; a < bounds.size(); ++a) {
    for (std::uint32_t b = a + 1; b < bounds.size(); ++b) {
      const auto along = [](double low_a, double high_a, double low_b, double high_b) {
        return low_a <= high_b && low_b <= high_a;
      };
      const auto &p = bounds[a], &q = bounds[b];
      const bool overlapping = along(p.low.x, p.high.x, q.low.x, q.high.x) &&
                               along(p.low.y, p.high.y, q.low.y, q.high.y) &&
                               along(p.low.z, p.high.z, q.low.z, q.high.z);
      if (overlapping && !(is_static[a] && is_static[b])) pairs.push_back({a, b});
    }
  }
  return pairs;
}

class BroadPhaseSteps : public ::testing::Test {
 protected:
  Aabb<double> some_bounds(double spread, double size) {
    const Vec centre{random_.uniform(-spread, spread), random_.uniform(-spread, spread), random_.uniform(-1, 1)};
    const Vec half{random_.uniform(0, size), random_.uniform(0, size), random_.uniform(0, size)};
    return {centre - half, centre + half};
  }

  RandomBodies random_{33};
};

TEST_F(BroadPhaseSteps, FindWhatTryingAllPairsFinds) {
  constexpr std::size_t kGeoms = 300;
  for (const double share_of_static : {0.0, 0.3, 1.0}) {
    std::vector<bool> is_static;
    std::vector<Aabb<double>> bounds;
    for (std::size_t g = 0; g < kGeoms; ++g) {
      is_static.push_back(random_.chance(share_of_static));
      bounds.push_back(some_bounds(3, random_.chance(0.02) ? 3 : 0.3));
    }
    BroadPhase broad_phase(is_static);
    for (int step = 0; step < 60; ++step) {
      for (std::size_t g = 0; g < kGeoms; ++g) {
        if (is_static[g]) continue;
        const double pace = step == 30 ? 5 : 0.05;  // once, everything leaps, and another axis is the widest
        const Vec by{random_.uniform(-pace, pace), random_.uniform(-pace, pace),
                     (step > 30 ? 20 : 1) * random_.uniform(-pace, pace)};
        bounds[g] = {bounds[g].low + by, bounds[g].high + by};
      }
      const auto found = broad_phase.update(bounds);
      ASSERT_EQ(std::vector<NearPair>(found.begin(), found.end()), every_pair(bounds, is_static)) << "step " << step;
    }
  }
}

TEST_F(BroadPhaseSteps, EqualTouchingEndlessAndSpoiledBoundsAreTreatedAsTheyAre) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Aabb<double> unit_box{{0, 0, 0}, {1, 1, 1}}, beside{{1, 0, 0}, {2, 1, 1}};
  const Aabb<double> just_off{{std::nextafter(2.0, 3.0), 0, 0}, {3, 1, 1}};
  const Aabb<double> endless{{-kInfinity, -kInfinity, -kInfinity}, {kInfinity, kInfinity, kInfinity}};
  const Aabb<double> spoiled{{nan, 0, 0}, {nan, 1, 1}}, half_spoiled{{0, 0, nan}, {1, 1, 1}};
  std::vector<Aabb<double>> bounds{unit_box, beside, unit_box, spoiled, endless, just_off, half_spoiled, endless};
  const std::vector<bool> is_static{false, false, false, false, true, false, false, true};
  BroadPhase broad_phase(is_static);
  const std::vector<NearPair> expected{{0, 1}, {0, 2}, {0, 4}, {0, 7}, {1, 2}, {1, 4},
                                       {1, 7}, {2, 4}, {2, 7}, {4, 5}, {5, 7}};
  for (int step = 0; step < 3; ++step) {
    const auto found = broad_phase.update(bounds);
    EXPECT_EQ(std::vector<NearPair>(found.begin(), found.end()), expected);
  }
  bounds[0] = bounds[2] = spoiled;
  EXPECT_EQ(broad_phase.update(bounds).size(), 4u);
  EXPECT_EQ(every_pair(bounds, is_static).size(), 4u);
}

TEST_F(BroadPhaseSteps, NothingAllocatesOnceThePairsAreAsManyAsEver) {
  std::vector<Aabb<double>> bounds;
  for (int g = 0; g < 200; ++g) bounds.push_back(some_bounds(2, 0.4));
  BroadPhase broad_phase(std::vector<bool>(bounds.size(), false));
  broad_phase.update(bounds);
  const auto* memory = broad_phase.update(bounds).data();
  for (int step = 0; step < 10; ++step) EXPECT_EQ(broad_phase.update(bounds).data(), memory);
}

TEST(BroadPhase, RefusesBoundsOfOtherGeoms) {
  BroadPhase broad_phase({false, true});
  EXPECT_THROW(broad_phase.update(std::vector<Aabb<double>>(3)), std::invalid_argument);
  EXPECT_EQ(BroadPhase(std::vector<bool>{}).update({}).size(), 0u);
}

}  // namespace
}  // namespace manyhands::testing
