// manyhands._core.learn, continued: regression.
#include "manyhands/learn/regression.h"

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/vector.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "bindings/arrays.h"
#include "bindings/bindings.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

using bindings::Array;
using bindings::as_span;
using bindings::copied;
using learn::Regression;
using learn::RegressionConfig;

std::vector<float> floats_of(const Array<float, 2>& array) { return {array.data(), array.data() + array.size()}; }

int columns_of(const Array<float, 2>& array) { return static_cast<int>(array.shape(1)); }

void make_regression(Regression* self, const Array<float, 2>& inputs, const Array<float, 2>& targets,
                     std::uint64_t seed, int num_threads, const std::vector<int>& hidden_layers, int batch_size,
                     float learning_rate, float averaging_rate, bool bounded) {
  if (inputs.shape(0) != targets.shape(0)) {
    throw std::invalid_argument("Regression: there are " + std::to_string(inputs.shape(0)) + " inputs and " +
                                std::to_string(targets.shape(0)) + " targets, expected as many of both");
  }
  const RegressionConfig config{.seed = seed,
                                .num_threads = num_threads,
                                .hidden_layers = hidden_layers,
                                .batch_size = batch_size,
                                .learning_rate = learning_rate,
                                .averaging_rate = averaging_rate,
                                .bounded = bounded};
  new (self) Regression(floats_of(inputs), columns_of(inputs), floats_of(targets), columns_of(targets), config);
}

nb::list fitted_layers(const Regression& regression) {
  const learn::Mlp<float>& net = regression.network();
  nb::list list;
  for (int layer = 0; layer < net.num_layers(); ++layer) {
    const learn::Matrix<float> rows = net.weight(layer).transpose();  // column by column, it is the weight row by row
    const auto outputs = static_cast<std::size_t>(rows.cols()), inputs = static_cast<std::size_t>(rows.rows());
    list.append(nb::make_tuple(copied(rows.data(), {outputs, inputs}), copied(net.bias(layer).data(), {outputs})));
  }
  return list;
}

}  // namespace

void bind_regression(nb::module_& m) {
  nb::module_ learn = nb::cast<nb::module_>(m.attr("learn"));
  const RegressionConfig defaults;
  nb::class_<Regression>(
      learn, "Regression",
      "Fits y = act(W_L relu(... relu(W_1 x + b_1) ...) + b_L) to pairs by Adam on mini-batches, and averages the "
      "weights. The result depends on the seed, not on the threads.")
      .def("__init__", &make_regression, "inputs"_a, "targets"_a, nb::kw_only(), "seed"_a = defaults.seed,
           "num_threads"_a = defaults.num_threads, "hidden_layers"_a = defaults.hidden_layers,
           "batch_size"_a = defaults.batch_size, "learning_rate"_a = defaults.learning_rate,
           "averaging_rate"_a = defaults.averaging_rate, "bounded"_a = defaults.bounded,
           nb::sig("def __init__(self, inputs: numpy.typing.NDArray[numpy.float32], "
                   "targets: numpy.typing.NDArray[numpy.float32], *, seed: int = 0, num_threads: int = 1, "
                   "hidden_layers: collections.abc.Sequence[int] = (256, 256), batch_size: int = 256, "
                   "learning_rate: float = 1e-3, averaging_rate: float = 1e-3, bounded: bool = True) -> None"),
           "Pairs `inputs` (n, input_dim) and `targets` (n, output_dim); of a target that is NaN nothing is asked. "
           "`bounded`: outputs pass tanh. `averaging_rate`: at which the result follows the weights that learn. "
           "Raises ValueError on numbers that make no sense.")
      .def("advance", &Regression::advance, "steps"_a, nb::call_guard<nb::gil_scoped_release>(),
           "Takes gradient steps and returns their mean loss. Raises RuntimeError if the network diverges.")
      .def_prop_ro("layers", &fitted_layers,
                   nb::sig("def layers(self) -> list[tuple[numpy.typing.NDArray[numpy.float32], "
                           "numpy.typing.NDArray[numpy.float32]]]"),
                   "(weight (outputs, inputs), bias (outputs)) of each layer.");
}

}  // namespace manyhands
