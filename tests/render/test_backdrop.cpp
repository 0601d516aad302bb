// What is kept of one picture does not show in the next.
#include <gtest/gtest.h>

#include "manyhands/render/texture.h"
#include "tests/render/render_testing.h"

namespace manyhands {
namespace {

using testing::Picture;
using testing::take;

/// Ground, a crate and a fixed mesh; a ball of triangles and a box that fly, a see-through mesh beside them.
std::shared_ptr<const Model> scene() {
  ModelBuilder builder("scene");
  const auto add = [&](LinkId link, const char* name, const Shape& shape, const Vec3<double>& p, float alpha = 1) {
    Geom geom{.name = name, .link = link, .shape = shape};
    geom.role = GeomRole::kVisual;
    geom.X_LG.p = p;
    geom.rgba = {0.8f, 0.6f, 0.4f, alpha};
    builder.add_geom(geom);
  };
  const auto free_link = [&](const char* name) {
    const LinkId link = builder.add_link(name, {.mass = 1, .com = {0, 0, 0}, .inertia = {1, 1, 1, 0, 0, 0}});
    builder.add_joint(
        {.name = std::string(name) + "_joint", .type = JointType::kFloating, .parent = builder.world(), .child = link});
    return link;
  };
  const MeshId ball = builder.add_mesh(testing::ball_mesh(0.15, 20));
  const MeshId block = builder.add_mesh(testing::box_mesh({0.1f, 0.2f, 0.3f}));
  add(builder.world(), "ground", {.type = ShapeType::kPlane}, {0, 0, 0});
  add(builder.world(), "crate", {.type = ShapeType::kBox, .size = {0.2, 0.2, 0.2}}, {0.4, 0.5, 0.2});
  add(builder.world(), "pillar", {.type = ShapeType::kMesh, .mesh = block}, {-0.5, 0.2, 0.3});
  add(free_link("ball"), "ball", {.type = ShapeType::kMesh, .mesh = ball}, {0, 0, 0});
  add(free_link("box"), "box", {.type = ShapeType::kBox, .size = {0.1, 0.1, 0.1}}, {0, 0, 0});
  add(free_link("glass"), "glass", {.type = ShapeType::kMesh, .mesh = block}, {0, 0, 0}, 0.4f);
  return std::make_shared<const Model>(builder.build());
}

/// Number i of pictures that differ in what moves, and some in what does not.
Shot shot_of(const Model& model, int i, bool is_fine) {
  Shot shot{.camera = perspective_camera(91, 67, 0.9), .q = model.initial_configuration()};
  shot.camera.X_FC = orbit({0, 0, 0.3}, 2.2, 0.7, -0.4);
  for (std::size_t body = 0; body < 3; ++body) {
    const double turn = 0.9 * static_cast<double>(body) + 0.37 * i;
    shot.q[7 * body] = 0.6 * std::cos(turn);
    shot.q[7 * body + 1] = 0.5 * std::sin(1.3 * turn);
    shot.q[7 * body + 2] = 0.4 + 0.3 * std::sin(2 * turn);
  }
  if (is_fine) {
    shot.look.antialiasing = 2;
    shot.look.shadow_rays = 6;
    shot.look.sun_size = 0.05;
  }
  shot.marks.push_back({.shape = {.type = ShapeType::kSphere, .size = {0.1, 0, 0}}});
  shot.marks[0].X_WM.p = {0.1 * i - 0.5, -0.3, 0.2};
  if (i % 5 == 1) shot.look.sun = 0.5f;
  if (i % 5 == 2) {
    shot.guise.sizes.resize(model.geoms().size(), Vec3<double>::zero());
    shot.guise.sizes[1] = {0.1, 0.25, 0.2};
  }
  if (i % 5 == 3) {
    for (const Geom& geom : model.geoms()) shot.guise.rgba.push_back(geom.rgba);
    shot.guise.rgba[0] = {0.2f, 0.3f, 0.1f, 1};
  }
  if (i % 5 == 4) {
    shot.guise.textures.resize(model.geoms().size());
    shot.guise.textures[0].image = assorted_images()[static_cast<std::size_t>(i / 5 % 2)];
  }
  return shot;
}

class Kept : public ::testing::TestWithParam<bool> {};

TEST_P(Kept, APictureIsTheSameWhateverWasDrawnBefore) {
  const auto model = scene();
  const auto shared = std::make_shared<const Scene>(model);
  Renderer used(shared, 1), threads(shared, 3);
  std::vector<Shot> shots;
  for (int i = 0; i < 30; ++i) shots.push_back(shot_of(*model, i, GetParam()));
  const Picture together = take(threads, shots);
  for (std::size_t i = 0; i < shots.size(); ++i) {
    Renderer fresh(shared, 1);
    const Picture first = take(fresh, shots[i]), again = take(used, shots[i]);
    EXPECT_EQ(first.colour, again.colour) << i;
    EXPECT_EQ(first.depth, again.depth) << i;
    EXPECT_EQ(first.segmentation, again.segmentation) << i;
    EXPECT_EQ(first.normals, again.normals) << i;
    const std::size_t n = first.depth.size();
    const auto part = [&](const auto& all, std::size_t size) {
      const auto from = all.begin() + static_cast<std::ptrdiff_t>(i * size);
      return std::vector(from, from + static_cast<std::ptrdiff_t>(size));
    };
    EXPECT_EQ(first.colour, part(together.colour, 3 * n)) << i;
    EXPECT_EQ(first.depth, part(together.depth, n)) << i;
    std::vector<std::uint8_t> colour(3 * n);
    used.render(std::span(&shots[i], 1), {colour, {}, {}, {}});  // colours do not depend on what else is asked for
    EXPECT_EQ(first.colour, colour) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Looks, Kept, ::testing::Bool());

}  // namespace
}  // namespace manyhands
