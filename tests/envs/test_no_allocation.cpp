// No step, no algorithm of the dynamics and no inverse kinematics allocates: all scratch is there beforehand.
//
// This file replaces the global operator new of the test program; it counts only while a `Watch` lives.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <new>
#include <random>

#include "manyhands/envs/make.h"
#include "manyhands/envs/panda.h"
#include "manyhands/learn/regression.h"
#include "manyhands/math/instantiate.h"
#include "manyhands/physics/collision/broad/broad_phase.h"
#include "manyhands/physics/world/batch.h"
#include "tests/physics/contact/joint_problem.h"
#include "tests/physics/world/world_scenes.h"

namespace {

std::atomic<bool> watching{false};
std::atomic<int> allocations{0};

void* counted(std::size_t size, std::size_t alignment) {
  if (watching) ++allocations;
  void* memory =
      std::aligned_alloc(alignment, (std::max<std::size_t>(size, 1) + alignment - 1) / alignment * alignment);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

constexpr std::size_t kAlignment = __STDCPP_DEFAULT_NEW_ALIGNMENT__;

}  // namespace

// GCC sees free() inlined into callers whose new it did not inline, and takes the two for a mismatch.
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"
// NOLINTBEGIN(cppcoreguidelines-owning-memory): whoever calls these owns the memory
void* operator new(std::size_t size) { return counted(size, kAlignment); }
void* operator new[](std::size_t size) { return counted(size, kAlignment); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return counted(size, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return counted(size, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return counted(size, kAlignment); }
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept { return counted(size, kAlignment); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
// NOLINTEND(cppcoreguidelines-owning-memory)

namespace manyhands {
namespace {

class Watch {
 public:
  Watch() {
    allocations = 0;
    watching = true;
  }
  ~Watch() { watching = false; }
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  [[nodiscard]] int stop() const {
    watching = false;
    return allocations;
  }
};

TEST(Allocation, IsSeen) {
  const Watch watch;
  const std::vector<Lanes16> lanes(3);
  const auto number = std::make_unique<int>(1);
  EXPECT_EQ(watch.stop(), 2) << lanes.size() << *number;
}

template <class T>
class NoAllocation : public ::testing::Test {};
using NumberTypes = ::testing::Types<double, float, Lanes4, Lanes8, Lanes16>;
TYPED_TEST_SUITE(NoAllocation, NumberTypes);

/// Motors and limits of every kind, so that pivots are needed, on trees with every type of joint.
TYPED_TEST(NoAllocation, InAStep) {
  using T = TypeParam;
  using R = real_t<T>;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const testing::JointProblem<R> p(seed, 7);
    StateStorage<T> state(p.model, 0);
    for (std::size_t i = 0; i < state.numbers().size(); ++i) state.numbers()[i] = T(p.state.numbers()[i]);
    const System<R> system(p.tree);
    StepWorkspace<T> ws(system);
    const Watch watch;
    for (int i = 0; i < 20; ++i) step(system, p.params, p.h, state, ws);
    EXPECT_EQ(watch.stop(), 0) << "seed " << seed;
  }
}

TYPED_TEST(NoAllocation, InTheDynamics) {
  using T = TypeParam;
  const testing::JointProblem<real_t<T>> p(3, 9);
  const StateStorage<T> state(p.model, 0);
  std::vector<T> a(p.size()), tau(p.size(), T(real_t<T>(0)));
  Workspace<T> ws(p.tree);
  const Watch watch;
  aba(p.tree, p.params, state.q(), state.v(), tau.data(), a.data(), ws);
  rnea(p.tree, p.params, state.q(), state.v(), a.data(), tau.data(), ws);
  crba(p.tree, p.params, state.q(), ws);
  EXPECT_EQ(watch.stop(), 0);
}

TYPED_TEST(NoAllocation, InInverseKinematics) {
  using T = TypeParam;
  using R = real_t<T>;
  const LonePanda robot;
  const Tree<R> tree(robot.model);
  const ParamsStorage<R> params(robot.model);
  Workspace<T> ws(tree);
  std::vector<T> q;
  for (const double x : robot.arm.neutral) q.push_back(T(static_cast<R>(x)));
  Transform<T> target = Transform<T>::identity();
  target.p.x = T(R(0.1));
  const IkSettings settings;
  const Watch watch;
  (void)solve_ik(tree, params, robot.arm.chain, settings, target, q.data(), ws);
  EXPECT_EQ(watch.stop(), 0);
}

/// Once everything has touched: what grows with the number of contacts has then grown.
TEST(NoAllocation, InAWorldInContact) {
  for (const auto& model : {testing::stack(3), testing::panda_and_cube()}) {
    World world(model);
    world.step(300);
    world.apply_force(model->links().back().name, {0.1, 0, 0});
    const Watch watch;
    world.step(50);
    EXPECT_EQ(watch.stop(), 0) << model->name();
    EXPECT_FALSE(world.contacts().empty());
  }
}

/// Where iterations do not do and the solver factors large matrices: a heavy cube on light ones that are kicked to and
/// fro, and its upper half off the lower. A few make a small system, which sliding leaves without symmetry; many a
/// sparse one.
TEST(NoAllocation, InNewtonSteps) {
  for (const int cubes : {4, 12}) {
    ModelBuilder builder("pressed");
    testing::add_floor(builder);
    for (int i = 0; i < cubes; ++i)
      testing::add_cube(builder, "cube" + std::to_string(i), {0, 0, 0.02 + 0.04 * i}, i + 1 == cubes ? 10 : 0.1);
    const Model model = builder.build();
    const System<double> system(model);
    const ParamsStorage<double> params(model);
    StateStorage<double> state(model, system.contact_numbers());
    StepWorkspace<double> ws(system);
    int newton_steps = 0;
    const auto shake = [&] {
      for (const double kick : {0.1, -0.1, -0.1, 0.1}) {
        for (int i = 0; i < cubes; ++i) state.v()[6 * i + 3] += i % 2 == 0 ? kick : -kick;
        for (int i = cubes / 2; i < cubes; ++i) state.v()[6 * i + 5] += 0.05;
        for (int n = 0; n < 50; ++n) {
          step(system, params, 0.002, state, ws);
          newton_steps += ws.contact.newton.steps();
        }
      }
    };
    shake();
    newton_steps = 0;
    const Watch watch;
    shake();
    EXPECT_EQ(watch.stop(), 0) << cubes << " cubes";
    EXPECT_GT(newton_steps, 50) << cubes << " cubes";
  }
}

TEST(NoAllocation, InABatchInContact) {
  for (const auto& model : {testing::stack(3), testing::panda_and_cube()}) {
    for (const int lanes : {1, 4, 8, 16}) {
      Batch batch(model, 20, 0.002, {.num_threads = 1, .lanes = lanes});
      batch.step(300);
      batch.apply_force(model->links().back().name, std::vector<float>(60, 0.1f));
      const Watch watch;
      batch.step(50);
      EXPECT_EQ(watch.stop(), 0) << model->name() << ", " << lanes << " lanes";
      EXPECT_GT(batch.contact_count()[3], 0);
    }
  }
}

/// Once there have been as many pairs as there will be, however the geoms move and the swept axis changes.
TEST(NoAllocation, InTheBroadPhase) {
  constexpr std::size_t kGeoms = 300;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Vec3<double>> start, velocity;
  std::vector<bool> is_static;
  for (std::size_t g = 0; g < kGeoms; ++g) {
    start.push_back({uniform(random), uniform(random), uniform(random)});
    velocity.push_back({uniform(random), 3 * uniform(random), uniform(random)});
    is_static.push_back(g % 5 == 0);
  }
  BroadPhase broad_phase(is_static);
  std::vector<Aabb<double>> bounds(kGeoms);
  std::size_t pairs = 0;
  const auto move = [&] {
    for (int step = 0; step < 50; ++step) {
      for (std::size_t g = 0; g < kGeoms; ++g) {
        const Vec3<double> p = start[g] + (is_static[g] ? 0.0 : 0.1 * step) * velocity[g];
        bounds[g] = grown(Aabb<double>{p, p}, 0.1);
      }
      pairs += broad_phase.update(bounds).size();
    }
  };
  move();
  const Watch watch;
  move();
  EXPECT_EQ(watch.stop(), 0);
  EXPECT_GT(pairs, 1000u);
}

/// Of so many geoms that a broad phase finds the pairs.
TEST(NoAllocation, InALargeWorldInContact) {
  ModelBuilder builder("cubes");
  testing::add_floor(builder);
  for (int i = 0; i < 70; ++i) {
    const int column = i / 2, layer = i % 2;
    testing::add_cube(builder, "cube" + std::to_string(i), {0.05 * column, 0, 0.021 + 0.042 * layer});
  }
  World world(std::make_shared<const Model>(builder.build()));
  world.step(100);
  const Watch watch;
  world.step(10);
  EXPECT_EQ(watch.stop(), 0);
  EXPECT_GT(world.contacts().size(), 200u);
}

/// Once products have their scratch.
TEST(NoAllocation, InRegression) {
  for (const int threads : {1, 2}) {
    learn::Regression regression(std::vector<float>(600, 0.5f), 6, std::vector<float>(300, 0.1f), 3,
                                 {.num_threads = threads});
    regression.advance(1);
    const Watch watch;
    regression.advance(20);
    EXPECT_EQ(watch.stop(), 0) << threads << " threads";
  }
}

TEST(NoAllocation, InABatchOfEnvironments) {
  const std::vector<RandomRange> some{{"motor_gain", 0.5, 1}, {"action_latency", 0, 2}, {"observation_noise", 0, 1}};
  for (const auto& [id, ranges] :
       {std::pair{"PandaReach-v3", std::vector<RandomRange>{}}, {"PandaReachJoints-v3", some}}) {
    for (const int threads : {1, 2}) {
      for (const int lanes : {1, 4, 8, 16}) {
        const auto env = make_env_batch(id, 40, {.num_threads = threads, .randomize = ranges, .lanes = lanes});
        const std::vector<float> action(static_cast<std::size_t>(40 * env->spec().action_dim), 0.7f);
        const std::vector<std::uint8_t> mask(40, 1);
        const std::vector<std::uint64_t> seeds(40, 5);
        const Watch watch;
        for (int i = 0; i < 5; ++i) env->step(action);
        env->reset(mask);
        env->reset({}, seeds);
        EXPECT_EQ(watch.stop(), 0) << id << ", " << threads << " threads, " << lanes << " lanes";
      }
    }
  }
}

}  // namespace
}  // namespace manyhands
