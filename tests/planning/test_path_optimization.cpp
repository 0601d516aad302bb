// Parts of the optimisation of paths, beside closed forms, exact distances and finite differences.
#include <gtest/gtest.h>

#include <cmath>

#include "manyhands/base/assets.h"
#include "manyhands/math/instantiate.h"
#include "manyhands/math/philox.h"
#include "manyhands/math/quaternion.h"
#include "manyhands/physics/collision/queries/queries.h"
#include "manyhands/physics/world/world.h"
#include "manyhands/planning/exact_check.h"
#include "manyhands/planning/path_descent.h"

namespace manyhands {
namespace {

using Vec = Vec3<double>;

Vec random_vector(RandomStream& random, double half) {
  return {random.uniform(-half, half), random.uniform(-half, half), random.uniform(-half, half)};
}

/// Of finite differences of the distance.
Vec slope_of_distance(const ObstacleTree& tree, const ObstaclePiece& piece, const Vec& p) {
  constexpr double h = 1e-5;
  const auto along = [&](const Vec& d) {
    return (tree.approach(piece, p + h * d).distance - tree.approach(piece, p - h * d).distance) / (2 * h);
  };
  return {along({1, 0, 0}), along({0, 1, 0}), along({0, 0, 1})};
}

TEST(ObstacleTree, ApproachesAreSignedDistancesAndTheirSlopes) {
  const Shape shapes[] = {{.type = ShapeType::kSphere, .size = {0.1, 0, 0}},
                          {.type = ShapeType::kCapsule, .size = {0.05, 0.1, 0}},
                          {.type = ShapeType::kCylinder, .size = {0.1, 0.05, 0}},
                          {.type = ShapeType::kBox, .size = {0.1, 0.2, 0.05}},
                          {.type = ShapeType::kPlane}};
  RandomStream random(3, 0, 0);
  int within = 0;
  for (const Shape& shape : shapes) {
    for (int i = 0; i < 200; ++i) {
      const Transform<double> X_WG{to_matrix(quat_from_rotation_vector(random_vector(random, 2.0))),
                                   random_vector(random, 0.1)};
      const Vec p = random_vector(random, 0.2);
      ObstacleTree tree;
      tree.add(0, shape, nullptr, X_WG);
      tree.build();
      const ObstaclePiece& piece = tree.pieces().empty() ? tree.endless()[0] : tree.pieces()[0];
      const Approach<double> found = tree.approach(piece, p);
      const double truth =
          signed_distance(ShapeView{.type = shape.type, .size = shape.size}, X_WG,
                          ShapeView{.type = ShapeType::kSphere, .size = {1e-9, 0, 0}}, {Mat3<double>::identity(), p})
              .phi;
      EXPECT_NEAR(found.distance, truth, 1e-6);
      EXPECT_NEAR(norm(found.away), 1, 1e-5);
      within += truth < 0;
      // Within, the slope jumps where two faces are equally near: then differences see both.
      const Vec slope = slope_of_distance(tree, piece, p);
      EXPECT_TRUE(norm(slope) < 0.999 || norm(slope - found.away) < 1e-2);
    }
  }
  EXPECT_GT(within, 100);
}

TEST(ObstacleTree, ApproachesToTrianglesAreTheirDistancesAndSlopes) {
  RandomStream random(4, 0, 0);
  for (int i = 0; i < 200; ++i) {
    ObstacleTree tree;
    tree.add_triangle(0, {random_vector(random, 0.2), random_vector(random, 0.2), random_vector(random, 0.2)});
    const ObstaclePiece& piece = tree.pieces()[0];
    const Vec p = random_vector(random, 0.4);
    const Approach<double> found = tree.approach(piece, p);
    EXPECT_NEAR(found.distance, tree.distance<double>(piece, p).low, 1e-9);
    EXPECT_LT(norm(slope_of_distance(tree, piece, p) - found.away), 1e-2);
  }
}

/// A Panda between a floor, a box, a cylinder and a cloud.
struct CrowdedPanda {
  CrowdedPanda() : model(make()), scene(model, model.initial_configuration(), settings(model)) {}

