// Pictures of meshes beside what geometry says of them.
#include <gtest/gtest.h>

#include "tests/render/render_testing.h"

namespace manyhands {
namespace {

using testing::Picture;
using testing::take;
using Point = Vec3<double>;

std::shared_ptr<const Model> model_of(const Mesh& mesh, const Transform<double>& X_WG, bool has_ground = false) {
  ModelBuilder builder("mesh");
  const MeshId id = builder.add_mesh(mesh);
  Geom geom{.name = "mesh", .link = builder.world(), .shape = {.type = ShapeType::kMesh, .mesh = id}};
  geom.X_LG = X_WG;
  builder.add_geom(geom);
  if (has_ground) builder.add_geom({.name = "ground", .link = builder.world(), .shape = {.type = ShapeType::kPlane}});
  return std::make_shared<const Model>(builder.build());
}

/// How far the ray through a pixel's centre passes from p_W.
double distance_of_ray(const Camera& camera, int i, int j, const Point& p_W) {
  const Point across{(i + 0.5 - camera.cx) / camera.fx, (j + 0.5 - camera.cy) / camera.fy, 0}, forward{0, 0, 1};
  const Point o = camera.orthographic ? camera.X_FC * across : camera.X_FC.p;
  const Point d = camera.X_FC.R * (camera.orthographic ? forward : across + forward);
  return norm(cross(p_W - o, d)) / norm(d);
}

void expect_silhouette_of_ball(const Camera& camera) {
  constexpr double kRadius = 0.3;
  constexpr int kCircles = 40;
  const Point centre{0.1, -0.2, 0.3};
  const auto model = model_of(testing::ball_mesh(kRadius, kCircles), {Mat3<double>::identity(), centre});
  Renderer renderer(model, 1);
  const Picture picture = take(renderer, Shot{.camera = camera, .q = {}});
  const double inner = kRadius * std::cos(std::numbers::pi / kCircles);
  int seen = 0;
  for (int j = 0; j < camera.height; ++j) {
    for (int i = 0; i < camera.width; ++i) {
      const auto k = static_cast<std::size_t>(j * camera.width + i);
      const double distance = distance_of_ray(camera, i, j, centre);
      seen += picture.segmentation[k] == 0 ? 1 : 0;
      if (distance < inner * (1 - 1e-4)) {
        ASSERT_EQ(picture.segmentation[k], 0) << i << ", " << j;
      }
      if (distance > kRadius * (1 + 1e-4)) {
        ASSERT_EQ(picture.segmentation[k], -1) << i << ", " << j;
      }
    }
  }
  EXPECT_GT(seen, camera.width * camera.height / 20);
}

TEST(Meshes, TheSilhouetteOfABallIsThatOfTheFormula) {
  for (const int size : {40, 161, 400}) {
    Camera camera = perspective_camera(size, size - 7, 0.9);
    camera.X_FC = orbit({0, 0, 0.2}, 1.3, 0.3 * size, -0.5, 0.1);
    expect_silhouette_of_ball(camera);
    Camera parallel = orthographic_camera(size, size - 7, 1.1);
    parallel.X_FC = orbit({0, 0, 0.2}, 1.3, 0.2 * size, 0.4);
    expect_silhouette_of_ball(parallel);
  }
}

TEST(Meshes, FromInsideTheWholeBallIsSeen) {
  const auto model = model_of(testing::ball_mesh(0.3, 12), Transform<double>::identity());
  Renderer renderer(model, 1);
  Shot shot{.camera = perspective_camera(64, 64, 2), .q = {}};
  shot.camera.X_FC = look_at({0.1, 0.05, -0.02}, {1, 0.2, 0.3});
  const Picture picture = take(renderer, shot);
  for (std::size_t k = 0; k < picture.segmentation.size(); ++k) {
    ASSERT_EQ(picture.segmentation[k], 0) << k;
    ASSERT_LT(picture.depth[k], 0.45f) << k;
  }
}

TEST(Meshes, TrianglesThatReachBehindTheCameraAreCutOff) {
  const auto model = model_of(testing::box_mesh({200, 200, 0.1f}), {Mat3<double>::identity(), {0, 0, -0.1}});
  Renderer renderer(model, 1);
  Shot shot{.camera = perspective_camera(90, 70, 1), .q = {}};
  shot.camera.X_FC = look_at({3, 4, 0.5}, {4, 4.5, 0.4});
  const Picture picture = take(renderer, shot);
  const Transform<double>& X = shot.camera.X_FC;
  int seen = 0;
  for (int j = 0; j < 70; ++j) {
    for (int i = 0; i < 90; ++i) {
      const Camera& c = shot.camera;
      const Point d = X.R * Point{(i + 0.5 - c.cx) / c.fx, (j + 0.5 - c.cy) / c.fy, 1};
      const double depth = -X.p.z / d.z;  // of the plane z = 0
      const auto k = static_cast<std::size_t>(j * 90 + i);
      if (d.z >= 0 || depth > 90) continue;
      ++seen;
      ASSERT_NEAR(static_cast<double>(picture.depth[k]), depth, 2e-4 * depth) << i << ", " << j;
    }
  }
  EXPECT_GT(seen, 2000);
}

TEST(Meshes, TheShadowOfABoxEndsWhereItsEdgesSay) {
  // The sun leans: the box's upper and lower faces, at heights of 1.1 and 0.9, shade what lies beside it.
  const auto model = model_of(testing::box_mesh({0.2f, 0.15f, 0.1f}), {Mat3<double>::identity(), {0, 0, 1}}, true);
  Renderer renderer(model, 1);
  Shot shot{.camera = orthographic_camera(201, 201, 2.01), .q = {}};
  shot.camera.X_FC = look_at({0, 0, 0.5}, {0, 0, 0}, {0, 1, 0});  // from below the box, down: 1 cm a pixel
  const double lean = 0.5;
  shot.look.light = {lean, 0, 1};
  const Picture picture = take(renderer, shot);
  shot.look.shadows = false;
  const Picture bright = take(renderer, shot);
  const double left = -0.2 - 1.1 * lean, right = 0.2 - 0.9 * lean, room = 0.02;
  for (int j = 0; j < 201; ++j) {
    for (int i = 0; i < 201; ++i) {
      const double x = 0.01 * (i - 100), y = 0.01 * (100 - j);
      const double beyond = std::max({left - x, x - right, std::abs(y) - 0.15});
      const auto k = 3 * static_cast<std::size_t>(j * 201 + i);
      if (beyond > room) {
        ASSERT_EQ(picture.colour[k], bright.colour[k]) << x << ", " << y;
      }
      if (beyond < -room) {
        ASSERT_LT(picture.colour[k], bright.colour[k] - 20) << x << ", " << y;
      }
    }
  }
}

TEST(Meshes, ClosedOnesDoNotShadeWhatFacesTheSun) {
  const auto model = model_of(testing::ball_mesh(0.3, 40), Transform<double>::identity());
  Renderer renderer(model, 1);
  for (const int rays : {1, 6}) {
    Shot shot{.camera = perspective_camera(120, 120, 0.6), .q = {}};
    shot.look.shadow_rays = rays;
    shot.look.sun_size = 0.05;
    shot.camera.X_FC = orbit({0, 0, 0}, 1.4, 0.4, -0.6);
    const Picture shaded = take(renderer, shot);
    shot.look.shadows = false;
    const Picture bright = take(renderer, shot);
    const Vec3<double> sun = (1 / norm(shot.look.light)) * shot.look.light;
    int facing = 0;
    for (std::size_t k = 0; k < shaded.depth.size(); ++k) {
      const float* const n = &shaded.normals[3 * k];
      const Vec3<double> normal{static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2])};
      if (dot(normal, sun) < 0.15) continue;  // where light only grazes, facets of 4.5 degrees may shade each other
      ++facing;
      for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(shaded.colour[3 * k + c], bright.colour[3 * k + c]) << rays;
    }
    EXPECT_GT(facing, 2000);
  }
}

}  // namespace
}  // namespace manyhands
