#include <gtest/gtest.h>

#include "manyhands/physics/collision/queries/queries.h"
#include "tests/render/render_testing.h"

namespace manyhands {
namespace {

using testing::Picture;
using testing::take;
using Point = Vec3<double>;

constexpr double kDegree = std::numbers::pi / 180;

/// What the world's own rays, in double precision, meet on the way through each pixel's centre.
struct Truth {
  std::vector<double> depth;
  std::vector<int> link;
};

Truth truth_of(const World& world, const Camera& camera, const Transform<double>& X_WC) {
  std::vector<Point> origins, directions;
  std::vector<double> stretch;
  for (int j = 0; j < camera.height; ++j) {
    for (int i = 0; i < camera.width; ++i) {
      const Point across{(i + 0.5 - camera.cx) / camera.fx, (j + 0.5 - camera.cy) / camera.fy, 0};
      const Point forward{0, 0, 1};
      const Point d = camera.orthographic ? forward : across + forward;
      stretch.push_back(norm(d));
      origins.push_back(camera.orthographic ? X_WC * across : X_WC.p);
      directions.push_back(X_WC.R * d);
    }
  }
  Truth truth;
  const auto hits = world.ray_cast(origins, directions, 1000);
  for (std::size_t k = 0; k < hits.size(); ++k) {
    const double depth = hits[k] ? hits[k]->distance / stretch[k] : camera.far;
    truth.depth.push_back(std::min(depth, camera.far));
    truth.link.push_back(hits[k] && depth < camera.far ? hits[k]->link.value() : -1);
  }
  return truth;
}

/// Whether all pixels around one see the same.
bool is_inside(const Truth& truth, const Camera& camera, int i, int j) {
  if (i == 0 || j == 0 || i + 1 == camera.width || j + 1 == camera.height) return false;
  for (int dj = -1; dj <= 1; ++dj) {
    for (int di = -1; di <= 1; ++di) {
      const auto at = [&](int x, int y) { return truth.link[static_cast<std::size_t>(y * camera.width + x)]; };
      if (at(i + di, j + dj) != at(i, j)) return false;
    }
  }
  return true;
}

void expect_truth(const std::shared_ptr<const Model>& model, const Camera& camera, const Transform<double>& X_WC) {
  const World world(model);
  Renderer renderer(model, 2);
  const Picture picture = take(renderer, Shot{.camera = camera, .q = model->initial_configuration()});
  const Truth truth = truth_of(world, camera, X_WC);
  int inside = 0;
  std::set<int> links;
  for (int j = 0; j < camera.height; ++j) {
    for (int i = 0; i < camera.width; ++i) {
      if (!is_inside(truth, camera, i, j)) continue;
      ++inside;
      const auto k = static_cast<std::size_t>(j * camera.width + i);
      links.insert(truth.link[k]);
      ASSERT_EQ(picture.segmentation[k], truth.link[k]) << "pixel " << i << ", " << j;
      ASSERT_NEAR(static_cast<double>(picture.depth[k]), truth.depth[k], 1e-4 * std::max(1.0, truth.depth[k] / 3))
          << "pixel " << i << ", " << j << " of " << model->links()[static_cast<std::size_t>(truth.link[k])].name;
    }
  }
  EXPECT_GT(inside, camera.width * camera.height / 2);
  EXPECT_GE(links.size(), 8U);
}

class Zoo : public ::testing::TestWithParam<unsigned> {};

TEST_P(Zoo, DepthAndSegmentationAreThoseOfRaysInDoublePrecision) {
  Camera camera = perspective_camera(161, 119, 55 * kDegree);
  camera.X_FC = orbit({0, 0, 0.4}, 3.2, 0.7 * GetParam(), -0.45, 0.2);
  expect_truth(testing::zoo(GetParam()), camera, camera.X_FC);
}

TEST_P(Zoo, ParallelRaysToo) {
  Camera camera = orthographic_camera(120, 90, 2.4);
  camera.X_FC = orbit({0, 0, 0.4}, 4, 0.9 * GetParam(), -0.6);
  expect_truth(testing::zoo(GetParam()), camera, camera.X_FC);
}

INSTANTIATE_TEST_SUITE_P(Seeds, Zoo, ::testing::Range(1U, 7U));

Shot shot_of(const std::shared_ptr<const Model>& model, int width, int height) {
  Shot shot{.camera = perspective_camera(width, height, 55 * kDegree), .q = model->initial_configuration()};
  shot.camera.X_FC = orbit({0, 0, 0.4}, 3.2, 0.7, -0.45);
  shot.look.antialiasing = 2;
  shot.marks.push_back({.shape = {.type = ShapeType::kSphere, .size = {0.3, 0, 0}}});
  shot.marks[0].X_WM.p = {0.4, -0.6, 0.6};
  return shot;
}

TEST(Renderer, TheSamePictureWhateverTheThreadsAndTheOthersOfTheCall) {
  const auto model = testing::zoo(3);
  Renderer one(model, 1), three(model, 3);
  const Shot shot = shot_of(model, 75, 61);
  const Picture alone = take(one, shot), shared = take(three, shot);
  EXPECT_EQ(alone.colour, shared.colour);
  EXPECT_EQ(alone.depth, shared.depth);
  EXPECT_EQ(alone.segmentation, shared.segmentation);
  EXPECT_EQ(alone.normals, shared.normals);
  std::vector<Shot> many(20, shot);
  for (std::size_t i = 0; i < many.size(); i += 2)
    many[i].camera.X_FC = orbit({0, 0, 0.3}, 2.5, 0.1 * static_cast<double>(i), -0.3);
  const Picture batch = take(three, many);
  for (std::size_t i = 1; i < many.size(); i += 2) {
    EXPECT_TRUE(std::equal(alone.colour.begin(), alone.colour.end(), batch.colour.begin() + i * alone.colour.size()));
    EXPECT_TRUE(std::equal(alone.depth.begin(), alone.depth.end(), batch.depth.begin() + i * alone.depth.size()));
  }
}

TEST(Renderer, MarksAreSeenInColourOnly) {
  const auto model = testing::zoo(3);
  Renderer renderer(model, 1);
  Shot shot = shot_of(model, 64, 48);
  const Picture with = take(renderer, shot);
  shot.marks.clear();
  const Picture without = take(renderer, shot);
  EXPECT_NE(with.colour, without.colour);
  EXPECT_EQ(with.depth, without.depth);
  EXPECT_EQ(with.segmentation, without.segmentation);
}

/// A ball of radius 0.2 at (0, 0, 1) over a plane, the sun straight above, seen from the side.
Shot ball_in_the_sun(std::shared_ptr<const Model>& model) {
  ModelBuilder builder("ball");
  builder.add_geom({.name = "ground", .link = builder.world(), .shape = {.type = ShapeType::kPlane}});
  Geom ball{.name = "ball", .link = builder.world(), .shape = {.type = ShapeType::kSphere, .size = {0.2, 0, 0}}};
  ball.X_LG.p = {0, 0, 1};
  builder.add_geom(ball);
  model = std::make_shared<const Model>(builder.build());
  Shot shot{.camera = orthographic_camera(101, 101, 2.02), .q = {}};
  shot.camera.X_FC = look_at({0, 0, 0.5}, {0, 0, 0}, {0, 1, 0});  // from below the ball, down: 2 cm a pixel
  shot.look.light = {0, 0, 1};
  return shot;
}

TEST(Renderer, TheShadowOfABallIsADisc) {
  std::shared_ptr<const Model> model;
  const Shot shot = ball_in_the_sun(model);
  Renderer renderer(model, 1);
  const Picture picture = take(renderer, shot);
  const auto brightness = [&](int i, int j) { return picture.colour[3 * static_cast<std::size_t>(j * 101 + i)]; };
  const int lit = brightness(0, 50), dark = brightness(50, 50);
  EXPECT_GT(lit, dark + 30);
  for (int j = 0; j < 101; ++j) {
    for (int i = 0; i < 101; ++i) {
      const double distance = 0.02 * std::hypot(i - 50, j - 50);
      if (std::abs(distance - 0.2) < 0.02) continue;
      const int expected = distance < 0.2 ? dark : lit;  // but for the squares of the floor, which differ less
      EXPECT_NEAR(brightness(i, j), expected, 25) << i << ", " << j;
    }
  }
}

TEST(Renderer, SoftShadowsHaveAPenumbraOfTheSunsWidth) {
  std::shared_ptr<const Model> model;
  Shot shot = ball_in_the_sun(model);
  shot.look.shadow_rays = 64;
  shot.look.sun_size = 0.1;  // 1 m below: from 0.1 to 0.3
  Renderer renderer(model, 1);
  const Picture soft = take(renderer, shot);
  shot.look.shadows = false;
  const Picture none = take(renderer, shot);
  const auto red = [](const Picture& p, int i) {
    return static_cast<int>(p.colour[3 * static_cast<std::size_t>(50 * 101 + i)]);
  };
  const int dark = red(soft, 50);
  EXPECT_NEAR(red(soft, 53), dark, 6);  // 0.06 from the middle
  EXPECT_GT(red(soft, 60), dark + 10);  // 0.20
  EXPECT_LT(red(soft, 60), red(none, 60) - 10);
  EXPECT_EQ(red(soft, 66), red(none, 66));  // 0.32
}

TEST(Renderer, ConvexBodiesDoNotShadeThemselves) {
  const auto model = testing::zoo(2);
  const Renderer renderer(model, 1);
  ModelBuilder builder("alone");
  const Geom geom{
      .name = "cylinder", .link = builder.world(), .shape = {.type = ShapeType::kCylinder, .size = {0.3, 0.5, 0}}};
  builder.add_geom(geom);
  const auto alone = std::make_shared<const Model>(builder.build());
  Renderer one(alone, 1);
  Shot shot{.camera = perspective_camera(80, 80, 1), .q = {}};
  shot.camera.X_FC = orbit({0, 0, 0}, 2, 0.4, -0.5);
  const Picture shaded = take(one, shot);
  shot.look.shadows = false;
  EXPECT_EQ(shaded.colour, take(one, shot).colour);
}

TEST(Renderer, ACameraOnALinkMovesWithIt) {
  ModelBuilder builder("arm");
  const LinkId arm = builder.add_link("arm", {.mass = 1, .com = {0, 0, 0}, .inertia = {1, 1, 1, 0, 0, 0}});
  builder.add_joint({.name = "turn", .type = JointType::kContinuous, .parent = builder.world(), .child = arm});
  Geom wall{.name = "wall", .link = builder.world(), .shape = {.type = ShapeType::kBox, .size = {1, 0.1, 1}}};
  wall.X_LG.p = {0, 2, 0};
  builder.add_geom(wall);
  const auto model = std::make_shared<const Model>(builder.build());
  Renderer renderer(model, 1);
  Shot shot{.camera = perspective_camera(9, 9, 0.5), .q = {0}};
  shot.camera.frame = "arm";
  shot.camera.X_FC = look_at({0.5, 0, 0}, {1, 0, 0});
  EXPECT_EQ(take(renderer, shot).segmentation[40], -1);
  shot.q = {std::numbers::pi / 2};
  const Picture picture = take(renderer, shot);
  EXPECT_EQ(picture.segmentation[40], 0);
  EXPECT_NEAR(static_cast<double>(picture.depth[40]), 1.4, 1e-5);
  EXPECT_NEAR(static_cast<double>(picture.normals[3 * 40 + 1]), -1, 1e-6);
  EXPECT_NEAR(renderer.camera_pose(shot).p.y, 0.5, 1e-12);
}

TEST(Renderer, RefusesWhatDoesNotFit) {
  const auto model = testing::zoo(1);
  Renderer renderer(model, 1);
  const Shot good = shot_of(model, 8, 8);
  const auto refuses = [&](auto&& spoil) {
    Shot shot = good;
    spoil(shot);
    EXPECT_THROW((void)take(renderer, shot), std::invalid_argument);
  };
  refuses([](Shot& shot) { shot.q = {1}; });
  refuses([](Shot& shot) { shot.guise.rgba.resize(1); });
  refuses([](Shot& shot) { shot.camera.near = -1; });
  refuses([](Shot& shot) { shot.camera.fx = 0; });
  refuses([](Shot& shot) { shot.look.light = {0, 0, 0}; });
  refuses([](Shot& shot) { shot.look.shadow_rays = 0; });
  refuses([](Shot& shot) { shot.look.antialiasing = 99; });
  refuses([](Shot& shot) { shot.marks[0].shape.type = ShapeType::kMesh; });
  Shot lost = good;
  lost.camera.frame = "nowhere";
  EXPECT_THROW((void)take(renderer, lost), std::out_of_range);
  std::vector<float> depth(3);
  EXPECT_THROW(renderer.render(std::span(&good, 1), {{}, depth, {}, {}}), std::invalid_argument);
}

}  // namespace
}  // namespace manyhands
