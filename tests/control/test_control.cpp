// Controllers against what inverse and forward dynamics say, and every width of lanes against scalar float.
#include <gtest/gtest.h>

#include <cstring>

#include "manyhands/control/batch_control.h"
#include "manyhands/control/joint_control.h"
#include "manyhands/control/sliding_control.h"
#include "manyhands/physics/dynamics/batch_dynamics.h"
#include "tests/physics/dynamics/random_tree.h"

namespace manyhands {
namespace {

using testing::Generator;

constexpr std::size_t kRows = 21;  // no multiple of any width

Model random_arm(std::uint64_t seed) { return testing::random_tree(seed, 9, testing::kSingleTypes); }

template <Real R>
std::vector<R> random_rows(Generator& rng, std::size_t numbers) {
  std::vector<R> rows;
  for (const double x : testing::random_numbers(numbers, rng)) rows.push_back(static_cast<R>(x));
  return rows;
}

/// States, desired motions and goals of a frame.
template <Real R>
struct Rows {
  Rows(const Model& model, std::uint64_t seed)
      : nv(static_cast<std::size_t>(model.nv())), frame(model.frames().size() - 1) {
    Generator rng(seed);
    for (std::vector<R>* rows : {&q, &v, &q_d, &v_d, &a_d, &integral, &posture})
      *rows = random_rows<R>(rng, kRows * nv);
    position = random_rows<R>(rng, kRows * 3);
    for (std::size_t i = 0; i < kRows; ++i) {
      const Quat<double> r = testing::random_rotation(rng);
      for (const double x : {r.x, r.y, r.z, r.w}) quaternion.push_back(static_cast<R>(x));
    }
    for (std::vector<R>* rows : {&velocity, &acceleration, &force}) *rows = random_rows<R>(rng, kRows * 6);
    for (std::vector<R>* gain : {&gains.kp, &gains.ki, &gains.kd, &gains.slope, &gains.robust, &gains.boundary}) {
      for (const double x : testing::random_numbers(nv, rng)) gain->push_back(static_cast<R>(2.5 + x));
    }
  }
  [[nodiscard]] typename BatchControl<R>::Tracked tracked() const { return {q, v, q_d, v_d, a_d}; }
  [[nodiscard]] typename BatchControl<R>::Goal goal() const {
    return {position, quaternion, velocity, acceleration, force};
  }

  std::size_t nv;
  FrameId frame;
  std::vector<R> q, v, q_d, v_d, a_d, integral, posture, position, quaternion, velocity, acceleration, force;
  typename BatchControl<R>::Gains gains;
};

const OperationalTask kTask{.directions = {TaskDirection::kFree, TaskDirection::kFree, TaskDirection::kMotion,
                                           TaskDirection::kMotion, TaskDirection::kMotion, TaskDirection::kForce}};

template <Real R>
std::vector<R> repeated(const std::vector<R>& row) {
  std::vector<R> rows;
  for (std::size_t i = 0; i < kRows; ++i) rows.insert(rows.end(), row.begin(), row.end());
  return rows;
}

/// What every controller asks of the joints, by name.
template <Real R>
std::vector<std::pair<std::string, std::vector<R>>> run_all(const Model& model, const Rows<R>& r, int width) {
  BatchControl<R> control(model, width);
  const std::size_t n = kRows;
  const std::vector<R> rate(kBodyParameters, R(0.3));
  std::vector<R> gravity(n * r.nv), pd(gravity), feedforward(gravity), computed(gravity), sliding(gravity),
      adaptive(gravity), impedance(gravity), operational(gravity), alone(gravity);
  std::vector<R> theta = repeated(control.body_parameters());
  control.gravity_torque(n, r.q, gravity);
  control.pd_gravity(n, r.gains, r.tracked(), pd);
  control.pd_feedforward(n, r.gains, r.tracked(), feedforward);
  control.computed_torque(n, r.gains, r.tracked(), r.integral, computed);
  control.sliding_mode(n, r.gains, r.tracked(), sliding);
  control.adaptive(n, r.gains, rate, R(0.01), r.tracked(), theta, adaptive);
  control.impedance(n, r.frame, {}, r.q, r.v, r.position, r.quaternion, impedance);
  control.operational_space(n, r.frame, kTask, r.q, r.v, r.goal(), r.posture, operational);
  control.operational_space(n, r.frame, kTask, r.q, r.v, r.goal(), {}, alone);
  return {{"gravity", gravity},      {"pd_gravity", pd},       {"pd_feedforward", feedforward},
          {"computed", computed},    {"sliding", sliding},     {"adaptive", adaptive},
          {"theta", theta},          {"impedance", impedance}, {"operational", operational},
          {"without posture", alone}};
}

TEST(BatchControl, EveryWidthGivesTheBitsOfScalarFloat) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Model model = random_arm(seed);
    if (model.nv() == 0) continue;
    const Rows<float> rows(model, seed);
    const auto scalar = run_all(model, rows, 1);
    for (const int width : {4, 8, 16}) {
      const auto lanes = run_all(model, rows, width);
      for (std::size_t i = 0; i < scalar.size(); ++i) {
        const std::vector<float>&x = scalar[i].second, &y = lanes[i].second;
        ASSERT_EQ(std::memcmp(x.data(), y.data(), x.size() * sizeof(float)), 0)
            << scalar[i].first << ", tree " << seed << ", width " << width;
      }
    }
  }
}

