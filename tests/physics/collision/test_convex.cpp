#include <gtest/gtest.h>

#include <algorithm>

#include "manyhands/physics/collision/general/collide_convex.h"
#include "tests/physics/collision/shape_testing.h"

namespace manyhands {
namespace {

using testing::Point;
using testing::ShapeSource;
using enum ConvexShape::Core;

constexpr std::array kCores{kPoint, kSegment, kTriangle, kBox, kCylinder, kHull};

struct Pair {
  ConvexShape a, b;
  Transform<double> X_WA, X_WB;
};

/// How far apart the shapes are along n: the exact phi of that direction, of which the true phi is the largest.
double gap_along(const Pair& p, const Point& n) {
  const Point on_a = p.X_WA * p.a.support(transpose_times(p.X_WA.R, n));
  const Point on_b = p.X_WB * p.b.support(-transpose_times(p.X_WB.R, n));
  return dot(n, on_b - on_a) - p.a.radius - p.b.radius;
}

template <class Check>
void for_random_pairs(int count, Check&& check) {
  ShapeSource source(7);
  std::vector<ConvexPolyhedron> hulls;
  for (const int n : {4, 8, 20, 60, 60, 60}) {
    const std::vector<Point> cloud = source.cloud(n);
    hulls.push_back(convex_polyhedron(std::span<const Point>(cloud)));
  }
  for (const auto core_a : kCores) {
    for (const auto core_b : kCores) {
      for (int i = 0; i < count; ++i) {
        Pair p{source.shape(core_a, hulls), source.shape(core_b, hulls), source.pose(1), source.pose(1)};
        const double reach = p.a.bound() + p.b.bound();
        p.X_WB.p = p.X_WA.p + (i % 20 == 0 ? 0 : source.uniform(0, 1.1) * reach) * source.direction();
        if (i % 10 == 0) p.X_WB.R = p.X_WA.R;
        SCOPED_TRACE(::testing::Message()
                     << "cores " << static_cast<int>(core_a) << " " << static_cast<int>(core_b) << ", pair " << i);
        check(p, reach);
        if (::testing::Test::HasFailure()) return;
      }
    }
  }
}

// What is found is feasible from both sides: the points lie in the shapes, and the shapes are parted by the planes
// across the normal. Apart, this proves the distance; overlapping, that the way out is one.
TEST(ConvexDistance, ItsPointsAndNormalProveIt) {
  for_random_pairs(400, [](const Pair& p, double reach) {
    const auto d = convex_distance(p.a, p.X_WA, p.b, p.X_WB);
    const double tolerance = 3e-6 * reach;
    EXPECT_NEAR(norm(d.normal_AB), 1, 1e-12);
    EXPECT_NEAR(d.phi, gap_along(p, d.normal_AB), tolerance);
    EXPECT_LT(norm(d.p_A + d.phi * d.normal_AB - d.p_B), 1e-12 * (1 + reach));
    // Where the surface is round, a point strays by the root of what the distance does.
    EXPECT_LT(testing::outside(p.a, inverse(p.X_WA) * d.p_A), 10 * tolerance);
    EXPECT_LT(testing::outside(p.b, inverse(p.X_WB) * d.p_B), 10 * tolerance);
  });
}

// No direction out of a dense sample parts the shapes by a shorter way.
TEST(ConvexDistance, NoSampledDirectionIsShorter) {
  for_random_pairs(4, [](const Pair& p, double reach) {
    const double phi = convex_distance(p.a, p.X_WA, p.b, p.X_WB).phi;
    constexpr int kSamples = 4000;
    for (int i = 0; i < kSamples; ++i) {
      const double z = 1 - (2 * i + 1.0) / kSamples, turn = 2.399963229728653 * i, r = std::sqrt(1 - z * z);
      ASSERT_LE(gap_along(p, {r * std::cos(turn), r * std::sin(turn), z}), phi + 1e-7 * reach);
    }
  });
}

TEST(ConvexDistance, IsTheSameFromBothSidesAndFromEveryFrame) {
  ShapeSource source(3);
  for_random_pairs(100, [&](const Pair& p, double reach) {
    const double phi = convex_distance(p.a, p.X_WA, p.b, p.X_WB).phi;
    EXPECT_NEAR(convex_distance(p.b, p.X_WB, p.a, p.X_WA).phi, phi, 2e-6 * reach);
    const Transform<double> X = source.pose(2);
    EXPECT_NEAR(convex_distance(p.a, X * p.X_WA, p.b, X * p.X_WB).phi, phi, 2e-6 * reach);
  });
}

TEST(ConvexDistance, MovingByItTouches) {
  for_random_pairs(100, [](const Pair& p, double reach) {
    const auto d = convex_distance(p.a, p.X_WA, p.b, p.X_WB);
    Pair moved = p;
    moved.X_WB.p = moved.X_WB.p - d.phi * d.normal_AB;
    EXPECT_NEAR(convex_distance(moved.a, moved.X_WA, moved.b, moved.X_WB).phi, 0, 2e-6 * reach);
  });
}

/// Not inlined, because GCC 12 drops the rounding where it sees the conversion back to double.
[[gnu::noinline]] Transform<float> in_float(const Transform<double>& X) { return broadcast<float>(X); }

TEST(ConvexDistance, FloatLosesOnlyWhatItsPosesRound) {
  for_random_pairs(100, [](const Pair& p, double reach) {
    const Transform<float> X_WA = in_float(p.X_WA), X_WB = in_float(p.X_WB);
    const Pair rounded{p.a, p.b, broadcast<double>(X_WA), broadcast<double>(X_WB)};
    const double truth = convex_distance(p.a, rounded.X_WA, p.b, rounded.X_WB).phi;
    const auto d = convex_distance(p.a, X_WA, p.b, X_WB);
    EXPECT_NEAR(static_cast<double>(d.phi), truth, 1e-6 * reach);
    EXPECT_NEAR(norm(d.normal_AB), 1.0f, 1e-6f);
  });
}

// Deep in a cylinder, all around its axis alike, is where an expanding polytope fares worst.
TEST(ConvexDistance, ABallInACylinderByItsClosedForm) {
  ShapeSource source(21);
  for (int i = 0; i < 3000; ++i) {
    const double r = source.length(), half = source.length(), ball = source.length();
    const Transform<double> X_WA = source.pose(1);
    const double spread = i % 3 == 0 ? 1e-6 : i % 3 == 1 ? 1e-2 : 1.5;
    const Point p{spread * r * source.uniform(-1, 1), spread * r * source.uniform(-1, 1),
                  spread * half * source.uniform(-1, 1)};
    const double side = std::hypot(p.x, p.y) - r, cap = std::abs(p.z) - half;
    const double truth =
        (std::max(side, cap) < 0 ? std::max(side, cap) : std::hypot(std::max(side, 0.0), std::max(cap, 0.0))) - ball;
    const Transform<double> X_WB{source.rotation(), X_WA * p};
    const auto d = convex_distance(ConvexShape::cylinder(r, half), X_WA, ConvexShape::sphere(ball), X_WB);
    EXPECT_NEAR(d.phi, truth, 1e-9) << r << " " << half << " " << ball << " at " << p.x << " " << p.y << " " << p.z;
  }
}

// A ball against a slab 0.1 mm thick: the depth is that of the face, whatever the slab's breadth.
TEST(ConvexDistance, ThinSlab) {
  const ConvexShape slab = ConvexShape::box({0.5, 0.5, 0.5e-4}), ball = ConvexShape::sphere(0.01);
  Transform<double> X_WB = Transform<double>::identity();
  for (const double x : {0.0, 0.123, 0.4}) {
    for (const double z : {0.5e-4 + 0.02, 0.5e-4 + 0.01, 0.5e-4 + 0.009, 0.5e-4, 0.2e-4}) {
      X_WB.p = {x, -x, z};
      const auto d = convex_distance(slab, Transform<double>::identity(), ball, X_WB);
      EXPECT_NEAR(d.phi, z - 0.5e-4 - 0.01, 1e-15);
      EXPECT_NEAR(d.normal_AB.z, 1, 1e-12);
    }
  }
}

TEST(CollideConvex, NoPointIsDeeperThanTheTruthAndTheDeepestIsThere) {
  for_random_pairs(200, [](const Pair& p, double reach) {
    const double phi = convex_distance(p.a, p.X_WA, p.b, p.X_WB).phi, margin = 0.02;
    const auto m = collide_convex(p.a, p.X_WA, p.b, p.X_WB, margin);
    double deepest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < kManifoldPoints; ++k) {
      if (!is_finite(m.phi[k])) continue;
      deepest = std::min(deepest, m.phi[k]);
      EXPECT_LE(m.phi[k], margin);
      const Point on_a = m.p[k] - 0.5 * m.phi[k] * m.normal, on_b = m.p[k] + 0.5 * m.phi[k] * m.normal;
      // The features are flat and the shapes are round beyond them: a point may lie off a surface, but not by much.
      EXPECT_LT(testing::outside(p.a, inverse(p.X_WA) * on_a), 0.03 * reach);
      EXPECT_LT(testing::outside(p.b, inverse(p.X_WB) * on_b), 0.03 * reach);
    }
    if (phi > margin) {
      EXPECT_FALSE(is_finite(deepest));
    } else {
      EXPECT_NEAR(deepest, phi, 2e-6 * reach);
      EXPECT_NEAR(gap_along(p, m.normal), phi, 2e-6 * reach);
    }
  });
}

// What is told apart early is what would be found apart in the end.
TEST(CollideConvex, FindsNothingExactlyWhereTheMarginIsBelowTheDistance) {
  int apart = 0;
  for_random_pairs(100, [&](const Pair& p, double reach) {
    const double phi = convex_distance(p.a, p.X_WA, p.b, p.X_WB).phi, beside = 1e-5 * reach;
    if (phi < 2 * beside) return;
    const auto finds = [&](double margin) {
      const auto m = collide_convex(p.a, p.X_WA, p.b, p.X_WB, margin);
      return std::ranges::any_of(m.phi, [](double x) { return is_finite(x); });
    };
    ++apart;
    for (const double share : {0.01, 0.5, 0.9}) EXPECT_FALSE(finds(share * phi));
    EXPECT_FALSE(finds(phi - beside));
    EXPECT_TRUE(finds(phi + beside));
  });
  EXPECT_GT(apart, 1000);
}

int points(const Manifold<double>& m) {
  int n = 0;
  for (const double phi : m.phi) n += is_finite(phi);
  return n;
}

/// The smallest extent of a manifold's points across z.
double spread(const Manifold<double>& m) {
  double narrowest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 36; ++i) {
    const double angle = i * std::numbers::pi / 36;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t k = 0; k < kManifoldPoints; ++k) {
      if (!is_finite(m.phi[k])) continue;
      const double x = std::cos(angle) * m.p[k].x + std::sin(angle) * m.p[k].y;
      low = std::min(low, x), high = std::max(high, x);
    }
    narrowest = std::min(narrowest, high - low);
  }
  return narrowest;
}

