// Where the time of a Reach environment step goes, for every number type.
//
// The same 128 worlds, driven by random actions in scalar float, give the states that are timed in every number type:
// in contact two runs part ways, however near they began. The stages of a physics step are
// timed by running a step up to the end of each stage: the difference of two such times is a stage's own.
#include <functional>
#include <random>

#include "benchmarks/support.h"
#include "manyhands/envs/control/control.h"
#include "manyhands/envs/make.h"
#include "manyhands/envs/panda.h"
#include "manyhands/envs/tasks/reach.h"

namespace benchmarks {

namespace {

using namespace manyhands;

constexpr int kWorlds = 128;
constexpr int kSubsteps = 20;
constexpr int kWarmUpSteps = 10;  // environment steps before the sampled one
constexpr int kEpisodeSteps = 50;
constexpr std::size_t kJoints = 9;
constexpr double kTimeStep = 0.002;  // [s]
constexpr const char* kId = "PandaReach-v3";

/// Random actions (steps, worlds, 3), the same for every number type.
std::vector<float> random_actions(int steps) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::vector<float> actions(static_cast<std::size_t>(steps * kWorlds * 3));
  for (float& a : actions) a = uniform(random);
  return actions;
}

/// What is sampled of one world: its numbers before the last action and at every physics step after it, and the action.
struct Sample {
  std::vector<float> start;
  std::array<float, 3> action;
  std::array<std::vector<float>, kSubsteps> steps;
};

/// Drives the worlds in scalar float, as the environment does.
std::vector<Sample> sample(const Model& scene) {
  const Arm arm(panda_arm(), scene, ArmControl::kEndEffector, false);
  const System<float> system(scene);
  ParamsStorage<float> params(scene);
  set_arm_motors(arm, params);
  StepWorkspace<float> ws(system);
  StateStorage<float> state(scene, system.contact_numbers());
  const auto numbers = [&] { return std::vector<float>(state.numbers().begin(), state.numbers().end()); };
  const std::vector<float> actions = random_actions(kWarmUpSteps + 1);
  std::vector<Sample> worlds(kWorlds);
  for (std::size_t w = 0; w < kWorlds; ++w) {
    reset_arm(arm, state, 0);
    for (std::size_t i = 0; i <= kWarmUpSteps; ++i) {
      worlds[w].start = numbers();
      std::copy_n(&actions[(i * kWorlds + w) * 3], 3, worlds[w].action.begin());
      const HandState<float> hand = observe_hand(arm, system.tree, state, ws.dynamics);
      apply_action(arm, system.tree, params, hand, worlds[w].action.data(), state, ws.dynamics);
      for (std::vector<float>& kept : worlds[w].steps) {
        kept = numbers();
        step(system, params, static_cast<float>(kTimeStep), state, ws);
      }
    }
  }
  return worlds;
}

template <Number T>
class Stages {
  using R = real_t<T>;
  static constexpr int kBlocks = kWorlds / width_v<T>;
  enum Stage { kCopy, kBias, kCollide, kPrepare, kSolve, kIntegrate };

 public:
  Stages(const Model& scene, const std::vector<Sample>& worlds)
      : arm_(panda_arm(), scene, ArmControl::kEndEffector, false),
        system_(scene),
        params_(scene),
        ws_(system_),
        state_(scene, system_.contact_numbers()) {
    set_arm_motors(arm_, params_);
    system_.solver = System<float>(scene).solver;
    gather(worlds);
  }

  /// What is timed: each stage of the environment step, then the physics step up to each of its stages.
  std::vector<std::function<void()>> calls() {
    return {[this] { copy_starts(); },     [this] { inverse_kinematics(); }, [this] { observe(); },
            [this] { physics(kCopy); },    [this] { physics(kBias); },       [this] { physics(kCollide); },
            [this] { physics(kPrepare); }, [this] { physics(kSolve); },      [this] { physics(kIntegrate); }};
  }

  /// Of the whole physics steps, which `calls` times last.
  [[nodiscard]] Results results() const { return unpack<T>(results_, 2 * kJoints); }

  /// The same of steps whose contacts are solved to the end: the few iterations that are timed leave more than rounding
  /// between number types.
  [[nodiscard]] Results solved_results() {
    const SolverSettings timed = system_.solver;
    system_.solver.max_iterations = 2000;
    system_.solver.tolerance = 1e-7;
    physics(kIntegrate);
    system_.solver = timed;
    return results();
  }