TEST(BatchControl, ComputedTorqueMakesEveryJointALinearSystem) {
  const Model model = random_arm(3);
  const Rows<double> r(model, 3);
  BatchControl<double> control(model);
  BatchDynamics<double> dynamics(model);
  std::vector<double> tau(kRows * r.nv), a(tau);
  control.computed_torque(kRows, r.gains, r.tracked(), r.integral, tau);
  dynamics.aba(kRows, r.q, r.v, tau, a);
  for (std::size_t i = 0; i < a.size(); ++i) {
    const std::size_t k = i % r.nv;
    const double wanted = r.a_d[i] + r.gains.kp[k] * (r.q_d[i] - r.q[i]) + r.gains.kd[k] * (r.v_d[i] - r.v[i]) +
                          r.gains.ki[k] * r.integral[i];
    EXPECT_NEAR(a[i], wanted, 1e-9 * (1 + std::abs(wanted)));
  }
}

TEST(BatchControl, FeedforwardAndGravityAreInverseDynamics) {
  const Model model = random_arm(4);
  Rows<double> r(model, 4);
  r.gains.kp.assign(r.nv, 0);
  r.gains.kd.assign(r.nv, 0);
  BatchControl<double> control(model);
  BatchDynamics<double> dynamics(model);
  const std::vector<double> rest(kRows * r.nv, 0.0);
  std::vector<double> found(rest), expected(rest);
  control.pd_feedforward(kRows, r.gains, r.tracked(), found);
  dynamics.rnea(kRows, r.q_d, r.v_d, r.a_d, expected);
  EXPECT_EQ(found, expected);
  control.pd_gravity(kRows, r.gains, r.tracked(), found);
  dynamics.rnea(kRows, r.q, rest, rest, expected);
  EXPECT_EQ(found, expected);
}

/// With slope 0 the reference velocity is v_d: M a_d + C(q, v) v_d + g + kd (v_d - v).
std::vector<double> reference_force_of(BatchControl<double>& control, const Rows<double>& r,
                                       const std::vector<double>& v, const std::vector<double>& v_r,
                                       const std::vector<double>& a_r) {
  typename BatchControl<double>::Gains gains;
  const std::vector<double> none(r.nv, 0.0), one(r.nv, 1.0);
  gains.slope = gains.kd = gains.robust = none;
  gains.boundary = one;
  std::vector<double> tau(kRows * r.nv);
  control.sliding_mode(kRows, gains, {r.q, v, r.q, v_r, a_r}, tau);
  return tau;
}

TEST(BatchControl, TheReferenceForceIsThatOfRneaAndItsCoriolisMatrixIsSkew) {
  const Model model = random_arm(5);
  const Rows<double> r(model, 5);
  BatchControl<double> control(model);
  BatchDynamics<double> dynamics(model);
  const std::vector<double> rest(kRows * r.nv, 0.0);
  std::vector<double> expected(rest), M_before(kRows * r.nv * r.nv), M_after(M_before), moved(r.q);
  dynamics.rnea(kRows, r.q, r.v, r.a_d, expected);
  const std::vector<double> found = reference_force_of(control, r, r.v, r.v, r.a_d);
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-10 * (1 + std::abs(found[i])));

  // x . (dM/dt - 2 C) x = 0 for any x, with dM/dt by differences along v.
  const double h = 1e-6;
  for (std::size_t i = 0; i < moved.size(); ++i) moved[i] = r.q[i] - h * r.v[i];
  dynamics.crba(kRows, moved, M_before);
  for (std::size_t i = 0; i < moved.size(); ++i) moved[i] = r.q[i] + h * r.v[i];
  dynamics.crba(kRows, moved, M_after);
  const std::vector<double> gravity = reference_force_of(control, r, r.v, rest, rest);
  const std::vector<double> coriolis = reference_force_of(control, r, r.v, r.v_d, rest);
  for (std::size_t row = 0; row < kRows; ++row) {
    double skew = 0, scale = 1;
    for (std::size_t i = 0; i < r.nv; ++i) {
      const double x = r.v_d[row * r.nv + i];
      for (std::size_t j = 0; j < r.nv; ++j) {
        const std::size_t at = (row * r.nv + i) * r.nv + j;
        skew += x * (M_after[at] - M_before[at]) / (2 * h) * r.v_d[row * r.nv + j];
      }
      const double force = coriolis[row * r.nv + i] - gravity[row * r.nv + i];
      skew -= 2 * x * force;
      scale += std::abs(x * force);
    }
    EXPECT_NEAR(skew, 0, 1e-6 * scale);
  }
}

