// Contact of two boxes: the true distance, points on both surfaces, stacks that keep their four corners.
#include <gtest/gtest.h>

#include "manyhands/physics/collision/closed_form/collide_box_box.h"
#include "tests/physics/collision/convex_truth.h"

namespace manyhands::testing {
namespace {

constexpr double kMargin = 0.02;

Manifold<double> collide(const Body& a, const Body& b, double margin = kMargin) {
  return collide_box_box<double>(a.size, a.X_WB, b.size, b.X_WB, margin);
}

/// What may be lost to the preference for faces.
double preference(const Body& a, const Body& b, double phi) {
  const double thin = std::min({a.size.x, a.size.y, a.size.z, b.size.x, b.size.y, b.size.z});
  return 6e-4 * thin + 1e-4 * std::max(phi, 0.0);
}

double kept_apart_by_a_face(const Body& a, const Body& b) {
  double most = -1;
  for (const Mat3<double>& R : {a.X_WB.R, b.X_WB.R}) {
    for (const Vec& n : {R.x, R.y, R.z}) most = std::max({most, separation(a, b, n), separation(a, b, -n)});
  }
  return most;
}

// The plane across the normal keeps the boxes phi apart, so they are no nearer; points of both surfaces are no farther
// apart. If they overlap, no direction found by search leads out sooner.
TEST(BoxBox, DistanceIsTheTrueOne) {
  RandomBodies random(11);
  for (int trial = 0; trial < 20000; ++trial) {
    const auto [a, b] = random.pair(ShapeType::kBox, ShapeType::kBox);
    SCOPED_TRACE("trial " + std::to_string(trial) + "\nA " + describe(a) + "\nB " + describe(b));
    const auto m = collide(a, b);
    ASSERT_NEAR(norm(m.normal), 1, 1e-12);
    const std::size_t first = deepest(m);
    const double phi = m.phi[first], between = separation(a, b, m.normal);
    if (!std::isfinite(phi)) {
      ASSERT_GT(kept_apart_by_a_face(a, b), kMargin);
      continue;
    }
    if (between > kMargin) continue;
    const double lost = preference(a, b, phi) + 1e-9;
    ASSERT_NEAR(phi, between, lost);
    const Vec p_A = m.p[first] - 0.5 * phi * m.normal, p_B = m.p[first] + 0.5 * phi * m.normal;
    ASSERT_NEAR(distance_from(a, p_A), 0, lost);
    ASSERT_NEAR(distance_from(b, p_B), 0, lost);
    if (phi < 0 && trial < 1000) {
      ASSERT_GT(phi, searched_distance(a, b) - lost);
    }
  }
}

// Of a point that is not the deepest, too, both ends are on the surfaces, or inside where another face is nearer.
TEST(BoxBox, EveryPointLiesOnBothSurfaces) {
  RandomBodies random(12);
  for (int trial = 0; trial < 20000; ++trial) {
    const auto [a, b] = random.pair(ShapeType::kBox, ShapeType::kBox);
    SCOPED_TRACE("trial " + std::to_string(trial) + "\nA " + describe(a) + "\nB " + describe(b));
    const auto m = collide(a, b);
    for (std::size_t k = 0; k < m.phi.size(); ++k) {
      if (m.phi[k] > kMargin) continue;
      const double lost = preference(a, b, m.phi[deepest(m)]) + 1e-5;
      ASSERT_NEAR(distance_from(a, m.p[k] - 0.5 * m.phi[k] * m.normal), 0, lost) << "point " << k;
      ASSERT_NEAR(distance_from(b, m.p[k] + 0.5 * m.phi[k] * m.normal), 0, lost) << "point " << k;
    }
  }
}

TEST(BoxBox, EveryLaneIsTheScalar) {
  RandomBodies random(13);
  const auto bodies = [&] { return random.pair(ShapeType::kBox, ShapeType::kBox); };
  const auto function = []<class T>(const Vec3<T>& size_A, const Transform<T>& X_WA, const Vec3<T>& size_B,
                                    const Transform<T>& X_WB) {
    return collide_box_box<T>(size_A, X_WA, size_B, X_WB, T(real_t<T>(kMargin)));
  };
  expect_lanes_collide_as_scalars<Lanes<float, 4>>(2000, bodies, function);
  expect_lanes_collide_as_scalars<Lanes<float, 8>>(2000, bodies, function);
  expect_lanes_collide_as_scalars<Lanes<float, 16>>(2000, bodies, function);
}

TEST(BoxBox, SinglePrecisionKeepsTheDistance) {
  RandomBodies random(14);
  for (int trial = 0; trial < 20000; ++trial) {
    const auto [a, b] = random.pair(ShapeType::kBox, ShapeType::kBox);
    SCOPED_TRACE("trial " + std::to_string(trial) + "\nA " + describe(a) + "\nB " + describe(b));
    const auto m = collide(a, b);
    const auto s = collide_box_box<float>(broadcast<float>(a.size), broadcast<float>(a.X_WB), broadcast<float>(b.size),
                                          broadcast<float>(b.X_WB), static_cast<float>(kMargin));
    const double phi = m.phi[deepest(m)];
    if (phi > 0.99 * kMargin) continue;
    ASSERT_NEAR(s.phi[deepest(s)], phi, 2e-6 + preference(a, b, phi));
  }
}

TEST(BoxBox, MovesWithTheWorldAndSwapsSides) {
  RandomBodies random(15);
  for (int trial = 0; trial < 5000; ++trial) {
    const auto [a, b] = random.pair(ShapeType::kBox, ShapeType::kBox);
    SCOPED_TRACE("trial " + std::to_string(trial) + "\nA " + describe(a) + "\nB " + describe(b));
    const auto m = collide(a, b), other = swapped(collide(b, a));
    const double phi = m.phi[deepest(m)];
    if (phi > 0.99 * kMargin) continue;
    ASSERT_NEAR(other.phi[deepest(other)], phi, 2 * preference(a, b, phi) + 1e-9);
    const Pose X{random.rotation(), {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}};
    const auto moved = collide({a.type, a.size, X * a.X_WB}, {b.type, b.size, X * b.X_WB});
    ASSERT_NEAR(moved.phi[deepest(moved)], phi, 2 * preference(a, b, phi) + 1e-9);
  }
}

/// A pose that stands upright but for a tilt [rad], turned by yaw.
Pose standing(double yaw, double tilt, const Vec& p) {
  return {to_matrix(normalized(Quat<double>{tilt, 0.5 * tilt, std::sin(yaw / 2), std::cos(yaw / 2)})), p};
}

/// The points' distances from the wanted ones: each wanted point has one near.
template <class R>
double worst_miss(const Manifold<R>& m, const std::vector<Vec>& wanted) {
  double worst = 0;
  for (const Vec& w : wanted) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < m.phi.size(); ++k) {
      if (std::isfinite(m.phi[k])) nearest = std::min(nearest, norm(broadcast<double>(m.p[k]) - w));
    }
    worst = std::max(worst, nearest);
  }
  return worst;
}

