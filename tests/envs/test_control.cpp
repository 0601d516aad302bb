// What actions mean under each control, by the laws that they promise; in double, and in the bits of a batch.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "manyhands/envs/control/control.h"
#include "manyhands/envs/make.h"
#include "manyhands/envs/scene.h"

namespace manyhands {
namespace {

constexpr double kStep = 0.002;

/// One arm alone, in double, that takes environment steps of 40 ms.
struct Driven {
  Driven(const std::string& robot, ArmControl control)
      : model(load_arm(arm_spec(robot))),
        arm(arm_spec(robot), model, control, true),
        system(model),
        params(model),
        state(model, system.contact_numbers()),
        ws(system) {
    set_arm_motors(arm, params);
    reset_arm(arm, state, 0);
  }

  /// `push` [N m, N] acts on the hand's origin throughout, in world axes.
  void act(const std::vector<double>& action, const Force<double>& push = Force<double>::zero()) {
    const HandState<double> hand = observe_hand(arm, system.tree, state, ws.dynamics);
    apply_action(arm, system.tree, params, hand, action.data(), state, ws.dynamics);
    for (int k = 0; k < 20; ++k) {
      std::ranges::fill_n(state.tau(), model.nv(), 0.0);
      drive_arm(arm, system.tree, params, action.data(), state, ws.dynamics);
      forward_kinematics(system.tree, state.q(), ws.dynamics);
      add_frame_force(arm.chain.dofs, hand_in_tree(arm, ws.dynamics), push, ws.dynamics, state.tau());
      step(system, params, kStep, state, ws);
    }
  }

  [[nodiscard]] std::vector<double> no_action() const {
    return std::vector<double>(static_cast<std::size_t>(action_size(arm)), 0.0);
  }
  [[nodiscard]] Transform<double> hand() {
    return place_chain(system.tree, arm.chain, arm.chain.X_BF, state.q(), ws.dynamics);
  }
  [[nodiscard]] double fastest() const {
    double v = 0;
    for (const std::size_t i : arm.joints) v = std::max(v, std::abs(state.v()[i]));
    return v;
  }

  Model model;
  Arm arm;
  System<double> system;
  ParamsStorage<double> params;
  StateStorage<double> state;
  StepWorkspace<double> ws;
};

/// The angle between two rotations.
double angle(const Mat3<double>& a, const Mat3<double>& b) { return norm(rotation_vector(to_quat(a * transpose(b)))); }

const Mat3<double> kDown{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}};

class Control : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Robots, Control, ::testing::Values("panda", "arm6"));

TEST_P(Control, WithoutActionHoldsStill) {
  for (const auto& [name, control] : kArmControls) {
    Driven robot(GetParam(), control);
    const Vec3<double> start = robot.hand().p;
    for (int i = 0; i < 50; ++i) robot.act(robot.no_action());
    // The neutral pose points down to a milliradian or so; controls of the hand put that right.
    EXPECT_LT(norm(robot.hand().p - start), control == ArmControl::kEndEffector ? 2e-3 : 1e-5) << name;
    EXPECT_LT(robot.fastest(), 1e-4) << name;
  }
}

TEST_P(Control, ByPoseReachesThePose) {
  Driven robot(GetParam(), ArmControl::kEndEffectorPose);
  const Vec3<double> turn{0.3, -0.2, 0.5};  // in units of 90 degrees
  const Transform<double> goal{to_matrix(quat_from_rotation_vector(std::numbers::pi / 2 * turn)) * kDown,
                               robot.hand().p + Vec3<double>{0.05, -0.08, 0.05}};
  for (int i = 0; i < 30; ++i) {
    const Vec3<double> move = 20.0 * (goal.p - robot.hand().p);
    robot.act({move.x, move.y, move.z, turn.x, turn.y, turn.z, 0});
  }
  EXPECT_LT(angle(robot.hand().R, goal.R), 1e-3);
  EXPECT_LT(norm(robot.hand().p - goal.p), 1e-3);
}

TEST_P(Control, ByVelocityReachesTheVelocity) {
  Driven robot(GetParam(), ArmControl::kJointVelocity);
  std::vector<double> action = robot.no_action();
  for (std::size_t i = 0; i < robot.arm.joints.size(); ++i) action[i] = i % 2 == 0 ? 0.4 : -0.25;
  const std::vector<double> start(robot.state.q(), robot.state.q() + robot.model.nq());
  for (int i = 0; i < 5; ++i) robot.act(action);
  for (std::size_t i = 0; i < robot.arm.joints.size(); ++i) {
    const std::size_t dof = robot.arm.joints[i];
    EXPECT_NEAR(robot.state.v()[dof], action[i], 1e-9) << i;
    EXPECT_NEAR(robot.state.q()[dof] - start[dof], 0.2 * action[i], 0.02 * std::abs(action[i])) << i;
  }
}

