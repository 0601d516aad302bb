// manyhands._core.World: one world in double precision.
#include "manyhands/physics/world/world.h"

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "bindings/arrays.h"
#include "bindings/bindings.h"
#include "bindings/model/load_warning.h"
#include "bindings/model/model_values.h"
#include "bindings/model/python_model.h"
#include "bindings/pickling.h"
#include "bindings/world/world_parts.h"
#include "manyhands/physics/contact/contact_solver.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

using bindings::copied;
using Doubles = std::vector<double>;
using PerDof = std::variant<double, Doubles>;  // one for all, or one each

constexpr const char* kPerDof = "float | collections.abc.Sequence[float] | numpy.typing.NDArray[numpy.floating]";

Integrator integrator_named(const std::string& name) {
  if (name == "semi_implicit") return Integrator::kSemiImplicit;
  if (name == "rk4") return Integrator::kRungeKutta4;
  throw std::invalid_argument("there is no integrator '" + name + "'; there are 'semi_implicit' and 'rk4'");
}

/// A copy that cannot be written to, so that `world.q[0] = 1` is an error and not a loss.
nb::object read_only(std::span<const double> values) {
  nb::object array = copied(values.data(), {values.size()});
  array.attr("flags").attr("writeable") = false;
  return array;
}

Doubles spread(const PerDof& value, int nv) {
  if (const double* all = std::get_if<double>(&value)) return Doubles(static_cast<std::size_t>(nv), *all);
  return std::get<Doubles>(value);
}

void set_motors(World& world, const PerDof& target_q, const PerDof& target_v, const PerDof& kp, const PerDof& kd,
                const PerDof& max_force) {
  const int nv = world.model().nv();
  const Doubles q = spread(target_q, nv), v = spread(target_v, nv), p = spread(kp, nv), d = spread(kd, nv),
                force = spread(max_force, nv);
  world.set_motors({.target_q = q, .target_v = v, .kp = p, .kd = d, .max_force = force});
}

void move_joints(World& world, const std::map<std::string, double>& targets, double kp, double kd,
                 const std::optional<double>& max_force) {
  std::vector<JointTarget> list;
  for (const auto& [joint, q] : targets) list.push_back({joint, q});
  world.move(list, kp, kd, max_force);
}

const std::string kSetMotors = [] {
  std::string text = "def set_motors(self";
  for (const char* name : {"target_q", "target_v", "kp", "kd", "max_force"}) {
    text += std::string(name == std::string("target_q") ? ", *, " : ", ") + name + ": " + kPerDof;
    if (name == std::string("target_q") || name == std::string("target_v")) text += " = 0.0";
    if (name == std::string("kp")) text += " = 0.1";
    if (name == std::string("kd")) text += " = 1.0";
  }
  return text + ") -> None";
}();

