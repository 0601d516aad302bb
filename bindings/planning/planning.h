// What bindings/planning adds to manyhands._core.
#pragma once

#include <nanobind/nanobind.h>

namespace manyhands::bindings {

void bind_planning(nanobind::module_& m);        // after bind_model
void bind_planner(nanobind::module_& planning);  // of bind_planning
void bind_grasps(nanobind::module_& planning);   // of bind_planning

}  // namespace manyhands::bindings