  static Model make() {
    World world = World::from_file(asset_path("panda/panda.urdf"));
    const auto add = [&](const char* name, const Shape& shape, const Vec& p) {
      world.add_body({.name = name, .shape = shape, .X_WB = {Mat3<double>::identity(), p}, .fixed = true});
    };
    add("floor", {.type = ShapeType::kPlane}, {0, 0, -0.01});
    add("box", {.type = ShapeType::kBox, .size = {0.1, 0.2, 0.15}}, {0.5, 0.2, 0.3});
    add("post", {.type = ShapeType::kCylinder, .size = {0.05, 0.4, 0}}, {0.3, -0.4, 0.4});
    return world.model();
  }
  static SceneSettings settings(const Model& model) {
    SceneSettings found{.joints = joints_that_move(model, model.frame_id("panda_hand"))};
    found.clouds.push_back({.points = {{0.4, 0, 0.7}, {0.45, 0.02, 0.7}}, .radius = 0.02});
    return found;
  }
  [[nodiscard]] std::vector<double> random_row(RandomStream& random) const {
    std::vector<double> q;
    for (std::size_t k = 0; k < scene.size(); ++k) q.push_back(random.uniform(scene.lower[k], scene.upper[k]));
    return q;
  }
  [[nodiscard]] PathSeed random_seed(RandomStream& random, std::size_t points) const {
    PathSeed seed{.goal = random_row(random), .displacement = {}, .obstacle_weight = random.uniform(100.0f, 500.0f)};
    for (std::size_t i = 0; i < points * scene.size(); ++i) seed.displacement.push_back(random.uniform(-0.5f, 0.5f));
    return seed;
  }

