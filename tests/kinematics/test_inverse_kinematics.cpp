#include <gtest/gtest.h>

#include <bit>

#include "manyhands/math/instantiate.h"
#include "tests/kinematics/placed_panda.h"
#include "tests/physics/dynamics/random_tree.h"

namespace manyhands {
namespace {

using testing::Generator;

using Panda = testing::PlacedPanda<double>;

constexpr std::size_t kJoints = 9;  // of the arm and its fingers

const Mat3<double> kDown{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}};  // the hand as panda-gym holds it

/// Joint angles that panda-gym 3.0.7 (PyBullet's solver) finds from the neutral pose for the hand moved by 5 cm.
TEST(InverseKinematics, FollowsPandaGym) {
  struct Case {
    Vec3<double> step;
    std::array<double, 7> q;
  };
  const std::array<Case, 4> cases{{
      {{0.05, 0, 0}, {-.00060, .50923, .00070, -1.69633, -.00042, 2.20993, .78566}},
      {{0, 0.05, 0}, {.05848, .41371, .02124, -1.84447, -.01091, 2.25825, .87019}},
      {{0, 0, 0.05}, {-.00057, .33965, .00064, -1.82050, -.00026, 2.16091, .78558}},
      {{0, 0, 0}, {.00069, .41, .00079, -1.85, -.00082, 2.26, .78822}},
  }};
  Panda panda;
  for (const Case& c : cases) {
    std::vector<double> q = panda.robot.arm.neutral;
    const Transform<double> start = panda.pose(panda.robot.arm.chain, q.data());
    improve_ik(panda.tree, panda.params, panda.robot.arm.chain, panda.robot.arm.ik, {kDown, start.p + c.step}, q.data(),
               panda.ws);
    for (std::size_t i = 0; i < 7; ++i)
      EXPECT_NEAR(q[i], c.q[i], 1e-5) << "step " << c.step.x << ' ' << c.step.y << ' ' << c.step.z << ", joint " << i;
    if (c.step.x <= 0) continue;
    EXPECT_NEAR(panda.pose(panda.robot.arm.chain, q.data()).p.x - start.p.x, 0.05 - 0.0153, 1e-4)
        << "how far it falls short";
  }
}

/// The number panda-gym's own tests hold, for the frame of its link 6 from the pose of zeros.
TEST(InverseKinematics, FollowsPandaGymFarAway) {
  Panda panda;
  const IkChain chain(panda.robot.model, panda.robot.model.frame_id("panda_link7"));
  std::vector<double> q(kJoints, 0.0);
  const Quat<double> r = normalized(Quat<double>{0.707, -0.02, 0.02, 0.707});
  improve_ik(panda.tree, panda.params, chain, panda.robot.arm.ik, {to_matrix(r), {0.4 - 0.6, 0.5, 0.6}}, q.data(),
             panda.ws);
  constexpr std::array<double, 9> kExpected{1.000, 1.223, -1.113, -0.021, -0.917, 0.666, -0.499, 0, 0};
  for (std::size_t i = 0; i < q.size(); ++i) EXPECT_NEAR(q[i], kExpected[i], 1e-3) << i;
}

/// Near a solution the damping vanishes with the square of the error: Newton's method, error squared at each step.
TEST(InverseKinematics, ConvergesQuadratically) {
  Panda panda;
  std::vector<double> q = panda.robot.arm.neutral;
  std::vector<double> there = q;
  for (std::size_t i = 0; i < 7; ++i) there[i] += 0.02 * (i % 2 == 0 ? 1 : -1);
  const Transform<double> target = panda.pose(panda.robot.arm.chain, there.data());
  double before = 1;
  for (int step = 0; step < 4; ++step) {
    const IkSettings once{.max_iterations = 1, .damping = 0, .error_damping = 0.1};
    const IkResult<double> result =
        solve_ik(panda.tree, panda.params, panda.robot.arm.chain, once, target, q.data(), panda.ws);
    const double error = std::hypot(result.position_error, result.rotation_error);
    EXPECT_LE(error, std::max(10 * before * before, 1e-14)) << "step " << step;
    before = error;
  }
  EXPECT_LT(before, 1e-12);
}

template <class T>
class IkLanes : public ::testing::Test {};
using LaneTypes = ::testing::Types<Lanes4, Lanes8, Lanes16>;
TYPED_TEST_SUITE(IkLanes, LaneTypes);

/// Lanes stop after different numbers of iterations; each has the bits of the scalar that ran alone.
TYPED_TEST(IkLanes, EqualTheScalarBitForBit) {
  using T = TypeParam;
  Panda panda;
  const Tree<float> tree(panda.robot.model);
  const ParamsStorage<float> params(panda.robot.model);
  const auto n = static_cast<std::size_t>(width_v<T>);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Generator rng(seed);
    std::vector<T> q(kJoints);
    std::vector<std::vector<float>> starts(n, std::vector<float>(kJoints));
    std::vector<Transform<float>> goals;
    Transform<T> targets = Transform<T>::identity();
    for (std::size_t k = 0; k < n; ++k) {
      std::vector<double> there(kJoints, 0.0);
      for (std::size_t i = 0; i < 7; ++i) {
        there[i] = testing::uniform(rng, panda.params.lower[i], panda.params.upper[i]);
        starts[k][i] = static_cast<float>(
            k % 3 == 0 ? there[i] + 0.01 : testing::uniform(rng, panda.params.lower[i], panda.params.upper[i]));
        set_lane(q[i], static_cast<int>(k), starts[k][i]);
      }
      goals.push_back(broadcast<float>(panda.pose(panda.robot.arm.chain, there.data())));
      const auto set = [k](Vec3<T>& to, const Vec3<float>& from) {
        set_lane(to.x, static_cast<int>(k), from.x);
        set_lane(to.y, static_cast<int>(k), from.y);
        set_lane(to.z, static_cast<int>(k), from.z);
      };
      set(targets.R.x, goals[k].R.x);
      set(targets.R.y, goals[k].R.y);
      set(targets.R.z, goals[k].R.z);
      set(targets.p, goals[k].p);
      for (std::size_t i = 7; i < 9; ++i) set_lane(q[i], static_cast<int>(k), 0.0f);
    }
    Workspace<T> ws(tree);
    Workspace<float> scalar_ws(tree);
    const IkSettings settings;
    const IkResult<T> found = solve_ik(tree, params, panda.robot.arm.chain, settings, targets, q.data(), ws);
    for (std::size_t k = 0; k < n; ++k) {
      std::vector<float> alone = starts[k];
      const IkResult<float> result =
          solve_ik(tree, params, panda.robot.arm.chain, settings, goals[k], alone.data(), scalar_ws);
      EXPECT_EQ(lane(found.success, static_cast<int>(k)), result.success);
      EXPECT_EQ(lane(found.position_error, static_cast<int>(k)), result.position_error);
      EXPECT_EQ(lane(found.rotation_error, static_cast<int>(k)), result.rotation_error);
      for (std::size_t i = 0; i < alone.size(); ++i) {
        ASSERT_EQ(std::bit_cast<std::uint32_t>(lane(q[i], static_cast<int>(k))), std::bit_cast<std::uint32_t>(alone[i]))
            << "seed " << seed << ", lane " << k << ", joint " << i;
      }
    }
  }
}

TEST(InverseKinematics, RefusesWhatItCannotMove) {
  ModelBuilder builder("ball");
  const LinkId ball = builder.add_link("ball", {.mass = 1, .inertia = {1, 1, 1, 0, 0, 0}});
  builder.add_joint({.name = "socket", .type = JointType::kSpherical, .parent = builder.world(), .child = ball});
  const LinkId table = builder.add_link("table");
  builder.add_joint({.name = "feet", .type = JointType::kFixed, .parent = builder.world(), .child = table});
  const Model model = builder.build();
  try {
    (void)IkChain(model, model.frame_id("ball"));
    FAIL();
  } catch (const ModelError& error) {
    for (const char* part : {"'ball'", "'socket'", "spherical"})
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
  try {
    (void)IkChain(model, model.frame_id("table"));
    FAIL();
  } catch (const ModelError& error) {
    EXPECT_NE(std::string(error.what()).find("'table'"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace manyhands
