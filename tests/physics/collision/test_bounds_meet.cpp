// Bounds leave no pair out that is near, and spare the narrow phase those that are plainly apart.
#include <gtest/gtest.h>

#include "manyhands/model/model_builder.h"
#include "manyhands/physics/collision/broad/bounds_meet.h"
#include "manyhands/physics/collision/queries/distance.h"
#include "tests/physics/collision/shape_testing.h"

namespace manyhands {
namespace {

constexpr double kMargin = 0.01;

/// Two geoms of any type, the second one's body at the world where it shall not move.
struct Pair {
  Pair(const Shape& a, const Shape& b, bool fixed, testing::ShapeSource& source)
      : model(built(a, b, fixed, source)), colliders(model), params(model) {}

  static Model built(Shape a, Shape b, bool fixed, testing::ShapeSource& source) {
    ModelBuilder builder("pair");
    const auto mesh = [&](Shape& shape) {
      if (shape.type != ShapeType::kConvex) return;
      Mesh cloud;
      // Far to one side of its origin, as hulls of links often are.
      for (const Vec3<double>& p : source.cloud(30))
        cloud.vertices.push_back(broadcast<float>(p + Vec3<double>{1, 0, 0}));
      shape.mesh = builder.add_mesh(cloud);
    };
    mesh(a);
    mesh(b);
    const auto add = [&](const char* name, const Shape& shape) {
      const LinkId link = builder.add_link(name, {.mass = 1, .inertia = {1, 1, 1, 0, 0, 0}});
      builder.add_joint({.name = name, .type = JointType::kFloating, .parent = builder.world(), .child = link});
      builder.add_geom({.link = link, .shape = shape});
    };
    add("a", a);
    if (fixed) {
      builder.add_geom({.link = builder.world(), .shape = b});
    } else {
      add("b", b);
    }
    return builder.build();
  }

  Model model;
  Colliders<double> colliders;
  ParamsStorage<double> params;
};

TEST(BoundsMeet, OfAllThatIsNearAndOfFewElse) {
  using enum ShapeType;
  testing::ShapeSource source(5);
  const std::vector<Shape> shapes{{.type = kSphere, .size = {0.3, 0, 0}},
                                  {.type = kCapsule, .size = {0.1, 0.5, 0}},
                                  {.type = kCylinder, .size = {0.1, 0.5, 0}},
                                  {.type = kBox, .size = {0.1, 0.3, 0.6}},
                                  {.type = kConvex}};
  int near = 0, spared = 0;
  for (const Shape& a : shapes) {
    for (const Shape& b : shapes) {
      for (const bool fixed : {false, true}) {
        const Pair pair(a, b, fixed, source);
        ASSERT_EQ(pair.colliders.pairs.size(), 1u);
        const ColliderPair& which = pair.colliders.pairs[0];
        const auto radius = [&](std::size_t i) {
          const Collider<double>& g = pair.colliders.geoms[i];
          return bounding_radius(g, pair.params.geom_size[g.geom]);
        };
        const std::vector<double> radii{radius(0), radius(1)};
        const auto view = [&](std::size_t i) {
          const Collider<double>& g = pair.colliders.geoms[i];
          return ShapeView{g.type, pair.params.geom_size[g.geom], g.hull.get(), g.mesh.get(), nullptr};
        };
        for (int trial = 0; trial < 400; ++trial) {
          const std::vector<Transform<double>> X{source.pose(1), source.pose(1)};
          const bool meets = spheres_meet(pair.colliders, which, pair.params, kMargin, X, radii) &&
                             boxes_meet(pair.colliders, which, pair.params, kMargin, X, radii);
          const double phi = signed_distance<double>(view(which.a), X[which.a], view(which.b), X[which.b]).phi;
          if (phi < kMargin) {
            ++near;
            EXPECT_TRUE(meets) << static_cast<int>(a.type) << ", " << static_cast<int>(b.type) << ", phi " << phi;
          } else if (!meets) {
            ++spared;
          }
        }
      }
    }
  }
  EXPECT_GT(near, 1000);
  EXPECT_GT(spared, 1000);
}

}  // namespace
}  // namespace manyhands
