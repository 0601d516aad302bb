#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "manyhands/physics/dynamics/batch_dynamics.h"
#include "tests/physics/dynamics/random_tree.h"

namespace manyhands {
namespace {

using testing::Generator;
using testing::random_tree;

constexpr std::size_t kRows = 21;  // no multiple of any width: every last block is padded

template <Real R>
struct States {
  std::vector<R> q, v, a;
};

template <Real R>
States<R> random_states(const Model& model, std::uint64_t seed) {
  Generator rng(seed);
  States<R> s;
  const auto append = [](std::vector<R>& to, const std::vector<double>& from) {
    for (const double x : from) to.push_back(static_cast<R>(x));
  };
  for (std::size_t k = 0; k < kRows; ++k) {
    append(s.q, testing::random_configuration(model, rng));
    append(s.v, testing::random_numbers(static_cast<std::size_t>(model.nv()), rng));
    append(s.a, testing::random_numbers(static_cast<std::size_t>(model.nv()), rng));
  }
  return s;
}

/// The results of every algorithm, by name.
template <Real R>
std::vector<std::pair<std::string, std::vector<R>>> run_all(const Model& model, const States<R>& s, int width) {
  const std::size_t n = kRows, nv = static_cast<std::size_t>(model.nv()), nf = model.frames().size();
  BatchDynamics<R> dynamics(model, width);
  std::vector<R> tau(n * nv), a(n * nv), M(n * nv * nv), p(n * 3), r(n * 4), all_p(n * nf * 3), all_r(n * nf * 4),
      J(n * 6 * nv), J_space(J), J_body(J), dJ(J), dJ_space(J), dJ_body(J), com(n * 3), h(n * 6), kinetic(n),
      potential(n);
  const FrameId last(nf - 1);
  dynamics.rnea(n, s.q, s.v, s.a, tau);
  dynamics.aba(n, s.q, s.v, s.a, a);
  dynamics.crba(n, s.q, M);
  dynamics.frame_pose(n, s.q, last, p, r);
  dynamics.forward_kinematics(n, s.q, all_p, all_r);
  dynamics.jacobian(n, s.q, last, J);
  dynamics.jacobian(n, s.q, last, J_space, JacobianForm::kSpace);
  dynamics.jacobian(n, s.q, last, J_body, JacobianForm::kBody);
  dynamics.jacobian_derivative(n, s.q, s.v, last, dJ);
  dynamics.jacobian_derivative(n, s.q, s.v, last, dJ_space, JacobianForm::kSpace);
  dynamics.jacobian_derivative(n, s.q, s.v, last, dJ_body, JacobianForm::kBody);
  dynamics.center_of_mass(n, s.q, com);
  dynamics.momentum(n, s.q, s.v, h);
  dynamics.energy(n, s.q, s.v, kinetic, potential);
  return {{"rnea", tau},
          {"aba", a},
          {"crba", M},
          {"position", p},
          {"quaternion", r},
          {"positions", all_p},
          {"quaternions", all_r},
          {"jacobian", J},
          {"com", com},
          {"space jacobian", J_space},
          {"body jacobian", J_body},
          {"jacobian derivative", dJ},
          {"space jacobian derivative", dJ_space},
          {"body jacobian derivative", dJ_body},
          {"momentum", h},
          {"kinetic", kinetic},
          {"potential", potential}};
}

TEST(BatchDynamics, EveryWidthGivesTheBitsOfScalarFloat) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const Model model = random_tree(seed, 12);
    const States<float> states = random_states<float>(model, seed);
    const auto scalar = run_all(model, states, 1);
    for (const int width : {4, 8, 16}) {
      const auto lanes = run_all(model, states, width);
      for (std::size_t i = 0; i < scalar.size(); ++i) {
        const std::vector<float>&x = scalar[i].second, &y = lanes[i].second;
        ASSERT_EQ(std::memcmp(x.data(), y.data(), x.size() * sizeof(float)), 0)
            << scalar[i].first << ", tree " << seed << ", width " << width;
      }
    }
  }
}

TEST(BatchDynamics, FloatFollowsDouble) {
  double worst = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const Model model = random_tree(seed, 12);
    const auto reference = run_all(model, random_states<double>(model, seed), 0);
    const auto single = run_all(model, random_states<float>(model, seed), 0);
    for (std::size_t i = 0; i < reference.size(); ++i) {
      // A quaternion's sign is free where w is nearly 0; poses are compared by position, axes by the Jacobian.
      if (reference[i].first.starts_with("quaternion")) continue;
      double scale = 1, error = 0;
      for (std::size_t k = 0; k < reference[i].second.size(); ++k) {
        scale = std::max(scale, std::abs(reference[i].second[k]));
        error = std::max(error, std::abs(reference[i].second[k] - static_cast<double>(single[i].second[k])));
      }
      // Float carries 6e-8; accelerations lose what the mass matrix is ill-conditioned by.
      EXPECT_LT(error / scale, reference[i].first == "aba" ? 3e-3 : 2e-5) << reference[i].first << ", tree " << seed;
      worst = std::max(worst, error / scale);
    }
  }
  RecordProperty("worst_relative_error", std::to_string(worst));
}

