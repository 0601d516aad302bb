// Contact of shapes alone is that of a step in every lane; distances and rays in a placed world are those of its geoms.
#include <gtest/gtest.h>

#include "manyhands/math/instantiate.h"
#include "manyhands/model/model_builder.h"
#include "manyhands/physics/collision/collide_pair.h"
#include "manyhands/physics/collision/general/shape_contact.h"
#include "manyhands/physics/collision/queries/queries.h"
#include "manyhands/physics/collision/queries/ray_cast.h"
#include "manyhands/physics/dynamics/kinematics.h"
#include "tests/physics/collision/convex_truth.h"
#include "tests/physics/collision/shape_testing.h"

namespace manyhands {
namespace {

using testing::Point;
using testing::ShapeSource;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A floor, and free bodies of two geoms each, at random; of the first two, contact is excluded.
struct Scene {
  explicit Scene(unsigned seed) : source(seed), model(built()), tree(model), colliders(model), params(model), ws(tree) {
    forward_kinematics(tree, model.initial_configuration().data(), ws);
  }

  Model built() {
    ModelBuilder builder("scene");
    builder.add_geom({.name = "floor",
                      .link = builder.world(),
                      .X_LG = {Mat3<double>::identity(), {0, 0, -1}},
                      .shape = {.type = ShapeType::kPlane}});
    for (int i = 0; i < 8; ++i) {
      const LinkId link = builder.add_link("body" + std::to_string(i), {.mass = 1, .inertia = {1, 1, 1, 0, 0, 0}});
      const Transform<double> X = source.pose(1);
      const Quat<double> r = to_quat(X.R);
      builder.add_joint({.name = "joint" + std::to_string(i),
                         .type = JointType::kFloating,
                         .parent = builder.world(),
                         .child = link,
                         .initial = {X.p.x, X.p.y, X.p.z, r.x, r.y, r.z, r.w}});
      builder.add_geom(
          {.link = link, .X_LG = source.pose(0.2), .shape = {.type = ShapeType::kBox, .size = {0.1, 0.2, 0.3}}});
      builder.add_geom(
          {.link = link, .X_LG = source.pose(0.2), .shape = {.type = ShapeType::kCapsule, .size = {0.1, 0.2, 0}}});
    }
    builder.exclude_contact(LinkId(1), LinkId(2));
    return builder.build();
  }

  /// By the poses of links and the model's own geoms, all of them against each other.
  [[nodiscard]] double distance(int a, int b) const {
    double least = kInfinity;
    for (const Geom& g : model.geoms()) {
      for (const Geom& h : model.geoms()) {
        if (g.link.value() != a || h.link.value() != b) continue;
        const ShapeView s{g.shape.type, g.shape.size}, t{h.shape.type, h.shape.size};
        least = std::min(least, signed_distance(s, pose(g), t, pose(h)).phi);
      }
    }
    return least;
  }
  [[nodiscard]] Transform<double> pose(const Geom& geom) const {
    const Link& link = model.link(geom.link);
    return frame_pose(link.body, link.X_BL, ws) * geom.X_LG;
  }

  ShapeSource source;
  Model model;
  Tree<double> tree;
  Colliders<double> colliders;
  ParamsStorage<double> params;
  Workspace<double> ws;
};

TEST(Queries, LinksAreAsFarApartAsTheirNearestGeoms) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const Scene scene(seed);
    const GeomPlaces places(scene.colliders, scene.params, scene.ws);
    const PlacedGeoms geoms(scene.colliders, scene.params, places);
    for (int a = 0; a < 9; ++a) {
      for (int b = 0; b < 9; ++b) {
        if (a == b) continue;
        const auto found = link_distance(scene.model, geoms, LinkId(a), LinkId(b));
        ASSERT_TRUE(found.has_value());
        EXPECT_NEAR(found->surfaces.phi, scene.distance(a, b), 1e-9);
        EXPECT_EQ(found->link_a, LinkId(a));
        EXPECT_EQ(scene.model.geoms()[found->geom_b.index()].link, LinkId(b));
      }
    }
  }
}

