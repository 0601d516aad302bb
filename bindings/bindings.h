// What each layer adds to the extension module manyhands._core; one source file of this folder each.
#pragma once

#include <nanobind/nanobind.h>

#include <algorithm>

namespace manyhands {

void bind_build_info(nanobind::module_& m);
void bind_model(nanobind::module_& m);
void bind_dynamics(nanobind::module_& m);      // after bind_model
void bind_kinematics(nanobind::module_& m);    // after bind_planning
void bind_collision(nanobind::module_& m);     // after bind_model
void bind_world(nanobind::module_& m);         // after bind_model
void bind_batch_worlds(nanobind::module_& m);  // after bind_model
void bind_render(nanobind::module_& m);        // after bind_world and bind_batch_worlds
void bind_envs(nanobind::module_& m);
void bind_env_parts(nanobind::module_& envs);  // of bind_envs
void bind_env_pictures(nanobind::module_& m);  // after bind_envs and bind_render
void bind_experts(nanobind::module_& m);       // after bind_envs
void bind_panda_gym(nanobind::module_& m);     // after bind_world
void bind_pybullet(nanobind::module_& m);      // after bind_render
void bind_pybullet_gui(nanobind::module_& m);  // after bind_pybullet
void bind_python_batch(nanobind::module_& m);  // after bind_envs
void bind_learn(nanobind::module_& m);
void bind_regression(nanobind::module_& m);   // after bind_learn
void bind_policies(nanobind::module_& m);     // after bind_learn
void explain_refusals(nanobind::module_& m);  // after all others

/// Advances worlds by n steps in pieces, keeping the interpreter's lock, and looks for Ctrl-C between two of them.
template <class Worlds>
void step_in_pieces(Worlds& worlds, int n, int piece) {
  do {
    worlds.step(std::min(n, piece));
    n -= piece;
    if (PyErr_CheckSignals() != 0) throw nanobind::python_error();
  } while (n > 0);
}

/// What never changes is its own copy.
template <class Bound>
void copy_as_itself(Bound& bound) {
  const auto itself = [](const nanobind::object& self) { return self; };
  bound.def("__copy__", itself)
      .def(
          "__deepcopy__", [itself](const nanobind::object& self, const nanobind::object&) { return itself(self); },
          nanobind::arg("memo"));
}

}  // namespace manyhands