template <class R>
Manifold<R> collide_as(const Body& a, const Body& b) {
  return collide_box_box<R>(broadcast<R>(a.size), broadcast<R>(a.X_WB), broadcast<R>(b.size), broadcast<R>(b.X_WB),
                            static_cast<R>(kMargin));
}

// A small cube at rest on a large table, in single precision and with the tilts of rounding: always its four corners.
TEST(BoxBox, CubeOnATableKeepsItsFourCorners) {
  RandomBodies random(16);
  for (int trial = 0; trial < 5000; ++trial) {
    const double yaw = random.chance(0.3) ? 0 : random.uniform(-3, 3);
    const Body table{ShapeType::kBox, {0.55, 0.35, 0.2}, standing(random.chance(0.5) ? 0 : yaw, 0, {0.2, -0.1, -0.2})};
    const Vec above = table.X_WB * Vec{random.uniform(-0.5, 0.5), random.uniform(-0.3, 0.3), 0.22};
    const double tilt = random.uniform(-1e-4, 1e-4);
    const Body cube{
        ShapeType::kBox, {0.02, 0.02, 0.02}, standing(yaw, tilt, above + Vec{0, 0, random.uniform(-1e-4, 1e-4)})};
    std::vector<Vec> corners;
    for (const double x : {-0.02, 0.02}) {
      for (const double y : {-0.02, 0.02}) corners.push_back(cube.X_WB * Vec{x, y, -0.02});
    }
    const auto below = collide_as<float>(table, cube), over = collide_as<float>(cube, table);
    ASSERT_LT(worst_miss(below, corners), 1e-4) << trial;
    ASSERT_LT(worst_miss(over, corners), 1e-4) << trial;
    ASSERT_NEAR(below.normal.z, 1, 1e-6) << trial;
    ASSERT_NEAR(over.normal.z, -1, 1e-6) << trial;
  }
}

// Cubes of one size one upon the other, flush but for rounding, share all four corners.
TEST(BoxBox, StackedCubesShareFourCorners) {
  RandomBodies random(17);
  for (int trial = 0; trial < 5000; ++trial) {
    const auto noise = [&] { return random.uniform(-1, 1) * std::pow(10.0, random.uniform(-9, -4)); };
    const Body low{ShapeType::kBox, {0.02, 0.02, 0.02}, standing(noise(), noise(), {0.5, 0.3, 0.02})};
    const Body high{ShapeType::kBox,
                    {0.02, 0.02, 0.02},
                    standing(noise(), noise(), {0.5 + noise(), 0.3 + noise(), 0.06 + noise()})};
    std::vector<Vec> corners;
    for (const double x : {0.48, 0.52}) {
      for (const double y : {0.28, 0.32}) corners.push_back({x, y, 0.04});
    }
    const auto m = collide_as<float>(low, high);
    ASSERT_LT(worst_miss(m, corners), 4e-4) << trial;
    ASSERT_NEAR(m.normal.z, 1, 1e-6) << trial;
  }
}

