// manyhands._core.ModelBuilder: actuators and sensors.
#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>

#include <tuple>

#include "bindings/model/builder_names.h"
#include "bindings/model/model_values.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

using bindings::actuator_of;
using bindings::joint_of;
using bindings::kInfinity;
using bindings::named;
using bindings::Numbers3;
using bindings::tendon_of;
using bindings::vec3;

SensorType sensor_type(const std::string& name) {
  std::string known;
  for (int i = 0; i < kSensorTypes; ++i) {
    const auto type = static_cast<SensorType>(i);
    if (name == to_string(type)) return type;
    known += std::string(i == 0 ? "'" : ", '") + to_string(type) + "'";
  }
  throw std::invalid_argument("there is no sensor type '" + name + "'; there are " + known);
}

}  // namespace

void bind_builder_actuators(nb::class_<ModelBuilder>& builder) {
  builder
      .def(
          "add_actuator",
          [](ModelBuilder& self, const std::string& name, const std::string& type, const std::string& joint,
             const std::string& tendon, const std::string& site, const std::string& reference, const Numbers3& force,
             const Numbers3& torque, double gear, double kp, double kd, const Numbers3& gain, const Numbers3& bias,
             double ctrl_scale, double ctrl_offset, const std::pair<double, double>& ctrl_range, double max_force,
             std::optional<double> min_force, const std::string& activation, double time_constant,
             const std::pair<double, double>& act_range, bool act_early) {
            Actuator actuator{.name = name,
                              .type = named("actuator type", type, bindings::kActuators),
                              .joint = joint.empty() ? JointId() : joint_of(self, joint),
                              .tendon = tendon.empty() ? TendonId() : tendon_of(self, tendon),
                              .gear = gear,
                              .ctrl_scale = ctrl_scale,
                              .ctrl_offset = ctrl_offset,
                              .kp = kp,
                              .kd = kd,
                              .gain = gain,
                              .bias = bias,
                              .activation = {.type = named("activation", activation, bindings::kActivations),
                                             .time_constant = time_constant,
                                             .lower = act_range.first,
                                             .upper = act_range.second,
                                             .early = act_early},
                              .min_ctrl = ctrl_range.first,
                              .max_ctrl = ctrl_range.second,
                              .max_force = max_force,
                              .min_force = min_force};
            if (!site.empty()) {
              actuator.site.emplace(ActuatorSite{.force = vec3(force), .torque = vec3(torque)});
              std::tie(actuator.site->link, actuator.site->X_LS) = self.frame(site);
              if (!reference.empty()) std::tie(actuator.site->reference, actuator.site->X_LR) = self.frame(reference);
            }
            self.add_actuator(std::move(actuator));
          },
          "name"_a, "type"_a, "joint"_a = "", nb::kw_only(), "tendon"_a = "", "site"_a = "", "reference"_a = "",
          "force"_a = Numbers3{0, 0, 0}, "torque"_a = Numbers3{0, 0, 0}, "gear"_a = 1.0, "kp"_a = 0.0, "kd"_a = 0.0,
          "gain"_a = Numbers3{1, 0, 0}, "bias"_a = Numbers3{0, 0, 0}, "ctrl_scale"_a = 1.0, "ctrl_offset"_a = 0.0,
          "ctrl_range"_a = std::pair{-kInfinity, kInfinity}, "max_force"_a = kInfinity, "min_force"_a = nb::none(),
          "activation"_a = "none", "time_constant"_a = 1.0, "act_range"_a = std::pair{-kInfinity, kInfinity},
          "act_early"_a = false,
          nb::sig("def add_actuator(self, name: str, type: typing.Literal['force', 'position', 'velocity', 'affine'], "
                  "joint: str = '', *, tendon: str = '', site: str = '', reference: str = '', "
                  "force: numpy.typing.ArrayLike = ..., torque: numpy.typing.ArrayLike = ..., gear: float = 1.0, "
                  "kp: float = 0.0, kd: float = 0.0, gain: numpy.typing.ArrayLike = ..., "
                  "bias: numpy.typing.ArrayLike = ..., ctrl_scale: float = 1.0, ctrl_offset: float = 0.0, "
                  "ctrl_range: tuple[float, float] = ..., max_force: float = ..., min_force: float | None = None, "
                  "activation: typing.Literal['none', 'integrator', 'filter', 'filterexact'] = 'none', "
                  "time_constant: float = 1.0, act_range: tuple[float, float] = ..., act_early: bool = False) -> None"),
          "Drives a joint of one degree of freedom, a tendon, or pulls at a site, a link or frame, with `force` and "
          "`torque` in its axes, or in those of `reference`, against which it pulls then. `Actuator` says what its "
          "numbers mean.")
      .def(
          "add_sensor",
          [](ModelBuilder& self, const std::string& name, const std::string& type, const std::string& joint,
             const std::string& tendon, const std::string& actuator, const std::string& frame,
             const std::string& reference, const std::string& shape, const Numbers3& size, double cutoff) {
            Sensor sensor{.name = name, .type = sensor_type(type), .cutoff = cutoff};
            if (!joint.empty()) sensor.joint = joint_of(self, joint);
            if (!tendon.empty()) sensor.tendon = tendon_of(self, tendon);
            if (!actuator.empty()) sensor.actuator = actuator_of(self, actuator);
            if (!frame.empty()) std::tie(sensor.link, sensor.X_LF) = self.frame(frame);
            if (!reference.empty()) std::tie(sensor.reference, sensor.X_LR) = self.frame(reference);
            sensor.volume = {.type = named("shape", shape, bindings::kShapes), .size = vec3(size)};
            self.add_sensor(std::move(sensor));
          },
          "name"_a, "type"_a, nb::kw_only(), "joint"_a = "", "tendon"_a = "", "actuator"_a = "", "frame"_a = "",
          "reference"_a = "", "shape"_a = "sphere", "size"_a = Numbers3{0.005, 0, 0}, "cutoff"_a = 0.0,
          nb::sig("def add_sensor(self, name: str, type: str, *, joint: str = '', tendon: str = '', actuator: str = "
                  "'', frame: str = '', reference: str = '', shape: str = 'sphere', size: numpy.typing.ArrayLike = "
                  "..., cutoff: float = 0.0) -> None"),
          "Measures by MuJoCo's name for it ('jointpos', 'gyro', 'touch' ...): a joint, tendon or actuator, or a link "
          "or "
          "frame; `size` of `shape` is where 'touch' feels [m].");
}

}  // namespace manyhands
