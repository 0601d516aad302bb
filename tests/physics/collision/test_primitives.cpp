// Contact of simple shapes: the distance is the true one, the points lie on both surfaces, and every lane is the
// scalar.
#include <gtest/gtest.h>

#include "manyhands/physics/collision/closed_form/collide_box.h"
#include "manyhands/physics/collision/closed_form/collide_capsule.h"
#include "manyhands/physics/collision/closed_form/collide_cylinder.h"
#include "manyhands/physics/collision/closed_form/collide_sphere.h"
#include "tests/physics/collision/convex_truth.h"

namespace manyhands::testing {
namespace {

struct PairOfShapes {
  const char* name;
  ShapeType a, b;
};

using enum ShapeType;
constexpr std::array<PairOfShapes, 10> kPairs{{{"sphere_sphere", kSphere, kSphere},
                                               {"sphere_capsule", kSphere, kCapsule},
                                               {"sphere_cylinder", kSphere, kCylinder},
                                               {"sphere_box", kSphere, kBox},
                                               {"sphere_plane", kSphere, kPlane},
                                               {"capsule_capsule", kCapsule, kCapsule},
                                               {"capsule_box", kCapsule, kBox},
                                               {"capsule_plane", kCapsule, kPlane},
                                               {"cylinder_plane", kCylinder, kPlane},
                                               {"box_plane", kBox, kPlane}}};

template <Number T>
Manifold<T> collide(ShapeType type_A, ShapeType type_B, const Vec3<T>& size_A, const Transform<T>& X_WA,
                    const Vec3<T>& size_B, const Transform<T>& X_WB) {
  const auto with = [&](auto function) { return function(size_A, X_WA, size_B, X_WB, T(real_t<T>(0.01))); };
  if (type_A == kSphere) {
    if (type_B == kSphere) return with(collide_sphere_sphere<T>);
    if (type_B == kCapsule) return with(collide_sphere_capsule<T>);
    if (type_B == kCylinder) return with(collide_sphere_cylinder<T>);
    return with(type_B == kBox ? collide_sphere_box<T> : collide_sphere_plane<T>);
  }
  if (type_A == kCapsule) {
    if (type_B == kCapsule) return with(collide_capsule_capsule<T>);
    return with(type_B == kBox ? collide_capsule_box<T> : collide_capsule_plane<T>);
  }
  return with(type_A == kCylinder ? collide_cylinder_plane<T> : collide_box_plane<T>);
}

Manifold<double> collide(const Body& a, const Body& b) {
  return collide<double>(a.type, b.type, a.size, a.X_WB, b.size, b.X_WB);
}

class PrimitivePairs : public ::testing::TestWithParam<PairOfShapes> {
 protected:
  std::string where(int trial, const Body& a, const Body& b) {
    return "trial " + std::to_string(trial) + "\nA " + describe(a) + "\nB " + describe(b);
  }
};

TEST_P(PrimitivePairs, DistanceIsTheTrueOne) {
  RandomBodies random(1);
  for (int trial = 0; trial < 150; ++trial) {
    const auto [a, b] = random.pair(GetParam().a, GetParam().b);
    SCOPED_TRACE(where(trial, a, b));
    const auto m = collide(a, b);
    const double phi = m.phi[deepest(m)];
    ASSERT_NEAR(norm(m.normal), 1, 1e-12);
    // The plane across the normal keeps the shapes as far apart as said, so they are no nearer; the points on both
    // surfaces (below) say that they are no farther. Of shapes that overlap, no direction found leads out sooner.
    ASSERT_NEAR(separation(a, b, m.normal), phi, 1e-9);
    if (phi < 0) {
      ASSERT_GT(phi, searched_distance(a, b) - 1e-9);
    }
  }
}

TEST_P(PrimitivePairs, PointsLieOnBothSurfaces) {
  RandomBodies random(2);
  for (int trial = 0; trial < 1500; ++trial) {
    const auto [a, b] = random.pair(GetParam().a, GetParam().b);
    SCOPED_TRACE(where(trial, a, b));
    const auto m = collide(a, b);
    const std::size_t first = deepest(m);
    for (std::size_t k = 0; k < m.phi.size(); ++k) {
      if (!std::isfinite(m.phi[k])) continue;
      const Vec p_A = m.p[k] - 0.5 * m.phi[k] * m.normal, p_B = m.p[k] + 0.5 * m.phi[k] * m.normal;
      // Beside the deepest point the one normal is only nearly that of the surfaces.
      const double tolerance = k == first ? 1e-9 : 1.05 * std::max(a.size.x, std::abs(m.phi[k]));
      ASSERT_LT(std::abs(distance_from(b, p_B)), tolerance) << "point " << k;
      ASSERT_LT(std::abs(distance_from(a, p_A)), tolerance) << "point " << k;
    }
  }
}

TEST_P(PrimitivePairs, EveryLaneIsTheScalar) {
  RandomBodies random(3);
  const auto [name, type_A, type_B] = GetParam();
  const auto bodies = [&] { return random.pair(type_A, type_B); };
  const auto function = [&, a = type_A, b = type_B]<class T>(const Vec3<T>& size_A, const Transform<T>& X_WA,
                                                             const Vec3<T>& size_B, const Transform<T>& X_WB) {
    return collide<T>(a, b, size_A, X_WA, size_B, X_WB);
  };
  expect_lanes_collide_as_scalars<Lanes<float, 4>>(1000, bodies, function);
  expect_lanes_collide_as_scalars<Lanes<float, 8>>(1000, bodies, function);
  expect_lanes_collide_as_scalars<Lanes<float, 16>>(1000, bodies, function);
}

TEST_P(PrimitivePairs, SinglePrecisionKeepsTheDistance) {
  RandomBodies random(4);
  const auto [name, type_A, type_B] = GetParam();
  for (int trial = 0; trial < 1500; ++trial) {
    const auto [a, b] = random.pair(type_A, type_B);
    SCOPED_TRACE(where(trial, a, b));
    const auto m = collide(a, b);
    const auto s = collide<float>(type_A, type_B, broadcast<float>(a.size), broadcast<float>(a.X_WB),
                                  broadcast<float>(b.size), broadcast<float>(b.X_WB));
    // Poses of about 1 m, sizes to 0.4 m: some roundings of 1e-7.
    ASSERT_NEAR(s.phi[deepest(s)], m.phi[deepest(m)], 2e-6);
    ASSERT_NEAR(norm(broadcast<double>(s.normal)), 1, 1e-6);
  }
}

TEST_P(PrimitivePairs, MovesWithTheWorld) {
  RandomBodies random(5);
  for (int trial = 0; trial < 500; ++trial) {
    auto [a, b] = random.pair(GetParam().a, GetParam().b);
    SCOPED_TRACE(where(trial, a, b));
    const Pose X{random.rotation(), {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}};
    const auto before = collide(a, b);
    // Deep inside, where two ways out may be equally short, rounding decides.
    if (before.phi[deepest(before)] < -std::min(0.01, 0.9 * a.size.x)) continue;
    a.X_WB = X * a.X_WB;
    b.X_WB = X * b.X_WB;
    const auto after = collide(a, b);
    const std::size_t k = deepest(before);
    ASSERT_NEAR(after.phi[deepest(after)], before.phi[k], 1e-12);
    ASSERT_NEAR(norm(after.normal - X.R * before.normal), 0, 1e-6);
    double nearest = 1;
    for (std::size_t i = 0; i < after.phi.size(); ++i) {
      if (std::isfinite(after.phi[i])) nearest = std::min(nearest, norm(after.p[i] - X * before.p[k]));
    }
    ASSERT_LT(nearest, 0.01 * (a.size.x + a.size.y));
  }
}

TEST_P(PrimitivePairs, HardCasesAreFinite) {
  RandomBodies random(8);
  const auto [name, type_A, type_B] = GetParam();
  for (int trial = 0; trial < 20000; ++trial) {
    const auto [a, b] = random.hard_pair(type_A, type_B);
    SCOPED_TRACE(where(trial, a, b));
    ASSERT_TRUE(is_sound(collide(a, b)));
    ASSERT_TRUE(is_sound(collide<float>(type_A, type_B, broadcast<float>(a.size), broadcast<float>(a.X_WB),
                                        broadcast<float>(b.size), broadcast<float>(b.X_WB))));
  }
}

INSTANTIATE_TEST_SUITE_P(All, PrimitivePairs, ::testing::ValuesIn(kPairs),
                         [](const auto& pair) { return std::string(pair.param.name); });

TEST(Primitives, SameShapesSwapSides) {
  RandomBodies random(6);
  for (const ShapeType type : {kSphere, kCapsule}) {
    for (int trial = 0; trial < 1000; ++trial) {
      const auto [a, b] = random.pair(type, type);
      const auto m = collide(a, b), other = swapped(collide(b, a));
      ASSERT_NEAR(m.phi[deepest(m)], other.phi[deepest(other)], 1e-12);
      if (m.phi[deepest(m)] > -0.99 * (a.size.x + b.size.x)) {
        ASSERT_NEAR(norm(m.normal - other.normal), 0, 1e-6);
      }
    }
  }
}

constexpr double kTiny = 1e-12;

Pose at(double x, double y, double z) { return {Mat3<double>::identity(), {x, y, z}}; }
Pose lying(double x, double y, double z) {  // its z along the world's x
  return {{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}, {x, y, z}};
}
int points(const Manifold<double>& m, double within = 1e6) {
  return static_cast<int>(std::count_if(m.phi.begin(), m.phi.end(), [&](double phi) { return phi < within; }));
}

TEST(Primitives, CoincidentCentresPartInAFixedDirection) {
  const Body ball{kSphere, {0.1, 0, 0}, at(1, 2, 3)}, can{kCylinder, {0.3, 0.2, 0}, at(1, 2, 3)};
  const Body pill{kCapsule, {0.05, 0.2, 0}, at(1, 2, 3)}, box{kBox, {0.3, 0.2, 0.4}, at(1, 2, 3)};
  const auto expect = [](const Manifold<double>& m, const Vec& normal, double phi) {
    EXPECT_NEAR(norm(m.normal - normal), 0, kTiny);
    EXPECT_NEAR(m.phi[deepest(m)], phi, kTiny);
  };
  expect(collide(ball, ball), {0, 0, 1}, -0.2);
  expect(collide(ball, pill), {1, 0, 0}, -0.15);
  expect(collide(ball, can), {0, 0, -1}, -0.3);
  expect(collide(ball, box), {0, -1, 0}, -0.3);
  expect(collide(pill, pill), {1, 0, 0}, -0.1);
  expect(collide(pill, box), {0, -1, 0}, -0.25);
}

TEST(Primitives, ParallelCapsulesTouchAtBothEndsOfTheirOverlap) {
  const Body low{kCapsule, {0.02, 0.1, 0}, lying(0, 0, 0)}, high{kCapsule, {0.01, 0.05, 0}, lying(0.08, 0, 0.029)};
  const auto m = collide(low, high);
  ASSERT_EQ(points(m), 2);
  EXPECT_NEAR(norm(m.normal - Vec{0, 0, 1}), 0, kTiny);
  const double left = std::min(m.p[0].x, m.p[1].x), right = std::max(m.p[0].x, m.p[1].x);
  EXPECT_NEAR(left, 0.03, kTiny);
  EXPECT_NEAR(right, 0.10, kTiny);
  EXPECT_NEAR(m.phi[0], -0.001, kTiny);
  EXPECT_NEAR(m.phi[1], -0.001, kTiny);
}

TEST(Primitives, CrossedCapsulesTouchOnce) {
  const Body low{kCapsule, {0.02, 0.1, 0}, lying(0, 0, 0)};
  const Body high{kCapsule, {0.01, 0.1, 0}, {{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}, {0.02, 0.03, 0.03}}};
  const auto m = collide(low, high);
  ASSERT_EQ(points(m), 1);
  EXPECT_NEAR(m.phi[deepest(m)], 0, kTiny);
  EXPECT_NEAR(norm(m.p[deepest(m)] - Vec{0.02, 0, 0.02}), 0, kTiny);
}

// A capsule that rolls off its line by small angles moves its contact's distances by little: nothing jumps.
TEST(Primitives, LyingCapsuleTiltsSmoothly) {
  const Body box{kBox, {0.05, 0.05, 0.05}, at(0, 0, -0.05)};
  for (double tilt = -0.01; tilt < 0.01; tilt += 1e-5) {
    const double c = std::cos(tilt), s = std::sin(tilt);
    const Body pill{kCapsule, {0.01, 0.03, 0}, {{{0, 1, 0}, {-s, 0, c}, {c, 0, s}}, {0.03, 0, 0.01}}};
    const auto m = collide(pill, box);
    ASSERT_EQ(points(m, 0.02), 2) << tilt;
    const std::size_t first = m.p[0].x < m.p[1].x ? 0 : 1;
    ASSERT_NEAR(m.phi[first], -0.03 * s, 1e-8) << tilt;
    ASSERT_NEAR(m.phi[1 - first], 0.02 * s, 1e-5) << tilt;
  }
}

TEST(Primitives, CylinderStandsOnFourPointsAndLiesOnTwo) {
  const Body plane{kPlane, {}, at(0, 0, 0)};
  const auto standing = collide({kCylinder, {0.03, 0.1, 0}, at(0.5, 0, 0.1)}, plane);
  EXPECT_EQ(points(standing, 1e-6), 4);
  Vec sum = Vec::zero();
  for (const Vec& p : standing.p) {
    EXPECT_NEAR(std::hypot(p.x - 0.5, p.y), 0.03, 1e-9);
    sum += p;
  }
  EXPECT_NEAR(norm(sum - Vec{2, 0, 0}), 0, 1e-9);
  const auto on_its_side = collide({kCylinder, {0.03, 0.1, 0}, lying(0.5, 0, 0.03)}, plane);
  EXPECT_EQ(points(on_its_side, 0.01), 2);
  EXPECT_NEAR(std::abs(on_its_side.p[0].x - on_its_side.p[3].x), 0.2, kTiny);
}

TEST(Primitives, BoxOnAPlaneHasItsFourLowestCorners) {
  RandomBodies random(7);
  const Body plane{kPlane, {}, at(0, 0, 0)};
  for (int trial = 0; trial < 1000; ++trial) {
    Body box = random.body(kBox);
    box.X_WB.p = {0.3, 0.2, 0.1};
    std::vector<double> heights;
    for (int corner = 0; corner < 8; ++corner) {
      const auto half = [&](int bit, double h) { return (corner >> bit & 1) != 0 ? h : -h; };
      heights.push_back((box.X_WB * Vec{half(0, box.size.x), half(1, box.size.y), half(2, box.size.z)}).z);
    }
    std::sort(heights.begin(), heights.end());
    auto m = collide(box, plane);
    std::sort(m.phi.begin(), m.phi.end());
    for (std::size_t k = 0; k < 4; ++k) ASSERT_NEAR(m.phi[k], heights[k], kTiny);
  }
}

}  // namespace
}  // namespace manyhands::testing