// However little a cube is tilted before it lands, and wherever its edges cross those below, all four corners land.
TEST(BoxBox, CubeThatLandsFlatLandsOnFourCorners) {
  RandomBodies random(19);
  const Vec half{0.02, 0.02, 0.02};
  for (int trial = 0; trial < 5000; ++trial) {
    const auto noise = [&] { return random.uniform(-1, 1) * std::pow(10.0, random.uniform(-14, -4.5)); };
    const auto turn = [&] { return to_matrix(normalized(Quat<double>{noise(), noise(), noise(), 1})); };
    const double gap = std::pow(10.0, random.uniform(-5, -2.5));
    const Body low{ShapeType::kBox, half, {turn(), {0.5, 0.3, 0.02}}};
    const Body high{ShapeType::kBox, half, {turn(), {0.502, 0.299, 0.06 + gap}}};
    std::vector<Vec> corners;
    for (const double x : {0.482, 0.52}) {
      for (const double y : {0.28, 0.319}) corners.push_back({x, y, 0.04 + 0.5 * gap});
    }
    const auto exact = collide(low, high);
    ASSERT_LT(worst_miss(exact, corners), 4e-4) << trial;
    ASSERT_NEAR(exact.phi[deepest(exact)], gap, 3e-6) << trial;
    ASSERT_LT(worst_miss(collide_as<float>(low, high), corners), 4e-4) << trial;
  }
}

// A cube tipped about one of its lower edges rests on both ends of that edge, at every tilt and in single precision.
TEST(BoxBox, TippedCubeRestsOnBothEndsOfItsEdge) {
  RandomBodies random(18);
  for (double tilt = 1e-5; tilt < 0.7; tilt *= 1.05) {
    const double yaw = random.uniform(-3, 3), c = std::cos(tilt), s = std::sin(tilt);
    const Body table{ShapeType::kBox, {0.55, 0.35, 0.2}, standing(0, 0, {0, 0, -0.2})};
    const Mat3<double> tipped = standing(yaw, 0, Vec::zero()).R * Mat3<double>{{1, 0, 0}, {0, c, s}, {0, -s, c}};
    Body cube{ShapeType::kBox, {0.02, 0.02, 0.02}, {tipped, {0.1, 0.05, 0}}};
    cube.X_WB.p.z = support({cube.type, cube.size, {tipped, Vec::zero()}}, {0, 0, -1}) + random.uniform(-1e-5, 1e-5);
    const std::vector<Vec> ends{cube.X_WB * Vec{-0.02, -0.02, -0.02}, cube.X_WB * Vec{0.02, -0.02, -0.02}};
    ASSERT_LT(worst_miss(collide_as<float>(table, cube), ends), 2e-5) << tilt;
    ASSERT_LT(worst_miss(collide_as<float>(cube, table), ends), 2e-5) << tilt;
  }
}

using Corners = std::vector<std::array<double, 2>>;

double area(const Corners& p) {
  double twice = 0;
  for (std::size_t i = 0, j = p.size() - 1; i < p.size(); j = i++) twice += p[j][0] * p[i][1] - p[i][0] * p[j][1];
  return 0.5 * std::abs(twice);
}

/// The part of a convex polygon with n . p <= d (Sutherland and Hodgman).
Corners cut(const Corners& p, double n_x, double n_y, double d) {
  Corners kept;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto &a = p[i], &b = p[(i + 1) % p.size()];
    const double at_a = n_x * a[0] + n_y * a[1] - d, at_b = n_x * b[0] + n_y * b[1] - d;
    if (at_a <= 0) kept.push_back(a);
    if ((at_a < 0) != (at_b < 0)) {
      const double t = at_a / (at_a - at_b);
      kept.push_back({a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])});
    }
  }
  return kept;
}

