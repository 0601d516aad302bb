// Worlds that grow and shrink while they run: at a cost that depends on what changes, with the results of worlds that
// were built at once.
#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <numeric>
#include <random>

#include "manyhands/model/model_builder.h"
#include "manyhands/physics/collision/queries/queries.h"
#include "manyhands/physics/contact/contact_solver.h"
#include "manyhands/physics/world/world.h"

namespace manyhands {
namespace {

NewBody box(const std::string& name, const Vec3<double>& p, bool fixed = false) {
  return {.name = name,
          .shape = {.type = ShapeType::kBox, .size = {0.02, 0.02, 0.02}},
          .mass = 0.1,
          .X_WB = {Mat3<double>::identity(), p},
          .fixed = fixed};
}

NewBody floor() { return {.name = "floor", .shape = {.type = ShapeType::kPlane}, .fixed = true}; }

Vec3<double> place(int i) { return {0.1 * (i % 100), 0.1 * (i / 100), 0.02}; }

/// An arm of two hinges that drive each other, on a welded base or on one that floats.
Model arm(bool floats) {
  ModelBuilder builder("arm");
  const Inertial inertial{.mass = 0.2, .inertia = {1e-4, 1e-4, 1e-4, 0, 0, 0}};
  LinkId parent = builder.add_link("base", inertial);
  if (floats) {
    builder.add_joint({.name = "free", .type = JointType::kFloating, .parent = builder.world(), .child = parent});
  }
  for (int i = 0; i < 2; ++i) {
    const std::string name = "link" + std::to_string(i);
    const LinkId link = builder.add_link(name, inertial);
    const JointId joint = builder.add_joint({.name = name + "_hinge",
                                             .type = JointType::kRevolute,
                                             .parent = parent,
                                             .child = link,
                                             .X_PF = {Mat3<double>::identity(), {0.05, 0, 0.1}},
                                             .axis = {0, 1, 0},
                                             .limits = {.lower = -1, .upper = 1},
                                             .damping = 0.01});
    builder.add_geom({.link = link, .shape = {.type = ShapeType::kSphere, .size = {0.03, 0, 0}}});
    if (i == 1) builder.joint(joint).mimic = Mimic{"link0_hinge", -1, 0};
    if (i == 0) builder.add_actuator({.name = "drive", .type = ActuatorType::kForce, .joint = joint});
    builder.add_frame(name + "_tip", link, {Mat3<double>::identity(), {0, 0, 0.1}});
    parent = link;
  }
  return builder.build();
}

double seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Adds n boxes and asks for something of each, then removes them in any order; how long either took [s].
std::pair<double, double> seconds_to_fill_and_empty(int n) {
  World world;
  world.add_body(floor());
  const double start = seconds();
  for (int i = 0; i < n; ++i) {
    const std::string name = "box" + std::to_string(i);
    world.add_body(box(name, place(i)));
    EXPECT_EQ(world.body_pose(name).p.x, place(i).x);
    EXPECT_EQ(world.mass(name), 0.1);
  }
  const double filled = seconds();
  EXPECT_EQ(world.q().size(), 7 * static_cast<std::size_t>(n));
  std::vector<int> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(1));
  const double before = seconds();
  for (const int i : order) {
    world.remove("box" + std::to_string(i));
    EXPECT_EQ(world.body_pose("floor").p.z, 0);
  }
  EXPECT_EQ(world.q().size(), 0u);
  return {filled - start, seconds() - before};
}

/// Four times as many take four times as long, and 16 times if each edit cost as much as what is there.
TEST(WorldGrowth, AnEditCostsWhatItTouches) {
  const auto few = seconds_to_fill_and_empty(2000), many = seconds_to_fill_and_empty(8000);
  EXPECT_LT(many.first, 9 * few.first);
  EXPECT_LT(many.second, 9 * few.second);
}

/// What a world is made of, to build it anew.
struct Part {
  std::string name;
  int kind;
  Vec3<double> p;
};

void add(World& world, const Part& part) {
  switch (part.kind) {
    case 0:
    case 1:
      world.add_body(box(part.name, part.p, part.kind == 1));
      break;
    default:
      world.add(arm(part.kind == 2), {Mat3<double>::identity(), part.p}, part.name);
  }
}

void expect_equal_bits(std::span<const double> a, std::span<const double> b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_TRUE(std::ranges::equal(a, b));
}

TEST(WorldGrowth, AnEditedWorldGoesOnAsOneThatWasBuiltAtOnce) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
    World world;
    world.add_body(floor());
    std::vector<Part> parts;
    std::vector<std::pair<std::string, std::string>> apart;
    const std::size_t most = seed % 3 == 0 ? 120 : 12;  // with a broad phase, or a list of pairs
    for (int edit = 0; edit < 80; ++edit) {
      if (parts.empty() || (parts.size() < most && below(3) > 0)) {
        const int i = static_cast<int>(below(9));
        parts.push_back({"part" + std::to_string(edit),
                         static_cast<int>(below(4)),
                         {0.05 * (i % 3), 0.05 * (i / 3), 0.03 + 0.05 * edit}});
        add(world, parts.back());
      } else {
        const std::size_t i = below(parts.size());
        world.remove(parts[i].name);
        std::erase_if(apart,
                      [&](const auto& pair) { return pair.first == parts[i].name || pair.second == parts[i].name; });
        parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(i));
      }
      if (parts.size() > 1 && below(10) == 0) {
        apart.emplace_back(parts.front().name, parts.back().name);
        world.set_collision(parts.front().name, parts.back().name, false);
      }
      if (below(4) == 0) world.step(static_cast<int>(below(4)));
      if (below(10) > 0) continue;

