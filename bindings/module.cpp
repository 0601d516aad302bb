// The extension module manyhands._core.
#include <nanobind/nanobind.h>

#include "bindings/bindings.h"
#include "bindings/control/control.h"
#include "bindings/perception/perception.h"
#include "bindings/planning/planning.h"

NB_MODULE(_core, m) {
  m.doc() = "The C++ library behind the manyhands package.";
  manyhands::bind_build_info(m);
  manyhands::bind_model(m);
  manyhands::bind_dynamics(m);
  manyhands::bindings::bind_planning(m);
  manyhands::bind_kinematics(m);
  manyhands::bindings::bind_control(m);
  manyhands::bindings::bind_perception(m);
  manyhands::bind_collision(m);
  manyhands::bind_world(m);
  manyhands::bind_batch_worlds(m);
  manyhands::bind_render(m);
  manyhands::bind_envs(m);
  manyhands::bind_env_pictures(m);
  manyhands::bind_experts(m);
  manyhands::bind_panda_gym(m);
  manyhands::bind_pybullet(m);
  manyhands::bind_pybullet_gui(m);
  manyhands::bind_python_batch(m);
  manyhands::bind_learn(m);
  manyhands::bind_regression(m);
  manyhands::bind_policies(m);
  manyhands::explain_refusals(m);
}