// Of faces that overlap anyhow, the four points span most of the overlap. Half is what the farthest pair of corners and
// the farthest to either side of it are sure of.
TEST(BoxBox, FourPointsSpanTheOverlapOfFaces) {
  RandomBodies random(19);
  double least = 1, sum = 0, count = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    const Body low{ShapeType::kBox, {random.length(), random.length(), 0.02}, standing(0, 0, {0, 0, -0.02})};
    const double yaw = random.uniform(-3, 3);
    const Vec at{random.uniform(-1, 1) * low.size.x, random.uniform(-1, 1) * low.size.y, 0.01};
    const Body high{ShapeType::kBox, {random.length(), random.length(), 0.01}, standing(yaw, 0, at)};
    Corners overlapping;
    for (const auto& [x, y] : Corners{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
      const Vec p = high.X_WB * Vec{x * high.size.x, y * high.size.y, 0};
      overlapping.push_back({p.x, p.y});
    }
    for (const double side : {-1, 1}) {
      overlapping = cut(overlapping, side, 0, low.size.x);
      overlapping = cut(overlapping, 0, side, low.size.y);
    }
    const double extent = std::max(low.size.x, low.size.y);
    if (overlapping.size() < 3 || area(overlapping) < 1e-2 * extent * extent) continue;
    const auto m = collide(low, high);
    Corners chosen;
    double x = 0, y = 0;
    for (std::size_t k = 0; k < m.phi.size(); ++k) {
      if (!std::isfinite(m.phi[k])) continue;
      ASSERT_NEAR(m.phi[k], 0, 1e-9);
      chosen.push_back({m.p[k].x, m.p[k].y});
      x += m.p[k].x;
      y += m.p[k].y;
    }
    x /= static_cast<double>(chosen.size());
    y /= static_cast<double>(chosen.size());
    std::sort(chosen.begin(), chosen.end(), [&](const auto& p, const auto& q) {
      return std::atan2(p[1] - y, p[0] - x) < std::atan2(q[1] - y, q[0] - x);
    });
    ASSERT_GE(chosen.size(), 3u) << trial;
    const double share = area(chosen) / area(overlapping);
    least = std::min(least, share);
    sum += share;
    count += 1;
  }
  EXPECT_GT(least, 0.5);
  EXPECT_GT(sum / count, 0.9);
}

TEST(BoxBox, CrossedEdgesTouchOnce) {
  const double c = std::numbers::sqrt2 / 2;
  const Body low{ShapeType::kBox, {0.02, 0.02, 0.02}, {{{1, 0, 0}, {0, c, c}, {0, -c, c}}, Vec::zero()}};
  for (const double gap : {-0.002, -1e-5, 1e-5, 0.002, 0.015}) {
    const double z = 2 * 0.02 * std::numbers::sqrt2 + gap;
    const Body high{ShapeType::kBox, {0.02, 0.02, 0.02}, {{{c, 0, -c}, {0, 1, 0}, {c, 0, c}}, {0.003, -0.005, z}}};
    const auto m = collide(low, high);
    EXPECT_NEAR(norm(m.normal - Vec{0, 0, 1}), 0, 1e-12);
    EXPECT_NEAR(m.phi[0], gap, 1e-12);
    EXPECT_NEAR(norm(m.p[0] - Vec{0.003, 0, z / 2}), 0, 1e-12);
    for (std::size_t k = 1; k < 4; ++k) EXPECT_FALSE(std::isfinite(m.phi[k]));
  }
}

/// Below zero where the boxes surely overlap, in single precision too: one's centre is well inside the other.
double sure_overlap(const Body& a, const Body& b) {
  const double scale = norm(a.size) + norm(b.size) + norm(b.X_WB.p);
  return std::min(distance_from(a, b.X_WB.p), distance_from(b, a.X_WB.p)) + 1e-5 * scale;
}

TEST(BoxBox, HardCasesAreFinite) {
  RandomBodies random(20);
  for (int trial = 0; trial < 50000; ++trial) {
    const auto [a, b] = random.hard_pair(ShapeType::kBox, ShapeType::kBox);
    SCOPED_TRACE("trial " + std::to_string(trial) + "\nA " + describe(a) + "\nB " + describe(b));
    ASSERT_TRUE(is_sound(collide(a, b)));
    ASSERT_TRUE(is_sound(collide_as<float>(a, b)));
    if (sure_overlap(a, b) < 0) {
      ASSERT_TRUE(std::isfinite(collide_as<float>(a, b).phi[0]));
    }
  }
}

TEST(BoxBox, CornersAndSharedCentresAreFinite) {
  const Vec half{0.02, 0.03, 0.04};
  const Body box{ShapeType::kBox, half, Pose::identity()};
  const auto inside = collide(box, box);
  EXPECT_NEAR(inside.phi[deepest(inside)], -0.04, 1e-12);
  const auto apart = collide(box, {ShapeType::kBox, half, {Mat3<double>::identity(), {0.041, 0.062, 0.082}}});
  EXPECT_NEAR(apart.phi[0], 0.003, 1e-12);
  EXPECT_NEAR(norm(apart.normal - Vec{1.0 / 3, 2.0 / 3, 2.0 / 3}), 0, 1e-9);
}

}  // namespace
}  // namespace manyhands::testing
