// What is saved as MJCF is read back as it was.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <random>

#include "manyhands/base/assets.h"
#include "manyhands/model/fingerprint.h"
#include "manyhands/model/io/save/save.h"
#include "manyhands/model/io/urdf/urdf.h"
#include "manyhands/model/unit.h"
#include "tests/model/mjcf_testing.h"
#include "tests/model/random_parts.h"

namespace manyhands {
namespace {

using testing::load_scene;
using testing::mujoco;
using testing::random_parts;

namespace fs = std::filesystem;

struct Tree {
  explicit Tree(const std::string& name) : folder(fs::temp_directory_path() / ("manyhands_" + name)) {
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  ~Tree() { fs::remove_all(folder); }
  Tree(const Tree&) = delete;
  Tree& operator=(const Tree&) = delete;

  fs::path folder;
};

Model read_again(const Model& model) { return load_scene(save_mjcf_string(model).text).model; }

std::string numbers_of(std::span<const Keyframe> keys) {
  std::string text;
  for (const Keyframe& key : keys) {
    text += key.name + " " + std::to_string(key.time);
    for (const auto* list : {&key.q, &key.v, &key.ctrl, &key.mocap}) {
      for (const double x : *list) text += " " + std::to_string(x);
    }
  }
  return text;
}

constexpr const char* kInertial =
    R"(<inertial pos="0.1 0.03 -0.2" mass="1.7" fullinertia="0.31 0.42 0.53 0.01 -0.02 0.03"/>)";

/// A scene with every part that is read, in poses without round numbers.
std::string every_part() {
  const std::string inertial = kInertial;
  return mujoco(R"(<compiler angle="radian"/><option timestep="0.0017" gravity="0.1 0.2 -9.7"/>
<asset>
  <mesh name="wedge" vertex="0 0 0 0.3 0 0 0 0.31 0 0 0 0.37 0.1 0.2 0.3"/>
  <hfield name="hills" nrow="2" ncol="3" size="1.3 0.7 0.21 0.1" elevation="0 0.1 0.3 0.25 0.17 0.05"/>
  <texture name="checks" type="2d" builtin="checker" rgb1="0.1 0.2 0.3" rgb2="0.4 0.5 0.6" width="8" height="8"/>
  <material name="floor" texture="checks" texrepeat="3 5" rgba="0.9 0.8 0.7 1"/>
</asset>
<worldbody>
  <geom name="ground" type="plane" size="0 0 1" material="floor" friction="0.7"/>
  <site name="mark" pos="0.1 0.2 0.3" quat="0.3 0.1 0.7 0.2"/>
  <body name="terrain" pos="3 0.1 0"><geom name="hills" type="hfield" hfield="hills"/></body>
  <body name="led" mocap="true" pos="1.1 0.3 2.7" quat="0.9 0.1 -0.3 0.2"><geom name="light" size="0.1"/></body>
  <body name="free" pos="0.1 0.2 1.3" quat="0.9 0.1 -0.3 0.2"><freejoint name="fly"/>)" +
                inertial + R"(<geom name="ball" size="0.13" condim="4" friction="0.9 0.01 0.001"/></body>
  <body name="base" pos="-0.3 0.1 0.7" euler="0.1 0.2 0.3"><geom name="foot" type="box" size="0.1 0.2 0.3"/>
    <body name="arm" pos="0.2 0 0.1" quat="0.8 0.2 0.1 -0.4" gravcomp="0.7">
      <joint name="shoulder" axis="0.6 0.7 -0.3" range="-1.1 2.3" damping="0.3" frictionloss="0.07" armature="0.01"
        stiffness="7.3" springref="0.21"/>)" +
                inertial + R"(<geom name="upper" type="capsule" size="0.05 0.2" euler="0.4 0.1 0.2" pos="0 0.1 0.07"/>
      <site name="tip" pos="0.11 0 0.3" euler="0.3 0.2 0.1"/>
      <body name="slider" pos="0.1 0.2 0.3" euler="1 0.3 0.2">
        <joint name="rail" type="slide" axis="0 0.3 1" ref="0.13" range="-0.2 0.3" actuatorfrcrange="-7 7"/>)" +
                inertial + R"(</body>
      <body name="wrist" pos="0.3 0.1 -0.2" euler="0.2 1 0.1">
        <joint name="pan" axis="0 0 1" pos="0.01 0.02 0.03"/><joint name="tilt" axis="0.1 1 0" pos="0.03 0.02 0.01"/>
        <joint name="push" type="slide" axis="1 0.2 0" ref="0.04" pos="0.1 0 0"/>)" +
                inertial +
                R"(<geom name="fist" type="mesh" mesh="wedge" contype="2" conaffinity="3" pos="0.1 0 0"/></body>
      <body name="bent" pos="0 0.1 0.4"><joint name="elbow" axis="0 1 0.3" pos="0.1 0.2 0.05" ref="0.3"/>)" +
                inertial + R"(<geom name="shell" type="cylinder" size="0.1 0.2" contype="0" conaffinity="0"/></body>
      <body name="socket" pos="0.1 0.1 0.1"><joint name="ball" type="ball" damping="0.2" stiffness="1.3"/>)" +
                inertial + R"(</body></body></body>
