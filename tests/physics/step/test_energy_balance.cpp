// Steps that move things too far to follow: what is found, what is let be, and what a world says of it.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "manyhands/model/io/mjcf/mjcf.h"
#include "manyhands/physics/world/batch.h"
#include "manyhands/physics/world/world.h"

namespace manyhands {
namespace {

using ModelPointer = std::shared_ptr<const Model>;

ModelPointer scene(const std::string& bodies, const std::string& beside = "") {
  return std::make_shared<const Model>(
      load_mjcf_string("<mujoco><worldbody>" + bodies + "</worldbody>" + beside + "</mujoco>").model);
}

/// A brick and a ball, both free.
ModelPointer brick_and_ball() {
  return scene(
      "<body name='brick' pos='0 0 1'><freejoint name='brick'/><geom type='box' size='.1 .2 .3'/></body>"
      "<body name='ball' pos='3 0 1'><freejoint name='ball'/><geom size='.1'/></body>");
}

/// A pendulum of two rods.
ModelPointer pendulum(const std::string& beside = "") {
  const std::string rod = "<geom type='capsule' size='.02' fromto='0 0 0 .3 0 0' contype='0'/>";
  return scene("<body><joint name='shoulder' axis='0 1 0'/>" + rod +
                   "<body pos='.3 0 0'><joint name='elbow' axis='0 1 0'/>" + rod + "</body></body>",
               beside);
}

/// Single bodies turn as they can: their energy stays, and that of what they do not touch.
TEST(EnergyBalance, ABrickThatTumblesFastKeepsItsEnergy) {
  for (const double fast : {300.0, 1000.0, 1e6}) {
    World world(brick_and_ball(), 0.002);
    world.set_v(std::vector<double>{fast, 0.6 * fast, 1.1 * fast, 0, 0, 0, 0, 0, 0, 0, 0, 0});
    const double before = world.energy().kinetic;
    world.step(300);
    const double fallen = 0.5 * 9.81 * 9.81 * 0.36 * (24 + 4.0 / 3 * std::numbers::pi);
    EXPECT_NEAR(world.energy().kinetic, before + fallen, 0.01 * before + fallen) << fast;
  }
}

TEST(EnergyBalance, AnArmThatWhirlsTooFastIsNamed) {
  World world(pendulum(), 0.002);
  world.set_v(std::vector<double>{2000, -3000});
  const double before = world.energy().kinetic;
  std::uint64_t hash = 0;
  try {
    for (int i = 0; i < 300; ++i) {
      hash = world.state_hash();
      world.step();
    }
    FAIL() << "no error";
  } catch (const SimulationError& error) {
    const std::string text = error.what();
    EXPECT_TRUE(text.find("'shoulder'") != std::string::npos || text.find("'elbow'") != std::string::npos) << text;
    for (const char* part : {"the step at ", "from nothing", "time_step"})
      EXPECT_NE(text.find(part), std::string::npos) << text;
  }
  EXPECT_EQ(world.state_hash(), hash);
  EXPECT_LT(world.energy().kinetic, 100 * before);
}

/// A pendulum and an arm of ball joints that turn by a quarter of a radian to one a step: what is explicit there feeds
/// on itself.
TEST(EnergyBalance, TreesThatTurnFastGainNothing) {
  const std::string balls =
      "<body><joint name='a' type='ball'/><geom type='box' size='.02 .05 .2' pos='0 0 .2'/>"
      "<body pos='0 0 .4'><joint name='b' type='ball'/><geom type='box' size='.05 .02 .2' pos='0 0 .2'/></body></body>";
  for (const ModelPointer& model : {pendulum(), scene(balls)}) {
    for (const double fast : {150.0, 300.0}) {
      World world(model, 0.002);
      std::vector<double> v(static_cast<std::size_t>(model->nv()));
      for (std::size_t i = 0; i < v.size(); ++i) v[i] = i % 2 == 0 ? fast : -1.5 * fast;
      world.set_v(v);
      const auto total = [&] { return world.energy().kinetic + world.energy().potential; };
      const double before = total();
      double most = before;
      for (int i = 0; i < 300; ++i) {
        world.step();
        most = std::max(most, total());
      }
      EXPECT_LT(most, 3 * before) << fast << ", " << model->nv();  // slower steps are let be
      EXPECT_GT(world.energy().kinetic, (fast < 200 ? 0.1 : 0) * before) << fast << ", " << model->nv();
    }
  }
}

TEST(EnergyBalance, AWorldIsSlowedAloneOrAmongOthersAlike) {
  const std::vector<float> speeds{0, 0, 200, -300, 600, -900, 1, 1, 100, -130};
  Batch together(pendulum(), 5, 0.002, {.num_threads = 1});
  together.set_v(speeds);
  together.step(200);
  for (std::size_t k = 0; k < 5; ++k) {
    Batch alone(pendulum(), 1, 0.002, {.num_threads = 1});
    alone.set_v(std::vector<float>(&speeds[2 * k], &speeds[2 * k] + 2));
    alone.step(200);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(alone.v()[i], together.v()[2 * k + i]) << k;
  }
}

/// Nothing turns its axes or holds it.
TEST(EnergyBalance, WhatIsFastAndFollowedIsLetBe) {
  World world(brick_and_ball(), 0.002);
  world.set_v(std::vector<double>{0, 0, 0, -1e6, 0, 0, 1e5, 2e5, 1e5, 0, 1e6, 0});
  const double before = world.energy().kinetic;
  world.step(300);
  EXPECT_NEAR(world.energy().kinetic / before, 1, 1e-6);
}

/// All in one step: far, and with a reason.
TEST(EnergyBalance, WhatDrivesAndSpringsDoIsNoneOfIt) {
  World driven(pendulum("<actuator><position joint='elbow' kp='1e6' ctrlrange='-9 9'/></actuator>"), 0.002);
  driven.set_ctrl(std::array{2.5});
  driven.step(50);
  World sprung(scene("<body><joint axis='0 1 0' stiffness='1e9'/><geom size='.1' pos='.3 0 0'/></body>"), 0.002);
  sprung.set_q(std::array{2.5});
  sprung.step(50);
}

/// A fall of a hundred metres a step is no reason for a pendulum to turn so far.
TEST(EnergyBalance, GravityDoesNoMoreThanItsFall) {
  World world(pendulum(), 0.1);
  world.set_gravity({0, 0, -1e4});
  EXPECT_THROW(world.step(50), SimulationError);
}

/// The pendulum, drawn by a spring that rests at a length of 2 m.
ModelPointer drawn(const std::string& stiffness) {
  const std::string rod = "<geom type='capsule' size='.02' fromto='0 0 0 .3 0 0' contype='0'/>";
  return scene("<site name='anchor' pos='.1 .2 .4'/><body><joint name='shoulder' axis='0 1 0'/>" + rod +
                   "<body pos='.3 0 0'><joint name='elbow' axis='0 1 0'/>" + rod +
                   "<site name='tip' pos='.3 0 0'/></body></body>",
               "<tendon><spatial stiffness='" + stiffness +
                   "' springlength='2'><site site='anchor'/><site site='tip'/></spatial></tendon>");
}

/// One that flings the rods around its anchor in a step meets them where it had not pushed: what it holds then is
/// named.
TEST(EnergyBalance, ASpringThatAStepPassesIsNamed) {
  World world(drawn("1e10"), 0.002);
  const std::uint64_t hash = world.state_hash();
  try {
    for (int i = 0; i < 300; ++i) world.step();
    FAIL() << "no error";
  } catch (const SimulationError& error) {
    EXPECT_NE(std::string(error.what()).find("its tree's"), std::string::npos) << error.what();
  }
  EXPECT_EQ(world.state_hash(), hash);
}

/// One that a step can follow gives what it holds, and takes it back.
TEST(EnergyBalance, ASpringInReasonIsNoneOfIt) {
  World world(drawn("10"), 0.0005);
  const auto total = [&] { return world.energy().kinetic + world.energy().potential; };
  const double before = total();
  world.step(2000);
  EXPECT_NEAR(total() / before, 1, 0.02);
}

TEST(EnergyBalance, ABatchFlagsIt) {
  Batch batch(pendulum(), 3, 0.002, {.num_threads = 1});
  batch.set_v(std::vector<float>{0, 0, 2000, -3000, 1, 1});
  batch.step(300);
  EXPECT_EQ(batch.flags()[0], 0);
  EXPECT_EQ(batch.flags()[1], BatchFlag::kNotFinite);
  EXPECT_EQ(batch.flags()[2], 0);
  for (const float speed : batch.v()) EXPECT_LT(std::abs(speed), 1e5F);
}

}  // namespace
}  // namespace manyhands
