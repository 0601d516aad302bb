// One contact point against the law itself: Signorini, Coulomb and maximum dissipation, on random points.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "manyhands/physics/contact/contact_solver.h"
#include "manyhands/physics/contact/coulomb.h"

namespace manyhands {
namespace {

/// A point with the velocity u where no impulse acts, and G: symmetric, positive, more so along the normal.
struct Point {
  Vec3<double> u;
  Mat3<double> G;
};

Point random_point(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(-1, 1), size(0.3, 1);
  const auto vector = [&] { return Vec3<double>{unit(random), unit(random), unit(random)}; };
  Mat3<double> G{{3, 0, 0}, {0, size(random), 0}, {0, 0, size(random)}};
  for (int k = 0; k < 2; ++k) {
    const Vec3<double> a = 0.7 * vector();
    G.x += a.x * a;
    G.y += a.y * a;
    G.z += a.z * a;
  }
  return {vector(), G};
}

template <Real To, Real From>
Vec3<To> as(const Vec3<From>& a) {
  return {static_cast<To>(a.x), static_cast<To>(a.y), static_cast<To>(a.z)};
}

/// The impulse after so many visits, none before the first.
template <Real R>
Vec3<double> visit(const Point& point, int visits) {
  const Mat3<R> G{as<R>(point.G.x), as<R>(point.G.y), as<R>(point.G.z)};
  const DelassusBlock<R> k = diagonalise(G, R(0), R(0), R(0), R(0));
  Vec3<R> impulse = Vec3<R>::zero();
  R x = 0;
  for (int n = 0; n < visits; ++n) {
    const Vec3<R> u = as<R>(point.u) + G * impulse;
    impulse = k.turned_back(solve_coulomb(k, k.turned(u), k.turned(impulse), x));
  }
  return as<double>(impulse);
}

/// By how much an impulse misses the law [m/s].
double law_error(const Point& point, const Vec3<double>& impulse) {
  const Vec3<double> u = point.u + point.G * impulse;
  const double n = impulse.x, y = std::hypot(impulse.y, impulse.z), u_t = std::hypot(u.y, u.z);
  if (n <= 0) return std::max(-u.x, y);
  const double dissipated = impulse.y * u.y + impulse.z * u.z;
  const double sliding = u_t + dissipated / n;  // 0 where what slides is opposed by all of the rim
  return std::max({std::abs(u.x), y - n, sliding});
}

TEST(Coulomb, FourVisitsInDoubleObeyTheLaw) {
  std::mt19937_64 random(1);
  int slid = 0;
  for (int n = 0; n < 10000; ++n) {
    const Point point = random_point(random);
    const Vec3<double> impulse = visit<double>(point, 4);
    ASSERT_LT(law_error(point, impulse), 1e-12) << "point " << n;
    if (impulse.x > 0 && std::hypot(impulse.y, impulse.z) > 0.999 * impulse.x) ++slid;
  }
  EXPECT_GT(slid, 1000);
}

TEST(Coulomb, VisitsInFloatStayWithinTheConeAndSettleOnTheLaw) {
  std::mt19937_64 random(2);
  double first = 0;
  for (int n = 0; n < 10000; ++n) {
    const Point point = random_point(random);
    const Vec3<double> once = visit<float>(point, 1);
    ASSERT_LE(std::hypot(once.y, once.z), once.x * (1 + 1e-6)) << "point " << n;
    first = std::max(first, law_error(point, once));
    ASSERT_LT(law_error(point, visit<float>(point, 6)), 3e-6) << "point " << n;
  }
  EXPECT_GT(first, 1e-4);  // or the visits after it would show nothing
}

}  // namespace
}  // namespace manyhands
