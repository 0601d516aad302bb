// How scenes are read where MuJoCo and this library differ: what is noted, translated or left out.
#include <algorithm>
#include <cstring>

#include "tests/model/mjcf_testing.h"

namespace manyhands::testing {
namespace {

/// The notes of one kind whose element and message hold these words.
int count_notes(const LoadReport& report, LoadAction action, const std::string& element, const std::string& message) {
  return static_cast<int>(std::ranges::count_if(report.notes, [&](const LoadNote& note) {
    return note.action == action && contains(note.element, element) && contains(note.message, message);
  }));
}

const Geom& geom_of(const Model& model, const std::string& name) {
  return *std::ranges::find(model.geoms(), name, &Geom::name);
}

bool may_meet(const Model& model, const std::string& a, const std::string& b) {
  const CollisionFilter fa = geom_of(model, a).filter, fb = geom_of(model, b).filter;
  return (fa.group & fb.mask) != 0 && (fb.group & fa.mask) != 0;
}

bool excludes(const Model& model, const std::string& a, const std::string& b) {
  const LinkId la = model.link_id(a), lb = model.link_id(b);
  return std::ranges::any_of(model.exclusions(), [&](const ContactExclusion& e) {
    return (e.a == la && e.b == lb) || (e.a == lb && e.b == la);
  });
}

std::string body(const std::string& name, const std::string& contents) {
  return "<body name=\"" + name + "\">" + contents + "</body>";
}

std::string free_ball(const std::string& name, const std::string& attributes) {
  return body("body " + name, "<freejoint/><geom name=\"" + name + "\" size=\"0.1\" " + attributes + "/>");
}

std::string world(const std::string& contents) { return "<worldbody>" + contents + "</worldbody>"; }

TEST(MjcfRules, WhatIsNotUsedIsCountedWithItsFirstLine) {
  const auto [model, report] =
      load_scene(one_body("<light/><camera/>\n<camera/><geom size=\"1\" solref=\"0.01 1\"/><geom size=\"1\" "
                          "solref=\"0.01 1\" fancy=\"2\"/>",
                          "<custom><text/></custom><deformable/>"));
  EXPECT_EQ(count_notes(report, LoadAction::kIgnored, "body 'b'", "<camera> in <body> is not used (and in 1 further"),
            1);
  EXPECT_EQ(count_notes(report, LoadAction::kIgnored, "body 'b'", "<light> in <body> is not used"), 1);
  EXPECT_EQ(count_notes(report, LoadAction::kIgnored, "geom 'geom_0'", "'solref' of <geom> is not used (and in 1"), 1);
  EXPECT_EQ(count_notes(report, LoadAction::kIgnored, "geom 'geom_1'", "'fancy' of <geom> is not used"), 1);
  EXPECT_EQ(count_notes(report, LoadAction::kIgnored, "mujoco", "the section <custom>, with 1 elements"), 1);
  EXPECT_EQ(count_notes(report, LoadAction::kIgnored, "mujoco", "the section <deformable>, with 0 elements"), 1);
  const auto camera = std::ranges::find_if(
      report.notes, [](const LoadNote& note) { return contains(note.message, "<camera> in <body>"); });
  EXPECT_EQ(camera->line, 3);
  EXPECT_EQ(camera->file, "s.xml");
}

TEST(MjcfRules, APlainSceneHasNothingToReport) {
  const auto [model, report] = load_scene(mujoco(
      "<option timestep=\"0.01\"/>" + world("<geom type=\"plane\" size=\"1 1 1\"/>" + free_ball("a", "condim=\"3\""))));
  EXPECT_TRUE(report.empty()) << report.to_string();
  EXPECT_EQ(model.time_step(), 0.01);
}

TEST(MjcfRules, IncludedFilesNameThemselves) {
  const ScratchFolder folder;
  folder.write("parts/body.xml",
               "<mujoco>\n<body name=\"i\"><freejoint/>\n<geom size=\"1\" gap=\"1\"/></body></mujoco>");
  folder.write("all.xml",
               "<mujocoinclude><geom name=\"outer\" size=\"1\"/><include file=\"parts/body.xml\"/></mujocoinclude>");
  const auto path =
      folder.write("scene.xml", mujoco(world("<include file=\"all.xml\"/><geom name=\"last\" size=\"1\"/>")));
  const auto [model, report] = load_mjcf(path);
  ASSERT_EQ(model.geoms().size(), 3u);
  EXPECT_EQ(model.geoms()[0].name, "outer");
  EXPECT_EQ(model.geoms()[1].name, "last");  // a body's own geoms come before those inside it
  EXPECT_EQ(model.links()[1].name, "i");
  ASSERT_EQ(report.notes.size(), 1u);
  EXPECT_EQ(report.notes[0].file, (folder.path() / "parts/body.xml").string());
  EXPECT_EQ(report.notes[0].line, 3);
}

TEST(MjcfRules, TheDefaultKindOfGeomMeetsGeomsAddedInCode) {
  const Model model = load_scene(mujoco(world(free_ball("a", "") + free_ball("b", "contype=\"2\" conaffinity=\"3\"") +
                                              free_ball("c", "contype=\"4\" conaffinity=\"4\""))))
                          .model;
  const CollisionFilter by_default;
  EXPECT_EQ(geom_of(model, "a").filter.group, by_default.group);
  for (const auto& [name, meets] : {std::pair{"a", true}, std::pair{"b", true}, std::pair{"c", false}}) {
    const CollisionFilter& filter = geom_of(model, name).filter;
    EXPECT_EQ((filter.mask & by_default.group) != 0, meets) << name;
  }
  EXPECT_TRUE(may_meet(model, "a", "b"));  // conaffinity 3 has the bit of contype 1
  EXPECT_FALSE(may_meet(model, "a", "c"));
  EXPECT_TRUE(may_meet(model, "b", "b"));
  EXPECT_EQ(geom_of(load_scene(mujoco(world(free_ball("a", "")))).model, "a").filter.mask, by_default.mask);
}

TEST(MjcfRules, ThirtyTwoKindsOfGeomsAreTold) {
  std::string geoms, further;
  for (int i = 0; i < 31; ++i) {
    const std::string bit = std::to_string(i == 30 ? 1 << 30 : 1 << i);
    geoms +=
        "<geom name=\"g" + std::to_string(i) + "\" size=\"1\" contype=\"" + bit + "\" conaffinity=\"" + bit + "\"/>";
  }
  const Model model = load_scene(mujoco(world(geoms))).model;
  EXPECT_TRUE(may_meet(model, "g30", "g30"));
  EXPECT_FALSE(may_meet(model, "g30", "g29"));
  for (int i = 0; i < 3; ++i) {
    further += "<geom size=\"1\" contype=\"" + std::to_string(3 << i) + "\" conaffinity=\"0\"/>";
  }
  EXPECT_PRED2(contains, scene_error(mujoco(world(geoms + further))), "make more than 32 kinds of geoms");
}

TEST(MjcfRules, FrictionsAreThoseOfTheCondimAndTheLargerCounts) {
  const auto [model, report] = load_scene(mujoco(world(free_ball("a", "condim=\"1\" friction=\"0.9\"") +
                                                       free_ball("b", "condim=\"4\" friction=\"0.7 0.1 0.2\""))));
  EXPECT_EQ(geom_of(model, "a").surface.lateral_friction, 0);
  EXPECT_EQ(geom_of(model, "b").surface.lateral_friction, 0.7);
  EXPECT_EQ(geom_of(model, "b").surface.spinning_friction, 0.1);
  EXPECT_EQ(geom_of(model, "b").surface.rolling_friction, 0);
  EXPECT_EQ(model.contact_rules().friction, CombineRule::kMaximum);
  ASSERT_EQ(model.contact_pairs().size(), 1u);  // for MuJoCo takes 0.9, the condim being 4
  EXPECT_EQ(model.contact_pairs()[0].surface->lateral_friction, 0.9);
  EXPECT_EQ(model.contact_pairs()[0].surface->spinning_friction, 0.1);
  EXPECT_TRUE(report.empty()) << report.to_string();
}

TEST(MjcfRules, PairsKeepTheirOwnSurfaceAndMakeGhostsSolid) {
  const auto [model, report] =
      load_scene(mujoco(world(free_ball("a", "contype=\"0\" conaffinity=\"0\"") + free_ball("b", "friction=\"0.6\"") +
                              free_ball("ghost", "contype=\"0\" conaffinity=\"0\"")) +
                        "<contact><pair geom1=\"a\" geom2=\"b\" friction=\"0.3 0.4 0.01\" condim=\"4\"/></contact>"));
  EXPECT_EQ(geom_of(model, "a").role, GeomRole::kCollision);
  EXPECT_EQ(geom_of(model, "ghost").role, GeomRole::kVisual);
  EXPECT_FALSE(may_meet(model, "a", "b"));
  ASSERT_EQ(model.contact_pairs().size(), 1u);
  const SurfaceMaterial surface = model.contact_pairs()[0].surface.value();
  EXPECT_EQ(surface.lateral_friction, 0.3);
  EXPECT_EQ(surface.spinning_friction, 0.01);
  EXPECT_EQ(count_notes(report, LoadAction::kRepaired, "pair ''", "frictions differ by direction"), 1);
}

TEST(MjcfRules, OfPairsOfTheSameGeomsTheLargerFrictionActs) {
  const auto [model, report] =
      load_scene(mujoco(world(free_ball("a", "") + free_ball("b", "friction=\"9\"")) +
                        "<contact><pair geom1=\"a\" geom2=\"b\"/><pair geom1=\"b\" geom2=\"a\" condim=\"1\"/>"
                        "<pair geom1=\"a\" geom2=\"b\" friction=\"0.5 0.5\"/></contact>"));
  ASSERT_EQ(model.contact_pairs().size(), 1u);
  EXPECT_EQ(model.contact_pairs()[0].surface->lateral_friction, 1);
  EXPECT_EQ(count_notes(report, LoadAction::kRepaired, "pair ''", "a pair of these geoms already"), 2);
}

TEST(MjcfRules, ParentsAndChildrenDoNotTouchAcrossSeveralJoints) {
  const std::string geom = "<geom size=\"0.1\"/>";
  const Model model =
      load_scene(mujoco(world(body("a", "<freejoint/>" + geom + body("on a", geom) +
                                            body("b", "<joint/><joint axis=\"1 0 0\"/>" + geom + body("on b", geom) +
                                                          body("c", "<joint/>" + geom))))))
          .model;
  for (const char* const a : {"a", "on a"}) {
    for (const char* const b : {"b", "on b"}) EXPECT_TRUE(excludes(model, a, b)) << a << ", " << b;
  }
  EXPECT_FALSE(excludes(model, "a", "c"));
  EXPECT_EQ(model.link(model.link_id("b")).body.value(), model.link(model.link_id("on b")).body.value());
}

TEST(MjcfRules, FixedBasesTouchWhatMovesOnThem) {
  const std::string base =
      "<geom name=\"foot\" size=\"0.1\"/>" + body("arm", "<joint/><geom name=\"arm\" size=\"0.1\"/>");
  const Model model = load_scene(mujoco(world(body("base", base)))).model;
  ASSERT_EQ(model.contact_pairs().size(), 1u);
  EXPECT_EQ(model.geoms()[model.contact_pairs()[0].a.index()].name, "foot");
  EXPECT_FALSE(model.contact_pairs()[0].surface.has_value());
  const std::string excluded = "<contact><exclude body1=\"base\" body2=\"arm\"/></contact>";
  EXPECT_TRUE(load_scene(mujoco(world(body("base", base)) + excluded)).model.contact_pairs().empty());
}

TEST(MjcfRules, MeshesComeFromTheirFolder) {
  const ScratchFolder folder;
  folder.write("meshes/corner.obj", kTetrahedronObj);
  const auto write = [&](const std::string& compiler, const std::string& file) {
    return folder.write(
        "scene.xml", mujoco("<compiler " + compiler + "/><asset><mesh file=\"" + file + "\" scale=\"2 2 2\"/></asset>" +
                            world(body("b", "<freejoint/><geom type=\"mesh\" mesh=\"corner\"/>"))));
  };
  for (const auto& [compiler, file] :
       {std::pair{"meshdir=\"meshes\"", "corner.obj"}, std::pair{"assetdir=\"meshes\"", "corner.obj"},
        std::pair{"", "meshes/corner.obj"}, std::pair{"meshdir=\"meshes\" strippath=\"true\"", "C/else/corner.obj"}}) {
    const Model model = load_mjcf(write(compiler, file)).model;
    ASSERT_EQ(model.meshes().size(), 1u) << compiler;
    EXPECT_NEAR(model.link(model.link_id("b")).inertial.mass, 8000.0 / 6, 1e-3);
    EXPECT_EQ(model.geoms()[0].shape.type, ShapeType::kConvex);
  }
  EXPECT_THROW((void)load_mjcf(write("meshdir=\"/etc\"", "passwd")), MjcfError);
}

TEST(MjcfRules, MissingMeshesLeaveTheirGeomsOut) {
  const std::string text = mujoco("<asset><mesh name=\"m\" file=\"none.stl\"/></asset>" +
                                  world(body("b", "<freejoint/><geom size=\"1\"/><geom type=\"mesh\" mesh=\"m\"/>")));
  const auto [model, report] = load_scene(text);
  EXPECT_EQ(model.geoms().size(), 1u);
  EXPECT_EQ(count_notes(report, LoadAction::kIgnored, "mesh 'm'", "there is no file"), 1);
  const LoadReport asked = load_scene(text, {.load_meshes = false}).report;
  EXPECT_EQ(count_notes(asked, LoadAction::kIgnored, "mesh 'm'", "left out, as asked"), 1);
}

TEST(MjcfRules, HeightFieldsAreReadFromBinaryFiles) {
  const ScratchFolder folder;
  const std::int32_t size[] = {2, 3};
  const float heights[] = {1, 2, 3, 4, 5, 11};
  std::string bytes(sizeof size + sizeof heights, '\0');
  std::memcpy(bytes.data(), size, sizeof size);
  std::memcpy(bytes.data() + sizeof size, heights, sizeof heights);
  folder.write("field.bin", bytes);
  folder.write("short.bin", bytes.substr(1));
  const auto scene = [&](const std::string& file) {
    return folder.write("scene.xml",
                        mujoco("<asset><hfield name=\"h\" file=\"" + file + "\" size=\"1 2 5 1\"/></asset>" +
                               world("<geom type=\"hfield\" hfield=\"h\"/>")));
  };
  const Model model = load_mjcf(scene("field.bin")).model;
  const HeightField& field = model.height_fields()[0];
  EXPECT_EQ(field.rows, 2);
  EXPECT_EQ(field.columns, 3);
  EXPECT_EQ(field.dx, 1);
  EXPECT_EQ(field.dy, 4);
  EXPECT_EQ(field.height, (std::vector<double>{0, 0.5, 1, 1.5, 2, 5}));
  EXPECT_THROW((void)load_mjcf(scene("short.bin")), MjcfError);
  folder.write("broken.png", "x");
  EXPECT_EQ(count_notes(load_mjcf(scene("none.png")).report, LoadAction::kIgnored, "hfield 'h'", "there is no file"),
            1);
  EXPECT_EQ(
      count_notes(load_mjcf(scene("broken.png")).report, LoadAction::kIgnored, "hfield 'h'", "not begin as a PNG"), 1);
}

TEST(MjcfRules, InertiasThatNoBodyHasAreRepaired) {
  const auto [model, report] =
      load_scene(mujoco(world(body("b", "<freejoint/><inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 3\"/>"))));
  EXPECT_EQ(count_notes(report, LoadAction::kRepaired, "body 'b'", "no rigid body has the principal moments"), 1);
  const SymMat3<double>& I = model.link(model.link_id("b")).inertial.inertia;
  EXPECT_LE(I.zz, I.xx + I.yy + 1e-12);
}

TEST(MjcfRules, ActuatorsOfOtherKindsAreLeftOut) {
  const auto [model, report] =
      load_scene(one_body("<joint name=\"j\"/>",
                          "<tendon><spatial name=\"t\"><geom geom=\"g\"/></spatial></tendon><actuator>"
                          "<muscle name=\"a\" joint=\"j\"/><motor name=\"b\" tendon=\"t\"/>"
                          "<general name=\"c\" joint=\"j\" dyntype=\"muscle\"/>"
                          "<general name=\"d\" joint=\"j\" gainprm=\"2\" biastype=\"affine\" biasprm=\"0 3 0\"/>"
                          "<motor name=\"e\" joint=\"j\" forcerange=\"-1 2\" gear=\"-3\"/>"
                          "<general name=\"f\" joint=\"j\" dyntype=\"filter\"/></actuator>"
                          "<keyframe><key ctrl=\"1 2 3 4 5 6\" act=\"7 8 9\"/></keyframe>"));
  ASSERT_EQ(model.actuators().size(), 3u);
  EXPECT_EQ(model.actuators()[0].type, ActuatorType::kAffine);
  EXPECT_EQ(model.actuators()[1].max_force, 3);
  EXPECT_EQ(model.actuators()[1].least_force(), -6);
  EXPECT_EQ(model.actuators()[2].iact, 0);
  EXPECT_EQ(count_notes(report, LoadAction::kIgnored, "actuator 'a'", "of kind <muscle> is not read"), 1);
  EXPECT_EQ(count_notes(report, LoadAction::kIgnored, "actuator 'b'", "tendon 't' was left out"), 1);
  EXPECT_EQ(count_notes(report, LoadAction::kIgnored, "tendon 't'", "wraps around a geom"), 1);
  EXPECT_EQ(count_notes(report, LoadAction::kIgnored, "actuator 'c'", "dyntype 'muscle' is not read"), 1);
  EXPECT_EQ(model.keyframes()[0].ctrl, (std::vector<double>{4, 5, 6}));
  EXPECT_EQ(model.keyframes()[0].act, std::vector<double>{9});
}

/// A joint's bound of all its actuators.
TEST(MjcfRules, JointsBoundTheirActuator) {
  const auto [model, report] =
      load_scene(one_body("<joint name=\"j\" actuatorfrcrange=\"-4 4\"/><joint name=\"k\" axis=\"1 0 0\"/>",
                          "<actuator><motor name=\"a\" joint=\"j\" gear=\"2\" forcerange=\"-1 9\"/>"
                          "<motor name=\"b\" joint=\"k\"/></actuator>"));
  EXPECT_EQ(model.actuators()[0].max_force, 4);
  EXPECT_EQ(model.actuators()[0].least_force(), -2);
  EXPECT_FALSE(is_finite(model.actuators()[1].max_force));
}

TEST(MjcfRules, GeneralServosMayScaleTheirCommand) {
  const Model model =
      load_scene(one_body("<joint name=\"j\"/>",
                          "<actuator><general joint=\"j\" gainprm=\"2\" biastype=\"affine\" biasprm=\"0.5 -4 -1\"/>"
                          "<general joint=\"j\" gainprm=\"3\" biastype=\"affine\" biasprm=\"6 0 0\" gear=\"5\"/>"
                          "</actuator>"))
          .model;
  const std::span<const Actuator> actuators = model.actuators();
  EXPECT_EQ(actuators[0].type, ActuatorType::kPosition);
  EXPECT_EQ(actuators[0].kp, 4);
  EXPECT_EQ(actuators[0].kd, 1);
  EXPECT_EQ(actuators[0].ctrl_scale, 0.5);
  EXPECT_EQ(actuators[0].ctrl_offset, 0.125);
  EXPECT_EQ(actuators[1].type, ActuatorType::kForce);
  EXPECT_EQ(actuators[1].gear, 5);
  EXPECT_EQ(actuators[1].ctrl_scale, 3);
  EXPECT_EQ(actuators[1].ctrl_offset, 6);
}

TEST(MjcfRules, TendonsWithoutWhatTheyNeedAreErrors) {
  const auto refused = [](const std::string& tendon) {
    const std::string scene = one_body("<joint name=\"j\"/><site name=\"s\"/><joint name=\"k\" axis=\"1 0 0\"/>",
                                       "<tendon>" + tendon + "</tendon>");
    EXPECT_THROW((void)load_scene(scene), MjcfError) << tendon;
  };
  const std::string way = "<site site=\"s\"/><site site=\"s\"/>";
  refused("<fixed><joint joint=\"none\" coef=\"1\"/></fixed>");
  refused("<spatial><site site=\"none\"/><site site=\"s\"/></spatial>");
  refused("<spatial><site site=\"s\"/></spatial>");
  refused("<spatial>" + way + "<pulley divisor=\"0\"/>" + way + "</spatial>");
  refused("<fixed range=\"2 1\"><joint joint=\"j\" coef=\"1\"/></fixed>");
  const std::string fixed = "<fixed name=\"t\"><joint joint=\"j\" coef=\"1\"/></fixed>";
  refused(fixed + fixed);
}

TEST(MjcfRules, HullsThatMuJoCoWouldMakeCoarserAreNoted) {
  const auto notes = [](const std::string& most) {
    const std::string cube = "-1 -1 -1 1 -1 -1 -1 1 -1 1 1 -1 -1 -1 1 1 -1 1 -1 1 1 1 1 1";
    const LoadReport report = load_scene(mujoco("<asset><mesh name=\"m\" vertex=\"" + cube + "\" " + most +
                                                "/></asset>" + world("<geom type=\"mesh\" mesh=\"m\"/>")))
                                  .report;
    return std::ranges::count_if(report.notes, &LoadNote::serious);
  };
  EXPECT_EQ(notes(""), 0);
  EXPECT_EQ(notes("maxhullvert=\"8\""), 0);
  EXPECT_EQ(notes("maxhullvert=\"6\""), 1);
  EXPECT_EQ(notes("maxhullvert=\"-1\""), 0);
}

TEST(MjcfRules, ADocumentTypeIsPassedOverUnlessItDeclaresSomething) {
  EXPECT_EQ(scene_error("<!DOCTYPE mujoco SYSTEM \"mujoco.dtd\">" + mujoco("")), "");
  EXPECT_PRED2(contains, scene_error("<!DOCTYPE mujoco [<!ENTITY a \"1\">]>" + mujoco("")), "declares entities");
}

TEST(MjcfRules, EqualitiesThatCannotBeLoopsAreNoted) {
  const auto [model, report] =
      load_scene(one_body("<joint name=\"j\"/><joint name=\"k\" axis=\"1 0 0\"/>",
                          "<equality><joint name=\"a\" joint1=\"j\"/><joint name=\"b\" joint1=\"j\" joint2=\"k\" "
                          "polycoef=\"0 2 3 0 0\"/><weld name=\"c\" body1=\"b\" active=\"false\"/></equality>"));
  ASSERT_EQ(model.equalities().size(), 1u);
  EXPECT_EQ(model.equalities()[0].ratio, 2);
  EXPECT_EQ(count_notes(report, LoadAction::kIgnored, "equality 'a'", "held at one place"), 1);
  EXPECT_EQ(count_notes(report, LoadAction::kRepaired, "equality 'b'", "the quadratic to quartic"), 1);
  EXPECT_EQ(count_notes(report, LoadAction::kIgnored, "equality 'c'", "not active"), 1);
}

TEST(MjcfRules, RelativePosesOfWeldsCount) {
  const Model model = load_scene(mujoco(world(body("a", std::string("<freejoint/>") + kMjcfInertial) +
                                              body("b", std::string("<freejoint/>") + kMjcfInertial)) +
                                        "<equality><weld body1=\"a\" body2=\"b\" relpose=\"1 2 3 0 1 0 0\" "
                                        "anchor=\"0 1 0\"/></equality>"))
                          .model;
  const EqualityConstraint& loop = model.equalities()[0];
  EXPECT_EQ(loop.X_LB.p.y, 1);
  EXPECT_EQ(loop.X_LA.p.y, 2 - 1);  // half a turn about x
  EXPECT_EQ(loop.X_LA.R.y.y, -1);
}

TEST(MjcfRules, NonlinearSpringsAndRangesOfBallsAreNoted) {
  const LoadReport report =
      load_scene(one_body("<joint name=\"j\" stiffness=\"3 1\" damping=\"-1\"/>" +
                          body("c", std::string("<joint name=\"k\" type=\"ball\" range=\"0 30\"/>") + kMjcfInertial)))
          .report;
  EXPECT_EQ(count_notes(report, LoadAction::kIgnored, "joint 'j'", "the nonlinear part of 'stiffness'"), 1);
  EXPECT_EQ(count_notes(report, LoadAction::kRepaired, "joint 'j'", "damping -1 is negative"), 1);
  EXPECT_EQ(count_notes(report, LoadAction::kIgnored, "joint 'k'", "the range of a ball"), 1);
}

TEST(MjcfRules, FreeBodiesStartWhereTheFilePutsThem) {
  const Model model =
      load_scene(mujoco(world("<body pos=\"1 2 3\" quat=\"0 0 0 1\"><freejoint/><geom size=\"1\"/></body>"))).model;
  EXPECT_EQ(model.initial_configuration(), (std::vector<double>{1, 2, 3, 0, 0, 1, 0}));
  EXPECT_EQ(model.neutral_configuration(), (std::vector<double>{0, 0, 0, 0, 0, 0, 1}));
}

TEST(MjcfRules, BulletReadsGlobalCoordinates) {
  // The same arm twice: b1 at x = 1, b2 at x = 2, turned by a quarter about z.
  const auto arm = [](const std::string& compiler, const std::string& b2) {
    return "<mujoco>" + compiler + "<worldbody><body name='b1' pos='1 0 0'>" + b2 + "</body></worldbody></mujoco>";
  };
  const std::string local =
      arm("",
          "<joint name='j1' pos='0 0 0'/><geom size='0.1'/><body name='b2' pos='1 0 0' quat='1 0 0 1'>"
          "<joint name='j2' axis='1 0 0' pos='0 0.5 0'/><geom type='box' size='.1 .2 .3' pos='0 0 1'/></body>");
  const std::string global =
      arm("<compiler coordinate='global'/>",
          "<joint name='j1' pos='1 0 0'/><geom size='0.1' pos='1 0 0'/><body name='b2' pos='2 0 0' quat='1 0 0 1'>"
          "<joint name='j2' axis='0 1 0' pos='1.5 0 0'/>"
          "<geom type='box' size='.1 .2 .3' pos='2 0 1' quat='1 0 0 1'/></body>");
  EXPECT_THROW((void)load_mjcf_string(global), MjcfError);
  const Model a = load_mjcf_string(local, "a", ".", {.bullet = true}).model;
  const Model b = load_mjcf_string(global, "b", ".", {.bullet = true}).model;
  ASSERT_EQ(a.nv(), 2);
  ASSERT_EQ(b.nv(), 2);
  for (std::size_t i = 0; i < a.joints().size(); ++i) {
    EXPECT_LT(norm(a.joints()[i].X_PF.p - b.joints()[i].X_PF.p), 1e-12);
    EXPECT_LT(norm(a.joints()[i].axis - b.joints()[i].axis), 1e-12);
  }
  for (std::size_t i = 0; i < a.geoms().size(); ++i) {
    EXPECT_LT(norm(a.geoms()[i].X_LG.p - b.geoms()[i].X_LG.p), 1e-12);
    EXPECT_LT(norm(a.geoms()[i].X_LG.R.x - b.geoms()[i].X_LG.R.x), 1e-12);
  }
}

TEST(MjcfRules, BulletKnowsFixedJointsAndNothingThatActs) {
  const std::string text =
      "<mujoco><compiler settotalmass='7'/><worldbody><body><joint type='fixed'/><geom size='.1' density='5' "
      "material='none'/>"
      "<body><joint name='j'/><geom size='.1'/></body></body></worldbody><actuator><motor "
      "joint='gone'/></actuator></mujoco>";
  EXPECT_THROW((void)load_mjcf_string(text), MjcfError);
  const LoadedModel loaded = load_mjcf_string(text, "a", ".", {.bullet = true});
  EXPECT_EQ(loaded.model.nv(), 1);
  const LinkId body = loaded.model.link_id("link0_0");
  EXPECT_NEAR(loaded.model.link(body).inertial.mass, 1000 * 4.0 / 3 * 3.14159265358979 * 1e-3, 1e-9);
}

}  // namespace
}  // namespace manyhands::testing
