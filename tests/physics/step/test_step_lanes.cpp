// Whole steps in lanes give, lane by lane, the bits of the scalar float: random trees with every type of joint, motors
// and limits of every kind, every lane in a state of its own.
#include <gtest/gtest.h>

#include <bit>

#include "manyhands/math/instantiate.h"
#include "manyhands/physics/step/step.h"
#include "tests/physics/contact/joint_problem.h"

namespace manyhands {
namespace {

using testing::Generator;
using testing::JointProblem;

constexpr int kLanes = 16;  // of the widest type
constexpr int kSteps = 200;

/// One tree, and for each lane a state and parameters of its own.
struct Worlds {
  explicit Worlds(std::uint64_t seed) : first(seed, 2 + static_cast<int>(seed % 7)) {
    first.h = 0.001f;
    for (int k = 0; k < kLanes; ++k) {
      all.emplace_back(first.model, seed + 1000 * static_cast<std::uint64_t>(k));
      all.back().h = 0.001f;
      all.back().tree.dof_limited.assign(first.size(), true);  // uniform; where there is none it is infinite
      all.back().tree.dof_stops.assign(first.size(), true);
      for (std::size_t i = 0; i < first.size(); ++i) {
        all.back().tree.dof_limited[i] = all.back().tree.dof_stops[i] = first.tree.dof_q[i] >= 0;
        all.back().state.v()[i] *= 0.2f;
        all.back().state.tau()[i] *= 0.1f;
      }
    }
  }