TEST(CollideConvex, ABoxOnABoxRestsOnTheCornersOfWhatTheyShare) {
  const ConvexShape low = ConvexShape::box({1, 1, 0.1}), high = ConvexShape::box({0.02, 0.03, 0.04});
  Transform<double> X_WB = Transform<double>::identity();
  X_WB.p = {0.99, 0.2, 0.1 + 0.04 - 1e-4};
  const auto m = collide_convex(low, Transform<double>::identity(), high, X_WB, 0.001);
  ASSERT_EQ(points(m), 4);
  EXPECT_EQ(m.normal.z, 1);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(m.phi[k], -1e-4, 1e-15);
    EXPECT_NEAR(m.p[k].z, 0.1 - 0.5e-4, 1e-15);
    EXPECT_TRUE(std::abs(m.p[k].x - 0.97) < 1e-12 || std::abs(m.p[k].x - 1) < 1e-12) << m.p[k].x;
    EXPECT_NEAR(std::abs(m.p[k].y - 0.2), 0.03, 1e-12);
  }
}

TEST(CollideConvex, CylindersStandOnSpreadPointsAndLieOnTwo) {
  const ConvexShape ground = ConvexShape::box({1, 1, 0.5}), cylinder = ConvexShape::cylinder(0.05, 0.1);
  Transform<double> X_WA = Transform<double>::identity(), X_WB = X_WA;
  X_WA.p.z = -0.5;
  X_WB.p = {0.01, 0.02, 0.1 - 1e-5};
  const auto standing = collide_convex(ground, X_WA, cylinder, X_WB, 0.001);
  EXPECT_EQ(points(standing), 4);
  EXPECT_GT(spread(standing), 0.07);
  X_WB.R = to_matrix(quat_from_rotation_vector(Point{0.5 * std::numbers::pi, 0, 0}));
  X_WB.p.z = 0.05 - 1e-5;
  const auto lying = collide_convex(ground, X_WA, cylinder, X_WB, 0.001);
  ASSERT_EQ(points(lying), 2);
  EXPECT_NEAR(norm(lying.p[0] - lying.p[1]), 0.2, 1e-9);
  EXPECT_NEAR(lying.phi[0], -1e-5, 1e-9);
  EXPECT_NEAR(lying.phi[1], -1e-5, 1e-9);
}

