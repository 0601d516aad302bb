// Lane k of a block in contact equals the scalar float run of world k, bit for bit; and no lane sees its neighbours.
#include <gtest/gtest.h>

#include <bit>
#include <random>

#include "manyhands/physics/step/step.h"
#include "tests/physics/contact/contact_scenes.h"

namespace manyhands {
namespace {

constexpr int kSteps = 240, kLanes = 16;

/// World k's start: everything pushed about a little, so that the worlds touch differently.
StateStorage<float> start_of(const Model& model, const System<float>& system, int k) {
  StateStorage<float> state(model, system.contact_numbers());
  std::mt19937 rng(static_cast<unsigned>(100 + k));
  std::uniform_real_distribution<float> any(-1, 1);
  for (const Body& body : model.bodies()) {
    if (body.joint.value() < 0) continue;
    for (int i = 0; i < body.nv; ++i) state.v()[body.iv + i] = 0.5f * any(rng);
    if (body.type == JointType::kFloating) {
      for (int i = 0; i < 3; ++i) state.q()[body.iq + i] += 0.002f * any(rng);
    } else {
      state.q()[body.iq] += 0.002f * any(rng);
    }
  }
  for (int u = 0; u < model.nu(); ++u) state.ctrl()[u] = 0.005f + 0.001f * any(rng);
  return state;
}

void set_up(System<float>& system, Params<float>& params) {
  system.solver = {.max_iterations = 12, .tolerance = 1e-6};
  for (std::size_t i = 0; i < params.motor_kp.size(); ++i) {
    const bool hinge = system.tree.dof_q[i] >= 0 && system.tree.dof_drive[i] < 0;
    params.motor_kp[i] = 0.1f;
    params.motor_kd[i] = 1;
    params.motor_max_force[i] = hinge && i % 2 == 0 ? 3.0f : 0.0f;
  }
}

std::vector<std::uint32_t> bits_of_lane(const auto& state, int k) {
  std::vector<std::uint32_t> bits;
  for (const auto& x : state.numbers()) bits.push_back(std::bit_cast<std::uint32_t>(static_cast<float>(lane(x, k))));
  return bits;
}

template <class T>
class ContactLanes : public ::testing::Test {};
using LaneTypes = ::testing::Types<Lanes4, Lanes8, Lanes16>;
TYPED_TEST_SUITE(ContactLanes, LaneTypes);

TYPED_TEST(ContactLanes, EqualTheScalarBitForBit) {
  using T = TypeParam;
  constexpr int W = width_v<T>;
  for (int which = 0; which < testing::kScenes; ++which) {
    const Model model = testing::contact_scene(which);
    System<float> system(model);
    ParamsStorage<float> params(model);
    set_up(system, params);
    StateStorage<T> block(model, system.contact_numbers());
    StepWorkspace<T> ws(system);
    std::vector<StateStorage<float>> worlds;
    StepWorkspace<float> alone(system);
    for (int k = 0; k < W; ++k) {
      worlds.push_back(start_of(model, system, k));
      for (std::size_t i = 0; i < block.numbers().size(); ++i)
        set_lane(block.numbers()[i], k, worlds.back().numbers()[i]);
    }
    std::size_t touched = 0;
    for (int n = 0; n < kSteps; ++n) {
      step(system, params, 0.004f, block, ws);
      for (int k = 0; k < W; ++k) {
        State<float>& world = worlds[static_cast<std::size_t>(k)];
        step(system, params, 0.004f, world, alone);
        touched += alone.contact.problem.points.size();
        ASSERT_EQ(bits_of_lane(block, k), bits_of_lane(world, 0))
            << "scene " << which << ", step " << n << ", lane " << k;
      }
    }
    EXPECT_GT(touched, static_cast<std::size_t>(kSteps)) << "scene " << which;
  }
}

TYPED_TEST(ContactLanes, DoNotSeeOneAnother) {
  using T = TypeParam;
  constexpr int W = width_v<T>;
  const Model model = testing::contact_scene(0);
  System<float> system(model);
  ParamsStorage<float> params(model);
  set_up(system, params);
  std::vector<std::vector<std::uint32_t>> found;
  for (int company = 0; company < 3; ++company) {
    StateStorage<T> block(model, system.contact_numbers());
    StepWorkspace<T> ws(system);
    for (int k = 0; k < W; ++k) {
      const StateStorage<float> world = start_of(model, system, k == 1 ? 1 : 7 * company + k);
      for (std::size_t i = 0; i < block.numbers().size(); ++i) {
        const bool lost = company == 2 && k != 1;
        set_lane(block.numbers()[i], k, lost ? std::numeric_limits<float>::quiet_NaN() : world.numbers()[i]);
      }
    }
    for (int n = 0; n < kSteps; ++n) step(system, params, 0.004f, block, ws);
    found.push_back(bits_of_lane(block, 1));
  }
  EXPECT_EQ(found[0], found[1]);
  EXPECT_EQ(found[0], found[2]);
}

}  // namespace
}  // namespace manyhands
