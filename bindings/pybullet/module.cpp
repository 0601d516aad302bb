// manyhands._core.pybullet: the functions behind manyhands.pybullet.
#include <nanobind/nanobind.h>

#include "bindings/bindings.h"
#include "bindings/pybullet/arguments.h"
#include "bindings/pybullet/clients.h"

namespace nb = nanobind;

namespace manyhands {

void bind_pybullet(nb::module_& parent) {
  nb::module_ m = parent.def_submodule("pybullet", "PyBullet's functions over this engine; see manyhands.pybullet.");
  static pybullet::Methods methods;
  pybullet::add_connection(methods);
  pybullet::add_bodies(methods);
  pybullet::add_states(methods);
  pybullet::add_motors(methods);
  pybullet::add_dynamics(methods);
  pybullet::add_constraints(methods);
  pybullet::add_kinematics(methods);
  pybullet::add_collision(methods);
  pybullet::add_shapes(methods);
  pybullet::add_looks(methods);
  pybullet::add_debug(methods);
  pybullet::add_mathematics(methods);
  pybullet::add_extras(methods);
  pybullet::add_convex(methods);
  pybullet::add_refusals(methods);
  methods.push_back({nullptr, nullptr, 0, nullptr});
  PyModule_AddFunctions(m.ptr(), methods.data());
  pybullet::add_constants(m.ptr());
  pybullet::error_class = PyErr_NewExceptionWithDoc(
      "pybullet.error", "A call that makes no sense, or a file that cannot be read.", PyExc_Exception, nullptr);
  m.attr("error") = nb::borrow(pybullet::error_class);
}

}  // namespace manyhands