/// The acceleration that follows a torque is that of the mass matrix: M a = tau - 1 N m s/rad v.
TEST_P(Control, ByTorqueObeysNewton) {
  Driven robot(GetParam(), ArmControl::kJointTorque);
  std::vector<double> action = robot.no_action();
  action[0] = 0.7;
  action[3] = -0.5;
  for (int i = 0; i < 3; ++i) robot.act(action);
  const std::vector<double> v(robot.state.v(), robot.state.v() + robot.model.nv());
  bias_and_mass_matrix(robot.system.tree, robot.params, robot.state.q(), robot.state.v(), robot.ws.dynamics);
  drive_arm(robot.arm, robot.system.tree, robot.params, action.data(), robot.state, robot.ws.dynamics);
  const Workspace<double> before = robot.ws.dynamics;
  const std::vector<double> tau(robot.state.tau(), robot.state.tau() + robot.model.nv());
  step(robot.system, robot.params, 1e-7, robot.state, robot.ws);
  bias_and_mass_matrix(robot.system.tree, robot.params, robot.state.q(), robot.state.v(), robot.ws.dynamics);
  const auto count = robot.arm.joints.size();
  for (std::size_t i = 0; i < count; ++i) {
    double Ma = 0;
    for (std::size_t j = 0; j < count + robot.arm.fingers.size(); ++j) {
      const double a = (robot.state.v()[j] - v[j]) / 1e-7;
      Ma += mass_matrix_entry(robot.system.tree, robot.ws.dynamics, std::max(i, j), std::min(i, j)) * a;
    }
    const double unit = 0.1 * robot.arm.max_force[i];
    EXPECT_NEAR(Ma, unit * action[i] - v[i], 1e-3 * robot.arm.max_force[i]) << i;
    EXPECT_NEAR(tau[i], before.bias[i] + unit * action[i], 1e-9) << i;
  }
}

TEST_P(Control, ByTorqueIsLimitedByTheMotors) {
  Driven robot(GetParam(), ArmControl::kJointTorque);
  for (double& f : robot.arm.max_force) f *= 0.02;
  drive_arm(robot.arm, robot.system.tree, robot.params, robot.no_action().data(), robot.state, robot.ws.dynamics);
  bool limits = false;
  for (std::size_t i = 0; i < robot.arm.joints.size(); ++i) {
    const double most = robot.arm.max_force[i], force = std::abs(robot.state.tau()[robot.arm.joints[i]]);
    EXPECT_LE(force, most);
    limits = limits || force == most;
  }
  EXPECT_TRUE(limits);
}

/// At rest a spring yields by F / k, and a turned one by torque / k.
TEST_P(Control, ByImpedanceYieldsByForceOverStiffness) {
  const std::vector<Force<double>> pushes{{{0, 0, 0}, {6, 0, 0}}, {{0, 0, 0}, {0, -8, 5}}, {{0.5, 0, -0.4}, {0, 0, 0}}};
  for (const Force<double>& push : pushes) {
    Driven robot(GetParam(), ArmControl::kImpedance);
    for (int i = 0; i < 25; ++i) robot.act(robot.no_action());
    const Transform<double> start = robot.hand();
    for (int i = 0; i < 150; ++i) robot.act(robot.no_action(), push);
    const Transform<double> end = robot.hand();
    EXPECT_LT(norm(end.p - start.p - (1 / robot.arm.impedance.stiffness) * push.f), 1e-5);
    const Vec3<double> turned = rotation_vector(to_quat(end.R * transpose(start.R)));
    EXPECT_LT(norm(turned - (1 / robot.arm.impedance.rotational_stiffness) * push.n), 1e-5);
    for (int i = 0; i < 150; ++i) robot.act(robot.no_action());
    EXPECT_LT(norm(robot.hand().p - start.p), 1e-5) << "the goal has moved with the hand";
  }
}

TEST_P(Control, ByImpedanceFollowsItsGoal) {
  Driven robot(GetParam(), ArmControl::kImpedance);
  const Vec3<double> start = robot.hand().p;
  for (int i = 0; i < 4; ++i) robot.act({0.25, 0.25, 0.4, 0, 0, 0, 0});
  for (int i = 0; i < 75; ++i) robot.act(robot.no_action());
  EXPECT_LT(norm(robot.hand().p - start - 4 * 0.05 * Vec3<double>{0.25, 0.25, 0.4}), 1e-3);
  EXPECT_LT(angle(robot.hand().R, kDown), 1e-3);
}

std::vector<float> random_action(const EnvBatch& env, int step) {
  std::vector<float> all;
  for (int i = 0; i < env.num_envs(); ++i) {
    std::mt19937 random(static_cast<unsigned>(i * 7919 + step));
    for (int k = 0; k < env.spec().action_dim; ++k) all.push_back(static_cast<float>(random() % 2001) * 1e-3f - 1);
  }
  return all;
}

