// Bodies that a user moves: where they are, what they pull and push, and that they belong to the state.
#include <gtest/gtest.h>

#include <cmath>

#include "manyhands/math/quaternion.h"
#include "manyhands/model/io/mjcf/mjcf.h"
#include "manyhands/physics/world/batch.h"
#include "manyhands/physics/world/world.h"

namespace manyhands {
namespace {

/// A ball welded to a hand that a user moves, a tray that another carries, with a cube on it, and a door on a third.
std::shared_ptr<const Model> scene() {
  return std::make_shared<const Model>(load_mjcf_string(R"(
<mujoco><worldbody>
  <geom name="floor" type="plane" size="0 0 1"/>
  <body name="hand" mocap="true" pos="0 0 1"><geom name="palm" type="box" size="0.1 0.1 0.01" contype="0" conaffinity="0"/>
  </body>
  <body name="ball" pos="0.2 0 1"><freejoint/><geom size="0.05" mass="1"/></body>
  <body name="tray" mocap="true" pos="2 0 0.005" euler="0 0 90"><geom name="tray" type="box" size="0.3 0.3 0.01"/></body>
  <body name="cube" pos="2 0 0.065"><freejoint/><geom type="box" size="0.05 0.05 0.05" mass="1"/></body>
  <body name="frame" mocap="true" pos="-2 0 1"><body name="door"><joint name="hinge" axis="1 0 0"/>
    <geom type="box" size="0.1 0.1 0.1" pos="0 0 -0.5" mass="2"/></body></body>
</worldbody><equality><weld body1="hand" body2="ball"/></equality></mujoco>)")
                                           .model);
}

Transform<double> at(double x, double y, double z) { return {Mat3<double>::identity(), {x, y, z}}; }

TEST(Mocap, BodiesStandWhereTheyArePutAndAreNoCoordinates) {
  World world(scene());
  EXPECT_EQ(world.model().nq(), 15);
  EXPECT_EQ(world.model().nv(), 13);
  EXPECT_EQ(world.model().mocap_bodies().size(), 3u);
  EXPECT_EQ(norm(world.body_pose("tray").p - Vec3<double>{2, 0, 0.005}), 0);
  const Transform<double> X{to_matrix(quat_from_rotation_vector(Vec3<double>{0.1, 0.2, 0.3})), {1, 2, 3}};
  world.set_mocap("tray", X);
  EXPECT_NEAR(norm(world.body_pose("tray").p - X.p), 0, 1e-15);
  EXPECT_NEAR(norm(world.body_pose("tray").R.x - X.R.x), 0, 1e-15);
  world.step(10);
  EXPECT_NEAR(norm(world.body_pose("tray").p - X.p), 0, 1e-15);
  EXPECT_EQ(norm(world.body_velocity("tray").v), 0);
}

TEST(Mocap, WhatIsWeldedToThemFollows) {
  World world(scene());
  world.step(100);
  EXPECT_NEAR(norm(world.body_pose("ball").p - Vec3<double>{0.2, 0, 1}), 0, 1e-9);
  for (int i = 1; i <= 200; ++i) {
    world.set_mocap("hand", at(0.002 * i, 0, 1));
    world.step();
  }
  EXPECT_NEAR(norm(world.body_pose("ball").p - Vec3<double>{0.6, 0, 1}), 0, 1e-6);
  const Quat<double> turn = quat_from_rotation_vector(Vec3<double>{0, 0, 0.5});
  world.set_mocap("hand", {to_matrix(turn), {0.4, 0, 1}});
  world.step(200);
  EXPECT_NEAR(norm(world.body_pose("ball").p - Vec3<double>{0.4 + 0.2 * std::cos(0.5), 0.2 * std::sin(0.5), 1}), 0,
              1e-6);
}

TEST(Mocap, WhatLiesOnThemIsLifted) {
  World world(scene());
  world.step(200);
  EXPECT_NEAR(world.body_pose("cube").p.z, 0.065, 1e-4);
  for (int i = 1; i <= 500; ++i) {
    world.set_mocap("tray", at(2, 0, 0.005 + 1e-3 * i));
    world.step();
  }
  world.step(100);
  EXPECT_NEAR(world.body_pose("cube").p.z, 0.565, 1e-3);
}

/// The frame's own geoms and the floor touch each other nowhere: no joint could part them.
TEST(Mocap, TheyTouchNothingThatIsFixed) {
  World world(scene());
  world.set_mocap("tray", at(5, 0, 0));
  world.set_mocap("hand", at(5, 0, 0));
  world.step();
  for (const Contact& contact : world.contacts()) {
    EXPECT_NE(world.model().geoms()[contact.geom_a.index()].name, "tray");
    EXPECT_NE(world.model().geoms()[contact.geom_b.index()].name, "tray");
  }
}

/// A pendulum swings as it does in the world, wherever the frame stands.
TEST(Mocap, JointsOnThemMoveAsOnTheWorld) {
  World here(scene()), there(scene());
  there.set_mocap("frame", at(-3, 1, 2));
  std::vector<double> q(here.q().begin(), here.q().end());
  q[14] = 0.7;
  here.set_q(q);
  there.set_q(q);
  here.step(200);
  there.step(200);
  EXPECT_NEAR(here.q()[14], there.q()[14], 1e-12);
  EXPECT_GT(std::abs(here.q()[14] - 0.7), 0.1);
  EXPECT_NEAR(norm(there.body_pose("door").p - Vec3<double>{-3, 1, 2}), 0, 1e-15);
}

TEST(Mocap, PosesBelongToTheState) {
  World world(scene());
  const std::uint64_t before = world.state_hash();
  const auto snapshot = world.snapshot();
  world.set_mocap("hand", at(0, 0.1, 1));
  EXPECT_NE(world.state_hash(), before);
  world.restore(snapshot);
  EXPECT_EQ(world.state_hash(), before);
  EXPECT_EQ(norm(world.body_pose("hand").p - Vec3<double>{0, 0, 1}), 0);
}

TEST(Mocap, PosesSurviveOtherPartsComingAndGoing) {
  World world(scene());
  world.set_mocap("tray", at(4, 5, 6));
  world.add(*scene(), at(0, 10, 0), "other");
  world.set_mocap("other/hand", at(1, 10, 1));
  EXPECT_EQ(norm(world.body_pose("tray").p - Vec3<double>{4, 5, 6}), 0);
  EXPECT_EQ(norm(world.body_pose("other/tray").p - Vec3<double>{2, 10, 0.005}), 0);
  world.step(5);
  world.remove("ball");
  EXPECT_EQ(world.model().mocap_bodies().size(), 6u);
  EXPECT_EQ(norm(world.body_pose("tray").p - Vec3<double>{4, 5, 6}), 0);
  EXPECT_EQ(norm(world.body_pose("other/hand").p - Vec3<double>{1, 10, 1}), 0);
}

TEST(Mocap, OneThatIsRemovedLeavesTheOthersWhereTheyAre) {
  World world(scene());
  world.set_mocap("frame", at(-5, 0, 3));
  world.remove("hand");
  world.set_mocap("tray", at(7, 0, 3));
  world.step(5);
  EXPECT_EQ(world.model().mocap_bodies().size(), 2u);
  EXPECT_EQ(world.mocap().size(), 14u);
  EXPECT_EQ(norm(world.body_pose("frame").p - Vec3<double>{-5, 0, 3}), 0);
  EXPECT_EQ(norm(world.body_pose("tray").p - Vec3<double>{7, 0, 3}), 0);
  EXPECT_THROW(world.set_mocap("hand", at(0, 0, 0)), std::out_of_range);
}

TEST(Mocap, OthersAreRefused) {
  World world(scene());
  EXPECT_THROW(world.set_mocap("ball", at(0, 0, 0)), std::invalid_argument);
  EXPECT_THROW(world.set_mocap("door", at(0, 0, 0)), std::invalid_argument);
  EXPECT_THROW(world.set_mocap("nobody", at(0, 0, 0)), std::out_of_range);
  EXPECT_THROW(world.set_mocap("hand", at(NAN, 0, 0)), std::invalid_argument);
  EXPECT_THROW(world.set_body_pose("hand", at(0, 0, 0)), std::invalid_argument);
  Batch batch(scene(), 2, 0.002, {.num_threads = 1});
  const std::array<float, 6> p{};
  EXPECT_THROW(batch.set_mocap("hand", p, std::array<float, 8>{0, 0, 0, 1, 0, 0, 0, 2}), std::invalid_argument);
  EXPECT_THROW(batch.set_mocap("ball", p, std::array<float, 8>{0, 0, 0, 1, 0, 0, 0, 1}), std::invalid_argument);
}

TEST(Mocap, BatchesMoveThemWorldByWorldInAnyLanes) {
  constexpr std::size_t kWorlds = 18;
  const auto run = [&](int lanes) {
    Batch batch(scene(), kWorlds, 0.002, {.num_threads = 1, .lanes = lanes});
    for (int i = 1; i <= 50; ++i) {
      std::vector<float> p, r;
      for (std::size_t k = 0; k < kWorlds; ++k) {
        p.insert(p.end(), {1e-4f * static_cast<float>(k) * static_cast<float>(i), 0.0f, 1.0f});
        r.insert(r.end(), {0.0f, 0.0f, 0.0f, 1.0f});
      }
      batch.set_mocap("hand", p, r);
      batch.step();
    }
    return batch.q();
  };
  const std::vector<float> scalar = run(1);
  for (const int lanes : {4, 8, 16}) EXPECT_EQ(run(lanes), scalar) << lanes;
  for (std::size_t k = 0; k < kWorlds; ++k) {
    EXPECT_NEAR(scalar[15 * k], 0.2 + 5e-3 * static_cast<double>(k), 1e-4) << k;
  }
}

}  // namespace
}  // namespace manyhands