</worldbody>
<contact>
  <pair geom1="ball" geom2="fist" friction="0.3" condim="3"/><pair geom1="ground" geom2="shell"/>
  <exclude body1="free" body2="arm"/>
</contact>
<equality>
  <weld name="glue" body1="wrist" body2="free" relpose="0.1 0.2 0.3 0.9 0.1 0.2 0.3" anchor="0.3 0.1 0.2"/>
  <joint name="couple" joint1="rail" joint2="shoulder" polycoef="0.07 0.3"/>
</equality>
<actuator>
  <motor name="m" joint="shoulder" gear="3.3" forcerange="-1.7 1.7"/>
  <position name="p" joint="rail" kp="71.3" kv="3.1" gear="0.7" ctrlrange="-0.13 0.17"/>
  <velocity name="v" joint="tilt" kv="2.3" ctrlrange="-1e10 3"/>
</actuator>
<keyframe><key name="home" time="0.3" qpos="0.1 0.2 0.3 0.9 0.1 0.2 0.3 0.4 0.13 0.1 0.2 0.3 0.5 1 0.2 0.1 0.3"
  qvel="1 2 3 4 5 6 7 8 9 10 11 12 13 14 15" ctrl="0.1 0.2 0.3" mpos="0.1 0.7 0.9" mquat="0 0 1 0"/></keyframe>)");
}

TEST(SaveMjcf, EveryPartIsReadBackToTheBit) {
  const Model model = load_scene(every_part()).model;
  const SavedText saved = save_mjcf_string(model);
  EXPECT_TRUE(saved.report.empty()) << saved.report.to_string();
  const Model again = load_scene(saved.text).model;
  EXPECT_EQ(fingerprint(again), fingerprint(model)) << saved.text;
  EXPECT_EQ(numbers_of(again.keyframes()), numbers_of(model.keyframes()));
  EXPECT_EQ(again.time_step(), model.time_step());
  ASSERT_EQ(again.frames().size(), model.frames().size());
  for (std::size_t i = 0; i < model.frames().size(); ++i) {
    EXPECT_EQ(again.frames()[i].name, model.frames()[i].name);
    EXPECT_EQ(norm(again.frames()[i].X_BF.p - model.frames()[i].X_BF.p), 0) << model.frames()[i].name;
  }
  EXPECT_EQ(again.geoms()[0].texture->repeat, model.geoms()[0].texture->repeat);
  EXPECT_EQ(again.geoms()[0].rgba, model.geoms()[0].rgba);
  EXPECT_EQ(save_mjcf_string(again).text, saved.text);
}

TEST(SaveMjcf, RotationsOfFilesAreReadBackToTheBit) {
  std::mt19937 random(7);
  std::normal_distribution<double> x;
  std::string bodies;
  for (int i = 0; i < 300; ++i) {
    bodies += "<body pos=\"0 0 1\" quat=\"";
    for (int k = 0; k < 4; ++k) bodies += std::to_string(x(random)) + " ";
    bodies += "\"><joint axis=\"" + std::to_string(x(random)) + " " + std::to_string(x(random)) + " 1\"/>" + kInertial +
              "</body>";
  }
  const Model model = load_scene(mujoco("<worldbody>" + bodies + "</worldbody>")).model;
  EXPECT_EQ(fingerprint(read_again(model)), fingerprint(model));
}

TEST(SaveMjcf, AfterOneRoundEveryModelIsReadBackToTheBit) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937 random(seed);
    const Model model = random_parts(random, "part");
    const SavedText saved = save_mjcf_string(model, {.allow_loss = true});
    const Model once = load_scene(saved.text).model;
    ASSERT_EQ(once.nq(), model.nq()) << seed;
    const SavedText second = save_mjcf_string(once, {.allow_loss = true});
    ASSERT_EQ(fingerprint(load_scene(second.text).model), fingerprint(once)) << "seed " << seed << "\n"
                                                                             << saved.text << second.text;
  }
}

