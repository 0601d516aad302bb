// The planner's checks in lanes, beside exact distances; Python's tests see whole plans.
#include <gtest/gtest.h>

#include "manyhands/base/assets.h"
#include "manyhands/math/instantiate.h"
#include "manyhands/math/philox.h"
#include "manyhands/math/quaternion.h"
#include "manyhands/physics/world/world.h"
#include "manyhands/planning/lane_check.h"
#include "manyhands/planning/plan.h"

namespace manyhands {
namespace {

using Vec = Vec3<double>;

Transform<double> random_pose(RandomStream& random, double reach) {
  const auto vector = [&](double half) {
    return Vec{random.uniform(-half, half), random.uniform(-half, half), random.uniform(-half, half)};
  };
  return {to_matrix(quat_from_rotation_vector(vector(2.0))), vector(reach)};
}

TEST(ObstacleTree, DistancesFromPiecesAreThoseOfShapes) {
  const Shape shapes[] = {{.type = ShapeType::kSphere, .size = {0.1, 0, 0}},
                          {.type = ShapeType::kCapsule, .size = {0.05, 0.1, 0}},
                          {.type = ShapeType::kCylinder, .size = {0.1, 0.05, 0}},
                          {.type = ShapeType::kBox, .size = {0.1, 0.2, 0.05}},
                          {.type = ShapeType::kPlane}};
  RandomStream random(3, 0, 0);
  for (const Shape& shape : shapes) {
    for (int i = 0; i < 200; ++i) {
      const Transform<double> X_WG = random_pose(random, 0.3),
                              X_WP{Mat3<double>::identity(), random_pose(random, 0.5).p};
      ObstacleTree tree;
      tree.add(0, shape, nullptr, X_WG);
      tree.build();
      const ObstaclePiece& piece = tree.pieces().empty() ? tree.endless()[0] : tree.pieces()[0];
      const double found = static_cast<double>(tree.distance<float>(piece, broadcast<float>(X_WP.p)).low);
      const double true_one = signed_distance(ShapeView{.type = shape.type, .size = shape.size}, X_WG,
                                              ShapeView{.type = ShapeType::kSphere, .size = {1e-9, 0, 0}}, X_WP)
                                  .phi;
      if (true_one > 0)
        EXPECT_NEAR(found, true_one, 1e-6);
      else
        EXPECT_LE(found, 1e-6);
    }
  }
}

TEST(ObstacleTree, DistancesFromTrianglesAreExact) {
  RandomStream random(4, 0, 0);
  for (int i = 0; i < 500; ++i) {
    const Vec a = random_pose(random, 0.2).p, b = random_pose(random, 0.2).p, c = random_pose(random, 0.2).p;
    const Transform<double> X_WP{Mat3<double>::identity(), random_pose(random, 0.4).p};
    ObstacleTree tree;
    tree.add_triangle(0, {a, b, c});
    const double found = static_cast<double>(tree.distance<float>(tree.pieces()[0], broadcast<float>(X_WP.p)).low);
    const double true_one =
        convex_distance(ConvexShape::triangle(a, b, c), Transform<double>::identity(), ConvexShape::sphere(1e-9), X_WP)
            .phi;
    EXPECT_NEAR(found, true_one, 2e-6);
  }
}

/// A Panda among a floor, a box, a cylinder and a hull.
Model panda_among_things() {
  World world = World::from_file(asset_path("panda/panda.urdf"));
  const auto add = [&](const char* name, const Shape& shape, const Vec& p) {
    world.add_body({.name = name, .shape = shape, .X_WB = {Mat3<double>::identity(), p}, .fixed = true});
  };
  add("floor", {.type = ShapeType::kPlane}, {0, 0, -0.01});
  add("box", {.type = ShapeType::kBox, .size = {0.1, 0.2, 0.15}}, {0.5, 0.2, 0.3});
  add("post", {.type = ShapeType::kCylinder, .size = {0.05, 0.4, 0}}, {0.3, -0.4, 0.4});
  return world.model();
}

struct Panda {
  Panda() : model(panda_among_things()), scene(model, model.initial_configuration(), settings()), check(scene) {}

