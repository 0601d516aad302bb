// manyhands._core.envs: batches of environments, and their autoreset modes.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "bindings/arrays.h"
#include "bindings/bindings.h"
#include "bindings/model/python_model.h"
#include "manyhands/envs/autoreset.h"
#include "manyhands/envs/env_batch.h"
#include "manyhands/envs/make.h"
#include "manyhands/math/instantiate.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

using bindings::Array;
using bindings::as_bytes;
using bindings::as_span;
using bindings::copied;
using bindings::copied_bools;
using bindings::viewed;
using Bytes = std::optional<Array<bool, 1>>;
using Ranges = std::vector<std::tuple<std::string, double, double, bool>>;
using Seeds = std::optional<Array<std::uint64_t, 1>>;

std::size_t size(int n) { return static_cast<std::size_t>(n); }

std::span<const std::uint8_t> bytes(const Bytes& mask) {
  if (!mask) return {};
  return {reinterpret_cast<const std::uint8_t*>(mask->data()), mask->size()};
}

std::span<const std::uint64_t> numbers(const Seeds& seeds) {
  return seeds ? as_span(*seeds) : std::span<const std::uint64_t>{};
}

std::string shape_text(std::size_t rows, std::size_t columns) {
  return "(" + std::to_string(rows) + ", " + std::to_string(columns) + ")";
}

std::span<const float> checked_action(const Array<float, 2>& action, const EnvBatch& envs) {
  const std::size_t rows = size(envs.num_envs()), columns = size(envs.spec().action_dim);
  if (action.shape(0) != rows || action.shape(1) != columns) {
    throw std::invalid_argument(envs.spec().id + ": the actions have shape " +
                                shape_text(action.shape(0), action.shape(1)) + ", expected " +
                                shape_text(rows, columns) + " (worlds, action_dim)");
  }
  return as_span(action);
}

nb::object rows(std::span<const float> values, int dim, nb::handle owner, bool copy) {
  const std::size_t n = values.size() / size(dim);
  return copy ? copied(values.data(), {n, size(dim)}) : viewed(values.data(), {n, size(dim)}, owner);
}

nb::tuple observations(const EnvBatch& envs, nb::handle owner, bool copy) {
  const EnvSpec& spec = envs.spec();
  return nb::make_tuple(rows(envs.observation(), spec.observation_dim, owner, copy),
                        rows(envs.achieved_goal(), spec.goal_dim, owner, copy),
                        rows(envs.desired_goal(), spec.goal_dim, owner, copy));
}

nb::object compute_reward(const EnvBatch& envs, const Array<float, 2>& achieved, const Array<float, 2>& desired) {
  const std::size_t columns = size(envs.spec().goal_dim);
  if (achieved.shape(1) != columns || desired.shape(1) != columns || achieved.shape(0) != desired.shape(0)) {
    throw std::invalid_argument(envs.spec().id + ": achieved_goal has shape " +
                                shape_text(achieved.shape(0), achieved.shape(1)) + " and desired_goal " +
                                shape_text(desired.shape(0), desired.shape(1)) + ", expected (k, " +
                                std::to_string(columns) + ") both");
  }
  std::vector<float> reward(achieved.shape(0));
  envs.compute_reward(as_span(achieved), as_span(desired), reward);
  return copied(reward.data(), {reward.size()});
}

void bind_spec(nb::module_& m) {
  nb::class_<EnvSpec>(m, "EnvSpec", "What an environment id means: sizes and limits.")
      .def("__repr__",
           [](const EnvSpec& spec) {
             return "<EnvSpec of '" + spec.id + "': " + std::to_string(spec.observation_dim) + " observations, " +
                    std::to_string(spec.goal_dim) + " goals, " + std::to_string(spec.action_dim) + " actions>";
           })
      .def_ro("id", &EnvSpec::id)
      .def_ro("observation_dim", &EnvSpec::observation_dim)
      .def_ro("robot_dim", &EnvSpec::robot_dim,
              "So many of an observation's first numbers are what the robot knows of itself.")
      .def_ro("goal_dim", &EnvSpec::goal_dim)
      .def_ro("action_dim", &EnvSpec::action_dim)
      .def_ro("max_episode_steps", &EnvSpec::max_episode_steps)
      .def_ro("dt", &EnvSpec::dt, "Simulated seconds of one environment step.")
      .def_ro("randomized", &EnvSpec::randomized, "What differs from episode to episode.");
}

