// manyhands._core.Batch: many worlds of one model, in arrays whose rows are worlds.
#include "manyhands/physics/world/batch.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>

#include "bindings/arrays.h"
#include "bindings/bindings.h"
#include "bindings/model/python_model.h"
#include "bindings/pickling.h"
#include "manyhands/physics/contact/contact_solver.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

using bindings::Array;
using bindings::copied;
using Bytes = std::optional<Array<bool, 1>>;

constexpr const char* kFloats = "numpy.typing.NDArray[numpy.float32]";

std::size_t count(const Batch& batch) { return static_cast<std::size_t>(batch.num_worlds()); }

/// What people hand over, as float32 rows for each world: one number or row stands for all.
class Rows {
 public:
  Rows(const Batch& batch, const nb::object& values, std::size_t columns)
      : Rows(values, nb::make_tuple(count(batch), columns)) {}
  /// One number for each world.
  Rows(const Batch& batch, const nb::object& values) : Rows(values, nb::make_tuple(count(batch))) {}

  [[nodiscard]] std::span<const float> span() const { return {array_.data(), array_.size()}; }

 private:
  using Any = nb::ndarray<const float, nb::c_contig, nb::device::cpu>;

  Rows(const nb::object& values, const nb::tuple& shape) {
    const nb::module_ numpy = nb::module_::import_("numpy");
    const nb::object floats = numpy.attr("asarray")(values, "dtype"_a = numpy.attr("float32"));
    try {
      owner_ = numpy.attr("ascontiguousarray")(numpy.attr("broadcast_to")(floats, shape));
    } catch (nb::python_error& error) {
      if (!error.matches(PyExc_ValueError)) throw;
      const nb::object given_shape = floats.attr("shape");
      const std::string given = nb::repr(given_shape).c_str(), wanted = nb::repr(shape).c_str();
      throw std::invalid_argument("values of shape " + given + " cannot be broadcast to " + wanted +
                                  ", the first for worlds, or one row or number for all");
    }
    array_ = nb::cast<Any>(owner_);
  }

  nb::object owner_;
  Any array_;
};

std::span<const std::uint8_t> bytes(const Bytes& mask) {
  if (!mask) return {};
  return {reinterpret_cast<const std::uint8_t*>(mask->data()), mask->size()};
}

nb::object matrix(const Batch& batch, const std::vector<float>& values) {
  return copied(values.data(), {count(batch), values.size() / count(batch)});
}

std::string getter(const std::string& name) { return "def " + name + "(self) -> " + kFloats; }
std::string setter(const std::string& name) { return "def " + name + "(self, arg: numpy.typing.ArrayLike, /) -> None"; }

using Get = std::vector<float> (Batch::*)() const;
using Set = void (Batch::*)(std::span<const float>, std::span<const std::uint8_t>);

/// A property, and a setter for some of the worlds.
void bind_rows(nb::class_<Batch>& batch, const std::string& name, int (Model::*columns)() const, Get get, Set set,
               const char* doc) {
  const std::string method = "set_" + name;
  const std::string signature = "def " + method +
                                "(self, values: numpy.typing.ArrayLike, mask: "
                                "numpy.typing.NDArray[numpy.bool_] | None = None) -> None";
  const auto write = [columns, set](Batch& self, const nb::object& values, const Bytes& mask) {
    const Rows rows(self, values, static_cast<std::size_t>((self.model().*columns)()));
    (self.*set)(rows.span(), bytes(mask));
  };
  batch
      .def_prop_rw(
          name.c_str(), [get](const Batch& self) { return matrix(self, (self.*get)()); },
          [write](Batch& self, const nb::object& values) { write(self, values, {}); },
          nb::for_getter(nb::sig(getter(name).c_str())), nb::for_setter(nb::sig(setter(name).c_str())), doc)
      .def(method.c_str(), write, "values"_a, "mask"_a = nb::none(), nb::sig(signature.c_str()),
           "Sets the rows where `mask` (n) is true; one row stands for all.");
}

