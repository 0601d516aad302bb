// What is saved as URDF is read back as it was, and what URDF cannot say is an error.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "manyhands/model/fingerprint.h"
#include "manyhands/model/io/save/save.h"
#include "manyhands/model/io/urdf/urdf.h"
#include "tests/model/mjcf_testing.h"
#include "tests/model/random_parts.h"

namespace manyhands {
namespace {

using testing::load_scene;
using testing::mujoco;
using testing::random_parts;

Model read_again(const SavedText& saved) { return load_urdf_string(saved.text).model; }

TEST(SaveUrdf, AfterOneRoundEveryRobotIsReadBackToTheBit) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937 random(seed);
    const Model once = read_again(save_urdf_string(random_parts(random, "part"), {.allow_loss = true}));
    const Model twice = read_again(save_urdf_string(once, {.allow_loss = true}));
    ASSERT_EQ(fingerprint(twice), fingerprint(once)) << "seed " << seed;
  }
}

TEST(SaveUrdf, ARobotOfAFileIsReadBackToTheBit) {
  const Model model = load_urdf_string(R"(<robot name="r">
<link name="base"/><link name="a"><inertial><origin xyz="0.1 0.2 0.3" rpy="0 0 0"/><mass value="1.3"/>
<inertia ixx="0.31" iyy="0.42" izz="0.53" ixy="0.01" ixz="0.02" iyz="0.03"/></inertial>
<collision><origin xyz="0.1 0 0" rpy="1.1 0.3 -2.3"/><geometry><cylinder radius="0.1" length="0.37"/></geometry></collision>
<contact><lateral_friction value="0.9"/><restitution value="0.1"/></contact></link>
<link name="b"><inertial><mass value="0.7"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="revolute"><origin xyz="0.1 0.2 0.3" rpy="0.4 1.5707963267948966 0.2"/><parent link="base"/>
<child link="a"/><axis xyz="0.6 0.7 0.1"/><limit lower="-1.1" upper="0.3" effort="7" velocity="3"/>
<dynamics damping="0.1" friction="0.2"/></joint>
<joint name="k" type="prismatic"><origin rpy="0 0 3.1"/><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
<limit lower="0" upper="0.3" effort="7" velocity="3"/><mimic joint="j" multiplier="0.3" offset="0.1"/></joint></robot>)")
                          .model;
  const Model again = read_again(save_urdf_string(model));
  EXPECT_EQ(fingerprint(again), fingerprint(model)) << save_urdf_string(model).text;
  EXPECT_EQ(again.joints()[1].mimic->joint, "j");
  EXPECT_EQ(again.joints()[0].limits.velocity, 3);
}

TEST(SaveUrdf, WhatItCannotSayIsAnError) {
  const std::string body = R"(<body name="b"><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>)";
  const std::string scenes[] = {
      "<worldbody>" + body + R"(<joint type="ball"/></body></worldbody>)",
      "<worldbody>" + body + R"(<joint armature="0.1"/></body></worldbody>)",
      "<worldbody>" + body + R"(<joint name="j"/></body></worldbody><actuator><motor joint="j"/></actuator>)",
      R"(<worldbody><geom type="plane" size="0 0 1"/></worldbody>)",
      "<worldbody>" + body + R"(<freejoint/></body></worldbody><equality><weld body1="b"/></equality>)",
  };
  for (const std::string& scene : scenes) {
    const Model model = load_scene(mujoco(scene)).model;
    EXPECT_THROW((void)save_urdf_string(model), SaveError) << scene;
    const SavedText saved = save_urdf_string(model, {.allow_loss = true});
    EXPECT_TRUE(std::ranges::any_of(saved.report.notes, &LoadNote::serious)) << scene;
  }
}

TEST(SaveUrdf, ARootThatFloatsIsTheFilesRoot) {
  const Model model =
      load_scene(
          mujoco(
              R"(<worldbody><body name="b"><freejoint/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body></worldbody>)"))
          .model;
  const SavedText saved = save_urdf_string(model);
  EXPECT_EQ(load_urdf_string(saved.text, "urdf", ".", {.fixed_base = false}).model.nq(), 7);
}

}  // namespace
}  // namespace manyhands