TEST(Queries, NearLinksAreAllOfThemThatMayTouch) {
  std::size_t total = 0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    const Scene scene(seed);
    const GeomPlaces places(scene.colliders, scene.params, scene.ws);
    const PlacedGeoms geoms(scene.colliders, scene.params, places);
    for (const double d : {-0.05, 0.0, 0.3, 10.0}) {
      std::vector<std::pair<int, int>> expected, got;
      for (int a = 0; a < 9; ++a) {
        for (int b = a + 1; b < 9; ++b) {
          if (!(a == 1 && b == 2) && scene.distance(a, b) < d) expected.emplace_back(a, b);
        }
      }
      for (const LinkDistance& near : links_within(geoms, d)) {
        got.emplace_back(near.link_a.value(), near.link_b.value());
        EXPECT_NEAR(near.surfaces.phi, scene.distance(near.link_a.value(), near.link_b.value()), 1e-9);
      }
      EXPECT_EQ(got, expected);
      total += got.size();
      std::vector<std::pair<int, int>> with_third;
      for (const LinkDistance& near : links_within(scene.model, geoms, d, LinkId(3))) {
        with_third.emplace_back(near.link_a.value(), near.link_b.value());
      }
      std::erase_if(expected, [](const std::pair<int, int>& pair) { return pair.first != 3 && pair.second != 3; });
      EXPECT_EQ(with_third, expected);
    }
  }
  EXPECT_GT(total, 300u);
}

TEST(Queries, ARayMeetsTheFirstOfAllGeoms) {
  int hits = 0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    Scene scene(seed);
    const GeomPlaces places(scene.colliders, scene.params, scene.ws);
    const PlacedGeoms geoms(scene.colliders, scene.params, places);
    std::vector<Point> origins, directions;
    for (int i = 0; i < 100; ++i) {
      origins.push_back(scene.source.uniform(0.5, 4) * scene.source.direction());
      origins.back().z = std::abs(origins.back().z);
      directions.push_back(scene.source.direction());
    }
    for (const double far : {1.5, kInfinity}) {
      const auto found = ray_cast(geoms, origins, directions, far);
      for (std::size_t i = 0; i < origins.size(); ++i) {
        double least = kInfinity;
        GeomId first;
        for (std::size_t g = 0; g < scene.model.geoms().size(); ++g) {
          const Geom& geom = scene.model.geoms()[g];
          const ShapeView shape{geom.shape.type, geom.shape.size};
          const auto hit = ray_cast(shape, scene.pose(geom), origins[i], directions[i], far);
          if (hit && hit->distance < least) least = hit->distance, first = GeomId(g);
        }
        ASSERT_EQ(found[i].has_value(), first.is_valid());
        if (!found[i]) continue;
        ++hits;
        EXPECT_NEAR(found[i]->distance, least, 1e-9);
        EXPECT_EQ(found[i]->geom, first);
        EXPECT_EQ(found[i]->link, scene.model.geoms()[first.index()].link);
        EXPECT_LT(norm(found[i]->point - origins[i] - least * directions[i]), 1e-9);
        EXPECT_LE(dot(found[i]->normal, directions[i]), 1e-12);
      }
    }
  }
  EXPECT_GT(hits, 500);
}

TEST(Queries, ALinkWithoutGeomsIsNowhere) {
  ModelBuilder builder("bare");
  builder.add_link("bare");
  const Model model = builder.build();
  const Tree<double> tree(model);
  const Workspace<double> ws(tree);
  const Colliders<double> colliders(model);
  const ParamsStorage<double> params(model);
  const GeomPlaces places(colliders, params, ws);
  const PlacedGeoms geoms(colliders, params, places);
  EXPECT_FALSE(link_distance(model, geoms, LinkId(0), LinkId(1)).has_value());
  EXPECT_TRUE(links_within(geoms, 1).empty());
}