void bind_state(nb::class_<World>& world) {
  const auto getter = [](const char* name) {
    return "def " + std::string(name) + "(self) -> numpy.typing.NDArray[numpy.float64]";
  };
  const auto setter = [](const char* name) {
    return "def " + std::string(name) +
           "(self, arg: collections.abc.Sequence[float] | numpy.typing.NDArray[numpy.floating], /) -> None";
  };
  world
      .def_prop_rw(
          "q", [](const World& self) { return read_only(self.q()); },
          [](World& self, const Doubles& q) { self.set_q(q); }, nb::for_getter(nb::sig(getter("q").c_str())),
          nb::for_setter(nb::sig(setter("q").c_str())), "Configuration (nq): a read-only copy; assign the whole.")
      .def_prop_rw(
          "v", [](const World& self) { return read_only(self.v()); },
          [](World& self, const Doubles& v) { self.set_v(v); }, nb::for_getter(nb::sig(getter("v").c_str())),
          nb::for_setter(nb::sig(setter("v").c_str())), "Velocity (nv): a read-only copy; assign the whole.")
      .def_prop_rw(
          "tau", [](const World& self) { return read_only(self.tau()); },
          [](World& self, const Doubles& tau) { self.set_tau(tau); }, nb::for_getter(nb::sig(getter("tau").c_str())),
          nb::for_setter(nb::sig(setter("tau").c_str())),
          "Joint forces (nv) [N m or N] that act in every step until they are set again: a read-only copy; assign the "
          "whole.")
      .def_prop_rw(
          "ctrl", [](const World& self) { return read_only(self.ctrl()); },
          [](World& self, const Doubles& ctrl) { self.set_ctrl(ctrl); },
          nb::for_getter(nb::sig(getter("ctrl").c_str())), nb::for_setter(nb::sig(setter("ctrl").c_str())),
          "Commands of the actuators (nu), each kept within its range: a read-only copy; assign the whole.")
      .def_prop_rw(
          "act", [](const World& self) { return read_only(self.act()); },
          [](World& self, const Doubles& act) { self.set_act(act); }, nb::for_getter(nb::sig(getter("act").c_str())),
          nb::for_setter(nb::sig(setter("act").c_str())),
          "Activations (na) of the actuators that have one, in their order: a read-only copy; assign the whole. Each "
          "step keeps them within their bounds.")
      .def(
          "activation", [](const World& self, const std::string& actuator) { return self.activation(actuator); },
          "actuator"_a, "The activation of one actuator. Raises ValueError if it has none.")
      .def(
          "set_activation",
          [](World& self, const std::string& actuator, double act) { self.set_activation(actuator, act); },
          "actuator"_a, "act"_a, "Sets it.")
      .def(
          "sensor",
          [](const World& self, const std::string& name) {
            const Doubles numbers = self.sensor(name);
            return copied(numbers.data(), {numbers.size()});
          },
          "name"_a, nb::sig("def sensor(self, name: str) -> numpy.typing.NDArray[numpy.float64]"),
          "The numbers (size) of one of `Model.sensors`: of the present state, or of the last step where it needs "
          "forces or accelerations. Where there was no step in this world, what the next would find. Raises "
          "RuntimeError with 'rk4', which finds none.")
      .def(
          "sensor_data",
          [](const World& self) {
            const Doubles numbers = self.sensor_data();
            return copied(numbers.data(), {numbers.size()});
          },
          nb::sig("def sensor_data(self) -> numpy.typing.NDArray[numpy.float64]"),
          "Of all sensors, one after the other in the order of `Model.sensors`.")
      .def_prop_ro(
          "tendon_lengths", [](const World& self) { return read_only(self.tendon_lengths()); },
          nb::sig(getter("tendon_lengths").c_str()),
          "Of `Model.tendons` (tendons): [m], or of fixed ones what their joints' q add up to.")
      .def_prop_ro(
          "tendon_velocities", [](const World& self) { return read_only(self.tendon_velocities()); },
          nb::sig(getter("tendon_velocities").c_str()), "Their rates (tendons).")
      .def(
          "set_keyframe", [](World& self, const std::string& name) { self.set_keyframe(name); }, "name"_a,
          "Sets q, v, ctrl, act and the poses of mocap bodies as the model's keyframe has them. Raises KeyError where "
          "there "
          "is none of that name; a world has none any more when parts have come or gone.")
      .def(
          "snapshot", [](const World& self) { return bindings::as_bytes(self.snapshot()); },
          "All that a run continues from, bit for bit, in the middle of contact too: state, contact cache, "
          "commands, forces applied, parameters and clock; not the solver's settings.")
      .def("forget", &World::forget,
           "Starts the clock anew and forgets the solver's warm start: what follows depends on q, v, act, forces and "
           "commands alone.")
      .def(
          "restore", [](World& self, const nb::bytes& snapshot) { self.restore(bindings::as_bytes(snapshot)); },
          "snapshot"_a,
          "Goes back to a snapshot. Raises ValueError if it is damaged, or of another model or time step. `contacts` "
          "and "
          "the like are empty until the next step.")
      .def("state_hash", &World::state_hash, "FNV-1a (64 bits) over what a snapshot holds.");
}

void bind_measures(nb::class_<World>& world) {
  world
      .def(
          "energy",
          [](const World& self) {
            const Energy<double> e = self.energy();
            return std::pair{e.kinetic, e.potential};
          },
          "(kinetic, potential) [J]; the potential is 0 at the world's origin.")
      .def(
          "momentum",
          [](const World& self) {
            const Force<double> p = self.mass_properties().momentum;
            return copied(&p.n.x, {6});
          },
          nb::sig("def momentum(self) -> numpy.typing.NDArray[numpy.float64]"),
          "About the world's origin (6): angular [kg m^2/s], linear [kg m/s].")
      .def(
          "center_of_mass",
          [](const World& self) {
            const Vec3<double> c = self.mass_properties().com;
            return copied(&c.x, {3});
          },
          nb::sig("def center_of_mass(self) -> numpy.typing.NDArray[numpy.float64]"), "In the world (3) [m].");
}

