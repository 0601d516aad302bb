// Models that become parts of others: on whose links they stand, and what a copy keeps.
#include <gtest/gtest.h>

#include "manyhands/model/compose.h"
#include "manyhands/model/fingerprint.h"

namespace manyhands {
namespace {

constexpr SymMat3<double> kInertia{1e-3, 1e-3, 1e-3, 0, 0, 0};

/// A palm welded to the world, 0.1 m up, with a finger that slides along x.
Model hand() {
  ModelBuilder builder("hand");
  const LinkId palm = builder.add_link("palm", {.mass = 1, .inertia = kInertia});
  builder.place_root(palm, {Mat3<double>::identity(), {0, 0, 0.1}});
  const LinkId finger = builder.add_link("finger", {.mass = 0.5, .inertia = kInertia});
  builder.add_joint(
      {.name = "slide", .type = JointType::kPrismatic, .parent = palm, .child = finger, .axis = {1, 0, 0}});
  builder.add_geom({.name = "pad", .link = finger, .shape = {.type = ShapeType::kSphere, .size = {0.01, 0, 0}}});
  builder.add_geom(
      {.name = "plate", .link = builder.world(), .shape = {.type = ShapeType::kSphere, .size = {1, 0, 0}}});
  return builder.build();
}

/// A link that turns about z, and a frame 0.5 m along its x.
ModelBuilder arm() {
  ModelBuilder builder("arm");
  const LinkId link = builder.add_link("link", {.mass = 2, .inertia = kInertia});
  builder.add_joint({.name = "hinge", .type = JointType::kRevolute, .parent = builder.world(), .child = link});
  builder.add_frame("flange", link, {Mat3<double>::identity(), {0.5, 0, 0}});
  return builder;
}

TEST(Compose, AHandOnAFlangeMovesWithIt) {
  ModelBuilder builder = arm();
  const auto [link, X_LF] = builder.frame("flange");
  append(builder, hand(), {.X_WM = X_LF, .prefix = "hand/", .onto = link});
  const Model model = builder.build();
  const Link& palm = model.link(model.link_id("hand/palm"));
  EXPECT_EQ(palm.body, model.link(model.link_id("link")).body);
  EXPECT_LT(norm(palm.X_BL.p - Vec3<double>{0.5, 0, 0.1}), 1e-15);
  EXPECT_EQ(model.joint(palm.joint).name, "hand/palm_mount");
  EXPECT_EQ(model.bodies()[palm.body.index()].inertia.m, 3);  // of link and palm
  EXPECT_EQ(model.nv(), 2);
  const Link& finger = model.link(model.link_id("hand/finger"));
  EXPECT_EQ(model.bodies()[finger.body.index()].parent, palm.body);
}

TEST(Compose, WhatStoodOnTheWorldStandsOnTheLink) {
  ModelBuilder builder = arm();
  const auto [link, X_LF] = builder.frame("flange");
  const PartMap map = append(builder, hand(), {.X_WM = X_LF, .prefix = "hand/", .onto = link});
  const Geom& plate = builder.geoms()[static_cast<std::size_t>(map.geoms[1])];
  EXPECT_EQ(plate.link, link);
  EXPECT_EQ(plate.X_LG.p.x, 0.5);
}

TEST(Compose, ThereMustBeALinkToStandOn) {
  ModelBuilder builder = arm();
  EXPECT_THROW(append(builder, hand(), {.onto = LinkId(7)}), ModelError);
}

/// Worlds make models anew of the old one's parts, when some go: what is carried must be carried then, too.
TEST(Compose, ACopyKeepsWhatIsCarriedOfALinksWeight) {
  ModelBuilder builder("balloon");
  const LinkId link = builder.add_link("balloon", {.mass = 1, .inertia = kInertia});
  builder.link(link).gravity_compensation = 1;
  builder.add_joint({.name = "free", .type = JointType::kFloating, .parent = builder.world(), .child = link});
  const Model model = builder.build();
  EXPECT_EQ(builder_of(model).build().link(LinkId(1)).gravity_compensation, 1);
  EXPECT_EQ(fingerprint(builder_of(model).build()), fingerprint(model));
}

TEST(Compose, AJointStartsWhereItIsTold) {
  ModelBuilder builder = arm();
  builder.set_initial(JointId(0), {0.3});
  EXPECT_EQ(builder.build().initial_configuration(), std::vector<double>{0.3});
  EXPECT_THROW(builder.set_initial(JointId(0), {0.3, 0.1}), ModelError);
}

}  // namespace
}  // namespace manyhands