  Model model;
  PlanningScene scene;
};

TEST(ClearanceCost, GradientsAreFiniteDifferences) {
  const CrowdedPanda panda;
  constexpr double h = 1e-6;
  RandomStream random(5, 0, 0);
  ClearanceCost<double> cost(panda.scene, 0.05);
  const auto at = [&](const std::vector<double>& q) {
    for (std::size_t k = 0; k < q.size(); ++k) cost.coordinate(k) = q[k];
    return cost.evaluate();
  };
  int costly = 0;
  for (int i = 0; i < 100; ++i) {
    std::vector<double> q = panda.random_row(random), gradient;
    costly += at(q) > 0;
    for (std::size_t k = 0; k < q.size(); ++k) gradient.push_back(cost.gradient(k));
    for (std::size_t k = 0; k < q.size(); ++k) {
      const double here = q[k];
      q[k] = here + h;
      const double after = at(q);
      q[k] = here - h;
      EXPECT_NEAR(gradient[k], (after - at(q)) / (2 * h), 1e-4) << "configuration " << i << ", joint " << k;
      q[k] = here;
    }
  }
  EXPECT_GT(costly, 30);
}

TEST(ClearanceCost, WhatCostsNothingKeepsTheClearanceAndWhatCollidesCosts) {
  constexpr double clearance = 0.02;
  const CrowdedPanda panda;
  RandomStream random(6, 0, 0);
  ClearanceCost<double> cost(panda.scene, clearance);
  internal::ExactCheck exact(panda.scene);
  int far = 0, hits = 0;
  for (int i = 0; i < 500; ++i) {
    const std::vector<double> q = panda.random_row(random);
    for (std::size_t k = 0; k < q.size(); ++k) cost.coordinate(k) = q[k];
    const double found = cost.evaluate();
    exact.place(q);
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t part = 0; part < panda.scene.parts.size(); ++part) {
      for (int obstacle = 0; obstacle < static_cast<int>(panda.scene.obstacles.size()) + panda.scene.clouds;
           ++obstacle) {
        if (!std::ranges::binary_search(panda.scene.parts[part].ignored, obstacle))
          nearest = std::min(nearest, exact.distance(static_cast<int>(part), obstacle, nearest));
      }
    }
    EXPECT_TRUE(nearest > 0 || found > 0);
    EXPECT_TRUE(found > 0 || nearest > clearance);
    hits += nearest < 0;
    far += found == 0;
  }
  EXPECT_GT(hits, 50);
  EXPECT_GT(far, 5);
}

TEST(PathSpline, MeetsItsEndsAndCostsWhatItsDerivativesDo) {
  const SmoothnessWeights weights{.velocity = 0.7, .acceleration = 0.03, .jerk = 2e-4};
  constexpr std::size_t m = 9;
  const PathSpline spline(m, 3, weights);
  RandomStream random(7, 0, 0);
  std::vector<double> x, controls{-0.4};
  for (std::size_t k = 0; k < m; ++k) {
    x.push_back(random.uniform(-1.0, 1.0));
    controls.push_back(std::lerp(-0.4, 1.1, static_cast<double>(k + 1) / (m + 1)) + x[k]);
  }
  controls.push_back(1.1);
  const Trajectory path = spline.path(controls, 1);
  const auto at = [&](double t) {
    double q = 0, v = 0, a = 0;
    path.sample({&t, 1}, {&q, 1}, {&v, 1}, {&a, 1});
    return std::array{q, v, a};
  };
  EXPECT_NEAR(at(0)[0], -0.4, 1e-12);
  EXPECT_NEAR(at(1)[0], 1.1, 1e-12);
  EXPECT_NEAR(at(0)[2], 0, 1e-9);
  EXPECT_NEAR(at(1)[2], 0, 1e-9);
  for (const PathSpline::Look& look : spline.looks()) {
    double q = std::lerp(-0.4, 1.1, look.s);
    for (std::size_t i = 0; i < look.count; ++i) q += look.weight[i] * x[look.first + i];
    EXPECT_NEAR(q, at(look.s)[0], 1e-12);
  }
  constexpr int steps = 100000;  // the middle rule, of which each step lies in one piece
  double integral = 0, quadratic = 0, identity = 0;
  for (int i = 0; i < steps; ++i) {
    const auto [q, v, a] = at((i + 0.5) / steps);
    const double jerk = (at((i + 0.75) / steps)[2] - at((i + 0.25) / steps)[2]) * steps / 0.5;
    integral += (weights.velocity * v * v + weights.acceleration * a * a + weights.jerk * jerk * jerk) / steps;
  }
  for (std::size_t i = 0; i < m; ++i) {
    for (std::size_t j = 0; j < m; ++j) {
      quadratic += x[i] * spline.smoothness()[i * m + j] * x[j];
      double product = 0;
      for (std::size_t k = 0; k < m; ++k)
        product += spline.smoothness()[i * m + k] * spline.inverse_smoothness()[k * m + j];
      identity = std::max(identity, std::abs(product - (i == j)));
    }
  }
  const double of_line = weights.velocity * 1.5 * 1.5;
  EXPECT_NEAR(integral, of_line + quadratic, 1e-6 * integral);
  EXPECT_LT(identity, 1e-9);
}

/// Rosenbrock's function of pairs of numbers: its minimum, 0, is at 1, at the end of a bent valley.
template <Number T>
T rosenbrock(const std::vector<T>& x, std::vector<T>& gradient) {
  T value = constant<T>(0);
  for (std::size_t i = 0; i < x.size(); i += 2) {
    const T a = constant<T>(1) - x[i], b = x[i + 1] - x[i] * x[i];
    value += a * a + constant<T>(100) * b * b;
    gradient[i] = constant<T>(-2) * a - constant<T>(400) * x[i] * b;
    gradient[i + 1] = constant<T>(200) * b;
  }
  return value;
}

template <Number T>
void minimize_rosenbrock(LaneMinimizer<T>& minimizer) {
  const auto precondition = [](const std::vector<T>& from, std::vector<T>& to) {
    for (std::size_t i = 0; i < from.size(); ++i) to[i] = constant<T>(1e-3) * from[i];
  };
  minimizer.start(&rosenbrock<T>, precondition);
  for (int i = 0; i < 500 && minimizer.iterate(&rosenbrock<T>, precondition);) ++i;
}

TEST(LaneMinimizer, EveryLaneFindsTheMinimumThatItFindsAlone) {
  constexpr std::size_t n = 6;
  const MinimizerSettings settings{.tolerance = 0};
  RandomStream random(8, 0, 0);
  LaneMinimizer<Lanes8> lanes(n, settings);
  std::array<std::vector<float>, 8> starts;
  for (int k = 0; k < 8; ++k) {
    for (std::size_t i = 0; i < n; ++i) {
      starts[static_cast<std::size_t>(k)].push_back(random.uniform(-1.5f, 1.5f));
      set_lane(lanes.x()[i], k, starts[static_cast<std::size_t>(k)].back());
    }
  }
  minimize_rosenbrock(lanes);
  for (int k = 0; k < 8; ++k) {
    LaneMinimizer<float> alone(n, settings);
    alone.x() = starts[static_cast<std::size_t>(k)];
    minimize_rosenbrock(alone);
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_EQ(lane(lanes.x()[i], k), alone.x()[i]);
      EXPECT_NEAR(alone.x()[i], 1, 0.02);
    }
    EXPECT_EQ(lane(lanes.value(), k), alone.value());
    EXPECT_LT(alone.value(), 1e-4f);
  }
}

