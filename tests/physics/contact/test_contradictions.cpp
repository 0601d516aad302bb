// Constraints that contradict each other: what comes out is bounded and comes to rest, whatever they ask for. Each
// scene ran away in its first steps when laws were exact at any price.
#include <gtest/gtest.h>

#include <cmath>

#include "manyhands/model/io/mjcf/mjcf.h"
#include "manyhands/physics/step/step.h"
#include "manyhands/physics/world/batch.h"
#include "manyhands/physics/world/world.h"

namespace manyhands {
namespace {

using ModelPointer = std::shared_ptr<const Model>;

ModelPointer scene(const std::string& world, const std::string& beside = "") {
  return std::make_shared<const Model>(
      load_mjcf_string("<mujoco><worldbody>" + world + "</worldbody>" + beside + "</mujoco>").model);
}

double fastest(std::span<const double> v) {
  double most = 0;
  for (const double x : v) most = std::max(most, std::abs(x));
  return most;
}

struct Motion {
  double fastest = 0, at_last = 0;  ///< of any joint [rad/s or m/s]
};

Motion run(const ModelPointer& model, double seconds) {
  World world(model, 0.002);
  Motion motion;
  for (int i = 0; i < static_cast<int>(std::lround(seconds / 0.002)); ++i) {
    world.step();
    motion.at_last = fastest(world.v());
    motion.fastest = std::max(motion.fastest, motion.at_last);
  }
  return motion;
}

/// Two rods on ball joints that pass through what they hang on: at the centre of a ball joint nothing moves.
ModelPointer chain_of_balls() {
  return scene(
      "<geom type='capsule' size='0.01' fromto='0 0 0 0 0 0.1'/><body pos='0 0 0.1'><geom type='capsule' size='0.01' "
      "fromto='0 0 0 0 0.1 0.1'/><joint type='ball' damping='0.005'/><body pos='0 0.1 0.1'><geom type='capsule' "
      "size='0.01' fromto='0 0 0 0 0.1 0'/><joint type='ball' damping='0.005'/></body></body>");
}

/// A finger on one hinge between two walls, inside both: each pushes it into the other, and friction wedges.
ModelPointer wedged_finger() {
  return scene(
      "<geom type='box' size='0.02 0.1 0.1' pos='0.032 0 0' euler='0 25 0'/><geom type='box' size='0.02 0.1 0.1' "
      "pos='-0.032 0 0' euler='0 -25 0'/><body><joint axis='0 1 0' pos='0 0 0.06'/><geom type='box' size='0.015 0.01 "
      "0.05' mass='0.02' friction='1.5'/></body>");
}

/// Of arms: it touches nothing.
const std::string rod =
    "<geom type='capsule' size='0.02' fromto='0 0 0 0.4 0 0' mass='1' contype='0' conaffinity='0'/>";

/// An arm of two rods whose hand is welded to a point that it cannot reach, where it is stretched and singular.
ModelPointer stretched_arm() {
  return scene("<body name='goal' pos='0.9 0 0.3'/><body pos='0 0 0'><joint axis='0 1 0' damping='0.1'/>" + rod +
                   "<body pos='0.4 0 0'><joint axis='0 1 0' damping='0.1'/>" + rod +
                   "<body name='hand' pos='0.4 0 0'/></body></body>",
               "<equality><weld body1='goal' body2='hand' relpose='0 0 0 1 0 0 0'/></equality>");
}

/// A finger in a slot that is narrower by a tenth of a millimetre on either side: so little that both are asked to
/// open.
ModelPointer tight_slot() {
  return scene(
      "<geom type='box' size='0.02 0.1 0.1' pos='0.0349 0 0'/><geom type='box' size='0.02 0.1 0.1' pos='-0.0349 0 0'/>"
      "<body><joint type='slide' axis='0 0 1'/><joint type='slide' axis='1 0 0'/><geom type='box' "
      "size='0.015 0.01 0.05' mass='0.02' friction='1.5'/></body>");
}

/// An arm whose shoulder is beyond its limit, and whose hand is tied to where it is. Forearm and hand are nearly in
/// line, so that the shoulder turns back only if they turn a hundred times as fast.
ModelPointer limited_arm() {
  return scene("<body><joint axis='0 1 0' range='-1 -0.2' limited='true'/>" + rod +
                   "<body pos='0.4 0 0' euler='0 1 0'><joint axis='0 1 0'/>" + rod +
                   "<body pos='0.4 0 0' euler='0 0.01 0'><joint axis='0 1 0'/>" + rod +
                   "<body name='hand' pos='0.4 0 0'/>" + "</body></body></body>",
               "<compiler angle='radian'/><equality><connect body1='hand' anchor='0 0 0'/></equality>");
}

/// An arm of n limited joints, their axes in turn from a list, whose hand is welded to a point that it cannot reach, or
/// not in that direction.
ModelPointer arm_out_of_reach(int n, const std::vector<std::string>& axes, const std::string& range,
                              const std::string& goal) {
  const std::string link =
      "<geom type='capsule' size='0.02' fromto='0 0 0 0.2 0 0' mass='0.5' contype='0' conaffinity='0'/>";
  std::string arm, end;
  for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
    arm += std::string("<body pos='") + (i > 0 ? "0.2" : "0") + " 0 0'><joint axis='" + axes[i % axes.size()] +
           "' range='" + range + "' limited='true' damping='0.1'/>" + link;
    end += "</body>";
  }
  return scene(
      "<body name='goal' pos='" + goal + "' quat='0.5 0.5 0.5 0.5'/>" + arm + "<body name='hand' pos='0.2 0 0'/>" + end,
      "<compiler angle='radian'/><equality><weld body1='goal' body2='hand' relpose='0 0 0 1 0 0 0'/></equality>");
}

TEST(Contradictions, AroundTheCentreOfABallJointNothingIsPushed) {
  const Motion motion = run(chain_of_balls(), 8);
  EXPECT_LT(motion.fastest, 20);
  EXPECT_LT(motion.at_last, 1e-3);
}

TEST(Contradictions, AFingerWedgedBetweenWallsStays) {
  const Motion motion = run(wedged_finger(), 4);
  EXPECT_LT(motion.fastest, 20);
  EXPECT_LT(motion.at_last, 0.1);
}

/// It comes as near as it can.
TEST(Contradictions, AnArmPulledBeyondItsReachStretches) {
  const ModelPointer model = stretched_arm();
  const Motion motion = run(model, 10);
  EXPECT_LT(motion.fastest, 10);
  EXPECT_LT(motion.at_last, 0.05);
  World world(model, 0.002);
  for (int i = 0; i < 5000; ++i) world.step();
  const Vec3<double> hand = world.body_pose("hand").p;
  EXPECT_GT(norm(hand), 0.95 * 0.8);  // the weld wants the hand level, too: MuJoCo's rests at 0.99
  EXPECT_GT(dot(hand, Vec3<double>{0.9, 0, 0.3}) / (norm(hand) * std::sqrt(0.9)), 0.99);
}

/// Each of them whirled at 13 to 316 rad/s, again and again.
TEST(Contradictions, ArmsAtTheirLimitsDoNotWhirl) {
  const std::vector<std::string> two{"0 1 0", "0 0 1"}, three{"0 0 1", "0 1 0", "1 0 0"};
  for (const ModelPointer& model :
       {arm_out_of_reach(6, two, "-2 0.3", "1 1 1"), arm_out_of_reach(7, two, "-2 0.3", "1 1 1"),
        arm_out_of_reach(7, two, "-2 0.3", "0 0.3 1.5"), arm_out_of_reach(7, two, "-2 0.3", "-1 0.2 0.3"),
        arm_out_of_reach(7, three, "-0.5 0.5", "-1 0.2 0.3")}) {
    World world(model, 0.002);
    world.step(1000);
    double most = 0;
    for (int i = 0; i < 1500; ++i) {
      world.step();
      most = std::max(most, fastest(world.v()));
    }
    EXPECT_LT(most, 3);
  }
}

/// Of a box on the floor, whose step is solved: more energy than there can be, and what is no number, are found.
TEST(Contradictions, SolutionsWithTooMuchEnergyAreFound) {
  const ModelPointer model = scene(
      "<geom type='plane' size='1 1 0.1'/><body pos='0 0 0.1'><freejoint/><geom type='box' size='.1 .1 .1'/></body>");
  const System<double> system(*model);
  const ParamsStorage<double> params(*model);
  StateStorage<double> state(*model, system.contact_numbers());
  StepWorkspace<double> ws(system);
  step(system, params, 0.002, state, ws);
  const ContactSolver<double>& contact = ws.contact;
  const auto exceeds = [&](double dv) {
    EnergyBound<double> scratch(6);
    const std::vector<double> change(6, dv), rest(6, 0.0);
    return internal::exceeds_energy(contact.problem, contact.factors, change, [&] { return rest; }, scratch);
  };
  EXPECT_FALSE(exceeds(1e-4));
  EXPECT_TRUE(exceeds(1));
  EXPECT_TRUE(exceeds(std::numeric_limits<double>::quiet_NaN()));
}

/// A motor that swings a light rod and, by a gear, a heavy one: it does the work that both take, in one step.
TEST(Contradictions, AMotorMayDriveMoreThanItsOwnBody) {
  const ModelPointer model = scene(
      "<body><joint name='light' axis='0 0 1'/><geom type='box' size='.05 .01 .01' mass='0.01'/></body>"
      "<body pos='1 0 0'><joint name='heavy' axis='0 0 1'/><geom type='box' size='.05 .01 .01' mass='0.1'/></body>",
      "<equality><joint joint1='heavy' joint2='light'/></equality>");
  World world(model, 0.002);
  world.set_joint_motor(model->joint_id("light"), {.target_v = 20, .max_force = 8});
  world.step();
  EXPECT_NEAR(world.v()[0], 20, 0.05);  // a held dof yields
  EXPECT_NEAR(world.v()[1], world.v()[0], 1e-9);
}

TEST(Contradictions, PressNoHarderAsTimeGoesOn) {
  for (const ModelPointer& model : {tight_slot(), wedged_finger()}) {
    World world(model, 0.002);
    const auto hardest = [&] {
      double most = 0;
      for (const Contact& contact : world.contacts()) most = std::max(most, norm(contact.force));
      return most;
    };
    world.step(600);
    const double before = hardest();
    world.step(2400);
    EXPECT_LT(before, 1e5);
    EXPECT_LT(hardest(), 1.01 * before);
  }
}

/// Demands that no motion meets are not made in every step: most are solved once.
TEST(Contradictions, AreTriedNowAndThen) {
  const ModelPointer model = limited_arm();
  const System<double> system(*model);
  const ParamsStorage<double> params(*model);
  StateStorage<double> state(*model, system.contact_numbers());
  StepWorkspace<double> ws(system);
  int tries = 0;
  for (int i = 0; i < 330; ++i) {
    step(system, params, 0.002, state, ws);
    tries += state.calm()[0] == contact_settings::kCalmSteps ? 1 : 0;
  }
  EXPECT_GT(tries, 5);
  EXPECT_LE(tries, 10);
}

/// What a world remembers of them is in its snapshots.
TEST(Contradictions, GoOnAsTheyWereFromASnapshot) {
  for (const ModelPointer& model : {limited_arm(), wedged_finger()}) {
    World world(model, 0.002), other(model, 0.002);
    world.step(50);
    other.restore(world.snapshot());
    world.step(100);
    other.step(100);
    EXPECT_EQ(world.state_hash(), other.state_hash());
  }
}

/// In batches, too: no world is put back.
TEST(Contradictions, AreBoundedInLanes) {
  for (const ModelPointer& model : {chain_of_balls(), wedged_finger(), stretched_arm()}) {
    Batch batch(model, 3, 0.002, {.num_threads = 1});
    batch.step(1000);
    for (const std::uint8_t flag : batch.flags()) EXPECT_EQ(flag & BatchFlag::kNotFinite, 0);
    for (const float speed : batch.v()) EXPECT_LT(std::abs(speed), 20);
  }
}

}  // namespace
}  // namespace manyhands
