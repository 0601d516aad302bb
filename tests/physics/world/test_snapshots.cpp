// Snapshots of worlds and batches: refused where they do not belong, and never the way to numbers that are not finite.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

#include "manyhands/physics/world/batch.h"
#include "tests/physics/world/snapshot_testing.h"
#include "tests/physics/world/world_scenes.h"

namespace manyhands {
namespace {

using testing::Bytes;
using testing::mutated;
using testing::panda_and_cube;
using testing::repair;
using testing::stack;
using testing::takes;

template <class R>
bool all_finite(std::span<const R> numbers) {
  return std::ranges::all_of(numbers, [](R x) { return std::isfinite(x); });
}

bool is_sound(const World& world) {
  return all_finite<double>(world.q()) && all_finite<double>(world.v()) && std::isfinite(world.time());
}

bool is_sound(const Batch& batch) {
  return all_finite<float>(batch.q()) && all_finite<float>(batch.v()) && all_finite<double>(batch.time());
}

void step(World& world) {
  try {
    world.step(2);
  } catch (const SimulationError&) {  // the world is as it was
  }
}
void step(Batch& batch) { batch.step(2); }

/// How many of `count` mutants were taken. None leads to numbers that are not finite, whether or not it is taken.
template <class R, class Worlds>
int take_mutants(Worlds& worlds, int count, bool repaired, std::uint32_t seed) {
  const Bytes sound = worlds.snapshot();
  int taken = 0;
  std::mt19937 random(seed);
  for (int i = 0; i < count; ++i) {
    Bytes mutant = mutated<R>(sound, random);
    if (mutant == sound) continue;
    if (repaired) repair(mutant);
    if (takes(worlds, mutant)) {
      ++taken;
      EXPECT_TRUE(is_sound(worlds)) << "mutant " << i << " of seed " << seed << ", restored";
      step(worlds);
    }
    if (!is_sound(worlds)) {
      ADD_FAILURE() << "mutant " << i << " of seed " << seed;
      return taken;
    }
    if (taken % 50 == 49) worlds.restore(sound);
  }
  EXPECT_TRUE(takes(worlds, sound));
  return taken;
}

World resting_world() {
  World world(panda_and_cube());
  world.step(60);
  world.apply_force("cube", {0, 0, 0.2});
  return world;
}

World crowded_world() {  // a broad phase finds what touches, and the contact cache grows
  World world;
  world.add_body({.name = "floor", .shape = {.type = ShapeType::kPlane}, .fixed = true});
  for (int i = 0; i < 64; ++i) {
    world.add_body({.name = "ball" + std::to_string(i),
                    .shape = {.type = ShapeType::kSphere, .size = {0.05, 0, 0}},
                    .X_WB = {Mat3<double>::identity(), {0.2 * (i % 8), 0.2 * (i / 8), 0.0499}}});
  }
  world.step(5);
  return world;
}

TEST(Snapshots, MutantsOfAWorldNeverLeadToNumbersThatAreNotFinite) {
  for (World world : {resting_world(), crowded_world()}) {
    ASSERT_FALSE(world.contacts().empty());
    EXPECT_EQ(take_mutants<double>(world, 1500, false, 1), 0);
    EXPECT_GT(take_mutants<double>(world, 1500, true, 2), 50) << "too few are taken: the test shows little";
  }
}

TEST(Snapshots, MutantsOfABatchNeverLeadToNumbersThatAreNotFinite) {
  Batch batch(panda_and_cube(), 3, 0.002, {.num_threads = 1});
  batch.step(60);
  EXPECT_EQ(take_mutants<float>(batch, 2000, false, 3), 0);
  EXPECT_GT(take_mutants<float>(batch, 2000, true, 4), 50) << "too few are taken: the test shows little";
}

TEST(Snapshots, ARefusedOneChangesNothing) {
  World world = resting_world();
  Batch batch(stack(2), 2);
  const Bytes sound = batch.snapshot();
  const std::uint64_t of_world = world.state_hash(), of_batch = batch.state_hash();
  std::mt19937 random(5);
  int refused = 0;
  for (int i = 0; i < 200; ++i) {
    Bytes a = mutated<double>(world.snapshot(), random), b = mutated<float>(sound, random);
    if (!takes(world, a)) {
      EXPECT_EQ(world.state_hash(), of_world) << i;
    }
    repair(b);
    if (takes(batch, b)) {
      batch.restore(sound);
      continue;
    }
    ++refused;
    EXPECT_EQ(batch.state_hash(), of_batch) << i;
  }
  EXPECT_GT(refused, 20);
}

/// A cube whose axis, mass and so on may differ while names and sizes are the same.
std::shared_ptr<const Model> slider(double mass, const Vec3<double>& axis, double size) {
  ModelBuilder builder("slider");
  const LinkId link = builder.add_link("part", {.mass = mass, .inertia = {mass, mass, mass, 0, 0, 0}});
  builder.add_joint(
      {.name = "joint", .type = JointType::kPrismatic, .parent = builder.world(), .child = link, .axis = axis});
  builder.add_geom({.name = "box", .link = link, .shape = {.type = ShapeType::kBox, .size = {size, 0.1, 0.1}}});
  return std::make_shared<const Model>(builder.build());
}

TEST(Snapshots, AreRefusedByAllThatTheyAreNotOf) {
  const std::array models{slider(1, {0, 0, 1}, 0.1), slider(2, {0, 0, 1}, 0.1), slider(1, {0, 1, 0}, 0.1),
                          slider(1, {0, 0, 1}, 0.2), stack(1)};
  struct Owner {
    std::string name;
    std::function<Bytes()> snapshot;
    std::function<bool(const Bytes&, std::string*)> takes;
  };
  std::vector<Owner> owners;
  const auto add = [&](const std::string& name, auto worlds) {
    owners.push_back({name, [worlds] { return worlds->snapshot(); },
                      [worlds](const Bytes& bytes, std::string* why) { return takes(*worlds, bytes, why); }});
  };
  for (std::size_t i = 0; i < models.size(); ++i) {
    for (const double h : {0.001, 0.002}) {
      const std::string name = " of model " + std::to_string(i) + ", time step " + std::to_string(h);
      add("World" + name, std::make_shared<World>(models[i], h));
      for (const int n : {1, 2}) add("Batch" + name, std::make_shared<Batch>(models[i], n, h));
    }
  }
  for (std::size_t a = 0; a < owners.size(); ++a) {
    for (std::size_t b = 0; b < owners.size(); ++b) {
      std::string why;
      EXPECT_EQ(owners[b].takes(owners[a].snapshot(), &why), a == b) << owners[a].name << " by " << owners[b].name;
      if (a != b) {
        EXPECT_NE(why.find("expected"), std::string::npos) << why;
      }
    }
  }
}

TEST(Snapshots, SayWhatTheyAreOf) {
  World world(stack(1), 0.002);
  Batch batch(stack(1), 3, 0.001);
  std::string why;
  EXPECT_FALSE(takes(world, batch.snapshot(), &why));
  EXPECT_EQ(why,
            "the snapshot is of a Batch of 'stack' (2 links, nq 7, nv 6), time_step 0.001, 3 worlds; expected one of a "
            "World of 'stack' (2 links, nq 7, nv 6), time_step 0.002");
  Bytes other = world.snapshot();
  other[8] = 9;
  repair(other);
  EXPECT_FALSE(takes(world, other, &why));
  EXPECT_EQ(why, "the snapshot is of version 9 of the format; expected version 1");
  EXPECT_FALSE(takes(world, {}, &why));
  EXPECT_FALSE(takes(world, Bytes(100, 7), &why));
  EXPECT_NE(why.find("these 100 bytes are no snapshot"), std::string::npos) << why;
}

TEST(Snapshots, ContactsOfALargeWorldComeBack) {
  World world = crowded_world(), other = crowded_world();
  const Bytes saved = world.snapshot();
  other.step(7);
  world.step(20);
  other.restore(saved);
  other.step(20);
  EXPECT_EQ(other.state_hash(), world.state_hash());
}

}  // namespace
}  // namespace manyhands
