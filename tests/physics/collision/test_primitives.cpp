// Contact of simple shapes: the distance is the true one, the points lie on both surfaces, and every lane is the
// scalar.
#include <gtest/gtest.h>

#include "manyhands/physics/collision/collide_box.h"
#include "manyhands/physics/collision/collide_capsule.h"
#include "manyhands/physics/collision/collide_cylinder.h"
#include "manyhands/physics/collision/collide_sphere.h"
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
  for (int trial = 0; trial < 300; ++trial) {
    const auto [a, b] = random.pair(GetParam().a, GetParam().b);
    SCOPED_TRACE(where(trial, a, b));
    const auto m = collide(a, b);
    const double phi = m.phi[deepest(m)];
    ASSERT_NEAR(norm(m.normal), 1, 1e-12);
    // The plane across the normal keeps the shapes as far apart as said, and no direction does so by more. A capsule
    // deep in a box prefers its faces by 2 %.
    ASSERT_NEAR(separation(a, b, m.normal), phi, 1e-9);
    const double bias = GetParam().a == kCapsule && GetParam().b == kBox ? 0.03 * std::abs(phi - a.size.x) : 0;
    ASSERT_GT(phi, searched_distance(a, b) - (phi < 0 ? bias : 0) - 1e-9);
  }
}

TEST_P(PrimitivePairs, PointsLieOnBothSurfaces) {
  RandomBodies random(2);
  for (int trial = 0; trial < 3000; ++trial) {
    const auto [a, b] = random.pair(GetParam().a, GetParam().b);
    SCOPED_TRACE(where(trial, a, b));
    const auto m = collide(a, b);
    const std::size_t first = deepest(m);
    for (std::size_t k = 0; k < m.phi.size(); ++k) {
      if (!std::isfinite(m.phi[k])) continue;
      const Vec p_A = m.p[k] - 0.5 * m.phi[k] * m.normal, p_B = m.p[k] + 0.5 * m.phi[k] * m.normal;
      // Beside the deepest point the one normal is only nearly that of the surfaces. A preferred face of a box that a
      // capsule is deep in may have the capsule's end a little beside it.
      const bool deep = GetParam().a == kCapsule && GetParam().b == kBox && m.phi[k] < -a.size.x;
      const double tolerance = k != first ? 1.05 * std::max(a.size.x, std::abs(m.phi[k])) : deep ? 0.003 : 1e-9;
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

INSTANTIATE_TEST_SUITE_P(All, PrimitivePairs, ::testing::ValuesIn(kPairs),
                         [](const auto& pair) { return std::string(pair.param.name); });

}  // namespace
}  // namespace manyhands::testing
