// The repair of inertias against a search that knows nothing of its formulas.
#include <gtest/gtest.h>

#include <random>

#include "manyhands/model/io/inertia_repair.h"

namespace manyhands::io {
namespace {

bool is_possible(const Vec3<double>& m, double slack = 0) {
  return m.x <= m.y + m.z + slack && m.y <= m.x + m.z + slack && m.z <= m.x + m.y + slack;
}

TEST(InertiaRepair, NoPossibleMomentsAreNearer) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-2, 2), small(-0.05, 0.05);
  for (int i = 0; i < 2000; ++i) {
    const Vec3<double> given{uniform(random), uniform(random), uniform(random)};
    const Vec3<double> found = nearest_principal_moments(given);
    ASSERT_TRUE(is_possible(found, 1e-12));
    const double distance = norm(found - given);
    for (int k = 0; k < 50; ++k) {
      // The allowed set is convex: if any point of it were nearer, one close by would be.
      const Vec3<double> other = found + Vec3<double>{small(random), small(random), small(random)};
      if (!is_possible(other)) continue;
      ASSERT_GE(norm(other - given), distance - 1e-12);
    }
  }
}

TEST(InertiaRepair, LeavesWhatIsPossibleAlone) {
  for (const SymMat3<double>& I :
       {SymMat3<double>{1, 2, 3, 0, 0, 0}, SymMat3<double>{0, 1, 1, 0, 0, 0}, SymMat3<double>{0, 0, 0, 0, 0, 0},
        SymMat3<double>{2, 2, 2, 0.5, 0.5, 0.5}, SymMat3<double>{1e-9, 1e-9, 1.9e-9, 0, 0, 0},
        SymMat3<double>{1, 1, 2.0000001, 0, 0, 0}}) {
    Inertial inertial{1, {0, 0, 0}, I};
    EXPECT_FALSE(repair_inertial(inertial).has_value());
    EXPECT_EQ(inertial.inertia.xx, I.xx);
    EXPECT_EQ(inertial.inertia.zz, I.zz);
  }
}

TEST(InertiaRepair, KeepsThePrincipalAxes) {
  // Moments -2, 1, 4 about axes turned by 45 degrees.
  Inertial inertial{1, {0, 0, 0}, {1, 1, 1, 3, 0, 0}};
  ASSERT_TRUE(repair_inertial(inertial).has_value());
  const Vec3<double> nearest = nearest_principal_moments({-2, 1, 4});
  EXPECT_NEAR(inertial.inertia.xx, (nearest.x + nearest.z) / 2, 1e-12);
  EXPECT_NEAR(inertial.inertia.xy, (nearest.z - nearest.x) / 2, 1e-12);
  EXPECT_NEAR(inertial.inertia.zz, nearest.y, 1e-12);
  EXPECT_NEAR(inertial.inertia.xz, 0, 1e-12);
}

}  // namespace
}  // namespace manyhands::io