void bind_solver(nb::class_<World>& world) {
  world
      .def(
          "set_solver",
          [](World& self, std::optional<int> max_iterations, std::optional<double> tolerance) {
            SolverSettings settings = self.solver();
            if (max_iterations) settings.max_iterations = *max_iterations;
            if (tolerance) settings.tolerance = *tolerance;
            self.set_solver(settings);
          },
          nb::kw_only(), "max_iterations"_a = nb::none(), "tolerance"_a = nb::none(),
          "How hard the contact solver works: at most max_iterations passes over all contacts, until none changes a "
          "velocity by more than tolerance [m/s]. What is None stays.")
      .def_prop_ro(
          "max_iterations", [](const World& self) { return self.solver().max_iterations; },
          "How many passes over all contacts a step may take.")
      .def_prop_ro(
          "tolerance", [](const World& self) { return self.solver().tolerance; }, "[m/s]")
      .def_prop_ro("solver_iterations", &World::solver_iterations, "Iterations that the last step took.");
}

void bind_making(nb::class_<World>& world) {
  constexpr const char* kIntegrator = "integrator: typing.Literal['semi_implicit', 'rk4'] = 'semi_implicit'";
  static const std::string init = std::string(
                                      "def __init__(self, model: Model | None = None, "
                                      "time_step: float | None = None, ") +
                                  kIntegrator + ") -> None";
  static const std::string from_file =
      std::string("def from_file(path: str | os.PathLike, time_step: float | None = None, ") + kIntegrator +
      ", *, allow_outside_package: bool = False, compliance: typing.Literal['stated', 'all', 'none'] = 'stated') -> "
      "World";
  world
      .def(
          "__init__",
          [](World* self, const PythonModel* model, std::optional<double> time_step, const std::string& integrator) {
            const double asked = model != nullptr ? model->model->time_step().value_or(0.002) : 0.002;
            const double h = time_step.value_or(asked);
            if (model == nullptr) {
              new (self) World(h, integrator_named(integrator));
            } else {
              new (self) World(model->model, h, integrator_named(integrator));
            }
          },
          "model"_a.none() = nb::none(), "time_step"_a = nb::none(), "integrator"_a = "semi_implicit",
          nb::sig(init.c_str()),
          "model: None for a world without parts. time_step [s]: None for the model's own, or 0.002. 'semi_implicit': "
          "Euler at the velocity level with implicit damping, motors, joint limits and contacts. 'rk4': the classic "
          "method of fourth order with Munthe-Kaas' correction for rotations; no motors, limits or contacts.")
      .def_static(
          "from_file",
          [](const std::filesystem::path& path, std::optional<double> time_step, const std::string& integrator,
             bool allow_outside_package, const std::string& compliance) {
            auto loaded = std::make_unique<World>(
                World::from_file(path, time_step, integrator_named(integrator), allow_outside_package,
                                 bindings::named("compliance", compliance, bindings::kCompliances)));
            bindings::warn_of(loaded->report().notes, "the world's `report`");
            return loaded;
          },
          "path"_a, "time_step"_a = nb::none(), "integrator"_a = "semi_implicit", nb::kw_only(),
          "allow_outside_package"_a = false, "compliance"_a = "stated", nb::sig(from_file.c_str()),
          "A world of a URDF file, its base fixed, of an MJCF or of an SDF file; what the loader changed is in "
          "`report`, "
          "and it warns of parts that it had to leave out. "
          "time_step [s]: None for the file's own, or 0.002. allow_outside_package: whether the files that it names "
          "may "
          "lie outside its package. compliance: which constraints of an MJCF file give way, as for `load_mjcf`. Raises "
          "FileNotFoundError, UrdfError, MjcfError, SdfError.")
      .def(
          "copy", [](const World& self) { return std::make_unique<World>(self); }, "Another world in the same state.")
      .def("__copy__", [](const World& self) { return std::make_unique<World>(self); })
      .def(
          "__deepcopy__", [](const World& self, const nb::object&) { return std::make_unique<World>(self); }, "memo"_a)
      .def_prop_ro(
          "model", [](const World& self) { return std::make_unique<PythonModel>(self.shared_model()); },
          "The model of the parts there are now; another one after parts come or go.")
      .def_prop_ro(
          "report", [](const World& self) { return self.report(); },
          "What loaders defaulted, repaired or ignored in the files of this world.")
      .def("__repr__", [](const World& self) {
        const Model& model = self.model();
        return "<World '" + model.name() + "': " + std::to_string(model.links().size()) + " links, nq " +
               std::to_string(model.nq()) + ", nv " + std::to_string(model.nv()) + ", time " +
               std::to_string(self.time()) + " s>";
      });
}

}  // namespace

