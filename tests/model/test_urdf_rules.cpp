// One small robot for each rule of the URDF loader: what it reads, defaults, repairs and ignores.
#include <algorithm>
#include <limits>

#include "tests/model/urdf_testing.h"

namespace manyhands::testing {
namespace {

TEST(UrdfRules, ReadsLinksAndJointsDepthFirst) {
  // Written in another order than that of the tree; the joints' order decides among siblings.
  const std::string text =
      robot(link("c") + link("b") + link("a") + link("root") + joint("rb", "fixed", "root", "b") +
            joint("ra", "fixed", "root", "a") + joint("bc", "continuous", "b", "c", "<axis xyz=\"0 0 1\"/>"));
  const LoadedModel loaded = load(text);
  std::vector<std::string> names;
  for (const Link& link : loaded.model.links()) names.push_back(link.name);
  EXPECT_EQ(names, (std::vector<std::string>{"world", "root", "b", "c", "a"}));
  EXPECT_EQ(loaded.model.name(), "r");
  EXPECT_EQ(loaded.model.nq(), 1);
  EXPECT_TRUE(loaded.report.empty()) << loaded.report.to_string();
}

TEST(UrdfRules, ReadsAJointWhole) {
  const std::string body =
      "<origin xyz=\"1 2 3\" rpy=\"0 0 1.5707963267948966\"/><axis xyz=\"0 1 0\"/>"
      "<limit lower=\"-1.5\" upper=\"2.\" effort=\"+87\" velocity=\"1e-1\"/><dynamics damping=\".5\" "
      "friction=\"0.25\"/>";
  const LoadedModel loaded = load(two_links("revolute", body));
  const Joint& joint = loaded.model.joints()[0];
  EXPECT_EQ(joint.type, JointType::kRevolute);
  EXPECT_EQ(joint.limits.lower, -1.5);
  EXPECT_EQ(joint.limits.upper, 2);
  EXPECT_EQ(joint.limits.effort, 87);
  EXPECT_EQ(joint.limits.velocity, 0.1);
  EXPECT_EQ(joint.damping, 0.5);
  EXPECT_EQ(joint.friction, 0.25);
  EXPECT_EQ(joint.axis.y, 1);
  EXPECT_EQ(joint.X_PF.p.z, 3);
  EXPECT_NEAR(joint.X_PF.R.x.y, 1, 1e-15);  // a quarter turn about z takes x to y
  EXPECT_TRUE(loaded.report.empty()) << loaded.report.to_string();
}

TEST(UrdfRules, KnowsAllJointTypes) {
  const std::pair<const char*, int> types[] = {{"fixed", 0},     {"revolute", 1}, {"continuous", 1}, {"prismatic", 1},
                                               {"spherical", 3}, {"planar", 3},   {"floating", 6}};
  for (const auto& [type, nv] : types) EXPECT_EQ(load(two_links(type, kHinge)).model.nv(), nv) << type;
}

TEST(UrdfRules, FloatsOnRequest) {
  const std::string text = robot(link("a") + link("b") + joint("root_joint", "continuous", "a", "b", kHinge));
  EXPECT_EQ(load(text).model.nv(), 1);
  const LoadedModel loaded = load(text, {.fixed_base = false});
  EXPECT_EQ(loaded.model.nv(), 7);
  EXPECT_EQ(loaded.model.joints()[0].name, "root_joint_");
  EXPECT_EQ(loaded.model.joints()[0].iq, 0);
}

TEST(UrdfRules, RootNamedWorldIsTheWorld) {
  const std::string text = robot(link("world", "") + link("a") + joint("j", "continuous", "world", "a", kHinge));
  const LoadedModel loaded = load(text, {.fixed_base = false});
  EXPECT_EQ(loaded.model.links().size(), 2u);
  EXPECT_EQ(loaded.model.nv(), 1);
  EXPECT_PRED2(contains, loaded.report.to_string(), "r.urdf:2: ignored: link 'world': the root link is the world");
}

TEST(UrdfRules, RotatesInertiaIntoTheLinkFrame) {
  const std::string body =
      "<inertial><origin xyz=\"0 0 1\" rpy=\"0 0 1.5707963267948966\"/><mass value=\"2\"/>"
      "<inertia ixx=\"1\" iyy=\"2\" izz=\"2.5\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>";
  const Inertial inertial = load(robot(link("a", body))).model.links()[1].inertial;
  EXPECT_EQ(inertial.mass, 2);
  EXPECT_EQ(inertial.com.z, 1);
  EXPECT_NEAR(inertial.inertia.xx, 2, 1e-15);
  EXPECT_NEAR(inertial.inertia.yy, 1, 1e-15);
}

TEST(UrdfRules, MimicKeepsItsNumbers) {
  const std::string text = robot(
      link("a") + link("b") + link("c") + joint("j", "revolute", "a", "b", kHinge) +
      joint("k", "prismatic", "a", "c", std::string(kHinge) + "<mimic joint=\"j\" multiplier=\"-2\" offset=\"0.5\"/>"));
  const Joint joint = load(text).model.joints()[1];
  ASSERT_TRUE(joint.mimic.has_value());
  EXPECT_EQ(joint.mimic->joint, "j");
  EXPECT_EQ(joint.mimic->multiplier, -2);
  EXPECT_EQ(joint.mimic->offset, 0.5);
}

TEST(UrdfRules, AMimicOfAJointThatIsGoneIsDropped) {
  const std::string text =
      robot(link("a") + link("b") + joint("j", "revolute", "a", "b", std::string(kHinge) + "<mimic joint=\"z\"/>"));
  const auto [model, report] = load(text);
  EXPECT_FALSE(model.joints()[0].mimic.has_value());
  EXPECT_TRUE(model.equalities().empty());
  ASSERT_EQ(report.notes.size(), 1u);
  EXPECT_TRUE(report.notes[0].serious);
  EXPECT_PRED2(contains, report.to_string(), "joint 'j': it mimics 'z', which is no joint of the robot");
}

TEST(UrdfRules, ReadsEveryShape) {
  const std::string geoms =
      "<collision><geometry><box size=\"2 4 6\"/></geometry></collision>"
      "<collision><geometry><sphere radius=\"2\"/></geometry></collision>"
      "<collision><geometry><cylinder radius=\"1\" length=\"3\"/></geometry></collision>"
      "<collision><geometry><capsule radius=\"1\" length=\"3\"/></geometry></collision>"
      "<collision name=\"floor\"><origin xyz=\"0 0 1\"/><geometry><plane normal=\"2 0 0\"/></geometry></collision>"
      "<visual><geometry><sphere radius=\"3\"/></geometry></visual>";
  const LoadedModel loaded = load(robot(link("a", std::string(kInertial) + geoms)));
  const auto found = loaded.model.geoms();
  ASSERT_EQ(found.size(), 6u);
  EXPECT_EQ(found[0].role, GeomRole::kVisual);
  EXPECT_EQ(found[1].shape.type, ShapeType::kBox);
  EXPECT_EQ(found[1].shape.size.y, 2);  // half extents
  EXPECT_EQ(found[3].shape.type, ShapeType::kCylinder);
  EXPECT_EQ(found[3].shape.size.y, 1.5);  // half length
  EXPECT_EQ(found[4].shape.type, ShapeType::kCapsule);
  EXPECT_EQ(found[5].name, "floor");
  EXPECT_NEAR(found[5].X_LG.R.z.x, 1, 1e-15);  // its z is the normal
  EXPECT_EQ(found[5].X_LG.p.z, 1);
  EXPECT_TRUE(loaded.report.empty()) << loaded.report.to_string();
}

TEST(UrdfRules, ColoursComeFromTheVisualThenTheRobotThenOtherVisuals) {
  const auto visual = [](const std::string& material) {
    return "<visual><geometry><sphere radius=\"1\"/></geometry>" + material + "</visual>";
  };
  const std::string text = robot(
      "<material name=\"red\"><color rgba=\"1 0 0 1\"/></material>\n" +
      link("a", std::string(kInertial) + visual("<material name=\"red\"/>") +
                    visual("<material name=\"red\"><color rgba=\"0 0 1 1\"/></material>") +
                    visual("<material name=\"green\"/>") + visual("<material name=\"none\"/>") +
                    visual("<material name=\"green\"><color rgba=\"0 1 0 1\"/></material><material name=\"red\"/>")));
  const LoadedModel loaded = load(text);
  const auto geoms = loaded.model.geoms();
  EXPECT_EQ(geoms[0].rgba[0], 1);
  EXPECT_EQ(geoms[1].rgba[2], 1);
  EXPECT_EQ(geoms[2].rgba[1], 1);
  EXPECT_EQ(geoms[3].rgba, Geom().rgba);
  EXPECT_PRED2(contains, loaded.report.to_string(), "defaulted: link 'a': no colour for the material 'none'");
  EXPECT_PRED2(contains, loaded.report.to_string(), "a further <material>; only the first counts");
}

TEST(UrdfRules, ContactIsPyBullets) {
  const std::string body = std::string(kInertial) +
                           "<contact><lateral_friction value=\"0.9\"/><rolling_friction value=\"0.01\"/>"
                           "<spinning_friction value=\"0.02\"/><restitution value=\"0.3\"/><stiffness value=\"3e4\"/>"
                           "<damping value=\"1000\"/><inertia_scaling value=\"3\"/><contact_cfm value=\"0\"/></contact>"
                           "<collision><geometry><sphere radius=\"1\"/></geometry></collision>";
  const LoadedModel loaded =
      load(robot(link("a", body) + link("b", "<collision><geometry><sphere radius=\"1\"/></geometry></collision>") +
                 joint("j", "fixed", "a", "b")));
  const SurfaceMaterial& s = loaded.model.geoms()[0].surface;
  EXPECT_EQ(s.lateral_friction, 0.9);
  EXPECT_EQ(s.rolling_friction, 0.01);
  EXPECT_EQ(s.spinning_friction, 0.02);
  EXPECT_EQ(s.restitution, 0.3);
  EXPECT_EQ(s.stiffness, 3e4);
  EXPECT_EQ(s.damping, 1000);
  EXPECT_EQ(loaded.model.geoms()[1].surface.lateral_friction, 0.5);
  EXPECT_PRED2(contains, loaded.report.to_string(), "ignored: link 'a': <inertia_scaling> in <contact> is not used");
  EXPECT_PRED2(contains, loaded.report.to_string(), "<contact_cfm> in <contact> is not used");
}

struct Note {
  const char* name;
  std::string text;
  std::string expected;  // a part of the report
};

class UrdfNotes : public ::testing::TestWithParam<Note> {};

TEST_P(UrdfNotes, AreInTheReport) {
  EXPECT_PRED2(contains, load(GetParam().text).report.to_string(), GetParam().expected);
}

std::string inertial(const std::string& mass, const std::string& inertia) {
  return "<inertial><mass value=\"" + mass + "\"/><inertia " + inertia + "/></inertial>";
}

std::string geom(const std::string& shape) {
  return robot(link("a", std::string(kInertial) + "\n<collision><geometry>" + shape + "</geometry></collision>"));
}

const std::string kLimit = "<limit lower=\"-1\" upper=\"2\" effort=\"3\" velocity=\"4\"/>";
const std::string kAxis = "<axis xyz=\"0 0 1\"/>";

INSTANTIATE_TEST_SUITE_P(
    All, UrdfNotes,
    ::testing::Values(
        Note{"NoRobotName", "<robot>" + link("a") + "</robot>", "r.urdf:1: defaulted: robot: <robot> has no name"},
        Note{"NoInertial", robot(link("a", "")), "r.urdf:2: defaulted: link 'a': no <inertial>; mass 0 taken"},
        Note{"NoInertia", robot(link("a", "<inertial><mass value=\"1\"/></inertial>")),
             "<inertial> has no <inertia>; 0"},
        Note{"NoProducts", robot(link("a", inertial("1", "ixx=\"1\" iyy=\"1\" izz=\"1\""))),
             "ixy, ixz and iyz; 0 taken"},
        Note{"NegativeMass", robot(link("a", inertial("-1", "ixx=\"1\" iyy=\"1\" izz=\"1\""))),
             "repaired: link 'a': mass -1 kg is negative; 0 taken"},
        Note{"Triangle", robot(link("a", inertial("1", "ixx=\"1\" iyy=\"1\" izz=\"5\""))),
             "principal moments of inertia 1 1 5 kg m^2; the nearest possible, 2 2 4, taken"},
        Note{"Indefinite",
             robot(link("a", inertial("1", "ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"3\" ixz=\"0\" iyz=\"0\""))),
             "repaired: link 'a': no rigid body has the principal moments of inertia -2 1 4"},
        Note{"MasslessMoving", robot(link("a") + link("b", "") + joint("j", "revolute", "a", "b", kHinge)),
             "r.urdf:3: repaired: link 'b': joint 'j' would move no inertia; a mass of 0.001 kg"},
        Note{"NoAxis", two_links("revolute", kLimit), "r.urdf:4: defaulted: joint 'j': no <axis>; 1 0 0 taken"},
        Note{"NoAxisXyz", two_links("revolute", kLimit + "<axis/>"), "defaulted: joint 'j': <axis> has no xyz"},
        Note{"ZeroAxis", two_links("revolute", kLimit + "\n<axis xyz=\"0 0 0\"/>"),
             "r.urdf:5: repaired: joint 'j': the axis is 0; 1 0 0 taken"},
        Note{"LongAxis", two_links("revolute", kLimit + "<axis xyz=\"0 3 4\"/>"),
             "the axis has length 5; brought to 1"},
        Note{"SecondAxis", two_links("revolute", kHinge + kAxis), "a further <axis>; only the first counts"},
        Note{"NoLimit", two_links("prismatic", kAxis), "defaulted: joint 'j': no <limit>; unlimited"},
        Note{"NoRange", two_links("revolute", kAxis + "<limit effort=\"1\" velocity=\"1\"/>"),
             "neither lower nor upper"},
        Note{"NoUpper", two_links("revolute", kAxis + "<limit lower=\"-1\" effort=\"1\" velocity=\"1\"/>"),
             "no upper; 0"},
        Note{"NoEffort", two_links("revolute", kAxis + "<limit lower=\"-1\" upper=\"1\" velocity=\"1\"/>"),
             "no effort"},
        Note{"CrossedLimits",
             two_links("revolute", kAxis + "<limit lower=\"1\" upper=\"-1\" effort=\"1\" velocity=\"1\"/>"),
             "lower 1 is above upper -1; no range taken"},
        Note{"NegativeEffort",
             two_links("revolute", kAxis + "<limit lower=\"0\" upper=\"1\" effort=\"-1\" velocity=\"1\"/>"),
             "the effort limit -1 is negative; unlimited"},
        Note{"NegativeDamping", two_links("revolute", kHinge + std::string("<dynamics damping=\"-1\"/>")),
             "damping -1 is neg"},
        Note{"RangeOfContinuous", two_links("continuous", kHinge), "ignored: joint 'j': attribute 'lower' of <limit>"},
        Note{"MimicOfFixed", two_links("fixed", "<mimic joint=\"j\"/>"),
             "ignored: joint 'j': a fixed joint cannot mimic"},
        Note{"Safety", two_links("revolute", kHinge + std::string("<safety_controller k_velocity=\"1\"/>")),
             "ignored: joint 'j': <safety_controller> in <joint> is not used"},
        Note{"Calibration", two_links("revolute", kHinge + std::string("<calibration rising=\"0\"/>")),
             "<calibration> in <joint>"},
        Note{"Transmission", robot(link("a") + "<transmission name=\"t\"/>"),
             "r.urdf:3: ignored: robot: <transmission> 't'"},
        Note{"Gazebo", robot(link("a") + "<gazebo reference=\"a\"><mu1>${x}</mu1></gazebo>"),
             "ignored: robot: <gazebo>"},
        Note{"UnknownElement", robot(link("a") + "<sensor/>"),
             "r.urdf:3: ignored: robot: <sensor> in <robot> is not used"},
        Note{"UnknownAttribute", robot("<link name=\"a\" mood=\"good\">" + std::string(kInertial) + "</link>"),
             "r.urdf:2: ignored: link 'a': attribute 'mood' of <link> is not used"},
        Note{"StrayText", robot(link("a") + "oops"), "ignored: robot: text 'oops'... in <robot>"},
        Note{"UnknownShape", geom("<cone/>"),
             "r.urdf:3: ignored: link 'a': the shape <cone> is not known; the geom is"},
        Note{"NoSize", geom("<sphere radius=\"0\"/>"), "the <sphere> has no size; the geom is left out"},
        Note{"TwoShapes", geom("<sphere radius=\"1\"/><box/>"), "<box> in <geometry>; only the first shape counts"},
        Note{"NoMesh", geom("<mesh filename=\"none.stl\"/>"),
             "r.urdf:3: ignored: link 'a': mesh 'none.stl': there is no"},
        Note{"NoPackage", geom("<mesh filename=\"package://surely_none/a.stl\"/>"), "no package 'surely_none' in"},
        Note{"Http", geom("<mesh filename=\"http://a/b.stl\"/>"),
             "only package://, model:// and file:// names are read"},
        Note{"OneScale", geom("<mesh filename=\"none.stl\" scale=\"2\"/>"), "holds one number; 2 taken for all axes"},
        Note{"NegativeFriction",
             robot(link("a", std::string(kInertial) + "<contact><lateral_friction value=\"-1\"/></contact>")),
             "<lateral_friction> -1 is negative; 0 taken"},
        Note{"RestitutionAboveOne",
             robot(link("a", std::string(kInertial) + "<contact><restitution value=\"2\"/></contact>")),
             "<restitution> 2 would make energy; 1 taken"},
        Note{"TrailingComma", two_links("revolute", kLimit + "<axis xyz=\"0, 0, 1\"/>"),
             "holds '0, 0, 1'; 0 0 1 taken"},
        Note{"TooManyNumbers", two_links("revolute", kLimit + "<axis xyz=\"0 0 1 0\"/>"),
             "holds '0 0 1 0'; 0 0 1 taken"},
        Note{"Optenv", two_links("fixed", "<origin xyz=\"$(optenv X 0 0 1)\"/>"), "its default taken"}),
    [](const auto& of) { return of.param.name; });

TEST(UrdfRules, RepairsAreInTheModel) {
  const LoadedModel loaded =
      load(robot(link("a") + link("b", "") + joint("j", "revolute", "a", "b", "<axis xyz=\"0 0 0\"/>")));
  EXPECT_EQ(loaded.model.joints()[0].axis.x, 1);
  EXPECT_EQ(loaded.model.links()[2].inertial.mass, 1e-3);
  EXPECT_EQ(loaded.model.joints()[0].limits.lower, -std::numeric_limits<double>::infinity());
}

TEST(UrdfRules, OnlyTheOutermostMasslessLinkGetsInertia) {
  const LoadedModel loaded =
      load(robot(link("a") + link("b", "") + link("c", "") + joint("j", "revolute", "a", "b", kHinge) +
                 joint("k", "revolute", "b", "c", kHinge)));
  EXPECT_EQ(loaded.model.links()[2].inertial.mass, 0);
  EXPECT_EQ(loaded.model.links()[3].inertial.mass, 1e-3);
}

TEST(UrdfRules, MasslessRootStaysFixed) {
  const LoadedModel loaded = load(robot(link("a", "")), {.fixed_base = false});
  EXPECT_EQ(loaded.model.nv(), 0);
  EXPECT_PRED2(contains, loaded.report.to_string(), "the root link has no mass and cannot float");
}

TEST(UrdfRules, RootThatIsANeedleFloatsWithAMendedInertia) {
  UrdfOptions options;
  options.fixed_base = false;
  const LoadedModel loaded = load_urdf_string(
      R"(<robot name="r"><link name="base"><inertial><mass value="0.1"/>
         <inertia ixx="1" iyy="1" izz="0" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>)",
      "r.urdf", ".", options);
  EXPECT_EQ(loaded.model.nv(), 6);
  EXPECT_GT(loaded.model.link(loaded.model.link_id("base")).inertial.inertia.zz, 0);
  EXPECT_PRED2(contains, loaded.report.to_string(), "would move no inertia");
}

TEST(UrdfRules, ReportFollowsTheFile) {
  const LoadReport report =
      load(robot(link("a", "") + "<sensor/>\n" + link("b", "") + joint("j", "revolute", "a", "b") + "<camera/>"))
          .report;
  ASSERT_GE(report.notes.size(), 5u);
  EXPECT_TRUE(std::ranges::is_sorted(report.notes, {}, &LoadNote::line));
}

TEST(UrdfRules, BulletsRulesAreAskedFor) {
  const std::string text = robot(link("world", "") + link("a", "<contact><inertia_scaling value=\"3\"/></contact>") +
                                 link("b") + joint("j", "floating", "world", "a") +
                                 joint("k", "revolute", "a", "b", std::string(kHinge) + "<mimic joint=\"k\"/>"));
  const LoadedModel loaded = load(text, {.fixed_base = false, .bullet = true});
  EXPECT_EQ(loaded.model.links()[1].name, "world_");  // without mass: it stands
  EXPECT_EQ(loaded.model.links()[2].inertial.mass, 1);
  EXPECT_EQ(loaded.model.links()[2].inertial.inertia.xx, 3);
  EXPECT_EQ(loaded.model.joints()[0].type, JointType::kFixed);
  EXPECT_FALSE(loaded.model.joints()[1].mimic);
  EXPECT_EQ(loaded.model.nv(), 1);
}

TEST(UrdfRules, BulletsCollisionMeshesAreHullsOfObjects) {
  const ScratchFolder folder;
  folder.write("two.obj",
               "o a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\ng b\nv 5 0 0\nf 2 3 5\nf 1 2 5\n");
  const auto mesh = [](const std::string& attributes) {
    return "<collision " + attributes + "><geometry><mesh filename=\"package://x/two.obj\"/></geometry></collision>";
  };
  const auto file = folder.write(
      "urdf/r.urdf",
      robot(link("a", std::string(kInertial) + mesh("group=\"2\" mask=\"-1\"") + mesh("concave=\"yes\""))));
  folder.write("x/two.obj", "f");  // as a package it is found, and broken
  EXPECT_EQ(load_urdf(file, {.package_paths = {folder.path()}, .bullet = true}).model.geoms().size(), 0u);
  std::filesystem::rename(folder.path() / "two.obj", folder.path() / "x/two.obj");
  const LoadedModel loaded = load_urdf(file, {.allow_outside_package = true, .bullet = true});
  ASSERT_EQ(loaded.model.geoms().size(), 3u) << loaded.report.to_string();
  EXPECT_EQ(loaded.model.geoms()[0].shape.type, ShapeType::kConvex);
  EXPECT_EQ(loaded.model.geoms()[0].filter.group, 2u);
  EXPECT_EQ(loaded.model.geoms()[0].filter.mask, 0xffffffffu);
  EXPECT_EQ(loaded.model.meshes()[0].vertices.size(), 4u);
  EXPECT_EQ(loaded.model.meshes()[1].triangles.size(), 2u);
  EXPECT_TRUE(loaded.model.meshes()[1].source.ends_with("two.obj#b"));
  EXPECT_EQ(loaded.model.geoms()[2].shape.type, ShapeType::kMesh);
}

TEST(UrdfRules, ScaleMultipliesLengthsOnly) {
  const std::string limits =
      "<origin xyz=\"1 0 0\"/><axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"2\" effort=\"3\" velocity=\"4\"/>";
  const std::string box = "<collision><origin xyz=\"0 0 1\"/><geometry><box size=\"1 1 1\"/></geometry></collision>";
  const std::string text =
      robot(link("a") + link("b", std::string(kInertial) + box) + joint("j", "prismatic", "a", "b", limits));
  const Model model = load(text, {.scale = 2}).model;
  EXPECT_EQ(model.joints()[0].X_PF.p.x, 2);
  EXPECT_EQ(model.joints()[0].limits.upper, 4);
  EXPECT_EQ(model.geoms()[0].X_LG.p.z, 2);
  EXPECT_EQ(model.geoms()[0].shape.size.x, 1);
  EXPECT_EQ(model.links()[2].inertial.mass, 1);
  EXPECT_PRED2(contains, error_of(text, {.scale = 0}), "scale is not above 0");
}

}  // namespace
}  // namespace manyhands::testing
