// Exponentials of twists against their power series, closed forms, and each other.
#include <gtest/gtest.h>

#include <numbers>

#include "manyhands/math/philox.h"
#include "manyhands/math/rigid_motion.h"

namespace manyhands {
namespace {

constexpr double kPi = std::numbers::pi;

Motion<double> random_twist(RandomStream& random, double angle) {
  const auto vector = [&] {
    return Vec3<double>{random.uniform(-1.0F, 1.0F), random.uniform(-1.0F, 1.0F), random.uniform(-1.0F, 1.0F)};
  };
  const Vec3<double> w = vector();
  return {(angle / norm(w)) * w, vector()};
}

double distance(const Transform<double>& a, const Transform<double>& b) {
  return norm(a.p - b.p) + norm(a.R.x - b.R.x) + norm(a.R.y - b.R.y) + norm(a.R.z - b.R.z);
}

double distance(const Motion<double>& a, const Motion<double>& b) { return norm(a.w - b.w) + norm(a.v - b.v); }

/// exp6 by its definition: a thousand million small steps, each right to second order, by doubling.
Transform<double> compounded(const Motion<double>& twist) {
  constexpr int kDoublings = 30;
  const double h = std::ldexp(1.0, -kDoublings);
  const Vec3<double> w = h * twist.w, v = h * twist.v;
  Transform<double> X{to_matrix(normalized(Quat<double>{0.5 * w.x, 0.5 * w.y, 0.5 * w.z, 1.0})), v + 0.5 * cross(w, v)};
  for (int i = 0; i < kDoublings; ++i) X = X * X;
  return X;
}

TEST(RigidMotion, ExponentialIsTheLimitOfSmallSteps) {
  RandomStream random(1, 0, 0);
  for (const double angle : {0.3, 1.0, 2.0, 3.1, 5.0}) {
    const Motion<double> twist = random_twist(random, angle);
    // Each doubling adds a rounding error to the angle, and doubles those before: 2^30 times 1e-16.
    EXPECT_LT(distance(exp6(twist), compounded(twist)), 1e-6) << angle;
  }
}

TEST(RigidMotion, ScrewsOfClosedForm) {
  const Transform<double> shift = exp6(Motion<double>{{0, 0, 0}, {1, 2, 3}});
  EXPECT_LT(distance(shift, {Mat3<double>::identity(), {1, 2, 3}}), 1e-15);
  // A quarter turn about the line x = 1, parallel to z, climbing by 0.5: the origin goes to (1, -1, 0.5).
  const Transform<double> turn = exp6(Motion<double>{{0, 0, kPi / 2}, {0, -kPi / 2, 0.5}});
  EXPECT_LT(distance(turn, {{{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}}, {1, -1, 0.5}}), 1e-15);
}

TEST(RigidMotion, LogarithmIsTheInverseAtEveryAngle) {
  RandomStream random(2, 0, 0);
  for (const double angle : {0.0, 1e-12, 1e-8, 9.9e-5, 1.01e-4, 1e-3, 0.1, 1.0, 3.0, kPi - 1e-6, kPi - 1e-9}) {
    for (int i = 0; i < 20; ++i) {
      const Motion<double> twist = random_twist(random, angle);
      EXPECT_LT(distance(log6(exp6(twist)), twist), 1e-14 * std::max(1.0, 2 * angle)) << angle;
    }
  }
  // Beyond half a turn the shortest way is the other one; the transform is the same.
  const Motion<double> twist = random_twist(random, 5.0);
  EXPECT_LT(distance(exp6(log6(exp6(twist))), exp6(twist)), 1e-14);
}

TEST(RigidMotion, AdjointCarriesTwistsFromFrameToFrame) {
  RandomStream random(3, 0, 0);
  for (int i = 0; i < 20; ++i) {
    const Transform<double> X = exp6(random_twist(random, 2.0));
    const Motion<double> twist = random_twist(random, 1.0);
    EXPECT_LT(distance(exp6(transformed(X, twist)), X * exp6(twist) * inverse(X)), 1e-14);
    // Its derivative is the bracket.
    const Motion<double> carried = random_twist(random, 1.0);
    const double h = 1e-6;
    const Motion<double> ahead = transformed(exp6(h * twist), carried), behind = transformed(exp6(-h * twist), carried);
    EXPECT_LT(distance((0.5 / h) * (ahead - behind), cross(twist, carried)), 1e-9);
  }
}

}  // namespace
}  // namespace manyhands
