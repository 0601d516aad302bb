// manyhands._core.learn, continued: trained policies that act.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/filesystem.h>

#include <cstddef>
#include <vector>

#include "bindings/arrays.h"
#include "bindings/bindings.h"
#include "manyhands/envs/env_batch.h"
#include "manyhands/learn/policy_file.h"
#include "manyhands/learn/policy_runner.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

using bindings::as_span;
using learn::PolicyRunner;
using Rows = bindings::Array<float, 2>;

nb::object actions(PolicyRunner& runner, const Rows& observation, const Rows& achieved_goal, const Rows& desired_goal) {
  const std::size_t n = observation.shape(0), dim = static_cast<std::size_t>(runner.action_dim());
  std::vector<float> action(n * dim);
  runner.act(as_span(observation), as_span(achieved_goal), as_span(desired_goal), action);
  return bindings::copied(action.data(), {n, dim});
}

}  // namespace

void bind_policies(nb::module_& m) {
  nb::module_ learn = nb::cast<nb::module_>(m.attr("learn"));
  learn.def("read_policy", &learn::read_policy, "path"_a,
            "The policy in an ONNX file that training wrote. Raises ValueError if there is no such file or it holds "
            "another graph.");
  nb::class_<PolicyRunner>(learn, "PolicyRunner", "A trained policy that acts, in n worlds at once.")
      .def(nb::init<const learn::Policy&>(), "policy"_a, "Raises ValueError if the arrays do not fit each other.")
      .def("act", &actions, "observation"_a, "achieved_goal"_a, "desired_goal"_a,
           nb::sig("def act(self, observation: numpy.typing.NDArray[numpy.float32], achieved_goal: "
                   "numpy.typing.NDArray[numpy.float32], desired_goal: numpy.typing.NDArray[numpy.float32]) -> "
                   "numpy.typing.NDArray[numpy.float32]"),
           "The best actions (n, action_dim) in n states, (n, observation_dim) and (n, goal_dim). Raises ValueError on "
           "other lengths.")
      .def("evaluate", &PolicyRunner::evaluate, "envs"_a, "episodes"_a, "first_seed"_a,
           nb::call_guard<nb::gil_scoped_release>(),
           "Runs episodes in the worlds of a batch; episode k starts from seed first_seed + k, whatever their number. "
           "Raises ValueError if the policy is of other sizes than the environment.");
}

}  // namespace manyhands
