// manyhands._core.envs, continued: scripted experts.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <vector>

#include "bindings/arrays.h"
#include "bindings/bindings.h"
#include "manyhands/envs/experts/expert.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

using bindings::Array;
using bindings::as_span;

nb::object act(Expert& expert, const Array<float, 2>& observation, const Array<float, 2>& desired_goal) {
  const std::size_t n = observation.shape(0), columns = static_cast<std::size_t>(expert.action_dim());
  std::vector<float> action(n * columns);
  expert.act(as_span(observation), as_span(desired_goal), action);
  return bindings::copied(action.data(), {n, columns});
}

}  // namespace

void bind_experts(nb::module_& m) {
  nb::module_ envs = nb::cast<nb::module_>(m.attr("envs"));
  nb::class_<Expert>(envs, "Expert", "A scripted policy that solves a task, in n worlds at once.")
      .def("act", &act, "observation"_a, "desired_goal"_a,
           nb::sig("def act(self, observation: numpy.typing.NDArray[numpy.float32], "
                   "desired_goal: numpy.typing.NDArray[numpy.float32]) -> numpy.typing.NDArray[numpy.float32]"),
           "The next actions (n, action_dim) for rows (n, observation_dim) and goals (n, goal_dim). It may remember "
           "what it did in each world. Raises ValueError on other lengths, RuntimeError if it drives joints, which are "
           "not observed.")
      .def(
          "act_in",
          [](Expert& expert, const EnvBatch& batch) {
            const auto n = static_cast<std::size_t>(batch.num_envs()),
                       columns = static_cast<std::size_t>(expert.action_dim());
            std::vector<float> action(n * columns);
            expert.act(batch, action);
            return bindings::copied(action.data(), {n, columns});
          },
          "envs"_a, nb::sig("def act_in(self, envs: EnvBatch) -> numpy.typing.NDArray[numpy.float32]"),
          "The same for a batch of the expert's task.");
  envs.def("expert_ids", &expert_ids,
           "The ids that `make_expert` knows: every task under control of the end effector or the joints.");
  envs.def("make_expert", &make_expert, "id"_a,
           "The expert of the environment `id`. Raises ValueError on an id without one.");
  envs.def(
      "make_adviser", &make_adviser, "id"_a,
      "An expert whose advice a policy can follow: it acts by what is observed and remembers nothing. That is the "
      "environment's, but of Flip and under control of the joints another, which solves less. Raises ValueError as "
      "make_expert.");
}

}  // namespace manyhands