      World anew;
      anew.add_body(floor());
      for (const Part& part : parts) add(anew, part);
      for (const auto& [a, b] : apart) anew.set_collision(a, b, false);
      anew.set_q(world.q());
      anew.set_v(world.v());
      World same = world;
      same.forget();
      same.set_q(world.q());  // normalises quaternions
      same.step(3);
      anew.step(3);
      expect_equal_bits(same.q(), anew.q());
      expect_equal_bits(same.v(), anew.v());
      EXPECT_EQ(same.state_hash(), anew.state_hash());
      if (::testing::Test::HasFailure()) return;
    }
  }
}

TEST(WorldGrowth, WhatWasRemovedMeetsNothing) {
  World world;
  world.add_body(floor());
  for (int i = 0; i < 5; ++i) world.add_body(box("box" + std::to_string(i), {0, 0, 0.1 + 0.1 * i}));
  const Vec3<double> origin{0, 0, 1}, down{0, 0, -1};
  EXPECT_NEAR(world.ray_cast({&origin, 1}, {&down, 1}, 5)[0]->point.z, 0.52, 1e-12);
  world.remove("box4");
  world.remove("box2");
  EXPECT_NEAR(world.ray_cast({&origin, 1}, {&down, 1}, 5)[0]->point.z, 0.42, 1e-12);
  EXPECT_EQ(world.near_links(0.07).size(), 1u);  // box0 and box1
  EXPECT_EQ(world.near_links(0.07, "box1").size(), 1u);
  EXPECT_TRUE(world.near_links(0.07, "box3").empty());
  const auto hit = world.ray_cast({&origin, 1}, {&down, 1}, 5)[0];
  EXPECT_EQ(world.link_name(hit->link), "box3");
  EXPECT_EQ(world.geom_name(hit->geom), "box3");
  EXPECT_EQ(World(world).model().link(hit->link).name, "box3");  // another model, the same ids
  EXPECT_EQ(World(world).model().geoms()[hit->geom.index()].name, "box3");
  EXPECT_EQ(world.q().size(), 21u);
  EXPECT_EQ(world.q()[16], 0.4);
  EXPECT_EQ(world.v().size(), 18u);
  EXPECT_EQ(world.names(), (std::vector<std::string>{"floor", "box0", "box1", "box3"}));
  EXPECT_THROW((void)world.body_pose("box2"), std::out_of_range);
  EXPECT_THROW((void)world.mass("box4"), std::out_of_range);
  EXPECT_THROW((void)world.distance("box1", "box2"), std::out_of_range);
  EXPECT_THROW(world.remove("box2"), std::out_of_range);
  world.add_body(box("box2", {1, 0, 0.3}));
  EXPECT_EQ(world.body_pose("box2").p.x, 1);
  EXPECT_EQ(world.q().back(), 1);
  EXPECT_EQ(world.q()[21], 1);  // behind the others
}

TEST(WorldGrowth, AModelThatSomebodyHoldsNeverChanges) {
  World world;
  world.add_body(box("a", {0, 0, 1}));
  const std::shared_ptr<const Model> held = world.shared_model();
  const World copy = world;
  world.add_body(box("b", {1, 0, 1}));
  world.remove("a");
  EXPECT_EQ(held->links().size(), 2u);
  EXPECT_EQ(held->link_id("a"), LinkId(1));
  EXPECT_EQ(copy.names(), (std::vector<std::string>{"a"}));
  EXPECT_EQ(copy.q().size(), 7u);
  EXPECT_EQ(world.model().links().size(), 2u);
  EXPECT_EQ(world.q()[0], 1);
}

/// With one iteration a step, a pile stays where it is only as long as it is warm started: without that it
/// would gain 0.02 m/s.
TEST(WorldGrowth, PilesRestWhileTheWorldOutgrowsItsListOfPairs) {
  World world;
  world.add_body(floor());
  for (int i = 0; i < 5; ++i) world.add_body(box("pile" + std::to_string(i), {0, 0, 0.02 + 0.04 * i}));
  world.step(500);
  SolverSettings settings = world.solver();
  settings.max_iterations = 1;
  world.set_solver(settings);
  for (int i = 0; i < 160; ++i) {
    World unedited = world;
    unedited.step();
    if (i < 80) {
      world.add_body(box("far" + std::to_string(i), {1 + 0.1 * i, 0, 1}, true));
    } else {
      world.remove("far" + std::to_string(i - 80));
    }
    world.step();
    for (std::size_t k = 0; k < 30; ++k) ASSERT_NEAR(world.v()[k], unedited.v()[k], 1e-4) << i;
  }
}

TEST(WorldGrowth, LinksThatMayNotTouchFallThroughEachOther) {
  World world;
  world.add_body(floor());
  world.add_body(box("a", {0, 0, 0.02}));
  world.add_body(box("b", {0, 0, 0.06}));
  world.step(100);
  world.set_collision("a", "b", false);
  world.step(300);
  EXPECT_NEAR(world.body_pose("b").p.z, 0.02, 1e-3);
  EXPECT_THROW(world.set_collision("a", "c", false), std::out_of_range);
  world.set_body_pose("b", {Mat3<double>::identity(), {0, 0, 0.07}});
  world.set_collision("a", "b", true);
  world.step(300);
  EXPECT_NEAR(world.body_pose("b").p.z, 0.06, 1e-3);
}

}  // namespace
}  // namespace manyhands
