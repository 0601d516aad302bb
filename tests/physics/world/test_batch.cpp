// Many worlds: the same bits whatever the lanes, threads and company; the scalar step; each its own parameters and
// fate.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "manyhands/math/instantiate.h"
#include "manyhands/physics/step/step.h"
#include "manyhands/physics/world/batch.h"
#include "tests/physics/world/snapshot_testing.h"
#include "tests/physics/world/world_scenes.h"

namespace manyhands {
namespace {

using testing::panda_and_cube;
using testing::stack;
using testing::world_of;

std::size_t size(int n) { return static_cast<std::size_t>(n); }

/// Rows in which world i's numbers depend on i alone.
std::vector<float> rows(const Batch& batch, int columns, float reach, std::uint32_t seed) {
  std::vector<float> all;
  for (int i = 0; i < batch.num_worlds(); ++i) {
    std::mt19937 random(seed + 7919 * static_cast<std::uint32_t>(i));
    for (int k = 0; k < columns; ++k) {
      all.push_back(reach * (static_cast<float>(random() % 2001) * 1e-3f - 1.0f));
    }
  }
  return all;
}

std::vector<float> each(const Batch& batch, float first, float step) {
  std::vector<float> all;
  for (int i = 0; i < batch.num_worlds(); ++i) all.push_back(first + step * static_cast<float>(i));
  return all;
}

std::string last_link(const Batch& batch) { return batch.model().links().back().name; }

/// Pushes, pulls and parameters of each world's own.
void stir(Batch& batch) {
  const std::string link = last_link(batch);
  batch.set_tau(rows(batch, batch.model().nv(), 0.02f, 1));
  batch.set_mass(link, each(batch, 0.1f, 0.01f));
  batch.set_friction(link, each(batch, 0.3f, 0.02f));
  batch.set_gravity(rows(batch, 3, 9.0f, 5));
  batch.step(15);
  std::vector<float> down(3 * size(batch.num_worlds()), -9.0f);
  for (std::size_t i = 0; i < down.size(); i += 3) down[i] = down[i + 1] = 0.1f;
  batch.set_gravity(down);
  batch.apply_force(link, rows(batch, 3, 2.0f, 9), rows(batch, 3, 0.001f, 11));
  batch.step(25);
}

std::vector<float> world_of(const std::vector<float>& all, int n, int world) {
  const std::size_t columns = all.size() / size(n);
  const auto first = all.begin() + static_cast<std::ptrdiff_t>(size(world) * columns);
  return {first, first + static_cast<std::ptrdiff_t>(columns)};
}

TEST(Batch, WorldsHaveTheSameBitsWhateverTheLanesThreadsAndCompany) {
  for (const auto& model : {stack(3), panda_and_cube()}) {
    Batch reference(model, 5, 0.002, {.num_threads = 1, .lanes = 1});
    stir(reference);
    const testing::Bytes expected = reference.snapshot();
    int touching = 0;
    for (const int contacts : reference.contact_count()) touching += contacts;
    ASSERT_GT(touching, 0);
    for (const int lanes : {1, 4, 8, 16}) {
      for (const int n : {5, 19}) {
        Batch batch(model, n, 0.002, {.num_threads = n == 5 ? 1 : 2, .lanes = lanes});
        stir(batch);
        const testing::Bytes got = batch.snapshot();
        for (int i = 0; i < 5; ++i) {
          EXPECT_EQ(world_of(got, n, i), world_of(expected, 5, i))
              << model->name() << ": world " << i << " of " << n << " in " << lanes << " lanes";
        }
      }
    }
  }
}

/// The step itself, called by hand.
TEST(Batch, EqualsTheScalarStep) {
  for (const auto& model : {stack(3), panda_and_cube()}) {
    Batch batch(model, 3);
    const System<float> system(*model);
    const ParamsStorage<float> params(*model);
    StateStorage<float> state(*model, system.contact_numbers());
    const std::vector<float> start = world_of(batch.q(), 3, 0);
    std::copy(start.begin(), start.end(), state.q());
    StepWorkspace<float> ws(system);
    for (int i = 0; i < 60; ++i) step(system, params, 0.002f, state, ws);
    batch.step(60);
    const std::vector<float> q = world_of(batch.q(), 3, 2), v = world_of(batch.v(), 3, 2);
    EXPECT_EQ(q, std::vector<float>(state.q(), state.q() + model->nq())) << model->name();
    EXPECT_EQ(v, std::vector<float>(state.v(), state.v() + model->nv())) << model->name();
  }
}

TEST(Batch, AWorldThatBreaksStandsAloneAndStill) {
  Batch batch(stack(2), 20), calm(stack(2), 20);
  batch.step(30);
  calm.step(30);
  std::vector<float> force(3 * 20, 0.0f);
  force[3 * 7] = 1e38f;
  batch.apply_force("cube1", force);
  calm.apply_force("cube1", std::vector<float>(3 * 20, 0.0f));
  const std::vector<float> before = world_of(batch.q(), 20, 7);
  batch.step(40);
  calm.step(40);
  for (int i = 0; i < 20; ++i) {
    const bool broken = i == 7;
    EXPECT_EQ(batch.flags()[size(i)], broken ? BatchFlag::kNotFinite : 0);
    if (!broken) {
      EXPECT_EQ(world_of(batch.snapshot(), 20, i), world_of(calm.snapshot(), 20, i)) << i;
    }
    EXPECT_DOUBLE_EQ(batch.time()[size(i)], 0.002 * (broken ? 30 : 70)) << i;
  }
  for (const float x : batch.q()) EXPECT_TRUE(std::isfinite(x));
  EXPECT_EQ(world_of(batch.q(), 20, 7), before);
  std::vector<std::uint8_t> mask(20, 0);
  mask[7] = 1;
  batch.reset(mask);
  EXPECT_EQ(batch.flags()[7], 0);
  EXPECT_EQ(batch.time()[7], 0);
  batch.step(70);
  EXPECT_EQ(world_of(batch.q(), 20, 7), world_of(calm.q(), 20, 3));
}

TEST(Batch, ContinuesInTheMiddleOfContactWithTheSameBits) {
  Batch batch(panda_and_cube(), 6);
  stir(batch);
  batch.apply_force("cube", rows(batch, 3, 0.5f, 3));
  const testing::Bytes snapshot = batch.snapshot();
  batch.step(30);
  Batch other(panda_and_cube(), 6, 0.002, {.num_threads = 2, .lanes = 4});
  other.step(3);
  other.restore(snapshot);
  other.step(30);
  EXPECT_EQ(other.state_hash(), batch.state_hash());
  std::vector<std::uint8_t> some(6, 0);
  some[2] = 1;
  other.restore(snapshot, some);
  EXPECT_EQ(world_of(other.snapshot(), 6, 2), world_of(snapshot, 6, 2));
  EXPECT_EQ(world_of(other.snapshot(), 6, 3), world_of(batch.snapshot(), 6, 3));
}

TEST(Batch, TellsWhatAWorldInDoubleTells) {
  const auto model = stack(2);
  Batch batch(model, 3);
  World world(model);
  batch.step(400);
  world.step(400);
  std::vector<float> p(9), r(12), w(9), v(9), normal(18), friction(18);
  batch.body_pose("cube1", p, r);
  EXPECT_NEAR(p[3 + 2], world.body_pose("cube1").p.z, 1e-5);
  batch.body_velocity("cube1", w, v);
  EXPECT_NEAR(v[3 + 2], 0, 1e-4);
  batch.contact_wrench("cube0", normal, friction);
  const double weight = 0.1 * 9.81;
  EXPECT_NEAR(normal[6 + 5] + friction[6 + 5], weight, 1e-3 * weight);
  EXPECT_EQ(batch.contact_count()[1], 8);
  EXPECT_EQ(batch.flags()[1], 0);
}

/// Ten iterations in float carry a cube on a cube, and not one on another of a hundredth of its mass.
TEST(Batch, SaysWhereTenIterationsDoNotDo) {
  for (const double ratio : {1.0, 100.0}) {
    ModelBuilder builder("pair");
    testing::add_floor(builder);
    testing::add_cube(builder, "below", {0, 0, 0.02}, 0.1);
    testing::add_cube(builder, "above", {0, 0, 0.06}, 0.1 * ratio);
    Batch batch(std::make_shared<const Model>(builder.build()), 3, 0.002, {.num_threads = 1});
    batch.step(300);
    for (const std::uint8_t flags : batch.flags())
      EXPECT_EQ((flags & BatchFlag::kUnsettled) != 0, ratio > 1) << "mass ratio " << ratio;
  }
}

/// In float each step of them is 30 times less than what the position can hold.
TEST(Batch, SlowThingsMove) {
  ModelBuilder builder("slow");
  builder.set_gravity({});
  for (const JointType type : {JointType::kPrismatic, JointType::kFloating}) {
    const std::string name = type == JointType::kPrismatic ? "slide" : "free";
    const LinkId link = builder.add_link(name, {.mass = 1, .com = {}, .inertia = {1, 1, 1, 0, 0, 0}});
    builder.add_joint({.name = name, .type = type, .parent = builder.world(), .child = link, .axis = {1, 0, 0}});
  }
  Batch batch(std::make_shared<const Model>(builder.build()), 5, 0.002, {.num_threads = 1});
  const double start = 0.75, speed = 1e-6;
  std::vector<float> q = batch.q(), v = batch.v();
  const std::size_t nq = q.size() / 5, nv = v.size() / 5;
  for (std::size_t i = 0; i < 5; ++i) {
    q[i * nq] = q[i * nq + 1] = static_cast<float>(start);
    v[i * nv] = v[i * nv + 4] = static_cast<float>(speed);
  }
  batch.set_q(q);
  batch.set_v(v);
  batch.step(1000);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(batch.q()[i * nq], start + speed * batch.time()[i], 6e-8);
    EXPECT_NEAR(batch.q()[i * nq + 1], start + speed * batch.time()[i], 6e-8);
  }
  const std::uint64_t moved = batch.state_hash();
  batch.set_q(batch.q());
  EXPECT_NE(batch.state_hash(), moved) << "what q had no room for is forgotten where q is set";
}

TEST(Batch, WorldsDifferByTheirParameters) {
  ModelBuilder builder;
  testing::add_floor(builder);
  testing::add_cube(builder, "cube", {0, 0, 0.02});
  builder.set_gravity({3, 0, -9});
  Batch batch(std::make_shared<const Model>(builder.build()), 2);
  batch.set_friction("floor", std::vector{0.0f, 2.0f});
  batch.step(100);
  std::vector<float> w(6), v(6);
  batch.body_velocity("cube", w, v);
  EXPECT_NEAR(v[0], 0.6, 1e-3);  // slides freely
  EXPECT_NEAR(v[3], 0, 1e-4);    // holds

  batch.reset();
  batch.set_gravity(std::vector<float>(6, 0.0f));
  batch.set_mass("cube", std::vector{0.1f, 0.2f});
  batch.apply_force("cube", std::vector{0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 1.0f});
  batch.step();
  batch.body_velocity("cube", w, v);
  EXPECT_NEAR(v[2], 0.002 / 0.1, 1e-7);
  EXPECT_NEAR(v[5], 0.002 / 0.2, 1e-7);
}

TEST(Batch, RefusesWhatIsNoBatch) {
  EXPECT_THROW(Batch(nullptr, 3), std::invalid_argument);
  EXPECT_THROW(Batch(stack(1), 0), std::invalid_argument);
  EXPECT_THROW(Batch(stack(1), 3, 0.0), std::invalid_argument);
  EXPECT_THROW(Batch(stack(1), 3, 0.002, {.lanes = 5}), std::invalid_argument);
  Batch batch(stack(1), 3);
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(batch.step(-1), std::invalid_argument);
  EXPECT_THROW(batch.set_q(std::vector<float>(5, 0.0f)), std::invalid_argument);
  EXPECT_THROW(batch.set_q(std::vector<float>(21, 0.0f)), std::invalid_argument);
  EXPECT_THROW(batch.set_v(std::vector<float>(18, kNaN)), std::invalid_argument);
  EXPECT_THROW(batch.set_v(std::vector<float>(18, 0.0f), std::vector<std::uint8_t>(2, 1)), std::invalid_argument);
  EXPECT_THROW(batch.set_mass("cube0", std::vector{0.1f, 0.0f, 0.1f}), std::invalid_argument);
  EXPECT_THROW(batch.set_friction("cube0", std::vector{0.1f, -1.0f, 0.1f}), std::invalid_argument);
  EXPECT_THROW(batch.set_friction("nobody", std::vector(3, 0.1f)), std::out_of_range);
  EXPECT_THROW(batch.restore(std::vector<std::uint8_t>(10, 0)), std::invalid_argument);
}

}  // namespace
}  // namespace manyhands