/// A scene with tendons of both kinds, whose references are not the lengths at the start.
Model with_tendons() {
  ModelBuilder builder("tendons");
  std::vector<JointId> joints;
  std::vector<LinkId> links{builder.world()};
  for (const char* const name : {"a", "b", "c"}) {
    const LinkId link = builder.add_link(name, {.mass = 1, .com = {}, .inertia = {1, 1, 1, 0, 0, 0}});
    joints.push_back(builder.add_joint({.name = name,
                                        .type = JointType::kRevolute,
                                        .parent = links.back(),
                                        .child = link,
                                        .X_PF = {Mat3<double>::identity(), {0.1, 0.2, 0.3}},
                                        .axis = {0, 1, 0},
                                        .initial = {0.3}}));
    links.push_back(link);
  }
  builder.add_frame("tip", links[3], {Mat3<double>::identity(), {0.5, 0, 0}});
  const TendonId sum = builder.add_tendon({.name = "sum",
                                           .joints = {{joints[0], 2}, {joints[2], -1}},
                                           .lower = -1,
                                           .damping = 0.1,
                                           .armature = 0.3,
                                           .stiffness = 5,
                                           .spring_lower = -1,
                                           .spring_upper = -1});
  const TendonId way = builder.add_tendon(
      {.name = "way",
       .branches = {{1, {{links[0], {0, 0, 2}}, {links[3], {0.5, 0, 0}}}}, {3, {{links[1], {}}, {links[3], {}}}}},
       .upper = 4,
       .friction = 0.2});
  builder.add_equality({.name = "couple",
                        .type = EqualityType::kTendon,
                        .tendon_a = sum,
                        .tendon_b = way,
                        .polynomial = {0.1, 2, -0.5, 0.25, 0.125},
                        .reference_a = 0.5});
  builder.add_equality({.name = "hold", .type = EqualityType::kTendon, .tendon_b = sum, .polynomial = {1, 0, 0, 0, 0}});
  builder.add_actuator({.name = "pull", .tendon = way, .gear = -2, .max_force = 3});
  builder.add_actuator({.name = "servo",
                        .type = ActuatorType::kPosition,
                        .tendon = sum,
                        .ctrl_scale = 0.3,
                        .ctrl_offset = 0.1,
                        .kp = 7,
                        .kd = 2});
  return builder.build();
}

TEST(SaveMjcf, TendonsAreReadBack) {
  const Model model = with_tendons();
  const Model once = read_again(model);
  ASSERT_EQ(once.tendons().size(), 2u);
  EXPECT_EQ(once.tendons()[0].joints[1].coefficient, -1);
  EXPECT_EQ(once.tendons()[0].spring_upper, -1);
  EXPECT_NEAR(once.tendons()[0].spring_lower, -1, 1e-15);
  EXPECT_EQ(once.tendons()[1].branches[1].divisor, 3);
  EXPECT_EQ(once.actuators()[1].ctrl_scale, 0.3);
  EXPECT_EQ(once.actuators()[1].ctrl_offset, 0.1);
  for (const double x : {-0.7, 0.0, 1.3}) {  // the same curves
    const auto curve = [x](const EqualityConstraint& e) {
      double p = 0;
      for (std::size_t i = 5; i-- > 0;) p = p * (x - e.reference_a) + e.polynomial[i];
      return p + e.reference_b;
    };
    EXPECT_NEAR(curve(once.equalities()[0]), curve(model.equalities()[0]), 1e-12);
  }
  const EqualityConstraint& hold = once.equalities()[1];
  EXPECT_NEAR(hold.reference_b + hold.polynomial[0], 1, 1e-12);
  EXPECT_EQ(fingerprint(read_again(once)), fingerprint(once));
}

TEST(SaveMjcf, ShippedRobots) {
  for (const char* const robot : {"panda/panda.urdf", "arm6/arm6.urdf"}) {
    const Tree tree("shipped");
    const Model model = load_urdf(asset_path(robot)).model;
    const LoadReport report = save_mjcf(model, tree.folder / "robot.xml");
    const Model once = load_mjcf(tree.folder / "robot.xml").model;
    EXPECT_EQ(once.nq(), model.nq());
    EXPECT_EQ(once.geoms().size(), model.geoms().size());
    const LoadReport second = save_mjcf(once, tree.folder / "again.xml");
    EXPECT_TRUE(second.empty()) << second.to_string();
    EXPECT_EQ(fingerprint(load_mjcf(tree.folder / "again.xml").model), fingerprint(once));
  }
}

