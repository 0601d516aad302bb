// manyhands._core.perception.
#pragma once

#include <nanobind/nanobind.h>

namespace manyhands::bindings {

void bind_perception(nanobind::module_& m);

}  // namespace manyhands::bindings
