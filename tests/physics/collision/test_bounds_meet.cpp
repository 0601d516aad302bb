// Bounds leave no pair out that is near, and spare the narrow phase those that are plainly apart.
#include <gtest/gtest.h>

#include <algorithm>

#include "manyhands/math/instantiate.h"
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

/// The box's corners in the world.
std::vector<Vec3<double>> corners(const Vec3<double>& half, const Transform<double>& X) {
  std::vector<Vec3<double>> all;
  for (const double x : {-half.x, half.x}) {
    for (const double y : {-half.y, half.y}) {
      for (const double z : {-half.z, half.z}) all.push_back(X * Vec3<double>{x, y, z});
    }
  }
  return all;
}

TEST(BoundsMeet, BoxesMeetUnlessAScanOfCornersFindsAGapAlongAnAxis) {
  testing::ShapeSource source(6);
  int meet = 0, apart = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const Vec3<double> half_A{source.length(), source.length(), source.length()};
    const Vec3<double> half_B{source.length(), source.length(), source.length()};
    const Transform<double> X_A = source.pose(0.5), X_B = source.pose(1);
    const auto corners_A = corners(half_A, X_A), corners_B = corners(half_B, X_B);
    double gap = -1;
    for (const Mat3<double>& R : {X_A.R, X_B.R}) {
      for (const Vec3<double>& axis : {R.x, R.y, R.z}) {
        const auto along = [&](const Vec3<double>& p, const Vec3<double>& q) { return dot(axis, p) < dot(axis, q); };
        const auto [low_A, high_A] = std::ranges::minmax_element(corners_A, along);
        const auto [low_B, high_B] = std::ranges::minmax_element(corners_B, along);
        gap = std::max({gap, dot(axis, *low_B - *high_A), dot(axis, *low_A - *high_B)});
      }
    }
    if (std::abs(gap - kMargin) < 1e-12) continue;
    const bool meets = internal::box_meets_box(half_A, X_A, half_B, X_B, kMargin);
    EXPECT_EQ(meets, gap < kMargin) << "trial " << trial << ", gap " << gap;
    ++(meets ? meet : apart);
  }
  EXPECT_GT(meet, 2000);
  EXPECT_GT(apart, 2000);
}

template <class T>
void put_vector(const Vec3<float>& from, Vec3<T>& to, int k) {
  set_lane(to.x, k, from.x);
  set_lane(to.y, k, from.y);
  set_lane(to.z, k, from.z);
}

template <class T>
class BoundsMeetLanes : public ::testing::Test {};
using LaneTypes = ::testing::Types<Lanes4, Lanes8, Lanes16>;
TYPED_TEST_SUITE(BoundsMeetLanes, LaneTypes);

TYPED_TEST(BoundsMeetLanes, BoxesMeetWhereTheScalarSaysSo) {
  using T = TypeParam;
  testing::ShapeSource source(8);
  int meet = 0, apart = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const auto half = [&] { return broadcast<float>(Vec3<double>{source.length(), source.length(), source.length()}); };
    const Vec3<float> half_A = half(), half_B = half();
    std::vector<Transform<float>> X_A, X_B;
    Transform<T> X_A_lanes, X_B_lanes;
    for (int k = 0; k < width_v<T>; ++k) {
      X_A.push_back(broadcast<float>(source.pose(0.5)));
      X_B.push_back(broadcast<float>(source.pose(1)));
      const auto put = [k](const Transform<float>& from, Transform<T>& to) {
        put_vector(from.R.x, to.R.x, k);
        put_vector(from.R.y, to.R.y, k);
        put_vector(from.R.z, to.R.z, k);
        put_vector(from.p, to.p, k);
      };
      put(X_A.back(), X_A_lanes);
      put(X_B.back(), X_B_lanes);
    }
    const float margin = static_cast<float>(kMargin);
    const auto meets =
        internal::box_meets_box(broadcast<T>(half_A), X_A_lanes, broadcast<T>(half_B), X_B_lanes, T(margin));
    for (int k = 0; k < width_v<T>; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const bool alone = internal::box_meets_box(half_A, X_A[i], half_B, X_B[i], margin);
      ASSERT_EQ(lane(meets, k), alone) << "trial " << trial << ", lane " << k;
      ++(alone ? meet : apart);
    }
  }
  EXPECT_GT(meet, 100);
  EXPECT_GT(apart, 100);
}

}  // namespace
}  // namespace manyhands
