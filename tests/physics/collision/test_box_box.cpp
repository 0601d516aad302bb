// Contact of two boxes: the true distance, points on both surfaces, stacks that keep their four corners.
#include <gtest/gtest.h>

#include "manyhands/physics/collision/collide_box_box.h"
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
  return 6e-4 * thin + 1e-3 * std::max(phi, 0.0);
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

}  // namespace
}  // namespace manyhands::testing
