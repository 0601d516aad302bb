// Damaged scenes by the thousand: they load or give the one error, and nothing else happens. The same cases every time;
// MANYHANDS_FUZZ_ROUNDS asks for more of them.
#include <cmath>

#include "tests/model/mjcf_testing.h"
#include "tests/model/mutator.h"

namespace manyhands::testing {
namespace {

constexpr std::string_view kScene = R"(<mujoco model="seed">
  <compiler angle="radian" eulerseq="xyz" boundmass="0.001" meshdir="m"/><option timestep="0.01" gravity="0 0 -9"/>
  <default><geom friction="1 0.01 0.001" density="500"/><joint damping="0.1"/>
    <default class="c"><geom type="capsule" size="0.1 0.2"/><motor ctrlrange="-1 1"/></default></default>
  <asset><mesh name="m" vertex="0 0 0 1 0 0 0 1 0 0 0 1 1 1 1" scale="1 1 2"/><mesh file="none.stl"/>
    <mesh name="t" vertex="0 0 0 1 0 0 0 1 0 0 0 1" face="0 2 1 0 1 3 1 2 3 2 0 3" inertia="exact"/>
    <hfield name="h" nrow="2" ncol="3" size="1 1 1 1" elevation="0 1 2 3 4 5"/><texture name="x" builtin="checker"
    type="2d" rgb1="1 0 0"/><texture file="none.png"/><material name="g" texture="x" texrepeat="2 3" rgba="0 1 0 1"/></asset>
  <worldbody>
    <geom name="floor" type="plane" size="0 0 1"/><geom type="hfield" hfield="h"/><light pos="0 0 1"/><site name="o" pos="1 1 1"/>
    <body name="a" pos="0 0 1" quat="1 0 0 0" childclass="c"><freejoint/><geom name="ga"/><geom type="mesh" mesh="m"/>
      <body name="b" euler="0.1 0.2 0.3"><joint name="j" axis="0 1 0" range="-1 1" pos="0 0 0.1" ref="0.1"/>
        <joint name="k" type="slide"/><geom type="ellipsoid" size="1 2 3" material="g"/><site name="s" zaxis="1 0 0"/>
        <frame pos="1 0 0"><geom type="box" fromto="0 0 0 0 0 1" size="0.1"/></frame>
        <replicate count="2" offset="0 1 0" euler="0 0 1"><geom name="r" size="0.1"/></replicate></body></body>
    <body name="d" xyaxes="1 0 0 0 1 0"><joint type="ball" pos="0 0 1"/><geom name="gd" size="0.1" contype="2"/>
      <inertial pos="0 0 0" mass="1" fullinertia="1 1 1 0 0 0.1"/><geom type="mesh" mesh="t"/></body>
  </worldbody>
  <contact><pair geom1="ga" geom2="gd" friction="1 1 0.1 0 0" condim="4"/><exclude body1="a" body2="d"/></contact>
  <equality><connect body1="a" body2="d" anchor="0 0 1"/><weld body1="b"/>
    <joint joint1="j" joint2="k" polycoef="0 1 0 0 0"/>
    <tendon tendon1="tf" tendon2="ts"/></equality>
  <tendon><fixed name="tf" range="-1 1" stiffness="2"><joint joint="j" coef="1"/><joint joint="k" coef="2"/></fixed>
    <spatial name="ts" springlength="0.1 0.2" damping="1"><site site="s"/><site site="o"/><pulley divisor="2"/>
      <site site="o"/><site site="s"/></spatial></tendon>
  <actuator><motor joint="j" gear="2" class="c"/><position joint="k" kp="10" dampratio="1" forcerange="-1 1"/>
    <general joint="j" gainprm="3" biastype="affine" biasprm="0 -3 -1"/><muscle joint="j"/>
    <motor tendon="ts"/></actuator>
  <keyframe><key qpos="0 0 1 1 0 0 0 0 0 1 0 0 0" ctrl="0 0 0 0 0"/></keyframe><sensor><clock/></sensor>
</mujoco>)";

void expect_whole(const Model& model) {
  for (const Link& link : model.links()) {
    ASSERT_TRUE(std::isfinite(link.inertial.mass) && link.inertial.mass >= 0);
    ASSERT_TRUE(link.body.is_valid());
  }
  for (const Joint& joint : model.joints()) {
    ASSERT_NEAR(norm(joint.axis), 1, 1e-9);
    ASSERT_LE(joint.limits.lower, joint.limits.upper);
  }
  for (const Geom& geom : model.geoms()) {
    const bool has_mesh = geom.shape.type == ShapeType::kConvex || geom.shape.type == ShapeType::kMesh;
    ASSERT_TRUE(!has_mesh || geom.shape.mesh.index() < model.meshes().size());
    ASSERT_NEAR(norm(geom.X_LG.R.x), 1, 1e-9);
  }
  for (const EqualityConstraint& loop : model.equalities())
    ASSERT_TRUE(std::isfinite(loop.X_LB.p.x + loop.ratio + loop.offset));
  for (const Tendon& tendon : model.tendons())
    ASSERT_TRUE(tendon.lower <= tendon.upper && std::isfinite(tendon.spring_lower + tendon.stiffness));
  for (const Body& body : model.bodies()) ASSERT_TRUE(std::isfinite(body.inertia.I.xx + body.X_PF.p.x));
  for (const double q : model.initial_configuration()) ASSERT_TRUE(std::isfinite(q));
  for (const Keyframe& key : model.keyframes()) ASSERT_EQ(std::ssize(key.q), model.nq());
}

TEST(MjcfFuzz, ScenesLoadOrGiveTheOneError) {
  int loaded = 0, refused = 0;
  for (unsigned seed = 0; seed < rounds(6000); ++seed) {
    const std::string text = Mutator(seed).mutated(kScene);
    SCOPED_TRACE("seed " + std::to_string(seed));
    try {
      expect_whole(load_mjcf_string(text, "fuzz.xml", ".", {.bullet = seed % 3 == 0}).model);
      ++loaded;
    } catch (const MjcfError& error) {
      ASSERT_TRUE(std::string(error.what()).starts_with("fuzz.xml:"));
      ++refused;
    }
    if (HasFatalFailure()) return;
  }
  // The mutations must neither break everything nor nothing.
  EXPECT_GT(loaded, refused / 20);
  EXPECT_GT(refused, loaded / 20);
}

TEST(MjcfFuzz, TheSeedItselfLoads) {
  const LoadedModel loaded = load_scene(std::string(kScene));
  EXPECT_EQ(loaded.model.nq(), 13);
  EXPECT_EQ(loaded.model.nu(), 4);
}

}  // namespace
}  // namespace manyhands::testing