void bind_batch(nb::module_& m) {
  nb::class_<EnvBatch>(m, "EnvBatch",
                       "n worlds of one environment, stepped together; arrays are float32, rows are worlds.")
      .def_prop_ro("spec", &EnvBatch::spec, nb::rv_policy::reference_internal)
      .def_prop_ro("num_envs", &EnvBatch::num_envs)
      .def("__repr__",
           [](const EnvBatch& envs) {
             return "<" + std::to_string(envs.num_envs()) + " worlds of '" + envs.spec().id + "'>";
           })
      .def(
          "reset",
          [](EnvBatch& envs, const Bytes& mask, const Seeds& seeds) {
            const nb::gil_scoped_release release;
            envs.reset(bytes(mask), numbers(seeds));
          },
          "mask"_a = nb::none(), "seeds"_a = nb::none(),
          "Starts a new episode in the worlds where `mask` (n) is true, all without it. With `seeds` (n), world i's "
          "random stream restarts from seeds[i]. Raises ValueError on a wrong length.")
      .def(
          "step",
          [](EnvBatch& envs, const Array<float, 2>& action) {
            const std::span<const float> values = checked_action(action, envs);
            const nb::gil_scoped_release release;
            envs.step(values);
          },
          "action"_a,
          "Steps every world under `action` (n, action_dim), clipped to [-1, 1]. Raises ValueError on a wrong shape or "
          "a value that is not finite.")
      .def(
          "observations", [](const EnvBatch& envs) { return observations(envs, {}, true); },
          nb::sig("def observations(self) -> tuple[numpy.typing.NDArray[numpy.float32], "
                  "numpy.typing.NDArray[numpy.float32], numpy.typing.NDArray[numpy.float32]]"),
          "Copies of (observation, achieved_goal, desired_goal): (n, observation_dim), (n, goal_dim), (n, goal_dim).")
      .def_prop_ro(
          "reward", [](const EnvBatch& envs) { return copied(envs.reward().data(), {envs.reward().size()}); },
          nb::sig("def reward(self) -> numpy.typing.NDArray[numpy.float32]"), "(n), of the last step.")
      .def_prop_ro(
          "is_success", [](const EnvBatch& envs) { return copied_bools(envs.is_success()); },
          nb::sig("def is_success(self) -> numpy.typing.NDArray[numpy.bool_]"), "(n)")
      .def_prop_ro(
          "terminated", [](const EnvBatch& envs) { return copied_bools(envs.terminated()); },
          nb::sig("def terminated(self) -> numpy.typing.NDArray[numpy.bool_]"), "(n), success ended the episode.")
      .def_prop_ro(
          "truncated", [](const EnvBatch& envs) { return copied_bools(envs.truncated()); },
          nb::sig("def truncated(self) -> numpy.typing.NDArray[numpy.bool_]"),
          "(n), the step limit or instability ended the episode.")
      .def_prop_ro(
          "unstable", [](const EnvBatch& envs) { return copied_bools(envs.unstable()); },
          nb::sig("def unstable(self) -> numpy.typing.NDArray[numpy.bool_]"),
          "(n), numbers stopped being finite in the last step; the world rests where that step began.")
      .def_prop_ro(
          "randomized",
          [](const EnvBatch& envs) {
            return copied(envs.randomized().data(), {size(envs.num_envs()), envs.spec().randomized.size()});
          },
          nb::sig("def randomized(self) -> numpy.typing.NDArray[numpy.float32]"),
          "(n, len(spec.randomized)), what the present episode of each world has.")
      .def_prop_ro("state_hash", &EnvBatch::state_hash, "Of the physics of all worlds: equal bits, equal hash.")
      .def(
          "snapshot", [](const EnvBatch& envs) { return as_bytes(envs.snapshot()); },
          "All that a run needs to continue bit for bit: physics, goals, random streams, step counts.")
      .def(
          "restore", [](EnvBatch& envs, const nb::bytes& snapshot) { envs.restore(as_bytes(snapshot)); }, "snapshot"_a,
          "Goes back to a snapshot. Raises ValueError if it is of another environment.")
      .def("compute_reward", &compute_reward, "achieved_goal"_a, "desired_goal"_a,
           nb::sig("def compute_reward(self, achieved_goal: numpy.typing.NDArray[numpy.float32], "
                   "desired_goal: numpy.typing.NDArray[numpy.float32]) -> numpy.typing.NDArray[numpy.float32]"),
           "The task's reward (k) of k pairs of goals (k, goal_dim). Raises ValueError on other shapes.");
}