void bind_state(nb::class_<Batch>& batch) {
  bind_rows(batch, "q", &Model::nq, &Batch::q, &Batch::set_q, "Configurations (n, nq): a copy; assign the whole.");
  bind_rows(batch, "v", &Model::nv, &Batch::v, &Batch::set_v, "Velocities (n, nv): a copy; assign the whole.");
  bind_rows(batch, "tau", &Model::nv, &Batch::tau, &Batch::set_tau,
            "Joint forces (n, nv) [N m or N] that act until they are set again: a copy; assign the whole.");
  bind_rows(batch, "ctrl", &Model::nu, &Batch::ctrl, &Batch::set_ctrl,
            "Commands of the actuators (n, nu), each kept within its range: a copy; assign the whole.");
  bind_rows(batch, "act", &Model::na, &Batch::act, &Batch::set_act,
            "Activations of the actuators that have one (n, na): a copy; assign the whole.");
  batch
      .def_prop_ro(
          "mocap",
          [](const Batch& self) {
            const std::size_t count = self.model().mocap_bodies().size();
            return bindings::copied(self.mocap().data(), {static_cast<std::size_t>(self.num_worlds()), count, 7});
          },
          nb::sig("def mocap(self) -> numpy.typing.NDArray[numpy.float32]"),
          "Poses of the mocap bodies (n, mocap bodies, 7): x y z [m], quaternion xyzw; see `Model.mocap_bodies`.")
      .def(
          "snapshot", [](const Batch& self) { return bindings::as_bytes(self.snapshot()); },
          "All that the worlds continue from, bit for bit, whatever the lanes and threads.")
      .def(
          "restore",
          [](Batch& self, const nb::bytes& snapshot, const Bytes& mask) {
            self.restore(bindings::as_bytes(snapshot), bytes(mask));
          },
          "snapshot"_a, "mask"_a = nb::none(),
          "Puts the worlds where `mask` (n) is true back to what they were in a snapshot. Raises ValueError if it is "
          "damaged, or of another model, time step or number of worlds.")
      .def(
          "reset", [](Batch& self, const Bytes& mask) { self.reset(bytes(mask)); }, "mask"_a = nb::none(),
          "Puts the worlds where `mask` (n) is true back to the start; parameters stay.")
      .def("state_hash", &Batch::state_hash, "FNV-1a (64 bits) over what a snapshot holds.")
      .def_prop_ro(
          "flags", [](const Batch& self) { return copied(self.flags().data(), {count(self)}); },
          nb::sig("def flags(self) -> numpy.typing.NDArray[numpy.uint8]"),
          "A byte for each world (n). 1: its numbers stopped being finite, or a step moved it so far that it made "
          "motion "
          "from nothing, and it stands as it was before that step until it is reset or restored. 2: a penetration "
          "beyond "
          "1 cm in the last call of `step`. 4: in that call the solver left contacts that still changed by more than "
          "5 cm/s: give it more iterations, or use a World.");
}

