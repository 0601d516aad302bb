// Rows that no joint can move: what rounding leaves of them is nothing, and must not be divided by. Mechanisms on a
// tilted base, where it leaves something, move as they do on a level one, where it leaves exact zeros.
#include <gtest/gtest.h>

#include <cmath>

#include "manyhands/model/io/mjcf/mjcf.h"
#include "manyhands/physics/world/batch.h"
#include "manyhands/physics/world/world.h"

namespace manyhands {
namespace {

constexpr const char* kLevel = "0 0 0";
constexpr const char* kTilts[] = {"10 20 30", "10 0 0", "-35 50 71"};

using ModelPointer = std::shared_ptr<const Model>;

/// What the base carries, and what stands beside it.
ModelPointer on_base(const std::string& tilt, const std::string& parts, const std::string& beside = "") {
  return std::make_shared<const Model>(
      load_mjcf_string("<mujoco><compiler angle='degree'/><worldbody><body name='base' "
                       "euler='" +
                       tilt + "' pos='0 0 1'>" + parts + "</body></worldbody>" + beside + "</mujoco>")
          .model);
}

/// Crank, rod and rocker in the plane of x and z, closed by `closure` where rod and rocker meet. `turn`: of the
/// rocker's frame, in which the closure's rows lie.
ModelPointer four_bar(const std::string& tilt, const std::string& closure = "connect",
                      const std::string& turn = "0 0 0") {
  const auto rod = [](const std::string& end) {
    return "<geom type='capsule' size='0.01' contype='0' conaffinity='0' mass='0.3' fromto='0 0 0 " + end + "'/>";
  };
  return on_base(tilt,
                 "<body name='crank'><joint axis='0 1 0'/>" + rod("0.1 0 0.2") +
                     "<body name='rod' pos='0.1 0 0.2'><joint axis='0 1 0'/>" + rod("0.3 0 0.05") +
                     "</body></body><body name='rocker' pos='0.4 0 0'><joint axis='0 1 0'/>" + rod("0 0 0.25") +
                     "<body name='end' pos='0 0 0.25' euler='" + turn + "'/></body>",
                 "<equality><" + closure + " body1='end' body2='rod' anchor='0 0 0'/></equality>");
}

/// A disc that turns on a plate.
ModelPointer turntable(const std::string& tilt, double friction) {
  const std::string surface = " friction='" + std::to_string(friction) + "'";
  return on_base(tilt, "<geom type='box' size='0.3 0.3 0.02'" + surface +
                           "/><body name='hub' pos='0 0 0.04'><joint axis='0 0 1'/><geom type='cylinder' size='0.2 "
                           "0.02' mass='1'" +
                           surface + "/></body>");
}

/// A post that turns about its own axis, and a wall that overlaps it from the side, on which its shaft cannot act.
ModelPointer post(const std::string& tilt) {
  return on_base(tilt,
                 "<geom type='box' size='0.1 0.3 0.3' pos='0.149 0 0.3'/><body name='post'><joint axis='0 0 1'/><geom "
                 "type='capsule' fromto='0 0 0.1 0 0 0.5' size='0.05' mass='1' friction='0'/></body>");
}

/// In the world's axes, turned as the base is.
Vec3<double> gravity_on(const ModelPointer& model) {
  return World(model).body_pose("base").R * Vec3<double>{0, 0, -9.81};
}

/// Gravity turned with the base, and the first joint set going.
World begin(const ModelPointer& model, double speed) {
  World world(model, 0.002);
  world.set_gravity(gravity_on(model));
  std::vector<double> v(static_cast<std::size_t>(model->nv()), 0.0);
  v[0] = speed;
  world.set_v(v);
  return world;
}

double energy_of(const World& world) { return world.energy().kinetic + world.energy().potential; }

/// Between the rod's end and the rocker's [m].
double gap(const World& world) {
  return norm(world.body_pose("rod") * Vec3<double>{0.3, 0, 0.05} - world.body_pose("end").p);
}

struct Swing {
  std::vector<double> v;
  double energy, gap;  ///< the most that they were off in 10 s [J], [m]
};

Swing swing(const ModelPointer& model) {
  World world = begin(model, 0);
  const double start = energy_of(world);
  Swing result{{}, 0, 0};
  for (int i = 0; i < 5000; ++i) {
    world.step();
    result.energy = std::max(result.energy, std::abs(energy_of(world) - start));
    result.gap = std::max(result.gap, gap(world));
  }
  result.v.assign(world.v().begin(), world.v().end());
  return result;
}

/// Energy and gap are off by what a step of 2 ms makes of joints that turn at up to 40 rad/s, level or tilted.
TEST(Mobility, ATiltedFourBarMovesAsALevelOneDoes) {
  for (const char* turn : {"0 0 0", "25 40 -15"}) {
    const Swing level = swing(four_bar(kLevel, "connect", turn));
    EXPECT_LT(level.energy, 0.3);
    EXPECT_LT(level.gap, 1e-4);
    for (const char* tilt : kTilts) {
      const Swing tilted = swing(four_bar(tilt, "connect", turn));
      EXPECT_NEAR(tilted.energy, level.energy, 1e-7) << tilt;
      EXPECT_NEAR(tilted.gap, level.gap, 1e-9) << tilt;
      for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(tilted.v[i], level.v[i], 1e-7) << tilt << ", joint " << i;
    }
  }
}

TEST(Mobility, AFourBarHeldByTooManyRowsStandsStill) {
  for (const char* tilt : {kLevel, kTilts[0], kTilts[1], kTilts[2]}) {
    World world = begin(four_bar(tilt, "weld"), 0);
    world.step(2000);
    for (const double v : world.v()) EXPECT_NEAR(v, 0, 1e-9) << tilt;
    EXPECT_LT(gap(world), 1e-9);
  }
}

TEST(Mobility, ATiltedTurntableTurnsOnAsALevelOneDoes) {
  for (const double friction : {0.0, 1.0}) {
    for (const char* tilt : {kLevel, kTilts[0], kTilts[1], kTilts[2]}) {
      World world = begin(turntable(tilt, friction), 1);
      world.step(5000);
      EXPECT_NEAR(world.v()[0], 1, 1e-9) << tilt << ", friction " << friction;
      EXPECT_NEAR(world.q()[0], 10, 1e-9) << tilt << ", friction " << friction;
    }
  }
}

TEST(Mobility, AWallCannotPushAPostAlongItsShaft) {
  for (const char* tilt : {kLevel, kTilts[0], kTilts[1], kTilts[2]}) {
    World world = begin(post(tilt), 1);
    world.step(5000);
    EXPECT_NEAR(world.v()[0], 1, 1e-9) << tilt;
  }
}

/// The same in float, whatever the lanes. Rounding of a metre in a step of 2 ms makes 3e-5 m/s, which is 2e-4 rad/s on
/// these levers.
TEST(Mobility, HoldsInLanes) {
  for (const int lanes : {1, 4, 8, 16}) {
    for (const char* tilt : {kLevel, kTilts[0], kTilts[1], kTilts[2]}) {
      const auto run = [&](const ModelPointer& model, float speed) {
        Batch batch(model, 3, 0.002, {.num_threads = 1, .lanes = lanes});
        const Vec3<double> g = gravity_on(model);
        std::vector<float> gravity, v;
        for (int i = 0; i < 3; ++i) {
          for (const double x : {g.x, g.y, g.z}) gravity.push_back(static_cast<float>(x));
          for (int k = 0; k < model->nv(); ++k) v.push_back(k == 0 ? speed : 0.0f);
        }
        batch.set_gravity(gravity);
        batch.set_v(v);
        batch.step(5000);
        EXPECT_EQ(batch.flags()[0], 0) << model->name() << ' ' << tilt << ", lanes " << lanes;
        return batch.v();
      };
      EXPECT_NEAR(run(turntable(tilt, 1), 1)[0], 1, 1e-3) << tilt;
      EXPECT_NEAR(run(turntable(tilt, 0), 1)[0], 1, 1e-3) << tilt;
      EXPECT_NEAR(run(post(tilt), 1)[0], 1, 1e-3) << tilt;
      EXPECT_NEAR(run(four_bar(tilt, "weld"), 0)[0], 0, 1e-3) << tilt;
      for (const float speed : run(four_bar(tilt), 0)) EXPECT_LT(std::abs(speed), 40) << tilt;
    }
  }
}

/// What little a joint can move is still moved: a load on the end of a beam whose strong motor holds it, while a joint
/// of a light part, which the load cannot turn, is free.
TEST(Mobility, WhatAMotorHoldsStillCarries) {
  const auto model = std::make_shared<const Model>(
      load_mjcf_string("<mujoco><compiler angle='degree'/><worldbody><body name='beam'><joint axis='0 1 0'/><geom "
                       "type='box' size='0.3 0.02 0.02' pos='0.3 0 0' mass='20' contype='0' conaffinity='0'/><body "
                       "name='pad' pos='0.6 0 0.03'><joint axis='0 0 1'/><geom type='box' size='0.05 0.05 0.01' "
                       "mass='0.001'/></body></body><body name='load' pos='0.6 0 0.1'><joint type='slide' axis='0 0 "
                       "1'/><geom type='box' size='0.03 0.03 0.03' mass='100'/></body></worldbody></mujoco>")
          .model);
  const std::vector<double> zero(3, 0.0), one(3, 1.0), force{1e5, 0, 0};
  World world(model, 0.002);
  world.set_motors({zero, zero, zero, one, force});
  world.step(1000);
  EXPECT_NEAR(world.body_pose("load").p.z, 0.07, 2e-3);
  Batch batch(model, 2, 0.002, {.num_threads = 1});
  const std::vector<float> zeros(6, 0.0f), ones(6, 1.0f), forces{1e5f, 0, 0, 1e5f, 0, 0};
  batch.set_motors({zeros, zeros, zeros, ones, forces});
  batch.step(1000);
  EXPECT_NEAR(static_cast<double>(batch.q()[2]), 0.07 - 0.1, 2e-3);
  EXPECT_EQ(batch.flags()[0], 0);
}

}  // namespace
}  // namespace manyhands