TEST(BatchControl, AdaptiveControlDescendsWhereItsEstimateIsWrong) {
  const Model model = random_arm(6);
  const Rows<double> r(model, 6);
  BatchControl<double> control(model);
  typename BatchControl<double>::Gains gains = r.gains;
  gains.robust.assign(r.nv, 0);
  const std::vector<double> truth = repeated(control.body_parameters()), still(kBodyParameters, 0.0);
  std::vector<double> theta = truth, tau(kRows * r.nv), known(tau);
  control.adaptive(kRows, gains, still, 0.01, r.tracked(), theta, tau);
  control.sliding_mode(kRows, gains, r.tracked(), known);
  EXPECT_EQ(theta, truth);
  for (std::size_t i = 0; i < tau.size(); ++i) EXPECT_NEAR(tau[i], known[i], 1e-10 * (1 + std::abs(known[i])));

  // d theta/dt = Y^T s: a change of theta by x changes s . tau by x . d theta/dt, as tau is linear in theta.
  const std::vector<double> unit(kBodyParameters, 1.0);
  std::vector<double> learned = truth, ignored(tau);
  control.adaptive(kRows, gains, unit, 1.0, r.tracked(), learned, ignored);
  Generator rng(6);
  std::vector<double> change = random_rows<double>(rng, truth.size()), other = truth;
  for (std::size_t i = 0; i < other.size(); ++i) other[i] += change[i];
  std::vector<double> tau_other(tau);
  control.adaptive(kRows, gains, still, 0.01, r.tracked(), other, tau_other);
  const std::size_t numbers = control.bodies() * kBodyParameters;
  for (std::size_t row = 0; row < kRows; ++row) {
    double power = 0, slope = 0;
    for (std::size_t i = row * r.nv; i < (row + 1) * r.nv; ++i) {
      const double s = r.v_d[i] - r.v[i] + gains.slope[i % r.nv] * (r.q_d[i] - r.q[i]);
      power += s * (tau_other[i] - tau[i]);
    }
    for (std::size_t i = row * numbers; i < (row + 1) * numbers; ++i) slope += change[i] * (learned[i] - truth[i]);
    EXPECT_NEAR(power, slope, 1e-9 * (1 + std::abs(power)));
  }
}

/// The acceleration of the frame (n, 6) under joint forces.
std::vector<double> frame_acceleration(const Model& model, const Rows<double>& r, const std::vector<double>& tau) {
  BatchDynamics<double> dynamics(model);
  std::vector<double> a(tau), J(kRows * 6 * r.nv), dJ(J), found(kRows * 6, 0.0);
  dynamics.aba(kRows, r.q, r.v, tau, a);
  dynamics.jacobian(kRows, r.q, r.frame, J);
  dynamics.jacobian_derivative(kRows, r.q, r.v, r.frame, dJ);
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (std::size_t k = 0; k < r.nv; ++k) {
      const std::size_t column = (i / 6) * r.nv + k;
      found[i] += J[i * r.nv + k] * a[column] + dJ[i * r.nv + k] * r.v[column];
    }
  }
  return found;
}

/// Seven revolute joints about changing axes: a frame that can move in all directions.
Model seven_joints() {
  ModelBuilder builder("seven joints");
  Generator rng(7);
  LinkId last = builder.world();
  for (int i = 0; i < 7; ++i) {
    const LinkId link = builder.add_link("link" + std::to_string(i), testing::random_inertial(rng));
    builder.add_joint({.name = "joint" + std::to_string(i),
                       .type = JointType::kRevolute,
                       .parent = last,
                       .child = link,
                       .X_PF = {to_matrix(testing::random_rotation(rng)), {0.1, 0.2, 0.3}},
                       .axis = {0, 0, 1}});
    last = link;
  }
  return builder.build();
}

TEST(BatchControl, OperationalSpaceGivesTheFrameTheAccelerationThatIsAskedFor) {
  const Model model = seven_joints();
  const Rows<double> r(model, 8);
  BatchControl<double> control(model);
  OperationalTask task;  // all six directions move
  task.kp = task.kd = task.rotational_kp = task.rotational_kd = 0;
  task.regularisation = 0;
  std::vector<double> tau(kRows * r.nv);
  control.operational_space(kRows, r.frame, task, r.q, r.v, r.goal(), r.posture, tau);
  const std::vector<double> found = frame_acceleration(model, r, tau);
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], r.acceleration[i], 1e-7);
}