void bind_clock(nb::class_<Batch>& batch) {
  batch
      .def(
          "__init__",
          [](Batch* self, const PythonModel& model, int n, std::optional<double> time_step,
             std::optional<int> num_threads, int lanes) {
            new (self) Batch(model.model, n, time_step.value_or(model.model->time_step().value_or(0.002)),
                             {.num_threads = num_threads.value_or(0), .lanes = lanes});
          },
          "model"_a, "n"_a, "time_step"_a = nb::none(), "num_threads"_a = nb::none(), "lanes"_a = 0,
          nb::sig("def __init__(self, model: Model, n: int, time_step: float | None = None, "
                  "num_threads: int | None = None, lanes: int = 0) -> None"),
          "n worlds. time_step [s]: None for the model's own, or 0.002. num_threads: None for the variable "
          "MANYHANDS_THREADS, or one for each core. lanes: 0 for the fastest, else 1 or a width that this build has; "
          "results do not depend on either.")
      // Keeps the interpreter's lock, so that Python's threads take turns with a batch.
      .def(
          "step", [](Batch& self, int n) { step_in_pieces(self, n, 500); }, "n"_a = 1,
          "Advances all worlds by n steps; Ctrl-C stops between two of them. One whose numbers stop being finite, or "
          "that "
          "makes motion from nothing, stays as it was; see `flags`.")
      .def("__len__", &Batch::num_worlds)
      .def_prop_ro(
          "model", [](const Batch& self) { return std::make_unique<PythonModel>(self.shared_model()); },
          "What all its worlds are of.")
      .def_prop_ro("num_worlds", &Batch::num_worlds, "How many worlds it steps.")
      .def_prop_ro("num_threads", &Batch::num_threads, "How many threads share them.")
      .def_prop_ro("lanes", &Batch::lanes, "Worlds that share the registers of one core.")
      .def_prop_ro("time_step", &Batch::time_step, "[s]")
      .def_prop_ro(
          "time",
          [](const Batch& self) {
            const std::vector<double> time = self.time();
            return copied(time.data(), {time.size()});
          },
          nb::sig("def time(self) -> numpy.typing.NDArray[numpy.float64]"), "Since each world began (n) [s].")
      .def(
          "set_solver",
          [](Batch& self, std::optional<int> max_iterations, std::optional<double> tolerance) {
            SolverSettings settings = self.solver();
            if (max_iterations) settings.max_iterations = *max_iterations;
            if (tolerance) settings.tolerance = *tolerance;
            self.set_solver(settings);
          },
          nb::kw_only(), "max_iterations"_a = nb::none(), "tolerance"_a = nb::none(), "As `World.set_solver`.")
      .def(
          "set_motors",
          [](Batch& self, const nb::object& target_q, const nb::object& target_v, const nb::object& kp,
             const nb::object& kd, const nb::object& max_force) {
            const auto nv = static_cast<std::size_t>(self.model().nv());
            const Rows q(self, target_q, nv), v(self, target_v, nv), p(self, kp, nv), d(self, kd, nv),
                force(self, max_force, nv);
            self.set_motors({q.span(), v.span(), p.span(), d.span(), force.span()});
          },
          nb::kw_only(), "target_q"_a = 0.0, "target_v"_a = 0.0, "kp"_a = 0.1, "kd"_a = 1.0, "max_force"_a,
          nb::sig("def set_motors(self, *, target_q: numpy.typing.ArrayLike = 0.0, "
                  "target_v: numpy.typing.ArrayLike = 0.0, kp: numpy.typing.ArrayLike = 0.1, "
                  "kd: numpy.typing.ArrayLike = 1.0, max_force: numpy.typing.ArrayLike) -> None"),
          "As `World.set_motors`: one number, one row (nv), or one for each world (n, nv).");
}

