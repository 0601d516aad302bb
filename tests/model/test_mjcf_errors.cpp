// What is not a scene: one error that names file and line and says what was expected.
#include "tests/model/mjcf_testing.h"

namespace manyhands::testing {
namespace {

struct Malformed {
  const char* name;
  std::string text;
  std::string expected;  // how the message begins or what it holds
};

class MjcfErrors : public ::testing::TestWithParam<Malformed> {};

TEST_P(MjcfErrors, SayWhatIsWrongAndWhere) {
  EXPECT_PRED2(contains, scene_error(GetParam().text), GetParam().expected);
}

std::string geom(const std::string& attributes) { return one_body("<geom " + attributes + "/>"); }
std::string hinge(const std::string& attributes) { return one_body("<joint name=\"j\" " + attributes + "/>"); }
std::string actuator(const std::string& element) {
  return one_body("<joint name=\"j\"/>", "<actuator>\n" + element + "</actuator>");
}
std::string asset(const std::string& element, const std::string& used) {
  return mujoco("<asset>" + element + "</asset><worldbody>\n<geom " + used + "/></worldbody>");
}
std::string equality(const std::string& element) {
  return one_body("<joint name=\"j\"/>", "<equality>\n" + element + "</equality>");
}
std::string with_compiler(const std::string& attributes) { return mujoco("<compiler " + attributes + "/>"); }

INSTANTIATE_TEST_SUITE_P(
    All, MjcfErrors,
    ::testing::Values(
        Malformed{"Empty", "", "s.xml:1: not well-formed XML"},
        Malformed{"OtherRoot", "<robot/>", "s.xml:1: mujoco: the root element is <robot>; expected <mujoco>"},
        Malformed{"Unclosed", "<mujoco>\n<worldbody>\n</mujoco>", "s.xml:3: not well-formed XML"},
        Malformed{"GlobalCoordinates", with_compiler("coordinate=\"global\""),
                  "s.xml:2: compiler: coordinate=\"global\" is not read"},
        Malformed{"UnknownAngle", with_compiler("angle=\"turns\""), "holds 'turns'; expected one of degree, radian"},
        Malformed{"BadSequence", with_compiler("eulerseq=\"xyw\""), "expected three of x, y, z, X, Y and Z"},
        Malformed{"NoTimeStep", mujoco("<option timestep=\"0\"/>"), "s.xml:2: option: the time step must be above 0"},
        Malformed{"UnknownClass", geom("class=\"c\" size=\"1\""),
                  "s.xml:3: geom 'geom_0': there is no default class 'c'"},
        Malformed{"ClassWithoutName", mujoco("<default><default/></default>"), "attribute 'class' of <default>"},
        Malformed{"ClassInItself", mujoco("<default><default class=\"main\"/></default>"), "lies in itself"},
        Malformed{"TwiceABody", mujoco("<worldbody><body name=\"a\"/>\n<body name=\"a\"/></worldbody>"),
                  "s.xml:3: worldbody: the name 'a' is taken by another body"},
        Malformed{"WorldAsBody", mujoco("<worldbody><body name=\"world\"/></worldbody>"), "'world' is taken"},
        Malformed{"TwiceAJoint", one_body("<joint name=\"j\"/>\n<joint name=\"j\"/>"),
                  "s.xml:4: body 'b': the name 'j'"},
        Malformed{"JointOfTheWorld", mujoco("<worldbody><joint/></worldbody>"), "the world cannot have joints"},
        Malformed{"UnknownJointType", hinge("type=\"screw\""),
                  "s.xml:3: joint 'j': attribute 'type' of <joint> holds 'screw'; expected one of hinge"},
        Malformed{"NoAxis", hinge("axis=\"0 0 0\""), "joint 'j': its axis is 0"},
        Malformed{"RangeTurnedRound", hinge("range=\"1 -1\""), "its range is 1 to -1; expected the lower limit first"},
        Malformed{"LimitedWithoutRange", hinge("limited=\"true\""), "its range is 0 to 0"},
        Malformed{"FreeInside", one_body("<body><freejoint/><geom size=\"1\"/></body>"),
                  "a free joint belongs to a body in <worldbody>"},
        Malformed{"FreeBesideHinge", one_body("<freejoint/><joint/>"), "must be the only joint of its body"},
        Malformed{"NoReplicas", one_body("<replicate count=\"0\"/>"), "s.xml:3: replicate in body 'b': count is 0"},
        Malformed{"TooManyReplicas", one_body("<replicate count=\"1000\"><replicate count=\"1000\"/></replicate>"),
                  "more than 100000 replicas in all"},
        Malformed{"TwoRotations", geom("size=\"1\" quat=\"1 0 0 0\" euler=\"0 0 0\""),
                  "both 'quat' and 'euler' say how it is turned"},
        Malformed{"NoQuaternion", geom("size=\"1\" quat=\"0 0 0 0\""), "a quaternion of length 0"},
        Malformed{"ShortVector", geom("size=\"1\" pos=\"1 2\""), "holds '1 2'; expected 3 finite numbers"},
        Malformed{"NotANumber", geom("size=\"nan\""), "holds 'nan'; expected 1 to 3 finite numbers"},
        Malformed{"Astronomic", geom("size=\"1e30\""), "expected at most 1e12"},
        Malformed{"NoSize", geom("type=\"box\""), "attribute 'size' of <geom> is missing; expected 3 numbers"},
        Malformed{"NegativeSize", geom("type=\"box\" size=\"1 -1 1\""), "size -1 is not above 0"},
        Malformed{"NoLength", geom("type=\"capsule\" size=\"1\" fromto=\"1 1 1 1 1 1\""),
                  "the ends of 'fromto' are one point"},
        Malformed{"FromToOfASphere", geom("size=\"1\" fromto=\"1 1 1 2 2 2\""), "'fromto' places capsules"},
        Malformed{"UnknownShape", geom("type=\"cone\" size=\"1\""), "holds 'cone'; expected one of plane"},
        Malformed{"MovingPlane", one_body("<freejoint/><geom type=\"plane\" size=\"1 1 1\"/>"),
                  "a plane lies on a body that moves"},
        Malformed{"UnknownMesh", geom("type=\"mesh\" mesh=\"m\""), "there is no mesh 'm'"},
        Malformed{"UnknownMaterial", geom("size=\"1\" material=\"m\""), "there is no material 'm'"},
        Malformed{"BadCondim", geom("size=\"1\" condim=\"2\""), "condim is 2; expected 1, 3, 4 or 6"},
        Malformed{"NegativeFriction", geom("size=\"1\" friction=\"-1\""), "a coefficient of friction is negative"},
        Malformed{"NegativeDensity", geom("size=\"1\" density=\"-1\""), "holds '-1'; expected 0 or more"},
        Malformed{"HalfAType", geom("size=\"1\" contype=\"0.5\""), "holds '0.5'; expected a whole number"},
        Malformed{"NoMass", mujoco("<worldbody><body>\n<inertial pos=\"0 0 0\"/></body></worldbody>"),
                  "s.xml:3: body 'body_1': <inertial> has no 'mass'"},
        Malformed{"TwoInertias",
                  mujoco("<worldbody><body><inertial mass=\"1\" diaginertia=\"1 1 1\" fullinertia=\"1 1 1 0 0 0\"/>"
                         "</body></worldbody>"),
                  "both 'diaginertia' and 'fullinertia'"},
        Malformed{"Massless", mujoco("<worldbody>\n<body name=\"a\"><joint name=\"j\"/></body></worldbody>"),
                  "s.xml:3: body 'a': joint 'j' moves no inertia: give the body a geom"},
        Malformed{
            "BadFace",
            asset("<mesh name=\"m\" vertex=\"0 0 0 1 0 0 0 1 0 0 0 1\" face=\"0 1 9\"/>", "type=\"mesh\" mesh=\"m\""),
            "mesh 'm': 'face' names a vertex 9, which does not exist"},
        Malformed{
            "FlatScale",
            asset("<mesh name=\"m\" vertex=\"0 0 0 1 0 0 0 1 0 0 0 1\" scale=\"1 1 0\"/>", "type=\"mesh\" mesh=\"m\""),
            "a scale of 0"},
        Malformed{"HugeHeightField",
                  asset("<hfield name=\"h\" nrow=\"99999\" ncol=\"99999\" size=\"1 1 1 1\"/>",
                        "type=\"hfield\" hfield=\"h\""),
                  "a height field of 99999 x 99999 heights"},
        Malformed{"ShortElevation",
                  asset("<hfield name=\"h\" nrow=\"2\" ncol=\"2\" size=\"1 1 1 1\" elevation=\"1 2 3\"/>",
                        "type=\"hfield\" hfield=\"h\""),
                  "holds '1 2 3'; expected 4 finite numbers"},
        Malformed{"UnknownGeomInPair", mujoco("<contact>\n<pair geom1=\"a\" geom2=\"b\"/></contact>"),
                  "s.xml:3: pair '': there is no geom 'a'"},
        Malformed{"UnknownBodyInExclude", mujoco("<contact><exclude body1=\"a\" body2=\"b\"/></contact>"),
                  "there is no body 'a'; expected the name of a <body>"},
        Malformed{"UnknownJoint", actuator("<motor joint=\"k\"/>"),
                  "s.xml:4: actuator 'actuator_0': there is no joint 'k'"},
        Malformed{"NoGear", actuator("<motor joint=\"j\" gear=\"0\"/>"), "its gear is 0"},
        Malformed{"ControlTurnedRound", actuator("<motor joint=\"j\" ctrlrange=\"1 -1\"/>"),
                  "min_ctrl is above max_ctrl"},
        Malformed{"InheritsNoRange", actuator("<position joint=\"j\" inheritrange=\"1\"/>"),
                  "'inheritrange' needs a joint or tendon with a range"},
        Malformed{"NoAnchor", equality("<connect body1=\"b\"/>"), "attribute 'anchor' of <connect> is missing"},
        Malformed{"WeldedToItself", equality("<weld body1=\"b\" body2=\"b\"/>"), "joins a link to itself"},
        Malformed{"CoupledToItself", equality("<joint joint1=\"j\" joint2=\"j\"/>"), "couples a joint with itself"},
        Malformed{"UnknownSite", equality("<connect site1=\"s\" site2=\"s\"/>"), "there is no site 's'"},
        Malformed{"ShortKey", one_body("<joint/>", "<keyframe><key qpos=\"1 2\"/></keyframe>"),
                  "key 'key_0': attribute 'qpos' of <key> holds '1 2'"},
        Malformed{"IncludeOfNothing", mujoco("<include/>"), "s.xml:2: <include> of '': attribute 'file' is missing"},
        Malformed{"AttachOfNothing", mujoco("<worldbody><attach body=\"b\"/></worldbody>"),
                  "s.xml:2: <attach> of '': expected the name of a <model> in <asset>"},
        Malformed{"ModelWithoutFile", mujoco("<asset><model name=\"m\"/></asset>"),
                  "s.xml:2: <model> 'm': attribute 'file' is missing"},
        Malformed{"AttachOfNoFile",
                  mujoco("<asset><model file=\"none.xml\"/></asset><worldbody>\n<attach model=\"none\"/></worldbody>"),
                  "s.xml:3: <attach> of 'none.xml': there is no file"},
        Malformed{"TooManyKeys", mujoco("<size nkey=\"99999\"/>"), "nkey is 99999; expected at most 10000"},
        Malformed{"FittedAlongALine",
                  asset("<mesh name=\"m\" vertex=\"0 0 0 1 0 0 0 1 0 0 0 1\"/>",
                        "type=\"capsule\" mesh=\"m\" fromto=\"0 0 0 0 0 1\""),
                  "'fromto' places no shape that is fitted to a mesh"},
        Malformed{"IncludeOfNoFile", mujoco("<include file=\"none.xml\"/>"),
                  "<include> of 'none.xml': there is no file"}),
    [](const auto& of) { return of.param.name; });

TEST(MjcfErrors, KnowFileAndLine) {
  try {
    const LoadedModel loaded = load_scene(hinge("axis=\"x\""));
    FAIL();
  } catch (const MjcfError& error) {
    EXPECT_EQ(error.file(), "s.xml");
    EXPECT_EQ(error.line(), 3);
  }
}

TEST(MjcfErrors, MissingFileIsItsOwnError) {
  const ScratchFolder folder;
  EXPECT_THROW((void)load_mjcf(folder.path() / "none.xml"), FileNotFound);
  EXPECT_THROW((void)load_mjcf(folder.path()), MjcfError);  // a folder
}

TEST(MjcfErrors, FilesOutsideTheFolderAreRefused) {
  const ScratchFolder folder;
  folder.write("part.xml", "<mujoco/>");
  const auto scene = folder.write("inside/scene.xml", mujoco("<include file=\"../part.xml\"/>"));
  EXPECT_THROW((void)load_mjcf(scene), MjcfError);
  EXPECT_NO_THROW((void)load_mjcf(scene, {.allow_outside_package = true}));
}

std::string attaches(const std::string& file, const std::string& attributes) {
  return mujoco("<asset><model name=\"m\" file=\"" + file + "\"/></asset><worldbody>\n<attach model=\"m\" " +
                attributes + "/></worldbody>");
}

TEST(MjcfErrors, AttachedModelsSayWhatIsWrongInTheirOwnFile) {
  const ScratchFolder folder;
  const auto error = [&](const std::string& part, const std::string& attributes) -> std::string {
    folder.write("parts/part.xml", part);
    try {
      (void)load_mjcf(folder.write("scene.xml", attaches("parts/part.xml", attributes)));
    } catch (const MjcfError& what) {
      return what.what();
    }
    return "";
  };
  const std::string part = mujoco("<worldbody><body name=\"b\">\n<geom size=\"1\"/></body></worldbody>");
  EXPECT_EQ(error(part, "body=\"b\" prefix=\"x-\""), "");
  EXPECT_PRED2(contains, error(part, "body=\"c\""), "scene.xml:3: <attach>: there is no body 'c' in ");
  EXPECT_PRED2(contains, error(mujoco("<worldbody>\n<geom size=\"-1\"/></worldbody>"), "prefix=\"x-\""),
               "part.xml:3: geom");
  EXPECT_PRED2(contains, error(mujoco("<worldbody>"), ""), "part.xml:3: not well-formed XML");
  EXPECT_PRED2(contains, error(attaches("part.xml", ""), ""),
               "models are nested more than 16 deep; does it attach itself?");
  EXPECT_PRED2(contains,
               error(mujoco("<asset><mesh name=\"m\" file=\"../../out.stl\"/></asset><worldbody>"
                            "<geom type=\"mesh\" mesh=\"m\"/></worldbody>"),
                     ""),
               "lies outside");
}

TEST(MjcfErrors, ModelsThatAttachTwiceAsManyEachAreRefused) {
  const ScratchFolder folder;
  for (int i = 0; i < 12; ++i) {
    const std::string next = "m" + std::to_string(i + 1);
    folder.write("m" + std::to_string(i) + ".xml",
                 mujoco("<asset><model name=\"m\" file=\"" + next +
                        ".xml\"/></asset><worldbody>"
                        "<attach model=\"m\" prefix=\"a\"/><attach model=\"m\" prefix=\"b\"/></worldbody>"));
  }
  folder.write("m12.xml", "<mujoco/>");
  try {
    (void)load_mjcf(folder.path() / "m0.xml");
    FAIL();
  } catch (const MjcfError& error) {
    EXPECT_PRED2(contains, error.what(), "more is attached than 1000 models");
  }
}

TEST(MjcfErrors, AFileIsIncludedOnce) {
  const ScratchFolder folder;
  folder.write("part.xml", "<mujoco><include file=\"part.xml\"/></mujoco>");
  const auto scene = folder.write("scene.xml", mujoco("<include file=\"part.xml\"/>"));
  try {
    (void)load_mjcf(scene);
    FAIL();
  } catch (const MjcfError& error) {
    EXPECT_PRED2(contains, error.what(), "part.xml:1: <include> of 'part.xml': the file is included already");
  }
}

}  // namespace
}  // namespace manyhands::testing
