// Parts of a model in the making, by name; and what the files that bind ModelBuilder share.
#pragma once

#include <nanobind/nanobind.h>

#include <limits>
#include <stdexcept>
#include <string>

#include "manyhands/model/model_builder.h"

namespace manyhands {

void bind_builder_actuators(nanobind::class_<ModelBuilder>& builder);  // actuators and sensors
void bind_builder_composition(nanobind::class_<ModelBuilder>& builder);

namespace bindings {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

[[nodiscard]] inline LinkId link_of(const ModelBuilder& builder, const std::string& name) {
  for (std::size_t i = 0; i < builder.links().size(); ++i) {
    if (builder.links()[i].name == name) return LinkId(i);
  }
  throw std::out_of_range("link '" + name + "' has not been added to the builder");
}

[[nodiscard]] inline JointId joint_of(const ModelBuilder& builder, const std::string& name) {
  for (std::size_t i = 0; i < builder.joints().size(); ++i) {
    if (builder.joints()[i].name == name) return JointId(i);
  }
  throw std::out_of_range("joint '" + name + "' has not been added to the builder");
}

[[nodiscard]] inline TendonId tendon_of(const ModelBuilder& builder, const std::string& name) {
  for (std::size_t i = 0; i < builder.tendons().size(); ++i) {
    if (builder.tendons()[i].name == name) return TendonId(i);
  }
  throw std::out_of_range("tendon '" + name + "' has not been added to the builder");
}

[[nodiscard]] inline ActuatorId actuator_of(const ModelBuilder& builder, const std::string& name) {
  for (std::size_t i = 0; i < builder.actuators().size(); ++i) {
    if (builder.actuators()[i].name == name) return ActuatorId(i);
  }
  throw std::out_of_range("actuator '" + name + "' has not been added to the builder");
}

}  // namespace bindings
}  // namespace manyhands