 private:
  struct Start {
    StateStorage<T> state;
    HandState<T> hand;
    std::array<T, 3> action;
  };

  /// Packs the worlds' numbers into blocks of lanes.
  void gather(const std::vector<Sample>& worlds) {
    const auto pack = [&](int block, auto&& numbers_of) {
      for (int k = 0; k < width_v<T>; ++k) {
        const std::vector<float>& from = numbers_of(worlds[static_cast<std::size_t>(block * width_v<T> + k)]);
        for (std::size_t i = 0; i < from.size(); ++i) set_lane(state_.numbers()[i], k, static_cast<R>(from[i]));
      }
      return state_;
    };
    for (int b = 0; b < kBlocks; ++b) {
      pack(b, [](const Sample& world) -> const std::vector<float>& { return world.start; });
      Start start{state_, observe_hand(arm_, tree_, state_, ws_.dynamics), {}};
      for (int k = 0; k < width_v<T>; ++k) {
        const std::array<float, 3>& action = worlds[static_cast<std::size_t>(b * width_v<T> + k)].action;
        for (std::size_t c = 0; c < 3; ++c) set_lane(start.action[c], k, static_cast<R>(action[c]));
      }
      starts_.push_back(start);
    }
    for (std::size_t substep = 0; substep < kSubsteps; ++substep) {
      for (int b = 0; b < kBlocks; ++b)
        steps_.push_back(
            pack(b, [&](const Sample& world) -> const std::vector<float>& { return world.steps[substep]; }));
    }
    results_.resize(steps_.size() * 2 * kJoints);
  }

  void copy(const State<T>& from) { std::ranges::copy(from.numbers(), state_.numbers().begin()); }

  void copy_starts() {
    for (const Start& start : starts_) {
      copy(start.state);
      consume(&state_);
    }
  }

  void inverse_kinematics() {
    for (const Start& start : starts_) {
      copy(start.state);
      apply_action(arm_, tree_, params_, start.hand, start.action.data(), state_, ws_.dynamics);
      consume(&state_);
    }
  }

  void observe() {
    const Vec3<T> goal{T(R(0.1)), T(R(-0.1)), T(R(0.2))};
    for (const Start& start : starts_) {
      copy(start.state);
      const HandState<T> hand = observe_hand(arm_, tree_, state_, ws_.dynamics);
      const Outcome<T> outcome = judge(Goals{}, norm(hand.p - goal));
      consume(&hand);
      consume(&outcome);
    }
  }

  void physics(Stage last) {
    T* out = results_.data();
    for (const State<T>& start : steps_) {
      copy(start);
      if (last >= kBias) bias_and_mass_matrix(tree_, params_, state_.q(), state_.v(), ws_.dynamics);
      const Colliders<R>& colliders = system_.colliders;
      const R h = static_cast<R>(kTimeStep);
      ContactSolver<T>& contact = ws_.contact;
      if (last >= kCollide) find_touches(colliders, params_, h, state_, ws_);
      if (last >= kPrepare) {
        assemble(tree_, colliders, std::span<const ColliderPair>(colliders.pairs), params_, h, state_, ws_.collision,
                 ws_.dynamics, contact);
        warm_start(contact.problem, std::span<const Touch<T>>(ws_.collision.touches), state_, contact.iterate);
      }
      if (last >= kSolve) solve(system_.solver, contact);
      if (last >= kIntegrate) {
        store_warm_start(contact.problem, contact.iterate, state_);
        add_velocity_change(state_, static_cast<std::size_t>(tree_.nv));
        integrate_configuration(tree_, state_.v(), T(h), state_.q());
        out = std::copy_n(state_.q(), kJoints, out);
        out = std::copy_n(state_.v(), kJoints, out);
      }
      consume(&state_);
    }
    consume(results_.data());
  }