TEST_P(Control, IsTheSameInAnyLanesAndThreadsAndAfterASnapshot) {
  constexpr int n = 19;
  const std::vector<std::uint64_t> seeds(n, 5);
  for (const auto& [name, control] : kArmControls) {
    std::uint64_t expected = 0;
    for (const int lanes : {1, 4, 8, 16}) {
      const EnvOptions options{
          .num_threads = lanes == 4 ? 3 : 1, .lanes = lanes, .arm = arm_spec(GetParam()), .control = control};
      const auto env = make_env_batch("PandaPickAndPlace-v3", n, options);
      env->reset({}, seeds);
      std::vector<std::uint8_t> middle;
      for (int step = 0; step < 30; ++step) {
        if (step == 15) middle = env->snapshot();
        env->step(random_action(*env, step));
      }
      if (lanes == 1) expected = env->state_hash();
      EXPECT_EQ(env->state_hash(), expected) << name << ", " << lanes << " lanes";
      env->restore(middle);
      for (int step = 15; step < 30; ++step) env->step(random_action(*env, step));
      EXPECT_EQ(env->state_hash(), expected) << name << ", " << lanes << " lanes, restored";
    }
  }
}

/// Random actions neither throw the arm about nor lead to numbers that are none.
TEST_P(Control, StaysSaneUnderRandomActions) {
  constexpr int n = 100;
  for (const auto& [name, control] : kArmControls) {
    const auto env = make_env_batch("PandaPush-v3", n, {.arm = arm_spec(GetParam()), .control = control});
    std::vector<std::uint64_t> seeds(n);
    std::iota(seeds.begin(), seeds.end(), 0);
    env->reset({}, seeds);
    float fastest = 0;
    for (int step = 0; step < 50; ++step) {
      env->step(random_action(*env, step));
      for (std::size_t i = 0; i < n; ++i) {
        const float* row = &env->observation()[i * static_cast<std::size_t>(env->spec().observation_dim)];
        ASSERT_TRUE(std::isfinite(row[0])) << name;
        fastest = std::max(fastest, std::hypot(row[3], row[4], row[5]));
      }
    }
    EXPECT_LT(fastest, 6) << name << ": m/s, of the hand";
  }
}

/// Searches for the active set that went round in circles, or off to infinity where friction wedged the fingers,
/// threw arms at up to 700 m/s in these batches of seeds.
TEST(Control, NoArmIsThrownAboutByTheTable) {
  constexpr int n = 100;
  const auto fastest_hand = [](const char* id, ArmControl control, unsigned batch) {
    const auto env = make_env_batch(id, n, {.control = control});
    std::vector<std::uint64_t> seeds(n);
    std::iota(seeds.begin(), seeds.end(), n * batch);
    env->reset({}, seeds);
    std::mt19937 random(batch);
    std::uniform_real_distribution<float> action(-1, 1);
    std::vector<float> actions(static_cast<std::size_t>(n * env->spec().action_dim));
    float fastest = 0;
    for (int step = 0; step < 50; ++step) {
      std::ranges::generate(actions, [&] { return action(random); });
      env->step(actions);
      for (std::size_t i = 0; i < n; ++i) {
        const float* row = &env->observation()[i * static_cast<std::size_t>(env->spec().observation_dim)];
        fastest = std::max(fastest, std::hypot(row[3], row[4], row[5]));
      }
    }
    return fastest;
  };
  for (const unsigned batch : {1U, 6U, 24U}) {
    EXPECT_LT(fastest_hand("PandaPush-v3", ArmControl::kEndEffector, batch), 4) << "m/s, of batch " << batch;
  }
  for (const unsigned batch : {8U, 17U, 22U, 23U, 24U}) {
    EXPECT_LT(fastest_hand("PandaPush-v3", ArmControl::kEndEffectorPose, batch), 4) << "m/s, of batch " << batch;
  }
  EXPECT_LT(fastest_hand("PandaReach-v3", ArmControl::kEndEffector, 55), 4) << "m/s";
}

TEST(Control, HasTheSizesItSays) {
  const auto size = [](const char* robot, const char* id, ArmControl control) {
    return make_env_batch(id, 1, {.arm = arm_spec(robot), .control = control})->spec().action_dim;
  };
  EXPECT_EQ(size("panda", "PandaReach-v3", ArmControl::kEndEffectorPose), 6);
  EXPECT_EQ(size("panda", "PandaFlip-v3", ArmControl::kImpedance), 7);
  EXPECT_EQ(size("panda", "PandaReach-v3", ArmControl::kJointVelocity), 7);
  EXPECT_EQ(size("arm6", "PandaStack-v3", ArmControl::kJointTorque), 7);
  EXPECT_EQ(size("arm6", "PandaPushJoints-v3", ArmControl::kEndEffector), 3);
  EXPECT_EQ(arm_control("impedance"), ArmControl::kImpedance);
  EXPECT_THROW((void)arm_control("magic"), std::invalid_argument);
}

}  // namespace
}  // namespace manyhands
