// What each layer adds to the extension module manyhands._core; one source file of this folder each.
#pragma once

#include <nanobind/nanobind.h>

namespace manyhands {

void bind_model(nanobind::module_& m);
void bind_dynamics(nanobind::module_& m);      // after bind_model
void bind_kinematics(nanobind::module_& m);    // after bind_model
void bind_collision(nanobind::module_& m);     // after bind_model
void bind_world(nanobind::module_& m);         // after bind_model
void bind_batch_worlds(nanobind::module_& m);  // after bind_model
void bind_envs(nanobind::module_& m);
void bind_experts(nanobind::module_& m);  // after bind_envs
void bind_learn(nanobind::module_& m);

}  // namespace manyhands