  Arm arm_;
  System<R> system_;
  const Tree<R>& tree_ = system_.tree;
  ParamsStorage<R> params_;
  StepWorkspace<T> ws_;
  StateStorage<T> state_;
  std::vector<Start> starts_;           // (blocks)
  std::vector<StateStorage<T>> steps_;  // (kSubsteps, blocks)
  std::vector<T> results_;
};

/// The environment as trainers step it, on one thread.
class WholeStep {
 public:
  explicit WholeStep(int lanes)
      : envs_(make_env_batch(kId, kWorlds, {.num_threads = 1, .lanes = lanes})),
        actions_(random_actions(kEpisodeSteps)) {
    for (std::uint64_t i = 0; i < kWorlds; ++i) seeds_.push_back(i);
  }

  void step() {
    if (steps_ % kEpisodeSteps == 0) envs_->reset({}, seeds_);
    const std::size_t size = static_cast<std::size_t>(kWorlds) * 3;
    envs_->step(std::span(actions_).subspan(static_cast<std::size_t>(steps_++ % kEpisodeSteps) * size, size));
  }

  /// The hash of the worlds at the end of the running episode.
  std::uint64_t hash() {
    do step();
    while (steps_ % kEpisodeSteps != 0);
    return envs_->state_hash();
  }

 private:
  std::unique_ptr<EnvBatch> envs_;
  std::vector<float> actions_;
  std::vector<std::uint64_t> seeds_;
  int steps_ = 0;
};

/// What scalar float gives.
struct Expected {
  Results timed, solved;
};

template <Number T>
void profile(const Settings& settings, const Model& scene, const std::vector<Sample>& worlds, const Expected& expected,
             std::uint64_t expected_hash) {
  Stages<T> stages(scene, worlds);
  std::vector<std::function<void()>> calls = stages.calls();
  constexpr bool kHasEnvironment = !std::is_same_v<T, double>;
  WholeStep whole(kHasEnvironment ? width_v<T> : 1);
  if (kHasEnvironment) calls.emplace_back([&] { whole.step(); });
  const std::vector<Timing> timings = time_in_turns<std::function<void()>>(settings, calls);
  const std::string wrong = std::is_same_v<T, double> ? compare<T>(stages.solved_results(), expected.solved, 1e-3)
                                                      : compare<T>(stages.results(), expected.timed, 0);

  const auto emit = [&](const char* name, const std::string& why, std::uint64_t hash, std::size_t to,
                        std::size_t from) {
    const double ns = 1e9 / kWorlds;
    const bool whole_call = from == to;
    print({std::string("Reach step: ") + name, number_name<T>(), 1,
           ns * (timings[to].cpu - (whole_call ? 0 : timings[from].cpu)), "ns/env step",
           ns * (timings[to].wall - (whole_call ? 0 : timings[from].wall)), timings[to].variation, hash, why});
  };
  const std::uint64_t hash = stages.results().hash;
  emit("inverse kinematics", wrong, hash, 1, 0);
  emit("bias and mass matrix", wrong, hash, 4, 3);
  emit("collision", wrong, hash, 5, 4);
  emit("motors, limits, contacts: prepare", wrong, hash, 6, 5);
  emit("motors, limits, contacts: solve", wrong, hash, 7, 6);
  emit("integrate", wrong, hash, 8, 7);
  emit("observation and reward", wrong, hash, 2, 0);
  if (!kHasEnvironment) return;
  const std::uint64_t end = whole.hash();
  emit("all", end == expected_hash ? "" : "not the bits of the scalar float run", end, 9, 9);
}

void run(const Settings& settings) {
  const Model scene = task_scene(panda_arm(), Table{}, {});
  const std::vector<Sample> worlds = sample(scene);
  Stages<float> scalar(scene, worlds);
  for (const std::function<void()>& call : scalar.calls()) call();
  Expected expected{scalar.results(), {}};
  expected.solved = scalar.solved_results();
  const std::uint64_t expected_hash = WholeStep(1).hash();
  profile<double>(settings, scene, worlds, expected, expected_hash);
  profile<float>(settings, scene, worlds, expected, expected_hash);
  profile<Lanes4>(settings, scene, worlds, expected, expected_hash);
  profile<Lanes8>(settings, scene, worlds, expected, expected_hash);
  profile<Lanes16>(settings, scene, worlds, expected, expected_hash);
}

}  // namespace

}  // namespace benchmarks

int main(int argc, char** argv) {
  benchmarks::run(benchmarks::parse(argc, argv, "Nanoseconds of each stage of a Reach step, per environment step."));
  return 0;
}
