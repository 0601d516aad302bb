// Drives on joints with dry friction: position and velocity actuators of bounded force on random trees, whose joints
// rub.
#include <gtest/gtest.h>

#include "manyhands/model/compose.h"
#include "manyhands/physics/world/batch.h"
#include "manyhands/physics/world/world.h"
#include "tests/physics/contact/joint_solution.h"

namespace manyhands {
namespace {

using testing::Generator;
using testing::JointLaw;
using testing::JointProblem;
using testing::JointSolution;
using testing::solution_of;
using testing::uniform;

/// A tree with a drive on each of its joints of one degree of freedom.
Model driven_tree(std::uint64_t seed, int links) {
  Generator rng(seed + 17);
  const auto pick = [&](std::initializer_list<double> values) { return values.begin()[rng() % values.size()]; };
  ModelBuilder builder = builder_of(testing::random_tree(seed, links));
  for (std::size_t i = 0; i < builder.joints().size(); ++i) {
    if (velocity_size(builder.joints()[i].type) != 1) continue;
    const bool position = rng() % 2 == 0;
    builder.add_actuator({.name = "drive" + std::to_string(i),
                          .type = position ? ActuatorType::kPosition : ActuatorType::kVelocity,
                          .joint = JointId(i),
                          .gear = pick({1, -0.5, 3}),
                          .kp = position ? pick({0, 30, 1e4}) : 0,
                          .kd = pick({0, 2, 500}),
                          .max_force = pick({0.5, 20, 1e3, std::numeric_limits<double>::infinity()})});
  }
  return builder.build();
}

template <Real R>
struct DrivenProblem : JointProblem<R> {
  DrivenProblem(std::uint64_t seed, int links) : JointProblem<R>(driven_tree(seed, links), seed) {
    Generator rng(seed ^ 0x51ed270b0a1f39c1u);
    for (std::size_t i = 0; i < this->size(); ++i) {
      const std::array<double, 4> frictions{0, 0.3, 10, 1e4};
      this->params.friction[i] = static_cast<R>(frictions[rng() % frictions.size()]);
      if (this->tree.dof_drive[i] >= 0 && rng() % 4 == 0) this->state.v()[i] = 0;
    }
    for (int k = 0; k < this->model.nu(); ++k) this->state.ctrl()[k] = static_cast<R>(uniform(rng, -3, 3));
  }
};

constexpr int kTrees = 1500;

TEST(RubbingDrives, ObeyTheirLawInDouble) {
  for (std::uint64_t seed = 0; seed < kTrees; ++seed) {
    const DrivenProblem<double> p(seed, 1 + static_cast<int>(seed % 12));
    EXPECT_LE(JointLaw(p).residual(solution_of(p).dv, 1e-11), 1e-9) << "seed " << seed << ", nv " << p.tree.nv;
  }
}

TEST(RubbingDrives, ObeyTheirLawInFloat) {
  for (std::uint64_t seed = 0; seed < kTrees; ++seed) {
    const DrivenProblem<float> p(seed, 1 + static_cast<int>(seed % 12));
    EXPECT_LE(JointLaw(p).residual(solution_of(p).dv, 5e-4), 1e-3) << "seed " << seed << ", nv " << p.tree.nv;
  }
}

TEST(RubbingDrives, DoNotDependOnTheirWarmStart) {
  using S = JointConstraintState;
  const std::array<double, 12> places{0, 1, -1, 3, 8, 9, 7, -8, -9, -7, 0, 3};
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const DrivenProblem<double> p(seed, 10);
    const JointSolution<double> cold = solution_of(p);
    Generator rng(seed);
    for (int start = 0; start < 5; ++start) {
      std::vector<double> states(p.size(), S::kSaturatedUp);
      for (std::size_t i = 0; i < states.size(); ++i)
        if (p.tree.dof_drive[i] >= 0) states[i] = places[rng() % places.size()];
      const JointSolution<double> warm = solution_of(p, states);
      for (std::size_t i = 0; i < p.size(); ++i)
        EXPECT_NEAR(warm.dv[i], cold.dv[i], 1e-8 * (1 + std::abs(cold.dv[i]))) << "seed " << seed << ", dof " << i;
    }
    const JointSolution<double> again = solution_of(p, cold.active_set);
    for (std::size_t i = 0; i < p.size(); ++i) EXPECT_NEAR(again.dv[i], cold.dv[i], 1e-9 * (1 + std::abs(cold.dv[i])));
  }
}

/// A slide of 2 kg with 3 N of friction and servos.
std::shared_ptr<const Model> slide(std::initializer_list<Actuator> servos, double friction = 3) {
  ModelBuilder builder("slide");
  const LinkId cart = builder.add_link("cart", {.mass = 2, .inertia = {1, 1, 1, 0, 0, 0}});
  const JointId joint = builder.add_joint({.name = "x",
                                           .type = JointType::kPrismatic,
                                           .parent = builder.world(),
                                           .child = cart,
                                           .axis = {1, 0, 0},
                                           .friction = friction});
  int count = 0;
  for (Actuator servo : servos) {
    servo.name = "servo" + std::to_string(count++);
    servo.joint = joint;
    builder.add_actuator(servo);
  }
  return std::make_shared<const Model>(builder.build());
}

TEST(RubbingDrives, AServoSticksWithinTheBandThatFrictionHolds) {
  for (const double ctrl : {-0.0299, 0.0299}) {  // kp times this is below 3 N
    World world(slide({{.type = ActuatorType::kPosition, .kp = 100, .kd = 5}}), 0.002);
    world.set_ctrl(std::array{ctrl});
    world.step(500);
    EXPECT_EQ(world.q()[0], 0.0);
    EXPECT_EQ(world.v()[0], 0.0);
  }
}

TEST(RubbingDrives, AServoComesToRestInsideTheBand) {
  World world(slide({{.type = ActuatorType::kPosition, .kp = 100, .kd = 5}}), 0.002);
  world.set_ctrl(std::array{0.5});
  world.step(4000);
  EXPECT_EQ(world.v()[0], 0.0);
  EXPECT_LE(std::abs(world.q()[0] - 0.5), 0.03);
  EXPECT_GT(std::abs(world.q()[0] - 0.5), 1e-6);
}

/// m dv/dt = kd (ctrl - v) - friction, closed form; the servo's force is bounded at first.
TEST(RubbingDrives, AVelocityServoLagsByFrictionOverItsGain) {
  World world(slide({{.type = ActuatorType::kVelocity, .kd = 10, .max_force = 8}}), 1e-4);
  world.set_ctrl(std::array{1.0});
  const double at_break = 0.2 / 2.5;  // saturated until 10 (1 - v) = 8, at (8 - 3) / 2 m/s^2
  world.step(400);
  EXPECT_NEAR(world.v()[0], 2.5 * 0.04, 1e-9);
  world.step(10000 - 400);
  const double expected = 0.7 - (0.7 - 0.2) * std::exp(-(1 - at_break) * 10 / 2);
  EXPECT_NEAR(world.v()[0], expected, 2e-5);
  world.step(60000);
  EXPECT_NEAR(world.v()[0], 0.7, 1e-12);
}

TEST(RubbingDrives, DrivesOfOneJointAddUp) {
  World world(slide({{.type = ActuatorType::kPosition, .kp = 50}, {.type = ActuatorType::kVelocity, .kd = 4}}, 0),
              1e-4);
  world.set_ctrl(std::array{0.3, -0.2});
  world.step(1);
  EXPECT_NEAR(world.v()[0] / 1e-4, (50 * 0.3 - 4 * 0.2) / 2, 1e-2);
  world.step(300000);
  EXPECT_NEAR(world.q()[0], 0.3 - 4 * 0.2 / 50, 1e-9);
}

TEST(RubbingDrives, LanesGiveTheBitsOfScalars) {
  for (const int links : {3, 9}) {
    const auto model = std::make_shared<const Model>(driven_tree(11, links));
    const auto run = [&](int lanes) {
      Batch batch(model, 16, 0.002, {.num_threads = 1, .lanes = lanes});
      for (const Joint& joint : model->joints()) {
        if (velocity_size(joint.type) == 1) batch.set_joint_friction(joint.name, std::vector<float>(16, 2.0f));
      }
      Generator rng(3);
      std::vector<float> ctrl = batch.ctrl();
      for (float& command : ctrl) command = static_cast<float>(uniform(rng, -1, 1));
      batch.set_ctrl(ctrl);
      batch.step(200);
      return batch.v();
    };
    const std::vector<float> scalar = run(1);
    for (const int lanes : {4, 8, 16}) EXPECT_EQ(run(lanes), scalar) << lanes << " lanes";
  }
}

}  // namespace
}  // namespace manyhands