/// The bodies of a batch's worlds, loaded once.
struct EnvBodies {
  explicit EnvBodies(const EnvBatch& of) : envs(of), scene(of.scene()) {}

  [[nodiscard]] std::vector<double> configuration(int world) const {
    if (world < 0 || world >= envs.num_envs()) {
      throw std::invalid_argument(envs.spec().id + ": there is no world " + std::to_string(world) + "; there are " +
                                  std::to_string(envs.num_envs()));
    }
    std::vector<double> q(size(scene.model.nq()));
    std::vector<Vec3<double>> sizes(scene.objects.size());
    envs.see(world, q, sizes);
    return q;
  }

  const EnvBatch& envs;
  EnvScene scene;
};

void bind_bodies(nb::module_& m) {
  nb::class_<EnvBodies>(m, "EnvBodies", "The bodies of a batch's worlds, as they are seen.")
      .def(nb::init<const EnvBatch&>(), "envs"_a, nb::keep_alive<1, 2>())
      .def_prop_ro(
          "model", [](const EnvBodies& self) { return std::make_unique<PythonModel>(self.scene.model); },
          "The same for all worlds, with all that is seen of them: a copy.")
      .def(
          "configuration",
          [](const EnvBodies& self, int world) {
            const std::vector<double> q = self.configuration(world);
            return copied(q.data(), {q.size()});
          },
          "world"_a = 0, nb::sig("def configuration(self, world: int = 0) -> numpy.typing.NDArray[numpy.float64]"),
          "Where the bodies of a world are: q (nq) of `model`. Raises ValueError if there is no such world.");
}

using Pair = std::pair<double, double>;

