// What the sources of manyhands._core.kinematics share.
#pragma once

#include <nanobind/nanobind.h>

#include <string>

#include "manyhands/physics/dynamics/jacobian_form.h"

namespace manyhands::bindings {

/// Throws std::invalid_argument for an unknown name.
[[nodiscard]] JacobianForm form_of(const std::string& name);

void bind_frames(nanobind::module_& kinematics);
void bind_screws(nanobind::module_& kinematics);

}  // namespace manyhands::bindings
