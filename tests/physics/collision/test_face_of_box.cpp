// A cylinder over the inside of a box's face meets what it would meet on a half-space; near an edge it does not.
#include <gtest/gtest.h>

#include "manyhands/physics/collision/general/shape_contact.h"
#include "tests/physics/collision/convex_truth.h"

namespace manyhands::testing {
namespace {

TEST(FaceOfBox, IsAHalfSpaceBelowACylinder) {
  RandomBodies random(5);
  const CollisionShape cylinder = CollisionShape::cylinder(0.03, 0.015), table = CollisionShape::box({0.7, 0.35, 0.2}),
                       ground = CollisionShape::plane();
  int over = 0, beyond = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Pose X_WT = random.body(ShapeType::kBox).X_WB;
    Pose X_TG = Pose::identity(), X_TA = random.body(ShapeType::kBox).X_WB;
    X_TG.p = {0, 0, 0.2};
    X_TA.p = {random.uniform(-0.75, 0.75), random.uniform(-0.4, 0.4), 0.2 + random.uniform(0.001, 0.05)};
    const auto on_table = shape_contact<double>(cylinder, X_WT * X_TA, table, X_WT, 0.02);
    const auto on_ground = shape_contact<double>(cylinder, X_WT * X_TA, ground, X_WT * X_TG, 0.02);
    const double reach = std::hypot(0.03, 0.015);
    if (std::abs(X_TA.p.x) + reach > 0.7 || std::abs(X_TA.p.y) + reach > 0.35) {
      ++beyond;
      continue;
    }
    ASSERT_EQ(on_table.size, on_ground.size);
    if (on_table.size == 0) continue;
    const Manifold<double>&a = on_table.manifolds[0], &b = on_ground.manifolds[0];
    EXPECT_LT(norm(a.normal - b.normal), 1e-12);
    for (std::size_t i = 0; i < 4; ++i) {
      if (!(std::min(a.phi[i], b.phi[i]) < 0.02)) continue;
      ++over;
      EXPECT_NEAR(a.phi[i], b.phi[i], 1e-12);
      EXPECT_LT(norm(a.p[i] - b.p[i]), 1e-6);
    }
  }
  EXPECT_GT(over, 300);
  EXPECT_GT(beyond, 100);
}

}  // namespace
}  // namespace manyhands::testing