TEST(PathDescent, GradientsAreFiniteDifferences) {
  const CrowdedPanda panda;
  const PathSpline spline(8, 2, {});
  RandomStream random(9, 0, 0);
  const std::vector<double> start = panda.random_row(random);
  PathDescent<double> descent(panda.scene, spline, start, {.clearance = 0.05});
  const PathSeed seed = panda.random_seed(random, spline.points());
  descent.set({&seed, 1});
  std::vector<double> x(seed.displacement.begin(), seed.displacement.end()), gradient(x.size()), unused(x.size());
  descent.evaluate(x, gradient);
  constexpr double h = 1e-6;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double here = x[i];
    x[i] = here + h;
    const double after = descent.evaluate(x, unused);
    x[i] = here - h;
    const double slope = (after - descent.evaluate(x, unused)) / (2 * h);
    EXPECT_NEAR(gradient[i], slope, 1e-4 * std::max(1.0, std::abs(slope)));
    x[i] = here;
  }
}

TEST(PathDescent, EveryLaneFindsWhatItFindsAloneAndItCostsLess) {
  const CrowdedPanda panda;
  const PathSpline spline(8, 2, {});
  RandomStream random(10, 0, 0);
  const std::vector<double> start = panda.random_row(random);
  const DescentSettings settings{.iterations = 12};
  const Deadline never(1e6);
  std::vector<PathSeed> seeds;
  for (int k = 0; k < 8; ++k) seeds.push_back(panda.random_seed(random, spline.points()));
  std::vector<PathSeed> together = seeds;
  PathDescent<Lanes8>(panda.scene, spline, start, settings).descend(together, never);
  PathDescent<float> alone(panda.scene, spline, start, settings);
  for (std::size_t k = 0; k < seeds.size(); ++k) {
    std::vector<float> gradient(seeds[k].displacement.size());
    alone.set({&seeds[k], 1});
    const float before = alone.evaluate(seeds[k].displacement, gradient);
    alone.descend({&seeds[k], 1}, never);
    EXPECT_EQ(together[k].displacement, seeds[k].displacement);
    EXPECT_EQ(together[k].cost, seeds[k].cost);
    EXPECT_LT(seeds[k].cost, 0.5f * before);
  }
}

}  // namespace
}  // namespace manyhands