TEST(BatchControl, TheSecondTaskMovesNeitherMotionNorForceDirections) {
  const Model model = seven_joints();
  const Rows<double> r(model, 9);
  BatchControl<double> control(model);
  OperationalTask task = kTask;
  task.regularisation = 0;
  std::vector<double> with(kRows * r.nv), without(with);
  control.operational_space(kRows, r.frame, task, r.q, r.v, r.goal(), r.posture, with);
  control.operational_space(kRows, r.frame, task, r.q, r.v, r.goal(), {}, without);
  EXPECT_NE(with, without);
  const std::vector<double> a = frame_acceleration(model, r, with), b = frame_acceleration(model, r, without);
  for (std::size_t row = 0; row < kRows; ++row) {
    const double* x = &r.quaternion[4 * row];
    const Mat3<double> R = to_matrix(Quat<double>{x[0], x[1], x[2], x[3]});
    const auto change = [&](std::size_t k) { return a[6 * row + k] - b[6 * row + k]; };
    const Vec3<double> w = transpose_times(R, Vec3<double>{change(0), change(1), change(2)});
    const Vec3<double> v = transpose_times(R, Vec3<double>{change(3), change(4), change(5)});
    EXPECT_NEAR(w.z, 0, 1e-8);  // the directions of kTask that are held
    EXPECT_NEAR(norm(v), 0, 1e-8);
  }
}

TEST(BatchControl, AForceDirectionIsJTransposeF) {
  const Model model = seven_joints();
  Rows<double> r(model, 10);
  r.v.assign(r.v.size(), 0.0);
  BatchControl<double> control(model);
  BatchDynamics<double> dynamics(model);
  OperationalTask task;
  task.directions.fill(TaskDirection::kForce);
  std::vector<double> tau(kRows * r.nv), gravity(tau), J(kRows * 6 * r.nv);
  control.operational_space(kRows, r.frame, task, r.q, r.v, r.goal(), {}, tau);
  control.gravity_torque(kRows, r.q, gravity);
  dynamics.jacobian(kRows, r.q, r.frame, J);
  for (std::size_t row = 0; row < kRows; ++row) {
    const double *x = &r.quaternion[4 * row], *f = &r.force[6 * row];
    const Mat3<double> R = to_matrix(Quat<double>{x[0], x[1], x[2], x[3]});
    const Vec3<double> moment = R * Vec3<double>{f[0], f[1], f[2]}, force = R * Vec3<double>{f[3], f[4], f[5]};
    const std::array<double, 6> F{moment.x, moment.y, moment.z, force.x, force.y, force.z};
    for (std::size_t k = 0; k < r.nv; ++k) {
      double expected = gravity[row * r.nv + k];
      for (std::size_t i = 0; i < 6; ++i) expected += J[(row * 6 + i) * r.nv + k] * F[i];
      EXPECT_NEAR(tau[row * r.nv + k], expected, 1e-10);
    }
  }
}

TEST(BatchControl, ABadRowSpoilsOnlyItself) {
  const Model model = random_arm(11);
  const Rows<float> good(model, 11);
  Rows<float> bad = good;
  bad.q[5 * bad.nv] = std::numeric_limits<float>::quiet_NaN();
  const auto expected = run_all(model, good, 0), found = run_all(model, bad, 0);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const std::size_t columns = expected[i].second.size() / kRows;
    for (std::size_t k = 0; k < expected[i].second.size(); ++k) {
      if (k / columns == 5) continue;
      ASSERT_EQ(found[i].second[k], expected[i].second[k]) << expected[i].first;
    }
  }
}

TEST(BatchControl, NonsenseIsRefused) {
  const Model model = seven_joints();
  const Rows<double> r(model, 12);
  BatchControl<double> control(model);
  std::vector<double> tau(kRows * r.nv), few(3);
  EXPECT_THROW(control.gravity_torque(kRows, few, tau), std::invalid_argument);
  EXPECT_THROW(control.pd_gravity(kRows, {}, r.tracked(), tau), std::invalid_argument);
  EXPECT_THROW(control.impedance(kRows, FrameId(999), {}, r.q, r.v, r.position, r.quaternion, tau),
               std::invalid_argument);
  EXPECT_THROW(BatchControl<double>(model, 4), std::invalid_argument);
  const Model floating = testing::random_tree(1, 12);
  EXPECT_THROW(BatchControl<double>{floating}, ModelError);
}

}  // namespace
}  // namespace manyhands
