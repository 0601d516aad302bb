// What will touch within the step has a point, however bodies turn and fly; what only passes by has none.
#include <gtest/gtest.h>

#include "manyhands/model/model_builder.h"
#include "manyhands/physics/collision/collide.h"
#include "manyhands/physics/collision/queries/distance.h"
#include "tests/physics/collision/shape_testing.h"

namespace manyhands {
namespace {

using enum ShapeType;

constexpr double kStep = 0.002;

/// Two free bodies with a geom each.
struct Pair {
  Pair(const Shape& a, const Shape& b)
      : model(built(a, b)), tree(model), colliders(model), params(model), cw(colliders), ws(tree) {}

  static Model built(const Shape& a, const Shape& b) {
    ModelBuilder builder("pair");
    for (const auto& [name, shape] : {std::pair{"a", a}, {"b", b}}) {
      const LinkId link = builder.add_link(name, {.mass = 1, .inertia = {1, 1, 1, 0, 0, 0}});
      builder.add_joint({.name = name, .type = JointType::kFloating, .parent = builder.world(), .child = link});
      builder.add_geom({.link = link, .shape = shape});
    }
    return builder.build();
  }

  /// Whether a point is found, the bodies being at X_WB with the velocities V.
  bool touches(const std::array<Transform<double>, 2>& X_WB, const std::array<Motion<double>, 2>& V) {
    for (std::size_t k = 0; k < 2; ++k) {
      ws.R_WB[k + 1] = X_WB[k].R;
      ws.p_WO[k + 1] = X_WB[k].p;
      ws.V[k + 1] = V[k];
    }
    place_colliders(colliders, params, kStep, ws, cw);
    collide(colliders, colliders.pairs, params, kStep, ws, cw);
    return !cw.touches.empty();
  }

  [[nodiscard]] double distance(const std::array<Transform<double>, 2>& X_WB) const {
    const auto view = [&](std::size_t g) {
      const Collider<double>& geom = colliders.geoms[g];
      return ShapeView{geom.type, params.geom_size[geom.geom], nullptr, nullptr, nullptr};
    };
    return signed_distance<double>(view(0), X_WB[0], view(1), X_WB[1]).phi;
  }

  Model model;
  Tree<double> tree;
  Colliders<double> colliders;
  ParamsStorage<double> params;
  CollisionWorkspace<double> cw;
  Workspace<double> ws;
};

Transform<double> moved(const Transform<double>& X, const Motion<double>& V, double time) {
  return {to_matrix(quat_from_rotation_vector(time * V.w)) * X.R, X.p + time * V.v};
}

TEST(NearPoints, AreThereForAllThatTouchesWithinTheStep) {
  testing::ShapeSource source(7);
  const std::vector<Shape> shapes{{.type = kSphere, .size = {0.03, 0, 0}},
                                  {.type = kCapsule, .size = {0.02, 0.05, 0}},
                                  {.type = kCylinder, .size = {0.03, 0.02, 0}},
                                  {.type = kBox, .size = {0.02, 0.03, 0.04}}};
  int met = 0, spared = 0;
  for (const Shape& a : shapes) {
    for (const Shape& b : shapes) {
      Pair pair(a, b);
      for (int trial = 0; trial < 1500; ++trial) {
        const auto motion = [&] { return Motion<double>{8 * source.direction(), 4 * source.direction()}; };
        const std::array V{motion(), motion()};
        std::array X{source.pose(0.01), source.pose(0.01)};
        // Just in front of each other, in the first direction of which they are apart.
        const Vec3<double> out = source.direction();
        double gap = pair.distance(X);
        while (gap < 0.003) {
          X[1].p += (0.004 - std::min(gap, 0.0)) * out;
          gap = pair.distance(X);
        }
        double least = gap;
        for (int k = 1; k <= 8; ++k) {
          const double time = kStep * k / 8;
          least = std::min(least, pair.distance({moved(X[0], V[0], time), moved(X[1], V[1], time)}));
        }
        const bool touches = pair.touches(X, V);
        if (least < 0.001) {
          ++met;
          EXPECT_TRUE(touches) << static_cast<int>(a.type) << ", " << static_cast<int>(b.type) << ", gap " << gap
                               << ", least " << least;
        } else if (!touches) {
          ++spared;
        }
      }
    }
  }
  EXPECT_GT(met, 3000);
  EXPECT_GT(spared, 3000);
}

TEST(NearPoints, AreNotThereForABoxThatSlidesAlongAnother) {
  const Shape box{.type = kBox, .size = {0.1, 0.1, 0.02}};
  Pair pair(box, box);
  const Transform<double> low = Transform<double>::identity(), high{low.R, {0, 0, 0.043}};
  const Vec3<double> zero = Vec3<double>::zero();
  EXPECT_FALSE(pair.touches({low, high}, {Motion<double>::zero(), {zero, {3, 0, 0}}}));
  EXPECT_FALSE(pair.touches({low, high}, {Motion<double>::zero(), {zero, {0, 0, 3}}}));
  EXPECT_TRUE(pair.touches({low, high}, {Motion<double>::zero(), {zero, {3, 0, -1}}}));
  EXPECT_TRUE(pair.touches({low, high}, {Motion<double>{zero, {0, 0, 1}}, {zero, {3, 0, 0}}}));
  EXPECT_TRUE(pair.touches({low, high}, {Motion<double>::zero(), {{10, 0, 0}, zero}}));
  EXPECT_EQ(pair.cw.touches.size(), 1u);
}

}  // namespace
}  // namespace manyhands