void bind_make(nb::module_& m) {
  m.attr("NATIVE_LANES") = width_v<NativeLanes>;
  m.def("env_ids", &env_ids, "The ids that `make_env_batch` knows.");
  m.def("max_episode_steps", &max_episode_steps, "id"_a,
        "The steps after which an episode of the environment is truncated. Raises ValueError on an unknown id.");
  m.def(
      "make_env_batch",
      [](const std::string& id, int num_envs, int num_threads, int n_substeps, double time_step,
         bool terminate_on_success, double distance_threshold, const Ranges& randomize, const std::string& object_shape,
         int lanes, const std::variant<std::string, ArmSpec>& robot, const std::string& control_type,
         const Pair& stiffness, const Pair& damping, const std::vector<Obstacle>& obstacles) {
        const nb::gil_scoped_release release;
        EnvOptions options{.num_threads = num_threads,
                           .n_substeps = n_substeps,
                           .time_step = time_step,
                           .terminate_on_success = terminate_on_success,
                           .distance_threshold = distance_threshold,
                           .object_shape = object_shape,
                           .lanes = lanes,
                           .impedance = {stiffness.first, damping.first, stiffness.second, damping.second},
                           .obstacles = obstacles};
        for (const auto& [name, low, high, logarithmic] : randomize)
          options.randomize.push_back({name, low, high, logarithmic});
        const std::string* name = std::get_if<std::string>(&robot);
        options.arm = name != nullptr ? arm_spec(*name) : std::get<ArmSpec>(robot);
        if (!control_type.empty()) options.control = arm_control(control_type);
        return make_env_batch(id, num_envs, options);
      },
      "id"_a, "num_envs"_a, nb::kw_only(), "num_threads"_a = EnvOptions{}.num_threads,
      "n_substeps"_a = EnvOptions{}.n_substeps, "time_step"_a = EnvOptions{}.time_step,
      "terminate_on_success"_a = EnvOptions{}.terminate_on_success,
      "distance_threshold"_a = EnvOptions{}.distance_threshold, "randomize"_a = Ranges{},
      "object_shape"_a = EnvOptions{}.object_shape, "lanes"_a = EnvOptions{}.lanes, "robot"_a = "panda",
      "control_type"_a = "", "stiffness"_a = Pair{Impedance{}.stiffness, Impedance{}.rotational_stiffness},
      "damping"_a = Pair{Impedance{}.damping, Impedance{}.rotational_damping}, "obstacles"_a = std::vector<Obstacle>{},
      "`num_envs` worlds of the environment `id`. Threads: `num_threads`, or if 0 the variable MANYHANDS_THREADS, or "
      "one for each core. Physics: `n_substeps` of `time_step` [s] in one environment step. Success: nearer than "
      "`distance_threshold`, 0 for what the task says. `randomize`: (name, low, high, whether the logarithm is "
      "uniform) of what differs from episode to episode. `object_shape`: box, cylinder, sphere or capsule in place of "
      "what the task says. `lanes`: worlds in one register, 0 for the fastest. `robot`: 'panda', 'arm6' or an ArmSpec. "
      "`control_type`: empty for what the id says. `stiffness` [N/m, N m/rad] and `damping` [N s/m, N m s/rad] are "
      "those of impedance control. Raises ValueError on an unknown id or an option out of range.");
}

nb::tuple outcome(const AutoresetBatch& batch) {
  return nb::make_tuple(copied(batch.reward().data(), {batch.reward().size()}), copied_bools(batch.terminated()),
                        copied_bools(batch.truncated()));
}

nb::object final_rows(const AutoresetBatch& batch) {
  const AutoresetBatch::Final& last = batch.final();
  if (last.world.empty()) return nb::none();
  const EnvSpec& spec = batch.envs().spec();
  return nb::make_tuple(
      copied(last.world.data(), {last.world.size()}), rows(last.observation, spec.observation_dim, {}, true),
      rows(last.achieved_goal, spec.goal_dim, {}, true), rows(last.desired_goal, spec.goal_dim, {}, true),
      copied_bools(last.is_success), copied_bools(last.unstable),
      copied(last.randomized.data(), {last.world.size(), spec.randomized.size()}));
}