std::vector<CollisionShape> every_shape() {
  std::vector<Point> corners;
  Mesh mesh;
  for (int i = 0; i < 8; ++i) corners.push_back({i & 1 ? 0.1 : -0.1, i & 2 ? 0.2 : -0.2, i & 4 ? 0.15 : -0.15});
  mesh.vertices = {{-1, -1, 0}, {1, -1, 0.1f}, {1, 1, 0}, {-1, 1, -0.1f}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  const HeightField field{.columns = 3, .rows = 3, .dx = 0.5, .dy = 0.5, .height = {0, 0.1, 0, 0.1, 0.2, 0, 0, 0, 0.1}};
  return {CollisionShape::sphere(0.1),       CollisionShape::capsule(0.1, 0.2),  CollisionShape::cylinder(0.1, 0.2),
          CollisionShape::box({.1, .2, .3}), CollisionShape::convex(corners),    CollisionShape::plane(),
          CollisionShape::mesh(mesh),        CollisionShape::height_field(field)};
}

/// Two shapes as the geoms of a model would be.
template <Real R>
Colliders<R> colliders_of(const CollisionShape& a, const CollisionShape& b) {
  Colliders<R> colliders;
  for (const CollisionShape* shape : {&a, &b}) {
    Collider<R>& geom = colliders.geoms.emplace_back();
    geom.type = shape->type();
    geom.geom = geom.body = geom.root = colliders.geoms.size() - 1;
    geom.hull = shape->hull();
    geom.mesh = shape->triangles();
    geom.height_field = shape->field();
  }
  return colliders;
}

// What a lane of a step finds, the scalar finds: for every pair of shapes, and with poses that come from double.
TEST(ShapeContact, IsThatOfEveryLane) {
  using T = Lanes8;
  ShapeSource source(5);
  const std::vector<CollisionShape> shapes = every_shape();
  int touching = 0;
  for (std::size_t i = 0; i < 5; ++i) {
    for (std::size_t j = i; j < shapes.size(); ++j) {
      const CollisionShape &a = shapes[i], &b = shapes[j];
      const Colliders<float> colliders = colliders_of<float>(a, b);
      Layout two_geoms;
      two_geoms[Each::kGeom] = 2;
      ParamsStorage<float> params(two_geoms);
      params.geom_size[0] = broadcast<float>(a.size());
      params.geom_size[1] = broadcast<float>(b.size());
      std::vector<Transform<T>> X_WG(2);
      std::vector<ShapeContact<float>> scalar;
      for (int k = 0; k < width_v<T>; ++k) {
        const auto X_WA = broadcast<float>(source.pose(0.15)), X_WB = broadcast<float>(source.pose(0.15));
        testing::put_lane(X_WG[0], k, X_WA);
        testing::put_lane(X_WG[1], k, X_WB);
        scalar.push_back(shape_contact(a, X_WA, b, X_WB, 0.01f));
      }
      std::array<Manifold<T>, 4> found;
      const ColliderPair pair = {.a = 0, .b = 1};
      const std::size_t count = collide_pair<T>(colliders, pair, params, mask_t<T>(true), T(0.01f), X_WG, found);
      for (int k = 0; k < width_v<T>; ++k) {
        const ShapeContact<float>& contact = scalar[static_cast<std::size_t>(k)];
        ASSERT_GE(count, contact.size);
        for (std::size_t m = 0; m < contact.size; ++m) {
          Manifold<T> kept = found[m];
          for (T& phi : kept.phi) phi = select(phi <= T(0.01f), phi, T(std::numeric_limits<float>::infinity()));
          for (const float phi : contact.manifolds[m].phi) touching += is_finite(phi);
          testing::compare_lane(kept, contact.manifolds[m], k, [&](float got, float want) {
            EXPECT_TRUE(testing::same(got, want)) << got << ", alone " << want << ": shapes " << i << " and " << j;
          });
        }
      }
    }
  }
  EXPECT_GT(touching, 300);
}

TEST(ShapeContact, RefusesWhatNoStepLooksAt) {
  const auto here = Transform<double>::identity();
  const CollisionShape plane = CollisionShape::plane(), ball = CollisionShape::sphere(1);
  EXPECT_THROW((void)shape_contact(plane, here, plane, here, 0.0), std::invalid_argument);
  EXPECT_THROW((void)shape_contact(ball, here, plane, here, -1.0), std::invalid_argument);
  EXPECT_THROW((void)shape_contact(ball, here, plane, here, kInfinity), std::invalid_argument);
  EXPECT_THROW((void)CollisionShape::sphere(kInfinity), std::invalid_argument);
}

}  // namespace
}  // namespace manyhands