// Sizes from 1e-8 m to 10 km, together and apart: what comes out is finite and no deeper than the direction it names.
TEST(CollideConvex, AbsurdSizesGiveFiniteContacts) {
  ShapeSource source(31);
  std::vector<ConvexPolyhedron> hulls;
  const auto any = [&] { return std::exp(source.uniform(std::log(1e-8), std::log(1e4))); };
  for (int i = 0; i < 20; ++i) {
    std::vector<Point> cloud = source.cloud(20);
    const Point s{any(), any(), any()};
    for (Point& p : cloud) p = {s.x * p.x, s.y * p.y, s.z * p.z};
    hulls.push_back(convex_polyhedron(std::span<const Point>(cloud)));
  }
  const auto shape = [&](ConvexShape::Core core) {
    ConvexShape s = source.shape(core, hulls);
    s.radius = s.radius > 0 ? any() : 0;
    s.size = {any(), any(), any()};
    for (Point& p : s.corners) p = any() * source.direction();
    return s;
  };
  for (int i = 0; i < 20000; ++i) {
    Pair p{shape(kCores[static_cast<std::size_t>(i) % 6]), shape(kCores[static_cast<std::size_t>(i) / 6 % 6]),
           source.pose(1), source.pose(1)};
    const double reach = p.a.bound() + p.b.bound();
    p.X_WB.p =
        p.X_WA.p + source.uniform(0, 1) * (i % 2 ? reach : std::min(p.a.bound(), p.b.bound())) * source.direction();
    SCOPED_TRACE(i);
    const auto d = convex_distance(p.a, p.X_WA, p.b, p.X_WB);
    ASSERT_TRUE(is_finite(d.phi));
    ASSERT_NEAR(norm(d.normal_AB), 1, 1e-9);
    ASSERT_LT(norm(d.p_A + d.phi * d.normal_AB - d.p_B), 1e-9 * (1 + reach));
    const auto m = collide_convex(p.a, p.X_WA, p.b, p.X_WB, 1e-3);
    for (std::size_t k = 0; k < kManifoldPoints; ++k) {
      ASSERT_FALSE(std::isnan(m.phi[k]));
      if (is_finite(m.phi[k])) {
        ASSERT_GE(m.phi[k], d.phi - 1e-6 * reach);
        ASSERT_TRUE(is_finite(norm(m.p[k])));
      }
    }
  }
}

// Poses that are no rotations or not finite come from users' mistakes; they must end, whatever they give.
TEST(CollideConvex, EndsOnAnyInput) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const ConvexShape box = ConvexShape::box({1, 1, 1}), cylinder = ConvexShape::cylinder(1, 1);
  const auto I = Transform<double>::identity();
  for (const double x : {nan, std::numeric_limits<double>::infinity(), 1e300, 1e-300, 0.0}) {
    Transform<double> X = I;
    X.p.x = x;
    for (const ConvexShape* s : {&box, &cylinder}) {
      const auto m = collide_convex(box, I, *s, X, 0.01);
      for (const double phi : m.phi) EXPECT_TRUE(!is_finite(x) || !std::isnan(phi));
    }
  }
}

}  // namespace
}  // namespace manyhands