void bind_autoreset(nb::module_& m) {
  nb::enum_<AutoresetMode>(m, "AutoresetMode", "When a finished world starts its next episode.")
      .value("NEXT_STEP", AutoresetMode::kNextStep, "With the step after the last.")
      .value("SAME_STEP", AutoresetMode::kSameStep, "With the last step.")
      .value("DISABLED", AutoresetMode::kDisabled, "When the caller resets it.");

  nb::class_<AutoresetBatch>(m, "AutoresetBatch",
                             "A batch with resets and a step limit as in Gymnasium's vector environments.")
      .def(nb::init<EnvBatch&, AutoresetMode, int>(), "envs"_a, "mode"_a, "max_episode_steps"_a, nb::keep_alive<1, 2>(),
           "Steps `envs` from now on; 0 steps: episodes have no limit.")
      .def(
          "reset",
          [](AutoresetBatch& batch, const Bytes& mask, const Seeds& seeds, const Bytes& seeded) {
            const nb::gil_scoped_release release;
            batch.reset(bytes(mask), numbers(seeds), bytes(seeded));
          },
          "mask"_a = nb::none(), "seeds"_a = nb::none(), "seeded"_a = nb::none(),
          "Starts a new episode where `mask` (n) is true, all without it; world i's random stream restarts from "
          "seeds[i] where seeded[i]. Raises ValueError on a wrong length.")
      .def(
          "step",
          [](AutoresetBatch& batch, const Array<float, 2>& action) {
            const std::span<const float> values = checked_action(action, batch.envs());
            const nb::gil_scoped_release release;
            batch.step(values);
          },
          "action"_a,
          "Steps every world under `action` (n, action_dim), and resets as the mode asks. Raises ValueError on a bad "
          "action, RuntimeError if a finished world waits for its reset in mode DISABLED; nothing is stepped then.")
      .def(
          "observations",
          [](nb::handle_t<AutoresetBatch> self, bool copy) {
            return observations(nb::cast<const AutoresetBatch&>(self).envs(), self, copy);
          },
          "copy"_a = true,
          nb::sig("def observations(self, copy: bool = True) -> tuple[numpy.typing.NDArray[numpy.float32], "
                  "numpy.typing.NDArray[numpy.float32], numpy.typing.NDArray[numpy.float32]]"),
          "(observation, achieved_goal, desired_goal): (n, observation_dim), (n, goal_dim), (n, goal_dim). Without "
          "`copy`, read-only views that the next step or reset overwrites.")
      .def(
          "snapshot", [](const AutoresetBatch& batch) { return as_bytes(batch.snapshot()); },
          "All that a run needs to continue bit for bit: that of the batch, and where each world is in its episode.")
      .def(
          "restore", [](AutoresetBatch& batch, const nb::bytes& snapshot) { batch.restore(as_bytes(snapshot)); },
          "snapshot"_a, "Goes back to a snapshot. Raises ValueError if it is of another environment.")
      .def("outcome", &outcome,
           nb::sig("def outcome(self) -> tuple[numpy.typing.NDArray[numpy.float64], "
                   "numpy.typing.NDArray[numpy.bool_], numpy.typing.NDArray[numpy.bool_]]"),
           "Copies of (reward, terminated, truncated), (n) each, of the last step.")
      .def_prop_ro(
          "is_success", [](const AutoresetBatch& batch) { return copied_bools(batch.envs().is_success()); },
          nb::sig("def is_success(self) -> numpy.typing.NDArray[numpy.bool_]"), "(n)")
      .def_prop_ro(
          "unstable", [](const AutoresetBatch& batch) { return copied_bools(batch.envs().unstable()); },
          nb::sig("def unstable(self) -> numpy.typing.NDArray[numpy.bool_]"), "(n)")
      .def(
          "on_final",
          [](AutoresetBatch& batch, nb::object look) {
            batch.on_final([look = std::move(look)](std::span<const int> worlds) {
              const nb::gil_scoped_acquire acquire;
              look(std::vector<int>(worlds.begin(), worlds.end()));
            });
          },
          "look"_a, nb::sig("def on_final(self, look: collections.abc.Callable[[list[int]], None]) -> None"),
          "In mode SAME_STEP, look(worlds) is called with the worlds that have ended before they start anew.")
      .def("final_rows", &final_rows,
           nb::sig("def final_rows(self) -> tuple[numpy.typing.NDArray[numpy.int32], "
                   "numpy.typing.NDArray[numpy.float32], numpy.typing.NDArray[numpy.float32], "
                   "numpy.typing.NDArray[numpy.float32], numpy.typing.NDArray[numpy.bool_], "
                   "numpy.typing.NDArray[numpy.bool_], numpy.typing.NDArray[numpy.float32]] | None"),
           "Of the k worlds that ended and started anew within the last step (mode SAME_STEP): (world (k), observation "
           "(k, observation_dim), achieved_goal (k, goal_dim), desired_goal (k, goal_dim), is_success (k), unstable "
           "(k), "
           "randomized (k, len(spec.randomized))); None if there is none.");
}

}  // namespace

void bind_envs(nb::module_& m) {
  nb::module_ envs = m.def_submodule("envs", "Batches of environments.");
  bind_spec(envs);
  bind_batch(envs);
  bind_env_parts(envs);
  bind_bodies(envs);
  bind_make(envs);
  bind_autoreset(envs);
}

}  // namespace manyhands
