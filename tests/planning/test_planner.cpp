// The planner's checks in lanes, beside exact distances; Python's tests see whole plans.
#include <gtest/gtest.h>

#include "manyhands/base/assets.h"
#include "manyhands/math/instantiate.h"
#include "manyhands/math/philox.h"
#include "manyhands/math/quaternion.h"
#include "manyhands/physics/collision/queries/queries.h"
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

  /// q of a world whose first coordinates are those of the arm.
  static std::vector<double> model_q(const std::vector<double>& row, const World& world) {
    std::vector<double> q(world.q().begin(), world.q().end());
    std::ranges::copy(row, q.begin());
    return q;
  }

  Model model;
  PlanningScene scene;
  ConfigurationCheck check;
};

/// The same for all parts and pairs, at rest.
Sways even_sways(const PlanningScene& scene, float sway) {
  const std::vector<float> parts(scene.parts.size(), sway), pairs(scene.pairs.size(), sway);
  return {1, parts, pairs, parts, pairs};
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
      const Sways sways = even_sways(panda.scene, sway);
      lanes.look(sways, mask_t<Lanes16>(false));
      for (int k = 0; k < 16; ++k) {
        const std::vector<double>& q = rows[static_cast<std::size_t>(k)];
        for (std::size_t j = 0; j < q.size(); ++j) scalar.coordinate(j) = static_cast<float>(q[j]);
        scalar.look(sways, false);
        EXPECT_EQ(lane(lanes.hit(), k), scalar.hit());
        const bool doubtful = scalar.undecided() || scalar.doubtful();
        EXPECT_EQ(lane(lanes.undecided() | lanes.doubtful(), k), doubtful);
        const double distance = panda.check.nearest(q).distance;
        if (scalar.hit()) {
          EXPECT_LT(distance, 1e-5);
          ++hits;
        } else if (!doubtful) {
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

/// No point of a part moves by more than its sway, and no pair comes nearer by more, along straight ways and parabolas:
/// a way that is free keeps its distance where exact distances look.
TEST(ConfigurationCheck, FreeWaysAreFreeWhereverOneLooks) {
  Panda panda;
  RandomStream random(8, 0, 0);
  const std::size_t n = panda.scene.size();
  int free = 0;
  for (int i = 0; i < 60; ++i) {
    const std::vector<double> a = panda.random_row(random), b = panda.random_row(random);
    if (panda.check.are_free(a)[0] == 0) continue;
    std::vector<float> start, linear, square;
    for (std::size_t k = 0; k < n; ++k) {
      start.push_back(static_cast<float>(a[k]));
      linear.push_back(static_cast<float>(0.4 * (b[k] - a[k])));
      square.push_back(i % 2 == 0 ? 0.0f : random.uniform(-0.5f, 0.5f));
    }
    const bool is_free = panda.check.is_free({start, linear, square});
    double least = 1;
    for (int look = 0; look <= 300; ++look) {
      const float t = static_cast<float>(look) / 300;
      std::vector<double> q;
      for (std::size_t k = 0; k < n; ++k) q.push_back(static_cast<double>(start[k] + t * (linear[k] + t * square[k])));
      least = std::min(least, panda.check.nearest(q).distance);
    }
    if (is_free)
      EXPECT_GT(least, 0) << "way " << i;
    else
      EXPECT_LT(least, 0.01) << "way " << i;  // farther than that from everything, a way is not refused
    free += is_free;
  }
  EXPECT_GT(free, 8);
  EXPECT_LT(free, 50);
}

TEST(ApartMap, SaysApartOnlyWhereThePairIs) {
  Panda panda;
  RandomStream random(9, 0, 0);
  int mapped = 0, apart = 0;
  for (const PartPair& pair : panda.scene.pairs) {
    if (pair.apart.axes().empty()) continue;
    ++mapped;
    const auto link = [&](std::size_t part) { return panda.scene.link_name(panda.scene.parts[part].link); };
    World world = World::from_file(asset_path("panda/panda.urdf"));
    for (int look = 0; look < 300; ++look) {
      const std::vector<double> row = panda.random_row(random);
      std::array<float, 2> q{};
      for (std::size_t axis = 0; axis < pair.apart.axes().size(); ++axis)
        q[axis] = static_cast<float>(row[pair.apart.axes()[axis].coordinate]);
      if (!pair.apart.is_apart(q, q)) continue;
      ++apart;
      world.set_q(panda.model_q(row, world));
      EXPECT_GT(world.distance(link(pair.a), link(pair.b))->surfaces.phi, 0);
    }
  }
  EXPECT_GE(mapped, 2);
  EXPECT_GT(apart, 300);
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