TEST(BatchDynamics, ForwardAndInverseDynamicsAgreeWithTheMassMatrix) {
  for (std::uint64_t seed = 100; seed < 140; ++seed) {
    const Model model = random_tree(seed, 12);
    const auto nv = static_cast<std::size_t>(model.nv());
    const States<double> s = random_states<double>(model, seed);
    BatchDynamics<double> dynamics(model);
    std::vector<double> tau(kRows * nv), bias(kRows * nv), back(kRows * nv), M(kRows * nv * nv);
    dynamics.rnea(kRows, s.q, s.v, s.a, tau);
    dynamics.rnea(kRows, s.q, s.v, std::vector<double>(kRows * nv, 0.0), bias);
    dynamics.aba(kRows, s.q, s.v, tau, back);
    dynamics.crba(kRows, s.q, M);
    for (std::size_t row = 0; row < kRows; ++row) {
      for (std::size_t i = 0; i < nv; ++i) {
        double product = bias[row * nv + i], scale = 1;
        for (std::size_t j = 0; j < nv; ++j) {
          product += M[row * nv * nv + i * nv + j] * s.a[row * nv + j];
          scale = std::max(scale, std::abs(tau[row * nv + j]));
        }
        EXPECT_NEAR(product, tau[row * nv + i], 1e-12 * scale);
        EXPECT_NEAR(back[row * nv + i], s.a[row * nv + i], 1e-9);
      }
    }
  }
}

TEST(BatchDynamics, ABadRowSpoilsOnlyItself) {
  const Model model = random_tree(5, 10);
  const States<float> good = random_states<float>(model, 5);
  States<float> bad = good;
  const auto nq = static_cast<std::size_t>(model.nq());
  constexpr std::size_t kBad = 6;
  for (std::size_t i = 0; i < nq; ++i) bad.q[kBad * nq + i] = std::numeric_limits<float>::quiet_NaN();
  const auto expected = run_all(model, good, 0), found = run_all(model, bad, 0);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const std::size_t columns = expected[i].second.size() / kRows;
    bool spoiled = false;
    for (std::size_t k = 0; k < expected[i].second.size(); ++k) {
      if (k / columns == kBad) {
        spoiled = spoiled || std::isnan(found[i].second[k]);
      } else {
        ASSERT_EQ(found[i].second[k], expected[i].second[k]) << expected[i].first << ", row " << k / columns;
      }
    }
    EXPECT_TRUE(spoiled) << expected[i].first;
  }
}

TEST(BatchDynamics, AxesNearMinusZKeepFramesOrthonormal) {
  for (const double tilt : {0.0, 1e-9, 1e-5, 1e-4, 1.3e-3, 1.5e-3, 1e-2, 0.1, 1.0, 3.0}) {
    ModelBuilder builder;
    const LinkId link = builder.add_link("link", {.mass = 1, .inertia = {1, 1, 1, 0, 0, 0}});
    const Vec3<double> axis{0.6 * std::sin(tilt), 0.8 * std::sin(tilt), -std::cos(tilt)};
    builder.add_joint(
        {.name = "joint", .type = JointType::kContinuous, .parent = builder.world(), .child = link, .axis = axis});
    const Mat3<double> R = builder.build().bodies()[1].X_PF.R;
    EXPECT_NEAR(norm(R.z - axis), 0, 1e-15) << tilt;
    const Mat3<double> square = transpose(R) * R;
    for (const Vec3<double>& error :
         {square.x - Vec3<double>{1, 0, 0}, square.y - Vec3<double>{0, 1, 0}, square.z - Vec3<double>{0, 0, 1}}) {
      EXPECT_NEAR(norm(error), 0, 1e-15) << tilt;
    }
  }
}

TEST(BatchDynamics, RefusesWrongLengthsAndWidths) {
  const Model model = random_tree(1, 6);
  EXPECT_THROW(BatchDynamics<float>(model, 3), std::invalid_argument);
  EXPECT_THROW(BatchDynamics<double>(model, 4), std::invalid_argument);
  BatchDynamics<double> dynamics(model);
  const std::vector<double> q(static_cast<std::size_t>(model.nq()) * 2, 0.0);
  std::vector<double> com(3), position(3), quaternion(4);
  try {
    dynamics.center_of_mass(1, q, com);
    FAIL() << "two rows were taken for one";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("q holds"), std::string::npos) << error.what();
  }
  const std::span one_row = std::span(q).first(q.size() / 2);
  EXPECT_THROW(dynamics.frame_pose(1, one_row, FrameId(1000), position, quaternion), std::invalid_argument);
}

}  // namespace
}  // namespace manyhands
