// What the sources of manyhands._core.control share.
#pragma once

#include <nanobind/nanobind.h>

namespace manyhands::bindings {

void bind_control(nanobind::module_& m);  // after bind_model
void bind_controllers(nanobind::module_& control);
void bind_control_laws(nanobind::module_& control);

}  // namespace manyhands::bindings
