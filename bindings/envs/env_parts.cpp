// manyhands._core.envs, continued: what an environment may be made with, arms and obstacles.
#include <nanobind/nanobind.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "bindings/bindings.h"
#include "bindings/model/model_values.h"
#include "bindings/model/python_model.h"
#include "manyhands/envs/make.h"
#include "manyhands/model/part_checks.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

using bindings::Numbers3;
using bindings::Numbers4;

constexpr std::array<std::pair<const char*, ShapeType>, 4> kObstacleShapes{{{"box", ShapeType::kBox},
                                                                            {"sphere", ShapeType::kSphere},
                                                                            {"cylinder", ShapeType::kCylinder},
                                                                            {"capsule", ShapeType::kCapsule}}};

std::vector<std::string> control_types() {
  std::vector<std::string> names;
  names.reserve(kArmControls.size());
  for (const auto& [name, control] : kArmControls) names.emplace_back(name);
  return names;
}

}  // namespace

void bind_env_parts(nb::module_& m) {
  nb::class_<ArmSpec>(m, "ArmSpec", "An arm with a gripper; see manyhands.envs.ArmSpec.")
      .def(
          "__init__",
          [](ArmSpec* self, const std::variant<std::filesystem::path, const PythonModel*>& urdf,
             std::vector<std::string> joints, std::vector<std::string> fingers, std::vector<double> closed,
             std::vector<double> opening, std::string hand, std::vector<double> neutral, std::vector<double> max_force,
             const Numbers3& position, const Numbers4& quaternion, bool meshes) {
            const auto* path = std::get_if<std::filesystem::path>(&urdf);
            new (self) ArmSpec{.urdf = path != nullptr ? *path : std::filesystem::path(),
                               .model = path != nullptr ? nullptr : std::get<const PythonModel*>(urdf)->model,
                               .X_WA = bindings::transform("the arm's base", position, quaternion),
                               .joints = std::move(joints),
                               .fingers = std::move(fingers),
                               .closed = std::move(closed),
                               .opening = std::move(opening),
                               .hand = std::move(hand),
                               .neutral = std::move(neutral),
                               .max_force = std::move(max_force),
                               .meshes = meshes};
          },
          nb::kw_only(), "urdf"_a, "joints"_a, "fingers"_a, "closed"_a, "opening"_a, "hand"_a, "neutral"_a,
          "max_force"_a, "position"_a, "quaternion"_a, "meshes"_a,
          "Raises ValueError on a quaternion that is not of length 1.")
      .def_ro("hand", &ArmSpec::hand, "The frame between the finger tips.")
      .def_prop_ro(
          "home",
          [](const ArmSpec& self) {
            std::map<std::string, double> home;
            std::vector<std::string> all = self.joints;
            all.insert(all.end(), self.fingers.begin(), self.fingers.end());
            for (std::size_t i = 0; i < all.size(); ++i) home[all[i]] = self.neutral[i];
            return home;
          },
          "Where every joint is as episodes start [rad or m], by name.");
  m.def("arm_spec", &arm_spec, "name"_a,
        "The arms that ship with the environments, \"panda\" and \"arm6\". Raises ValueError, which lists them, on "
        "others.");
  nb::class_<Obstacle>(m, "Obstacle", "What stands in the way; see manyhands.envs.Obstacle.")
      .def(
          "__init__",
          [](Obstacle* self, const std::string& shape, const bindings::NumberOrNumbers& size, const Numbers3& position,
             const Numbers4& quaternion, double friction) {
            const ShapeType type = bindings::named("shape", shape, kObstacleShapes);
            const Obstacle obstacle{.shape = {.type = type, .size = bindings::size_of(shape, type, size)},
                                    .X_WO = bindings::transform("an obstacle", position, quaternion),
                                    .friction = friction};
            check_geom({.name = "obstacle",
                        .X_LG = obstacle.X_WO,
                        .shape = obstacle.shape,
                        .surface = {.lateral_friction = friction}});
            new (self) Obstacle(obstacle);
          },
          nb::kw_only(), "shape"_a, "size"_a, "position"_a, "quaternion"_a, "friction"_a,
          "Raises ValueError on an unknown shape, a size that does not fit it or is not above 0, or a negative "
          "friction.");
  m.def("control_types", &control_types, "What an action may mean; see manyhands.envs.ControlType.");
}

}  // namespace manyhands
