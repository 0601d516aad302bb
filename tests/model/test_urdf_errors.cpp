// What is not a robot: one error that names file and line and says what was expected.
#include "tests/model/urdf_testing.h"

namespace manyhands::testing {
namespace {

struct Malformed {
  const char* name;
  std::string text;
  std::string expected;  // how the message begins or what it holds
};

class UrdfErrors : public ::testing::TestWithParam<Malformed> {};

TEST_P(UrdfErrors, SayWhatIsWrongAndWhere) { EXPECT_PRED2(contains, error_of(GetParam().text), GetParam().expected); }

std::string with_origin(const std::string& xyz) { return two_links("fixed", "\n<origin xyz=\"" + xyz + "\"/>"); }

std::string deep(int depth) {
  std::string text;
  for (int i = 0; i < depth; ++i) text += "<a>";
  for (int i = 0; i < depth; ++i) text += "</a>";
  return robot(link("a") + text);
}

std::string mimics(const std::string& of_j, const std::string& of_k) {
  return robot(link("a") + link("b") + link("c") + joint("j", "revolute", "a", "b", kHinge + of_j) +
               joint("k", "revolute", "b", "c", kHinge + of_k));
}

INSTANTIATE_TEST_SUITE_P(
    All, UrdfErrors,
    ::testing::Values(
        Malformed{"Empty", "", "r.urdf:1: not well-formed XML"},
        Malformed{"NotXml", "hello", "r.urdf:1: not well-formed"},
        Malformed{"Unclosed", "<robot name=\"r\">\n<link name=\"a\">\n</robot>", "r.urdf:3: not well-formed XML"},
        Malformed{"OtherRoot", "<sdf/>", "r.urdf:1: robot: the root element is <sdf>; expected <robot"},
        Malformed{"TwoRobots", robot(link("a")) + "\n<robot/>", "r.urdf:5: a second root element <robot>"},
        Malformed{"Doctype", "<!DOCTYPE robot [<!ENTITY a \"b\">]>" + robot(link("a")), "declares entities"},
        Malformed{"TwiceAttribute", robot("<link name=\"a\" name=\"b\"/>"),
                  "r.urdf:2: <link> has the attribute 'name' twice"},
        Malformed{"TooDeep", deep(1000), "deep; expected at most 128"},
        Malformed{"NoLinks", robot(""), "r.urdf:1: robot: <robot> has no <link>"},
        Malformed{"XacroElement", robot(link("a") + "<xacro:include filename=\"b\"/>"),
                  "r.urdf:3: robot: found <xacro:include>; this is a xacro file: run xacro first"},
        Malformed{"XacroValue", with_origin("${x} 0 0"), "found '${x} 0 0'; this is a xacro file"},
        Malformed{"XacroFind", robot(link("a", "<visual name=\"$(find b)\"/>")),
                  "found '$(find b)'; this is a xacro file"},
        Malformed{"LinkWithoutName", robot("<link/>"), "r.urdf:2: robot: attribute 'name' of <link> is missing"},
        Malformed{"LinkWithEmptyName", robot("<link name=\"\"/>"), "attribute 'name' of <link> is empty"},
        Malformed{"JointWithoutType", robot(link("a") + "<joint name=\"j\"/>"), "joint 'j': <joint> has no <parent>"},
        Malformed{"UnknownType", two_links("hinge", ""),
                  "joint 'j': there is no joint type 'hinge'; expected one of fixed, rev"},
        Malformed{"NoChild", robot(link("a") + "<joint name=\"j\" type=\"fixed\"><parent link=\"a\"/></joint>"),
                  "<joint> has no <child>; expected <child link="},
        Malformed{"DuplicateLink", robot(link("a") + link("a")), "r.urdf:3: link 'a': the name is taken by line 2"},
        Malformed{
            "DuplicateJoint",
            robot(link("a") + link("b") + link("c") + joint("j", "fixed", "a", "b") + joint("j", "fixed", "a", "c")),
            "r.urdf:6: joint 'j': the name is taken by line 5"},
        Malformed{"UnknownParent", robot(link("a") + joint("j", "fixed", "z", "a")),
                  "r.urdf:3: joint 'j': its parent 'z' is no link"},
        Malformed{"UnknownChild", robot(link("a") + joint("j", "fixed", "a", "z")), "its child 'z' is no link"},
        Malformed{"OwnParent", robot(link("a") + link("b") + joint("j", "fixed", "b", "b")),
                  "parent and child are both 'b'"},
        Malformed{"TwoParents",
                  robot(link("a") + link("b") + joint("j", "fixed", "a", "b") + joint("k", "fixed", "a", "b")),
                  "r.urdf:5: joint 'k': its child 'b' is the child of joint 'j' (line 4) already"},
        Malformed{"TwoRoots", robot(link("a") + link("b")),
                  "r.urdf:3: link 'b': a second root: neither this link nor 'a' (line 2)"},
        Malformed{"NoRoot",
                  robot(link("a") + link("b") + joint("j", "fixed", "a", "b") + joint("k", "fixed", "b", "a")),
                  "the joints form a cycle"},
        Malformed{
            "CycleBeside",
            robot(link("r") + link("a") + link("b") + joint("j", "fixed", "a", "b") + joint("k", "fixed", "b", "a")),
            "r.urdf:3: link 'a': it is its own ancestor"},
        Malformed{"WorldInside", robot(link("a") + link("world") + joint("j", "fixed", "a", "world")),
                  "only the root link may be called 'world'"},
        Malformed{
            "CommaVector", with_origin("1,0 0"),
            "r.urdf:5: joint 'j': attribute 'xyz' of <origin> holds '1,0 0'; expected 3 finite numbers between blanks"},
        Malformed{"CommaInNumber", with_origin("1,0 0 0"), "holds '1,0 0 0'; expected 3 finite"},
        Malformed{"TwoNumbers", with_origin("1 0"), "holds '1 0'; expected 3"},
        Malformed{"EmptyVector", with_origin(""), "attribute 'xyz' of <origin> is empty"},
        Malformed{"Words", with_origin("1 0 up"), "holds '1 0 up'"},
        Malformed{"NaN", with_origin("nan 0 0"), "holds 'nan 0 0'; expected 3 finite numbers"},
        Malformed{"Infinite", with_origin("inf 0 0"), "holds 'inf 0 0'"},
        Malformed{"Overflow", with_origin("1e999 0 0"), "holds '1e999 0 0'"},
        Malformed{"Astronomic", with_origin("1e30 0 0"), "expected at most 1e12"},
        Malformed{"NoMass", robot(link("a", "\n<inertial/>")), "r.urdf:3: link 'a': <inertial> has no <mass>"},
        Malformed{"NoMassValue", robot(link("a", "<inertial><mass/></inertial>")),
                  "attribute 'value' of <mass> is missing"},
        Malformed{"NoIxx", robot(link("a", "<inertial><mass value=\"1\"/><inertia/></inertial>")),
                  "attribute 'ixx' of <inertia> is missing"},
        Malformed{"NoGeometry", robot(link("a", "<visual/>")), "<visual> has no <geometry>"},
        Malformed{"EmptyGeometry", robot(link("a", "<visual><geometry/></visual>")),
                  "<geometry> is empty; expected a shape"},
        Malformed{"NoRadius", robot(link("a", "<visual><geometry><sphere/></geometry></visual>")),
                  "attribute 'radius' of <sphere> is missing"},
        Malformed{"NoNormal", robot(link("a", "<visual><geometry><plane normal=\"0 0 0\"/></geometry></visual>")),
                  "the normal of <plane> is 0"},
        Malformed{"ShortColour", robot(link("a") + "<material name=\"m\"><color rgba=\"1 1 1\"/></material>"),
                  "material 'm': attribute 'rgba' of <color> holds '1 1 1'; expected 4"},
        Malformed{"MimicsItself", mimics("<mimic joint=\"j\"/>", ""),
                  "joint 'j': it mimics, directly or through others, itself"},
        Malformed{"MimicCircle", mimics("<mimic joint=\"k\"/>", "<mimic joint=\"j\"/>"),
                  "directly or through others, itself"}),
    [](const auto& of) { return of.param.name; });

TEST(UrdfErrors, KnowFileAndLine) {
  try {
    const LoadedModel loaded = load(with_origin("x 0 0"));
    FAIL();
  } catch (const UrdfError& error) {
    EXPECT_EQ(error.file(), "r.urdf");
    EXPECT_EQ(error.line(), 5);
  }
}

TEST(UrdfErrors, MissingFileIsItsOwnError) {
  const ScratchFolder folder;
  EXPECT_THROW((void)load_urdf(folder.path() / "none.urdf"), FileNotFound);
  EXPECT_THROW((void)load_urdf(folder.path()), UrdfError);  // a folder
}

}  // namespace
}  // namespace manyhands::testing