void bind_world(nb::module_& m) {
  nb::exception<SimulationError>(m, "SimulationError", PyExc_RuntimeError).doc() =
      "A step led to numbers that are not finite, or moved things so far that it made motion from nothing: the message "
      "names joints, time and cause. The world is as it was before that step.";
  auto world = nb::class_<World>(
      m, "World",
      "A model in motion, in double precision: parts with names, contact, motors and actuators.\n\n"
      "Starts at rest in the model's initial configuration with motors off. Setters raise ValueError on a wrong "
      "length, "
      "a number that is not finite, or a quaternion not of unit length; names that are not there raise KeyError.");
  bind_making(world);
  bindings::pickle_by(world, &World::archived, &World::unarchived);
  world
      .def(
          "step", [](World& self, int n) { step_in_pieces(self, n, 1000); }, "n"_a = 1,
          "Advances by n steps; Ctrl-C stops between two of them. Raises SimulationError, naming a joint, if a step "
          "leads to numbers that are not finite, or moves things so far that it makes motion from nothing: the world "
          "is "
          "then as it was before that step. With 'rk4' raises "
          "RuntimeError if a motor is on, something touches or a joint leaves its limits.")
      .def(
          "set_motors", &set_motors, nb::kw_only(), "target_q"_a = 0.0, "target_v"_a = 0.0, "kp"_a = 0.1, "kd"_a = 1.0,
          "max_force"_a, nb::sig(kSetMotors.c_str()),
          "Motors as PyBullet's: each step drives a dof towards the velocity kp (target_q - q) / time_step + v' + "
          "kd (target_v - v') with at most max_force, where v' is what it would reach without. One number for all dofs "
          "or one each (nv); targets [rad or m] and [rad/s or m/s], forces [N m or N], 0 switches a motor off. "
          "target_q is not read for rotations by quaternion. Raises ValueError where a position or velocity actuator "
          "drives the dof: command it by `ctrl`.")
      .def(
          "move", &move_joints, "targets"_a, nb::kw_only(), "kp"_a = 0.1, "kd"_a = 1.0, "max_force"_a = nb::none(),
          nb::sig("def move(self, targets: collections.abc.Mapping[str, float], *, kp: float = 0.1, kd: float = 1.0, "
                  "max_force: float | None = None) -> None"),
          "Moves joints by name, as `world.move({'panda_joint1': 0.3})`: sets their motors as `set_motors` does, "
          "targets "
          "[rad or m], and leaves the others alone. max_force [N m or N] is each joint's effort unless it is given. "
          "Raises KeyError for a name that is not there, ValueError for a joint without exactly one degree of freedom, "
          "or whose effort nobody gave, and for a target beyond limits; then no motor has changed.")
      .def(
          "show",
          [](const nb::object& self, const nb::kwargs& options) {
            return nb::module_::import_("manyhands.viewer").attr("view")(self, **options);
          },
          nb::sig("def show(self, **options: typing.Any) -> manyhands.viewer.Viewer"),
          "Opens a page for the browser that shows this world: `manyhands.view`. Needs pip install "
          "'manyhands[viewer]'.")
      .def_prop_ro("time_step", &World::time_step, "[s]")
      .def_prop_ro("time", &World::time, "[s]");
  bind_state(world);
  bind_measures(world);
  bind_solver(world);
  bind_world_bodies(world);
  bind_world_contacts(m, world);
  bind_world_queries(m, world);
  bind_world_parts(world);
}

}  // namespace manyhands
