// One small model for each rule of the SDF loader: what it reads, defaults, repairs and ignores.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "manyhands/model/io/sdf/sdf.h"
#include "tests/model/urdf_testing.h"  // ScratchFolder, contains

namespace manyhands::testing {
namespace {

std::string sdf(const std::string& body, const std::string& version = "1.7") {
  return "<sdf version='" + version + "'>\n" + body + "\n</sdf>";
}

std::string in_model(const std::string& body, const std::string& version = "1.7") {
  return sdf("<model name='m'>" + body + "</model>", version);
}

std::string part(const std::string& name, const std::string& body = "") {
  return "<link name='" + name +
         "'><inertial><mass>2</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia>"
         "</inertial>" +
         body + "</link>\n";
}

std::string hinge(const std::string& name, const std::string& parent, const std::string& child,
                  const std::string& body = "<axis><xyz>0 0 1</xyz></axis>", const std::string& type = "revolute") {
  return "<joint name='" + name + "' type='" + type + "'><parent>" + parent + "</parent><child>" + child + "</child>" +
         body + "</joint>\n";
}

std::vector<LoadedModel> load_all(const std::string& text, const SdfOptions& options = {}) {
  return load_sdf_string(text, "m.sdf", ".", options);
}

LoadedModel load_one(const std::string& text, const SdfOptions& options = {}) {
  std::vector<LoadedModel> loaded = load_all(text, options);
  EXPECT_EQ(loaded.size(), 1u);
  return std::move(loaded.at(0));
}

std::string error_of_sdf(const std::string& text) {
  try {
    (void)load_all(text);
  } catch (const SdfError& error) {
    return error.what();
  }
  return "";
}

void expect_near(const Vec3<double>& a, const Vec3<double>& b) {
  EXPECT_LT(norm(a - b), 1e-12) << a.x << " " << a.y << " " << a.z;
}

TEST(SdfRules, RootsFloatUnlessTheModelIsStatic) {
  const LoadedModel free = load_one(in_model("<pose>1 2 3 0 0 0</pose>" + part("a", "<pose>0 0 1 0 0 0</pose>")));
  EXPECT_EQ(free.model.joints()[0].name, "a_free");
  EXPECT_EQ(free.model.initial_configuration(), (std::vector<double>{1, 2, 4, 0, 0, 0, 1}));
  EXPECT_TRUE(free.report.empty()) << free.report.to_string();
  const LoadedModel fixed = load_one(in_model("<static>1</static><pose>1 2 3 0 0 0</pose>" + part("a")));
  EXPECT_EQ(fixed.model.nv(), 0);
  expect_near(fixed.model.link(fixed.model.link_id("a")).X_BL.p, {1, 2, 3});
  const LoadedModel massless = load_one(in_model("<link name='a'><inertial><mass>0</mass></inertial></link>"));
  EXPECT_EQ(massless.model.nv(), 0);
  EXPECT_PRED2(contains, massless.report.to_string(), "repaired: link 'a': a root link without mass cannot float");
}

TEST(SdfRules, LinkPosesAreInTheModelAndAxesInTheJoint) {
  // b stands above a, turned by a quarter about x: its z axis points along the model's -y.
  const std::string turned = part("b", "<pose>0 0 1 1.5707963267948966 0 0</pose>");
  const LoadedModel loaded = load_one(in_model(part("a") + turned + hinge("j", "a", "b")));
  const Joint& joint = loaded.model.joint(loaded.model.joint_id("j"));
  expect_near(joint.X_PF.p, {0, 0, 1});
  expect_near(joint.axis, {0, 0, 1});
  expect_near(joint.X_PF.R * joint.axis, {0, -1, 0});
  for (const char* const axis : {"<axis><xyz expressed_in='__model__'>0 0 1</xyz></axis>",
                                 "<axis><xyz>0 0 1</xyz><use_parent_model_frame>1</use_parent_model_frame></axis>"}) {
    const LoadedModel other = load_one(in_model(part("a") + turned + hinge("j", "a", "b", axis)));
    const Joint& in_model_frame = other.model.joint(other.model.joint_id("j"));
    expect_near(in_model_frame.X_PF.R * in_model_frame.axis, {0, 0, 1});
  }
  // Up to SDF 1.4 an axis was in the model's frame.
  const LoadedModel old = load_one(in_model(part("a") + turned + hinge("j", "a", "b"), "1.4"));
  const Joint& old_joint = old.model.joint(old.model.joint_id("j"));
  expect_near(old_joint.X_PF.R * old_joint.axis, {0, 0, 1});
}

TEST(SdfRules, ReadsAnAxisWhole) {
  const std::string axis =
      "<axis><xyz>0 2 0</xyz><limit><lower>-1.5</lower><upper>2</upper><effort>87</effort><velocity>0.1</velocity>"
      "</limit><dynamics><damping>.5</damping><friction>0.25</friction><spring_reference>0.1</spring_reference>"
      "<spring_stiffness>3</spring_stiffness></dynamics></axis>";
  const LoadedModel loaded = load_one(in_model(part("a") + part("b") + hinge("j", "a", "b", axis)));
  const Joint& joint = loaded.model.joint(loaded.model.joint_id("j"));
  EXPECT_EQ(joint.limits.lower, -1.5);
  EXPECT_EQ(joint.limits.upper, 2);
  EXPECT_EQ(joint.limits.effort, 87);
  EXPECT_EQ(joint.limits.velocity, 0.1);
  EXPECT_EQ(joint.damping, 0.5);
  EXPECT_EQ(joint.friction, 0.25);
  EXPECT_EQ(joint.stiffness, 3);
  EXPECT_EQ(joint.spring_reference, std::vector<double>{0.1});
  EXPECT_EQ(joint.axis.y, 1);
  EXPECT_TRUE(loaded.report.empty()) << loaded.report.to_string();
}

TEST(SdfRules, HugeLimitsAreNone) {
  const std::string axis =
      "<axis><xyz>0 0 1</xyz><limit><lower>-1e16</lower><upper>inf</upper><effort>-1</effort></limit></axis>";
  const LoadedModel loaded = load_one(in_model(part("a") + part("b") + hinge("j", "a", "b", axis)));
  const JointLimits& limits = loaded.model.joint(loaded.model.joint_id("j")).limits;
  EXPECT_EQ(limits.lower, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(limits.upper, std::numeric_limits<double>::infinity());
  EXPECT_EQ(limits.effort, std::numeric_limits<double>::infinity());
}

TEST(SdfRules, KnowsJointTypes) {
  const std::pair<const char*, int> types[] = {{"fixed", 0},     {"revolute", 1}, {"continuous", 1},
                                               {"prismatic", 1}, {"ball", 3},     {"universal", 2},
                                               {"revolute2", 2}, {"screw", 0},    {"gearbox", 0}};
  const std::string axes = "<axis><xyz>1 0 0</xyz></axis><axis2><xyz>0 1 0</xyz></axis2>";
  for (const auto& [type, nv] : types) {
    const LoadedModel loaded = load_one(in_model(part("a") + part("b") + hinge("j", "a", "b", axes, type)));
    EXPECT_EQ(loaded.model.nv(), 6 + nv) << type;
  }
}

TEST(SdfRules, AJointBesideItsLinksOriginTurnsThere) {
  const std::string body = "<pose>0 0 -0.5 0 0 0</pose><axis><xyz>0 1 0</xyz></axis>";
  const std::string text =
      in_model("<static>0</static>" + part("a") + part("b", "<pose>0 0 2 0 0 0</pose>") + hinge("j", "a", "b", body));
  const LoadedModel loaded = load_one(text);
  const Joint& joint = loaded.model.joint(loaded.model.joint_id("j"));
  expect_near(joint.X_PF.p, {0, 0, 1.5});
  const Link& b = loaded.model.link(loaded.model.link_id("b"));
  expect_near(loaded.model.joint(b.joint).X_PF.p, {0, 0, 0.5});
  EXPECT_EQ(loaded.model.joint(b.joint).type, JointType::kFixed);
  // Bullet does not look at the joint's pose.
  const LoadedModel bullet = load_one(text, {.bullet = true});
  expect_near(bullet.model.joint(bullet.model.joint_id("j")).X_PF.p, {0, 0, 2});
}

TEST(SdfRules, PosesAreRelativeToAnyFrame) {
  const std::string text =
      in_model(part("a", "<pose>1 0 0 0 0 0</pose>") + part("b", "<pose relative_to='f'>0 1 0 0 0 0</pose>") +
               "<frame name='f' attached_to='a'><pose>0 0 1 0 0 1.5707963267948966</pose></frame>" +
               hinge("j", "a", "b", "<axis><xyz expressed_in='a'>1 0 0</xyz></axis>"));
  const LoadedModel loaded = load_one(text);
  const Joint& joint = loaded.model.joint(loaded.model.joint_id("j"));
  expect_near(joint.X_PF.p, {-1, 0, 1});
  expect_near(joint.X_PF.R * joint.axis, {1, 0, 0});
  EXPECT_PRED2(contains,
               error_of_sdf(in_model(part("a", "<pose relative_to='b'/>") + part("b", "<pose relative_to='a'/>"))),
               "relative to itself");
  EXPECT_PRED2(contains, error_of_sdf(in_model(part("a", "<pose relative_to='x'/>"))), "'x' is no link");
}

TEST(SdfRules, PosesHaveDegreesAndQuaternions) {
  const LoadedModel loaded = load_one(
      in_model("<static>1</static>" + part("a", "<pose degrees='true'>0 0 0 0 0 90</pose>") +
               part("b", "<pose rotation_format='quat_xyzw'>1 2 3  0 0 0.7071067811865476 0.7071067811865476</pose>")));
  for (const char* const name : {"a", "b"}) {
    expect_near(loaded.model.link(loaded.model.link_id(name)).X_BL.R.x, {0, 1, 0});
  }
}

TEST(SdfRules, ModelsInModelsAndPlacementFrames) {
  const std::string inner = "<model name='arm' placement_frame='grip'><pose>0 0 5 0 0 0</pose>" +
                            part("grip", "<pose>0 0 1 0 0 0</pose>") + "</model>";
  const LoadedModel loaded =
      load_one(in_model("<static>true</static>" + part("a") + inner + hinge("j", "a", "arm::grip", "", "fixed")));
  expect_near(loaded.model.link(loaded.model.link_id("arm::grip")).X_BL.p, {0, 0, 5});
}

TEST(SdfRules, LoopsCloseWithConstraints) {
  const LoadedModel loaded = load_one(in_model(part("a") + part("b") + part("c") + hinge("ab", "a", "b") +
                                               hinge("ac", "a", "c") + hinge("bc", "b", "c", "", "ball")));
  ASSERT_EQ(loaded.model.equalities().size(), 1u);
  EXPECT_EQ(loaded.model.equalities()[0].type, EqualityType::kPoint);
  EXPECT_EQ(loaded.model.nv(), 8);
}

TEST(SdfRules, AWorldHasSeveralModels) {
  const std::string text = sdf(
      "<world name='w'><gravity>0 0 -1.6</gravity><physics type='ode'><max_step_size>0.004</max_step_size></physics>"
      "<light name='sun'/><model name='m'>" +
      part("a") + "</model><model name='m'>" + part("a") + "</model></world>");
  std::vector<LoadedModel> loaded = load_all(text);
  ASSERT_EQ(loaded.size(), 2u);
  EXPECT_EQ(loaded[1].model.name(), "m_");
  EXPECT_EQ(loaded[1].model.gravity().z, -1.6);
  EXPECT_EQ(loaded[1].model.time_step(), 0.004);
  EXPECT_PRED2(contains, loaded[0].report.to_string(), "m.sdf:2: ignored: world: <light> in <world> is not used");
  EXPECT_PRED2(contains, loaded[1].report.to_string(), "there is another model 'm'");
  const LoadedModel all = joined(std::move(loaded));
  EXPECT_EQ(all.model.nv(), 12);
  EXPECT_TRUE(all.model.link_id("m_/a").is_valid());
  EXPECT_EQ(all.model.gravity().z, -1.6);
}

TEST(SdfRules, IncludesModelsByNameAndPlace) {
  const ScratchFolder folder;
  folder.write("box/model.config",
               "<model><name>box</name><sdf version='1.4'>old.sdf</sdf><sdf version='1.9'>new.sdf</sdf></model>");
  folder.write("box/new.sdf", in_model(part("a")));
  folder.write("ball/model.sdf", in_model(part("a")));
  const auto world =
      folder.write("w.sdf", sdf("<world name='w'><include><uri>model://box</uri><pose>0 0 7 0 0 0</pose></include>"
                                "<include><uri>model://ball</uri><name>other</name><static>1</static></include>"
                                "<include><uri>model://none</uri></include></world>"));
  const std::vector<LoadedModel> loaded = load_sdf(world);
  ASSERT_EQ(loaded.size(), 2u);
  EXPECT_EQ(loaded[0].model.initial_configuration()[2], 7);
  EXPECT_EQ(loaded[1].model.name(), "other");
  EXPECT_EQ(loaded[1].model.nv(), 0);
  EXPECT_PRED2(contains, loaded[0].report.to_string(), "the model is left out");
}

TEST(SdfRules, AModelThatIncludesItselfIsRefused) {
  const ScratchFolder folder;
  const auto file = folder.write("me/model.sdf", in_model(part("a") + "<include><uri>model://me</uri></include>"));
  EXPECT_THROW((void)load_sdf(file), SdfError);
}

TEST(SdfRules, FilesOutsideThePackageAreRefused) {
  const ScratchFolder folder;
  folder.write("out.sdf", in_model(part("a")));
  const auto world = folder.write("in/w.sdf", sdf("<world name='w'><include><uri>../out.sdf</uri></include></world>"));
  EXPECT_THROW((void)load_sdf(world), SdfError);
  EXPECT_EQ(load_sdf(world, {.allow_outside_package = true}).size(), 1u);
}

TEST(SdfRules, ReadsShapesAndSurfaces) {
  const std::string surface =
      "<surface><friction><ode><mu>0.3</mu></ode><torsional><coefficient>2</coefficient><patch_radius>0.1</"
      "patch_radius>"
      "</torsional></friction><bounce><restitution_coefficient>0.5</restitution_coefficient></bounce></surface>";
  const std::string shapes[] = {"<box><size>1 2 3</size></box>", "<sphere><radius>1</radius></sphere>",
                                "<cylinder><radius>1</radius><length>2</length></cylinder>",
                                "<capsule><radius>1</radius><length>2</length></capsule>",
                                "<ellipsoid><radii>1 2 3</radii></ellipsoid>"};
  std::string body;
  for (const std::string& shape : shapes) {
    body += "<collision name='c'><geometry>" + shape + "</geometry>" + surface + "</collision>";
  }
  const LoadedModel loaded =
      load_one(in_model(part("a", body + "<visual name='v'><geometry><box><size>1 1 1</size></box></geometry>"
                                         "<material><diffuse>1 0 0 1</diffuse></material>"
                                         "<transparency>0.5</transparency></visual>")));
  ASSERT_EQ(loaded.model.geoms().size(), 6u);
  EXPECT_EQ(loaded.model.geoms()[0].rgba, (std::array<float, 4>{1, 0, 0, 0.5f}));
  const Geom& box = loaded.model.geoms()[1];
  EXPECT_EQ(box.shape.size.z, 1.5);
  EXPECT_EQ(box.surface.lateral_friction, 0.3);
  EXPECT_EQ(box.surface.restitution, 0.5);
  EXPECT_NEAR(box.surface.spinning_friction, 3 * std::numbers::pi / 16 * 0.1 * 2, 1e-15);
  EXPECT_EQ(loaded.model.geoms()[5].shape.type, ShapeType::kConvex);
  EXPECT_EQ(loaded.model.contact_rules().friction, CombineRule::kMinimum);
}

TEST(SdfRules, BulletsContactBlockCountsForTheLink) {
  const std::string body =
      "<contact><lateral_friction>0.9</lateral_friction><stiffness>100</stiffness></contact>"
      "<collision name='c'><geometry><sphere><radius>1</radius></sphere></geometry></collision>";
  const LoadedModel loaded =
      load_one(in_model(part("a", body) + part("b", body.substr(body.find("<collision")))), {.bullet = true});
  EXPECT_EQ(loaded.model.geoms()[0].surface.lateral_friction, 0.9);
  EXPECT_EQ(loaded.model.geoms()[0].surface.stiffness, 100);
  EXPECT_EQ(loaded.model.geoms()[1].surface.lateral_friction, 0.5);
  EXPECT_EQ(loaded.model.contact_rules().friction, CombineRule::kProduct);
}

TEST(SdfRules, BitMasksSayWhoTouches) {
  const auto body = [](const std::string& mask) {
    return "<collision name='c'><geometry><sphere><radius>1</radius></sphere></geometry><surface><contact>" + mask +
           "</contact></surface></collision>";
  };
  const LoadedModel loaded =
      load_one(in_model(part("a", body("<collide_bitmask>0x06</collide_bitmask>")) + part("b", body(""))));
  EXPECT_EQ(loaded.model.geoms()[0].filter.group, 6u);
  EXPECT_EQ(loaded.model.geoms()[0].filter.mask, 6u);
  EXPECT_EQ(loaded.model.geoms()[1].filter.group, 0xffffu);
}

TEST(SdfRules, DefaultsAndNamesOfTheFormat) {
  const LoadedModel loaded = load_one(in_model("<link name='world'><gravity>0</gravity></link>"));
  const Link& link = loaded.model.link(loaded.model.link_id("world_"));
  EXPECT_EQ(link.inertial.mass, 1);
  EXPECT_EQ(link.inertial.inertia.xx, 1);
  EXPECT_EQ(link.gravity_compensation, 1);
}

TEST(SdfRules, MimicsFollowTheirReference) {
  const std::string mimic =
      "<axis><xyz>0 0 1</xyz><mimic joint='j'><multiplier>2</multiplier><offset>1</offset>"
      "<reference>0.25</reference></mimic></axis>";
  const LoadedModel loaded =
      load_one(in_model(part("a") + part("b") + part("c") + hinge("j", "a", "b") + hinge("k", "a", "c", mimic)));
  const Joint& joint = loaded.model.joint(loaded.model.joint_id("k"));
  ASSERT_TRUE(joint.mimic);
  EXPECT_EQ(joint.mimic->multiplier, 2);
  EXPECT_EQ(joint.mimic->offset, 0.5);
}

TEST(SdfRules, RefusesWhatIsNoModel) {
  const std::pair<std::string, const char*> cases[] = {
      {"<robot/>", "m.sdf:1: robot: the root element is <robot>"},
      {sdf(""), "there is no model in it"},
      {in_model(""), "it has no <link>"},
      {sdf("<model>" + part("a") + "</model>"), "has no name"},
      {in_model(part("a") + part("a")), "the name is taken by line 2"},
      {in_model(part("a") + part("b") + hinge("j", "a", "x")), "'x' is no link"},
      {in_model(part("a") + part("b") + hinge("j", "a", "b", "", "rope")), "there is no joint type 'rope'"},
      {in_model(part("a") + part("b") + hinge("j", "a", "b") + hinge("k", "b", "a")), "the joints form a cycle"},
      {in_model(part("a", "<pose>1 2 x 0 0 0</pose>")), "expected 6 numbers"},
      {in_model(part("a", "<gravity>maybe</gravity>")), "expected true or false"},
      {in_model(part("a", "<collision name='c'/>")), "no <geometry>"},
  };
  for (const auto& [text, message] : cases) EXPECT_PRED2(contains, error_of_sdf(text), message);
}

}  // namespace
}  // namespace manyhands::testing