  SceneSettings settings() const { return {.joints = joints_that_move(model, model.frame_id("panda_hand"))}; }
  std::vector<double> random_row(RandomStream& random) const {
    std::vector<double> q;
    for (std::size_t k = 0; k < scene.size(); ++k) q.push_back(random.uniform(scene.lower[k], scene.upper[k]));
    return q;
  }

  Model model;
  PlanningScene scene;
  ConfigurationCheck check;
};

Sways no_sways(const PlanningScene& scene, float sway) {
  return {std::vector<float>(scene.parts.size(), sway), std::vector<float>(scene.pairs.size(), sway)};
}

TEST(LaneCheck, LanesAreScalarsAndBallsAgreeWithExactDistances) {
  Panda panda;
  RandomStream random(5, 0, 0);
  LaneCheck<float> scalar(panda.scene);
  LaneCheck<Lanes16> lanes(panda.scene);
  int hits = 0, clear = 0;
  for (int round = 0; round < 20; ++round) {
    for (const float sway : {0.0f, 0.05f}) {
      std::vector<std::vector<double>> rows;
      for (int k = 0; k < 16; ++k) {
        rows.push_back(panda.random_row(random));
        for (std::size_t j = 0; j < panda.scene.size(); ++j)
          set_lane(lanes.coordinate(j), k, static_cast<float>(rows.back()[j]));
      }
      const Sways sways = no_sways(panda.scene, sway);
      lanes.look(sways, mask_t<Lanes16>(false));
      for (int k = 0; k < 16; ++k) {
        const std::vector<double>& q = rows[static_cast<std::size_t>(k)];
        for (std::size_t j = 0; j < q.size(); ++j) scalar.coordinate(j) = static_cast<float>(q[j]);
        scalar.look(sways, false);
        EXPECT_EQ(lane(lanes.hit(), k), scalar.hit());
        EXPECT_EQ(lane(lanes.doubtful(), k), scalar.doubtful());
        const double distance = panda.check.nearest(q).distance;
        if (scalar.hit()) {
          EXPECT_LT(distance, 1e-5);
          ++hits;
        } else if (!scalar.doubtful()) {
          EXPECT_GT(distance, static_cast<double>(sway));
          ++clear;
        }
      }
    }
  }
  EXPECT_GT(hits, 50);
  EXPECT_GT(clear, 50);
}

TEST(ConfigurationCheck, FreeIsWhatExactDistancesCallFree) {
  Panda panda;
  RandomStream random(6, 0, 0);
  int free = 0;
  for (int i = 0; i < 500; ++i) {
    const std::vector<double> q = panda.random_row(random);
    const bool is_free = panda.check.are_free(q)[0] != 0;
    EXPECT_EQ(is_free, !panda.check.encounter(q).has_value());
    free += is_free;
  }
  EXPECT_GT(free, 50);
  EXPECT_LT(free, 450);
}

TEST(FindPlan, IsTheSameForASeedAndKeepsItsTimeLimit) {
  Panda panda;
  RandomStream random(7, 0, 0);
  std::vector<double> start, goal;
  for (std::vector<double>* row : {&start, &goal}) {
    do *row = panda.random_row(random);
    while (panda.check.are_free(*row)[0] == 0);
  }
  const Plan a = find_plan(panda.scene, panda.check, start, goal), b = find_plan(panda.scene, panda.check, start, goal);
  ASSERT_EQ(a.status, PlanStatus::kSolved) << a.message;
  EXPECT_EQ(a.waypoints, b.waypoints);
  const Plan none = find_plan(panda.scene, panda.check, start, goal, {.time_limit = 0});
  EXPECT_EQ(none.status, PlanStatus::kTimeLimit);
  EXPECT_TRUE(none.waypoints.empty());
}

}  // namespace
}  // namespace manyhands
