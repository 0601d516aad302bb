// manyhands._core.panda_gym: what the drop-in for panda-gym asks of C++.
#include "manyhands/envs/panda_gym.h"

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bindings/arrays.h"
#include "bindings/bindings.h"
#include "bindings/model/python_model.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

using bindings::Array;

void require(const Array<double, 1>& array, const char* name, std::size_t size) {
  if (array.size() != size) {
    throw std::invalid_argument(std::string(name) + " has " + std::to_string(array.size()) + " numbers; expected " +
                                std::to_string(size));
  }
}

nb::object approach_pose(const PythonModel& self, const std::string& frame, const Array<double, 1>& position,
                         const Array<double, 1>& quaternion, const Array<double, 1>& start) {
  const Model& model = *self.model;
  require(position, "position", 3);
  require(quaternion, "quaternion", 4);
  require(start, "start", static_cast<std::size_t>(model.nq()));
  const Quat<double> r{quaternion(0), quaternion(1), quaternion(2), quaternion(3)};
  const Transform<double> X_WF{to_matrix(normalized(r)), {position(0), position(1), position(2)}};
  const std::vector<double> q = approach(model, model.frame_id(frame), X_WF, bindings::as_span(start));
  return bindings::copied(q.data(), {q.size()});
}

}  // namespace

void bind_panda_gym(nb::module_& parent) {
  nb::module_ m = parent.def_submodule("panda_gym", "panda-gym's laws for a World.");
  m.def(
      "step", [](World& world, int n, const std::vector<std::string>& links) { step_in_air(world, n, links); },
      "world"_a, "n"_a, "links"_a,
      "Advances by n steps in which the air slows free links by accelerations of -u (0.04 + 0.04 |u|), u being their "
      "velocity and their angular velocity. Raises KeyError on an unknown link, ValueError on one that is not free.");
  m.def("approach", &approach_pose, "model"_a, "frame"_a, "position"_a, "quaternion"_a, "start"_a,
        nb::sig("def approach(model: manyhands._core.Model, frame: str, position: numpy.typing.NDArray[numpy.float64], "
                "quaternion: numpy.typing.NDArray[numpy.float64], start: numpy.typing.NDArray[numpy.float64]) -> "
                "numpy.typing.NDArray[numpy.float64]"),
        "The configuration (nq) after at most 20 updates dq = J^T (J J^T + 0.5 1)^-1 e from `start` (nq) towards the "
        "frame's position (3) [m] and quaternion (4), with no regard of limits: it falls short by design.");
}

}  // namespace manyhands
