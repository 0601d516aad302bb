// What bindings/planning adds to manyhands._core.
#pragma once

#include <nanobind/nanobind.h>

namespace manyhands::bindings {

void bind_planning(nanobind::module_& m);  // after bind_model

}  // namespace manyhands::bindings