void bind_bodies(nb::class_<Batch>& batch) {
  const auto pair = [](const std::string& head) { return head + " -> tuple[" + kFloats + ", " + kFloats + "]"; };
  const std::string force =
      "def apply_force(self, link: str, force: numpy.typing.ArrayLike, torque: "
      "numpy.typing.ArrayLike | None = None, point: numpy.typing.ArrayLike | None = None) -> None";
  batch
      .def(
          "body_pose",
          [](Batch& self, const std::string& name) {
            std::vector<float> p(3 * count(self)), r(4 * count(self));
            self.body_pose(name, p, r);
            return std::pair{matrix(self, p), matrix(self, r)};
          },
          "name"_a, nb::sig(pair("def body_pose(self, name: str)").c_str()),
          "Of a link or frame in each world: position (n, 3) [m], quaternion xyzw (n, 4).")
      .def(
          "body_velocity",
          [](Batch& self, const std::string& name) {
            std::vector<float> w(3 * count(self)), v(3 * count(self));
            self.body_velocity(name, w, v);
            return std::pair{matrix(self, w), matrix(self, v)};
          },
          "name"_a, nb::sig(pair("def body_velocity(self, name: str)").c_str()),
          "Of a link or frame: angular (n, 3) [rad/s], and that of its origin (n, 3) [m/s], in world axes.")
      .def(
          "set_mocap",
          [](Batch& self, const std::string& link, const nb::object& position, const nb::object& quaternion,
             const Bytes& mask) {
            const Rows p(self, position, 3), r(self, quaternion, 4);
            self.set_mocap(link, p.span(), r.span(), bytes(mask));
          },
          "link"_a, "position"_a, "quaternion"_a, "mask"_a = nb::none(),
          nb::sig(
              "def set_mocap(self, link: str, position: numpy.typing.ArrayLike, quaternion: numpy.typing.ArrayLike, "
              "mask: numpy.typing.ArrayLike | None = None) -> None"),
          "Puts a mocap body, at rest, at positions (n, 3) [m] and quaternions xyzw (n, 4); one row stands for all. "
          "Raises ValueError for other links.")
      .def(
          "apply_force",
          [](Batch& self, const std::string& link, const nb::object& force_rows, const nb::object& torque,
             const nb::object& point) {
            const Rows f(self, force_rows, 3), n(self, torque.is_none() ? nb::cast(0.0) : torque, 3);
            if (point.is_none()) {
              self.apply_force(link, f.span(), n.span());
            } else {
              self.apply_force(link, f.span(), n.span(), Rows(self, point, 3).span());
            }
          },
          "link"_a, "force"_a, "torque"_a = nb::none(), "point"_a = nb::none(), nb::sig(force.c_str()),
          "Forces (n, 3) [N] at points (n, 3) [m], default the link's centre of mass, and torques (n, 3) [N m], in "
          "world "
          "axes; one row stands for all. They act in the next step only, and add up.")
      .def_prop_ro(
          "contact_count",
          [](const Batch& self) {
            const std::vector<std::int32_t> counts = self.contact_count();
            return copied(counts.data(), {counts.size()});
          },
          nb::sig("def contact_count(self) -> numpy.typing.NDArray[numpy.int32]"),
          "Points that touched in the last step (n).")
      .def(
          "max_penetration",
          [](const Batch& self) {
            const std::vector<float> deepest = self.max_penetration();
            return copied(deepest.data(), {deepest.size()});
          },
          nb::sig(getter("max_penetration").c_str()), "Of the deepest contact before the last step (n) [m].")
      .def(
          "contact_wrench",
          [](const Batch& self, const std::string& link) {
            std::vector<float> normal(6 * count(self)), friction(normal);
            self.contact_wrench(link, normal, friction);
            return std::pair{matrix(self, normal), matrix(self, friction)};
          },
          "link"_a, nb::sig(pair("def contact_wrench(self, link: str)").c_str()),
          "What the last step's contacts do to a link: torque, force (n, 6) of normal forces, and of friction, in "
          "world "
          "axes about its origin as it was before the step.")
      .def(
          "contact_force",
          [](const Batch& self, const std::string& link) {
            std::vector<float> normal(6 * count(self)), friction(normal);
            self.contact_wrench(link, normal, friction);
            for (std::size_t i = 0; i < normal.size(); ++i) normal[i] += friction[i];
            return matrix(self, normal);
          },
          "link"_a, nb::sig(("def contact_force(self, link: str) -> " + std::string(kFloats)).c_str()),
          "Both parts of `contact_wrench` together (n, 6).");
}

using SetByName = void (Batch::*)(std::string_view, std::span<const float>);

