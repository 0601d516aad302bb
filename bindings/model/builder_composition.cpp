// manyhands._core: models that become parts of others.
#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bindings/bindings.h"
#include "bindings/model/builder_names.h"
#include "bindings/model/model_values.h"
#include "bindings/model/python_model.h"
#include "manyhands/model/compose.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

using bindings::Numbers3;
using bindings::Numbers4;

void bind_builder_composition(nb::class_<ModelBuilder>& builder) {
  builder
      .def_static(
          "of", [](const PythonModel& model) { return builder_of(*model.model); }, "model"_a,
          "A builder that holds the model's parts, gravity, medium, time step and rules of contact; keyframes stay "
          "behind.")
      .def(
          "add_model",
          [](ModelBuilder& self, const PythonModel& model, const std::string& frame, const Numbers3& position,
             const Numbers4& orientation, const std::string& prefix) {
            const auto [link, X_LF] = self.frame(frame);
            const Transform<double> X_FM = bindings::transform("the model's place", position, orientation);
            append(self, *model.model, {.X_WM = X_LF * X_FM, .prefix = prefix, .onto = link});
          },
          "model"_a, nb::kw_only(), "frame"_a = "world", "position"_a = Numbers3{},
          "quaternion"_a = Numbers4{0, 0, 0, 1}, "prefix"_a = "",
          nb::sig("def add_model(self, model: Model, *, frame: str = 'world', position: numpy.typing.ArrayLike = "
                  "(0, 0, 0), quaternion: numpy.typing.ArrayLike = (0, 0, 0, 1), prefix: str = '') -> None"),
          "Adds the parts of a model, their names after `prefix`. Its world frame comes to lie at position (3) [m] and "
          "quaternion xyzw (4) in a link or frame, and its bases are fixed there by joints 'BASE_mount': a gripper on "
          "a flange. Keyframes stay behind. Raises ValueError on a name that is taken and on an unknown frame.")
      .def(
          "set_initial",
          [](ModelBuilder& self, const std::string& joint, const std::vector<double>& q) {
            self.set_initial(bindings::joint_of(self, joint), q);
          },
          "joint"_a, "q"_a, nb::sig("def set_initial(self, joint: str, q: numpy.typing.ArrayLike) -> None"),
          "Where a joint starts, in q. Raises ValueError on a wrong length.");
}

}  // namespace manyhands
