// Which geoms may touch: what the rules of self-collision say of a robot and of the base that it stands on.
#include <gtest/gtest.h>

#include "manyhands/base/assets.h"
#include "manyhands/model/compose.h"
#include "manyhands/model/io/urdf/urdf.h"
#include "manyhands/physics/collision/colliders.h"

namespace manyhands::testing {
namespace {

std::size_t pairs_of(const Model& model) { return Colliders<double>(model).pairs.size(); }

Model panda(bool self_collision) {
  return load_urdf(asset_path("panda/panda.urdf"), {.self_collision = self_collision}).model;
}

TEST(PairRules, ARobotWithoutSelfCollisionDoesNotTouchItsFixedBaseEither) {
  EXPECT_EQ(pairs_of(panda(false)), 0u);
  EXPECT_GT(pairs_of(panda(true)), 0u);
}

TEST(PairRules, ItsPlaceInALargerSceneChangesNothing) {
  const Model robot = panda(false);
  ModelBuilder builder("scene");
  exclude_self_collision(builder, robot, append(builder, robot));
  EXPECT_EQ(pairs_of(builder.build()), 0u);
}

TEST(PairRules, TwoRobotsTouchEachOther) {
  const Model robot = panda(false);
  ModelBuilder builder = builder_of(robot);
  append(builder, robot, {.prefix = "other/"});
  EXPECT_GT(pairs_of(builder.build()), 0u);
}

}  // namespace
}  // namespace manyhands::testing