TEST(SaveMjcf, NothingElseIsOverwritten) {
  const Tree tree("overwrite");
  const Model model = load_scene(every_part()).model;
  const fs::path taken = tree.folder / "scene_assets" / "wedge_0.obj";
  save_mjcf(model, tree.folder / "scene.xml");
  ASSERT_EQ(std::distance(fs::directory_iterator(tree.folder / "scene_assets"), fs::directory_iterator()), 1);
  const fs::path mesh = fs::directory_iterator(tree.folder / "scene_assets")->path();
  std::ofstream(mesh) << "somebody's";
  save_mjcf(model, tree.folder / "scene.xml");
  EXPECT_EQ(fs::file_size(mesh), 10u);
  EXPECT_EQ(fingerprint(load_mjcf(tree.folder / "scene.xml").model), fingerprint(model));
  save_mjcf(model, tree.folder / "scene.xml");  // the same bytes: the same files
  EXPECT_EQ(std::distance(fs::directory_iterator(tree.folder / "scene_assets"), fs::directory_iterator()), 2);
}

TEST(SaveMjcf, WhatCannotBeWrittenLeavesWhatWasThere) {
  const Tree tree("broken");
  ModelBuilder builder("bounces");
  builder.add_geom(
      {.name = "ball", .link = builder.world(), .shape = {.size = {1, 0, 0}}, .surface = {.restitution = 0.5}});
  const Model model = builder.build();
  std::ofstream(tree.folder / "scene.xml") << "before";
  EXPECT_THROW(save_mjcf(model, tree.folder / "scene.xml"), SaveError);
  EXPECT_EQ(fs::file_size(tree.folder / "scene.xml"), 6u);
  const LoadReport report = save_mjcf(model, tree.folder / "scene.xml", {.allow_loss = true});
  EXPECT_NE(report.to_string().find("restitution"), std::string::npos);
  EXPECT_THROW(save_mjcf(model, tree.folder / "none" / "scene.xml", {.allow_loss = true}), SaveError);
  EXPECT_THROW(save_mjcf(model, tree.folder, {.allow_loss = true}), SaveError);
}

Model with_body_of(const std::string& name) {
  ModelBuilder builder(name);
  const LinkId link = builder.add_link(name, {.mass = 1, .inertia = {1, 1, 1, 0, 0, 0}});
  builder.add_joint({.name = name, .type = JointType::kFloating, .parent = builder.world(), .child = link});
  for (int i = 0; i < 2; ++i) builder.add_geom({.name = name, .link = link, .shape = {.size = {1, 0, 0}}});
  return builder.build();
}

TEST(SaveMjcf, NamesOfAnyKind) {
  for (const std::string name : {"<&>\"'", "a b\tc\nd", "\xc3\xa4\xe2\x82\xac", "]]>", "&amp;", "--", "worldbody"}) {
    const Model again = read_again(with_body_of(name));
    EXPECT_EQ(again.links()[1].name, name);
    EXPECT_EQ(again.joints()[0].name, name);
    EXPECT_EQ(again.geoms()[0].name, name);
    EXPECT_EQ(again.geoms()[1].name, name + "_2");
    EXPECT_EQ(again.name(), name);
  }
  EXPECT_THROW((void)save_mjcf_string(with_body_of(std::string("a\0b", 3))), SaveError);
  EXPECT_THROW((void)save_mjcf_string(with_body_of("a\x01")), SaveError);
}

Model chain_of(int links) {
  ModelBuilder builder("chain");
  LinkId last = builder.world();
  for (int i = 0; i < links; ++i) {
    const LinkId link = builder.add_link("l" + std::to_string(i), {.mass = 1, .inertia = {1, 1, 1, 0, 0, 0}});
    builder.add_joint({.name = "j" + std::to_string(i), .type = JointType::kRevolute, .parent = last, .child = link});
    builder.add_geom({.link = link, .shape = {.size = {1, 0, 0}}});
    last = link;
  }
  return builder.build();
}

TEST(SaveMjcf, WhatIsWrittenIsNotTooDeepToBeRead) {
  EXPECT_EQ(read_again(chain_of(125)).nq(), 125);
  EXPECT_THROW((void)save_mjcf_string(chain_of(126)), SaveError);
}

TEST(SaveMjcf, NumbersThatAreNoneAreRefused) {
  ModelBuilder builder("nan");
  builder.set_gravity({0, 0, std::numeric_limits<double>::quiet_NaN()});
  EXPECT_THROW((void)save_mjcf_string(builder.build()), SaveError);
  builder.set_gravity({0, 0, -std::numeric_limits<double>::infinity()});
  EXPECT_THROW((void)save_mjcf_string(builder.build(), {.allow_loss = true}), SaveError);
}

}  // namespace
}  // namespace manyhands