void bind_parameter(nb::class_<Batch>& batch, const std::string& method, const char* of, SetByName set,
                    const char* doc) {
  const std::string signature = "def " + method + "(self, " + of + ": str, values: numpy.typing.ArrayLike) -> None";
  batch.def(
      method.c_str(),
      [set](Batch& self, const std::string& name, const nb::object& values) {
        (self.*set)(name, Rows(self, values).span());
      },
      nb::arg(of), "values"_a, nb::sig(signature.c_str()), doc);
}

void bind_parameters(nb::class_<Batch>& batch) {
  bind_parameter(batch, "set_mass", "link", &Batch::set_mass,
                 "One for all or for each world [kg]; scales the inertia.");
  bind_parameter(batch, "set_friction", "name", &Batch::set_friction, "Of a geom, or of a link's colliding geoms.");
  bind_parameter(batch, "set_spinning_friction", "name", &Batch::set_spinning_friction, "The same [m].");
  bind_parameter(batch, "set_rolling_friction", "name", &Batch::set_rolling_friction, "The same [m].");
  bind_parameter(batch, "set_restitution", "name", &Batch::set_restitution, "The same.");
  bind_parameter(batch, "set_damping", "joint", &Batch::set_damping, "Of a joint [N m s/rad or N s/m].");
  bind_parameter(batch, "set_stiffness", "joint", &Batch::set_stiffness, "Of a joint's spring [N m/rad or N/m].");
  bind_parameter(batch, "set_joint_friction", "joint", &Batch::set_joint_friction, "Dry friction [N m or N].");
  bind_parameter(batch, "set_armature", "joint", &Batch::set_armature, "Rotor inertia [kg m^2 or kg].");
  batch
      .def(
          "set_gravity",
          [](Batch& self, const nb::object& gravity) { self.set_gravity(Rows(self, gravity, 3).span()); }, "gravity"_a,
          nb::sig("def set_gravity(self, gravity: numpy.typing.ArrayLike) -> None"), "(3) or (n, 3) [m/s^2].")
      .def(
          "set_geom_size",
          [](Batch& self, const std::string& geom, const nb::object& size) {
            self.set_geom_size(geom, Rows(self, size, 3).span());
          },
          "geom"_a, "size"_a, nb::sig("def set_geom_size(self, geom: str, size: numpy.typing.ArrayLike) -> None"),
          "(3) or (n, 3) [m], see `World.geom_size`.")
      .def(
          "set_gains",
          [](Batch& self, const std::string& actuator, const nb::object& kp, const nb::object& kd) {
            self.set_gains(actuator, Rows(self, kp).span(), Rows(self, kd).span());
          },
          "actuator"_a, "kp"_a, "kd"_a,
          nb::sig("def set_gains(self, actuator: str, kp: numpy.typing.ArrayLike, kd: numpy.typing.ArrayLike) -> None"),
          "Of a position or velocity actuator: one for all, or for each world (n).");
}

}  // namespace

void bind_batch_worlds(nb::module_& m) {
  auto batch = nb::class_<Batch>(
      m, "Batch",
      "n worlds of one model in single precision, stepped together in SIMD lanes and threads.\n\n"
      "Rows of arrays are worlds. Each world has the same bits whatever the size of the batch, the lanes or the "
      "threads. "
      "Setters raise ValueError on a wrong shape or a number that is not finite; unknown names raise KeyError.");
  bind_clock(batch);
  bind_state(batch);
  bind_bodies(batch);
  bind_parameters(batch);
  batch.def("__repr__", [](const Batch& self) {
    return "<Batch of " + std::to_string(self.num_worlds()) + (self.num_worlds() == 1 ? " world" : " worlds") +
           " of '" + self.model().name() + "': nq " + std::to_string(self.model().nq()) + ", nv " +
           std::to_string(self.model().nv()) + ", " + std::to_string(self.lanes()) + " lanes, " +
           std::to_string(self.num_threads()) + (self.num_threads() == 1 ? " thread>" : " threads>");
  });
  bindings::pickle_by(batch, &Batch::archived, &Batch::unarchived);
}

}  // namespace manyhands