  JointProblem<float> first;
  std::vector<JointProblem<float>> all;
};

template <Number T>
void copy_params(const Params<float>& from, Params<T>& to, int k) {
  const auto copy = [k](const Field<float>& a, Field<T>& b) {
    for (std::size_t i = 0; i < a.size(); ++i) set_lane(b[i], k, a[i]);
  };
  copy(from.damping, to.damping);
  copy(from.armature, to.armature);
  copy(from.lower, to.lower);
  copy(from.upper, to.upper);
  copy(from.motor_kp, to.motor_kp);
  copy(from.motor_kd, to.motor_kd);
  copy(from.motor_max_force, to.motor_max_force);
}

template <Number T>
void put(const JointProblem<float>& world, int k, State<T>& state, Params<T>& params) {
  for (std::size_t i = 0; i < state.numbers().size(); ++i) set_lane(state.numbers()[i], k, world.state.numbers()[i]);
  copy_params(world.params, params, k);
}

std::vector<std::uint32_t> bits_of_lane(const auto& state, int k) {
  std::vector<std::uint32_t> bits;
  for (const auto& x : state.numbers()) bits.push_back(std::bit_cast<std::uint32_t>(static_cast<float>(lane(x, k))));
  return bits;
}

/// The bits of the state after every 20 steps.
std::vector<std::vector<std::uint32_t>> scalar_run(const JointProblem<float>& world) {
  StateStorage<float> state = world.state;
  const System<float> system(world.tree);
  StepWorkspace<float> ws(system);
  std::vector<std::vector<std::uint32_t>> trace;
  for (int step = 1; step <= kSteps; ++step) {
    manyhands::step(system, world.params, world.h, state, ws);
    if (step % 20 == 0) trace.push_back(bits_of_lane(state, 0));
  }
  return trace;
}

template <class T>
class StepLanes : public ::testing::Test {};
using LaneTypes = ::testing::Types<Lanes4, Lanes8, Lanes16>;
TYPED_TEST_SUITE(StepLanes, LaneTypes);

/// A state that has blown up has no bits to compare: which numbers a NaN reaches is open.
bool is_alive(const std::vector<std::uint32_t>& bits) {
  return std::ranges::all_of(bits, [](std::uint32_t b) { return is_finite(std::bit_cast<float>(b)); });
}

TYPED_TEST(StepLanes, EqualTheScalarBitForBit) {
  using T = TypeParam;
  int compared = 0, dead = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const Worlds worlds(seed);
    const System<float> system(worlds.all[0].tree);
    StateStorage<T> state(worlds.first.model, 0);
    ParamsStorage<T> params(worlds.first.model);
    for (int k = 0; k < width_v<T>; ++k) put(worlds.all[static_cast<std::size_t>(k)], k, state, params);
    StepWorkspace<T> ws(system);
    std::vector<std::vector<std::vector<std::uint32_t>>> expected;
    for (int k = 0; k < width_v<T>; ++k) expected.push_back(scalar_run(worlds.all[static_cast<std::size_t>(k)]));
    for (int step = 1; step <= kSteps; ++step) {
      manyhands::step(system, params, worlds.first.h, state, ws);
      if (step % 20 != 0) continue;
      for (int k = 0; k < width_v<T>; ++k) {
        const std::vector<std::uint32_t> found = bits_of_lane(state, k),
                                         alone = expected[static_cast<std::size_t>(k)]
                                                         [static_cast<std::size_t>(step / 20 - 1)];
        const std::string which = "seed " + std::to_string(seed) + ", lane " + std::to_string(k) + ", step " +
                                  std::to_string(step) + ", nv " + std::to_string(system.tree.nv);
        ASSERT_EQ(is_alive(found), is_alive(alone)) << which;
        if (is_alive(alone)) {
          ASSERT_EQ(found, alone) << which;
          ++compared;
        } else {
          ++dead;
        }
      }
    }
  }
  EXPECT_LE(dead, compared / 20);
}

/// Each world in the company of copies of itself, of strangers, and of worlds of NaN.
TYPED_TEST(StepLanes, DoNotSeeOneAnother) {
  using T = TypeParam;
  for (std::uint64_t seed = 100; seed < 106; ++seed) {
    const Worlds worlds(seed);
    const System<float> system(worlds.all[0].tree);
    const int place = static_cast<int>(seed) % width_v<T>;
    std::vector<std::vector<std::uint32_t>> found;
    for (int company = 0; company < 3; ++company) {
      StateStorage<T> state(worlds.first.model, 0);
      ParamsStorage<T> params(worlds.first.model);
      for (int k = 0; k < width_v<T>; ++k) {
        put(worlds.all[company == 1 ? static_cast<std::size_t>((k + 3) % kLanes) : 0u], k, state, params);
        if (company != 2) continue;
        for (T& x : state.numbers()) set_lane(x, k, std::numeric_limits<float>::quiet_NaN());
      }
      put(worlds.all[0], place, state, params);
      StepWorkspace<T> ws(system);
      for (int step = 0; step < kSteps; ++step) manyhands::step(system, params, worlds.first.h, state, ws);
      found.push_back(bits_of_lane(state, place));
    }
    EXPECT_EQ(found[0], found[1]) << "seed " << seed;
    EXPECT_EQ(found[0], found[2]) << "seed " << seed;
  }
}

/// Parameters shared by all lanes (P = float) and one for each (P = T) are the same physics.
TYPED_TEST(StepLanes, TakeSharedParametersToo) {
  using T = TypeParam;
  const Worlds worlds(7);
  const System<float> system(worlds.all[0].tree);
  StateStorage<T> shared(worlds.first.model, 0), own(worlds.first.model, 0);
  ParamsStorage<T> params(worlds.first.model);
  for (int k = 0; k < width_v<T>; ++k) {
    put(worlds.all[static_cast<std::size_t>(k)], k, own, params);
    copy_params(worlds.all[0].params, params, k);
  }
  for (std::size_t i = 0; i < own.numbers().size(); ++i) shared.numbers()[i] = own.numbers()[i];
  StepWorkspace<T> ws(system);
  for (int step = 0; step < 50; ++step) {
    manyhands::step(system, params, worlds.first.h, own, ws);
    manyhands::step(system, worlds.all[0].params, worlds.first.h, shared, ws);
  }
  for (int k = 0; k < width_v<T>; ++k) EXPECT_EQ(bits_of_lane(own, k), bits_of_lane(shared, k)) << "lane " << k;
}

}  // namespace
}  // namespace manyhands
