// Parts that no model can have: the builder refuses them by name.
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "manyhands/model/model_builder.h"

namespace manyhands {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct Bad {
  const char* name;
  std::function<void(ModelBuilder&)> add;
  std::string expected;
};

class PartChecks : public ::testing::TestWithParam<Bad> {};

TEST_P(PartChecks, RefuseByName) {
  ModelBuilder builder;
  builder.add_link("link", {.mass = 1, .inertia = {1, 1, 1, 0, 0, 0}});
  builder.add_joint({.name = "joint", .type = JointType::kRevolute, .parent = builder.world(), .child = LinkId(1)});
  try {
    GetParam().add(builder);
    (void)builder.build();
    FAIL() << "nothing was refused";
  } catch (const ModelError& error) {
    EXPECT_NE(std::string(error.what()).find(GetParam().expected), std::string::npos) << error.what();
  }
}

Geom geom(ShapeType type, const Vec3<double>& size) {
  return {.name = "g", .link = LinkId(1), .shape = {.type = type, .size = size}};
}

template <class Change>
std::function<void(ModelBuilder&)> ball_with(Change change) {
  return [change](ModelBuilder& builder) {
    Geom ball = geom(ShapeType::kSphere, {1, 0, 0});
    change(ball);
    builder.add_geom(ball);
  };
}

std::function<void(ModelBuilder&)> with_geom(const Geom& added) {
  return [added](ModelBuilder& builder) { builder.add_geom(added); };
}

std::function<void(ModelBuilder&)> with_mesh(const Mesh& added) {
  return [added](ModelBuilder& builder) { builder.add_mesh(added); };
}

INSTANTIATE_TEST_SUITE_P(
    All, PartChecks,
    ::testing::Values(
        Bad{"NoRadius", with_geom(geom(ShapeType::kSphere, {0, 0, 0})), "geom 'g': a size is 0"},
        Bad{"NegativeLength", with_geom(geom(ShapeType::kCapsule, {1, -1, 0})), "geom 'g': a size is -1"},
        Bad{"FlatBox", with_geom(geom(ShapeType::kBox, {1, 1, 0})), "geom 'g': a size is 0"},
        Bad{"NaNSize", with_geom(geom(ShapeType::kCylinder, {1, kNaN, 0})), "geom 'g': a size is"},
        Bad{"NaNPose", ball_with([](Geom& g) { g.X_LG.p.y = kNaN; }), "geom 'g': its pose"},
        Bad{"NegativeFriction", ball_with([](Geom& g) { g.surface.lateral_friction = -1; }), "geom 'g': frictions"},
        Bad{"NaNMargin", ball_with([](Geom& g) { g.margin = kNaN; }), "geom 'g': the margin"},
        Bad{"MakesEnergy", ball_with([](Geom& g) { g.surface.restitution = 1.5; }), "geom 'g': restitution is 1.5"},
        Bad{"NaNRestitution", ball_with([](Geom& g) { g.surface.restitution = kNaN; }), "geom 'g': restitution is"},
        Bad{"NoLink", ball_with([](Geom& g) { g.link = LinkId(7); }), "a geom needs a link added before"},
        Bad{"NoMesh", with_geom(geom(ShapeType::kConvex, {})), "geom 'g' needs a mesh added before"},
        Bad{"NoHeights", with_geom(geom(ShapeType::kHeightField, {})), "geom 'g' needs a height field added before"},
        Bad{"NaNVertex", with_mesh({.source = "m", .vertices = {{0, 0, static_cast<float>(kNaN)}}}),
            "mesh 'm': a vertex is not finite"},
        Bad{"NoSuchVertex", with_mesh({.source = "m", .vertices = {{0, 0, 0}}, .triangles = {{0, 0, 1}}}),
            "mesh 'm': a triangle names vertex 1 of 1"},
        Bad{"OneRow", [](ModelBuilder& b) { b.add_height_field({.columns = 2, .rows = 1, .height = {0, 0}}); },
            "2 x 2 or more"},
        Bad{"LongInitial",
            [](ModelBuilder& b) {
              const LinkId link = b.add_link("second", {.mass = 1});
              b.add_joint({.name = "j", .parent = b.world(), .child = link, .initial = {1}});
            },
            "joint 'j': its initial configuration has 1 numbers; expected 0"},
        Bad{"ShortKey", [](ModelBuilder& b) { b.add_keyframe({.name = "k", .q = {1, 2}}); },
            "keyframe 'k' does not have nq, nv, nu and na numbers"}),
    [](const auto& of) { return of.param.name; });

TEST(PartChecks, KeyframesBeginWithWhatIsThere) {
  ModelBuilder builder;
  builder.add_link("link", {.mass = 1, .inertia = {1, 1, 1, 0, 0, 0}});
  builder.add_joint(
      {.name = "joint", .type = JointType::kRevolute, .parent = builder.world(), .child = LinkId(1), .initial = {0.5}});
  builder.add_keyframe({.name = "k"});
  const Model model = builder.build();
  EXPECT_EQ(model.keyframes()[0].q, std::vector<double>{0.5});
  EXPECT_EQ(model.keyframes()[0].v, std::vector<double>{0.0});
  EXPECT_EQ(model.initial_configuration(), std::vector<double>{0.5});
}

}  // namespace
}  // namespace manyhands
