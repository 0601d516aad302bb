// World's distances and rays: in the present state, of this world's own sizes, through edits.
#include <gtest/gtest.h>

#include <cmath>

#include "manyhands/physics/collision/queries/queries.h"
#include "tests/physics/world/world_scenes.h"

namespace manyhands {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::optional<WorldRayHit> cast(const World& world, const Vec3<double>& origin, const Vec3<double>& direction,
                                double far = kInfinity) {
  return world.ray_cast({&origin, 1}, {&direction, 1}, far).front();
}

TEST(WorldQueries, ARayTellsAllThatItMeets) {
  ModelBuilder builder("two");
  testing::add_floor(builder);
  testing::add_cube(builder, "low", {0, 0, 0.05});
  testing::add_cube(builder, "high", {0, 0, 0.15});
  const World world(std::make_shared<const Model>(builder.build()));
  const auto hits = world.ray_cast_all({0, 0, 1}, {0, 0, -2}, kInfinity);
  ASSERT_EQ(hits.size(), 3u);
  EXPECT_NEAR(hits[0].distance, 0.83, 1e-12);
  EXPECT_NEAR(hits[1].distance, 0.93, 1e-12);
  EXPECT_NEAR(hits[2].distance, 1, 1e-12);
  EXPECT_EQ(hits[1].link, world.model().link_id("low"));
  EXPECT_EQ(world.ray_cast_all({0, 0, 1}, {0, 0, -1}, 0.9).size(), 1u);
  EXPECT_EQ(world.ray_cast_all({0, 0, 0.15}, {0, 0, 1}, 1)[0].distance, 0) << "it begins inside";
  EXPECT_THROW((void)world.ray_cast_all({0, 0, 0}, {0, 0, 0}, 1), std::invalid_argument);
}

TEST(WorldQueries, FollowTheStateAndTheParts) {
  ModelBuilder builder("two");
  testing::add_floor(builder);
  testing::add_cube(builder, "low", {0, 0, 0.05});
  testing::add_cube(builder, "high", {0, 0, 0.15});
  World world(std::make_shared<const Model>(builder.build()));
  EXPECT_NEAR(world.distance("low", "high")->surfaces.phi, 0.06, 1e-12);
  EXPECT_NEAR(world.distance("low", "world")->surfaces.phi, 0.03, 1e-12);
  EXPECT_NEAR(world.distance("low", "world")->surfaces.normal_AB.z, -1, 1e-12);
  EXPECT_NEAR(cast(world, {0, 0, 1}, {0, 0, -2})->distance, 0.83, 1e-12);
  ASSERT_EQ(world.near_links(0.05).size(), 1u);
  EXPECT_EQ(world.near_links(0.05)[0].link_b, world.model().link_id("low"));
  EXPECT_EQ(world.near_links(0.07).size(), 2u);

  world.set_body_pose("high", {Mat3<double>::identity(), {0, 0, 0.25}});
  EXPECT_NEAR(world.distance("low", "high")->surfaces.phi, 0.16, 1e-12);
  world.set_geom_size("high", {0.02, 0.02, 0.05});
  EXPECT_NEAR(world.distance("high", "low")->surfaces.phi, 0.13, 1e-12);
  EXPECT_NEAR(cast(world, {0, 0, 1}, {0, 0, -1})->distance, 0.7, 1e-12);
  world.step(10);
  const double fallen = 0.5 * 9.81 * 0.02 * 0.02;
  EXPECT_NEAR(cast(world, {0, 0, 1}, {0, 0, -1})->distance, 0.7 + fallen, 1e-9);

  world.add_body({.name = "lid",
                  .shape = {.type = ShapeType::kSphere, .size = {0.1, 0, 0}},
                  .X_WB = {Mat3<double>::identity(), {0, 0, 0.6}}});
  EXPECT_NEAR(cast(world, {0, 0, 1}, {0, 0, -1})->distance, 0.3, 1e-12);
  EXPECT_EQ(world.model().link(cast(world, {0, 0, 1}, {0, 0, -1})->link).name, "lid");
  EXPECT_FALSE(cast(world, {0, 0, 1}, {0, 0, -1}, 0.29).has_value());
  EXPECT_FALSE(cast(world, {0, 0, 1}, {0, 0, 1}).has_value());
}

TEST(WorldQueries, RefuseNonsense) {
  const World world(testing::stack(2));
  const double nan = std::nan("");
  EXPECT_THROW((void)world.distance("cube0", "cube0"), std::invalid_argument);
  EXPECT_THROW((void)world.distance("cube0", "cube9"), std::out_of_range);
  EXPECT_THROW((void)world.near_links(nan), std::invalid_argument);
  EXPECT_THROW((void)cast(world, {nan, 0, 0}, {0, 0, 1}), std::invalid_argument);
  EXPECT_THROW((void)cast(world, {0, 0, 0}, {0, 0, 0}), std::invalid_argument);
  EXPECT_THROW((void)cast(world, {0, 0, 0}, {0, 0, nan}), std::invalid_argument);
  EXPECT_THROW((void)cast(world, {0, 0, 0}, {0, 0, 1}, nan), std::invalid_argument);
  const std::vector<Vec3<double>> two(2, {0, 0, 1});
  EXPECT_THROW((void)world.ray_cast(two, std::span(two).first(1), 1), std::invalid_argument);
}

}  // namespace
}  // namespace manyhands
