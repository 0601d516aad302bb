// Seeds of inverse kinematics against a look at every one of them.
#include <gtest/gtest.h>

#include <algorithm>

#include "manyhands/kinematics/ik_seeds.h"
#include "manyhands/math/philox.h"
#include "manyhands/model/model_builder.h"
#include "tests/kinematics/placed_panda.h"

namespace manyhands {
namespace {

using internal::IkSeeds;

struct Seeded : testing::PlacedPanda<float> {
  IkSeeds seeds{tree, params, robot.arm.chain};

  /// Of the arm's joints.
  Transform<float> hand(std::span<const float> q) {
    std::vector<float> all(robot.arm.neutral.begin(), robot.arm.neutral.end());
    std::ranges::copy(q, all.begin());
    return PlacedPanda::hand(all.data());
  }

  IkTarget<double> target(std::uint32_t number) {
    RandomStream random(5, number, 0);
    std::vector<float> q;
    for (const std::size_t dof : robot.arm.chain.dofs)
      q.push_back(random.uniform(params.lower[dof], params.upper[dof]));
    return {broadcast<double>(hand(q)), {0.3, 0.1, 0.2}};
  }
};

TEST(IkSeeds, LieWithinTheLimitsNearTheTarget) {
  Seeded panda;
  double mean = 0;
  for (std::uint32_t i = 0; i < 200; ++i) {
    const IkTarget<double> target = panda.target(i);
    for (int rank = 0; rank < IkSeeds::kRanks; ++rank) {
      const std::span<const float> q = panda.seeds.near({}, target, rank);
      ASSERT_EQ(q.size(), panda.robot.arm.chain.dofs.size());
      for (std::size_t k = 0; k < q.size(); ++k) {
        ASSERT_GE(q[k], panda.params.lower[panda.robot.arm.chain.dofs[k]]);
        ASSERT_LE(q[k], panda.params.upper[panda.robot.arm.chain.dofs[k]]);
      }
      if (rank == 0) mean += norm(broadcast<double>(panda.hand(q).p) - target.X_WF.p) / 200;
    }
  }
  EXPECT_LT(mean, 0.25) << "two random poses of the hand are 0.8 m apart on average";
}

TEST(IkSeeds, OfAllRanksAreDifferent) {
  Seeded panda;
  const IkGoal position{.orientation = IkOrientation::kFree};
  for (std::uint32_t i = 0; i < 50; ++i) {
    const IkTarget<double> target = panda.target(i);
    std::vector<std::vector<float>> all;
    for (int rank = 0; rank < IkSeeds::kRanks; ++rank) {
      const std::span<const float> q = panda.seeds.near(position, target, rank);
      all.emplace_back(q.begin(), q.end());
    }
    std::ranges::sort(all);
    EXPECT_EQ(std::ranges::adjacent_find(all), all.end());
  }
}

/// A joint without limits begins within half a turn of where it is.
TEST(IkSeeds, JointsWithoutLimitsStayInTheirTurn) {
  ModelBuilder builder("turntable");
  const LinkId link = builder.add_link("plate", {.mass = 1, .inertia = {1, 1, 1, 0, 0, 0}});
  builder.add_joint({.name = "spin", .type = JointType::kContinuous, .parent = builder.world(), .child = link});
  const Model model = builder.build();
  const IkChain chain(model, model.frame_id("plate"));
  const IkSeeds seeds{Tree<float>(model), ParamsStorage<float>(model), chain};
  const IkTarget<double> here{Transform<double>::identity(), {}};
  for (int rank = 0; rank < IkSeeds::kRanks; ++rank)
    EXPECT_NEAR(seeds.coordinate(seeds.near({}, here, rank), 0, 100.0F), 100, 3.15);
}

}  // namespace
}  // namespace manyhands
