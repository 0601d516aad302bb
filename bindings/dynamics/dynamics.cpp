// manyhands._core.dynamics: the algorithms over rows; float64 and float32 overloads of each.
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include "bindings/bindings.h"
#include "bindings/dynamics/rows.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

using bindings::Batch;
using bindings::batch_of;
using bindings::Input;
using bindings::Output;
using bindings::Result;
using bindings::rows;
using bindings::run;
using bindings::size;

template <Real R>
Output<R> rnea(PythonModel& model, const Input<R>& q, const Input<R>& v, const Input<R>& a, int width) {
  const std::size_t nv = size(model.model->nv());
  const Batch batch = batch_of(q, size(model.model->nq()));
  const auto q_rows = std::span(q.data(), q.size()), v_rows = rows("v", v, batch, nv), a_rows = rows("a", a, batch, nv);
  Result<R> tau(batch, {nv});
  run<R>(model, width, [&](auto& d) { d.rnea(batch.n, q_rows, v_rows, a_rows, tau.span()); });
  return tau.array();
}

template <Real R>
Output<R> aba(PythonModel& model, const Input<R>& q, const Input<R>& v, const Input<R>& tau, int width) {
  const std::size_t nv = size(model.model->nv());
  const Batch batch = batch_of(q, size(model.model->nq()));
  const auto q_rows = std::span(q.data(), q.size()), v_rows = rows("v", v, batch, nv);
  const auto tau_rows = rows("tau", tau, batch, nv);
  Result<R> a(batch, {nv});
  run<R>(model, width, [&](auto& d) { d.aba(batch.n, q_rows, v_rows, tau_rows, a.span()); });
  return a.array();
}

template <Real R>
Output<R> crba(PythonModel& model, const Input<R>& q, int width) {
  const std::size_t nv = size(model.model->nv());
  const Batch batch = batch_of(q, size(model.model->nq()));
  Result<R> M(batch, {nv, nv});
  run<R>(model, width, [&](auto& d) { d.crba(batch.n, std::span(q.data(), q.size()), M.span()); });
  return M.array();
}

template <Real R>
nb::tuple frame_pose(PythonModel& model, const Input<R>& q, const std::string& frame, int width) {
  const Batch batch = batch_of(q, size(model.model->nq()));
  const FrameId id = model.model->frame_id(frame);
  Result<R> position(batch, {3}), quaternion(batch, {4});
  run<R>(model, width, [&](auto& d) {
    d.frame_pose(batch.n, std::span(q.data(), q.size()), id, position.span(), quaternion.span());
  });
  return nb::make_tuple(position.array(), quaternion.array());
}

template <Real R>
nb::tuple forward_kinematics(PythonModel& model, const Input<R>& q, int width) {
  const Batch batch = batch_of(q, size(model.model->nq()));
  const std::size_t nf = model.model->frames().size();
  Result<R> position(batch, {nf, 3}), quaternion(batch, {nf, 4});
  run<R>(model, width, [&](auto& d) {
    d.forward_kinematics(batch.n, std::span(q.data(), q.size()), position.span(), quaternion.span());
  });
  return nb::make_tuple(position.array(), quaternion.array());
}

template <Real R>
Output<R> jacobian(PythonModel& model, const Input<R>& q, const std::string& frame, int width) {
  const Batch batch = batch_of(q, size(model.model->nq()));
  const FrameId id = model.model->frame_id(frame);
  Result<R> J(batch, {6, size(model.model->nv())});
  run<R>(model, width, [&](auto& d) { d.jacobian(batch.n, std::span(q.data(), q.size()), id, J.span()); });
  return J.array();
}

template <Real R>
Output<R> center_of_mass(PythonModel& model, const Input<R>& q, int width) {
  const Batch batch = batch_of(q, size(model.model->nq()));
  Result<R> com(batch, {3});
  run<R>(model, width, [&](auto& d) { d.center_of_mass(batch.n, std::span(q.data(), q.size()), com.span()); });
  return com.array();
}

template <Real R>
Output<R> momentum(PythonModel& model, const Input<R>& q, const Input<R>& v, int width) {
  const Batch batch = batch_of(q, size(model.model->nq()));
  const auto v_rows = rows("v", v, batch, size(model.model->nv()));
  Result<R> result(batch, {6});
  run<R>(model, width, [&](auto& d) { d.momentum(batch.n, std::span(q.data(), q.size()), v_rows, result.span()); });
  return result.array();
}

template <Real R>
nb::tuple energy(PythonModel& model, const Input<R>& q, const Input<R>& v, int width) {
  const Batch batch = batch_of(q, size(model.model->nq()));
  const auto v_rows = rows("v", v, batch, size(model.model->nv()));
  Result<R> kinetic(batch, {}), potential(batch, {});
  run<R>(model, width,
         [&](auto& d) { d.energy(batch.n, std::span(q.data(), q.size()), v_rows, kinetic.span(), potential.span()); });
  return nb::make_tuple(kinetic.array(), potential.array());
}

/// One overload of every function. `real` is numpy's name of R.
template <Real R>
void bind_functions(nb::module_& m, const std::string& real) {
  const std::string array = "numpy.typing.NDArray[numpy." + real + "]";
  const auto signature = [&](const std::string& name, const std::string& inputs, bool two) {
    std::string text = "def " + name + "(model: manyhands._core.Model";
    std::size_t from = 0;
    while (from < inputs.size()) {
      const std::size_t comma = std::min(inputs.find(' ', from), inputs.size());
      const std::string input = inputs.substr(from, comma - from);
      text += ", " + input + ": " + (input == "frame" ? "str" : array);
      from = comma + 1;
    }
    return text + ", width: int = 0) -> " + (two ? "tuple[" + array + ", " + array + "]" : array);
  };
  const auto x = [](const char* name) { return nb::arg(name).noconvert(); };
  const auto width = nb::arg("width") = 0;
  m.def("rnea", &rnea<R>, "model"_a, x("q"), x("v"), x("a"), width, nb::sig(signature("rnea", "q v a", false).c_str()));
  m.def("aba", &aba<R>, "model"_a, x("q"), x("v"), x("tau"), width,
        nb::sig(signature("aba", "q v tau", false).c_str()));
  m.def("crba", &crba<R>, "model"_a, x("q"), width, nb::sig(signature("crba", "q", false).c_str()));
  m.def("frame_pose", &frame_pose<R>, "model"_a, x("q"), "frame"_a, width,
        nb::sig(signature("frame_pose", "q frame", true).c_str()));
  m.def("forward_kinematics", &forward_kinematics<R>, "model"_a, x("q"), width,
        nb::sig(signature("forward_kinematics", "q", true).c_str()));
  m.def("jacobian", &jacobian<R>, "model"_a, x("q"), "frame"_a, width,
        nb::sig(signature("jacobian", "q frame", false).c_str()));
  m.def("center_of_mass", &center_of_mass<R>, "model"_a, x("q"), width,
        nb::sig(signature("center_of_mass", "q", false).c_str()));
  m.def("momentum", &momentum<R>, "model"_a, x("q"), x("v"), width,
        nb::sig(signature("momentum", "q v", false).c_str()));
  m.def("energy", &energy<R>, "model"_a, x("q"), x("v"), width, nb::sig(signature("energy", "q v", true).c_str()));
}

}  // namespace

void bind_dynamics(nb::module_& m) {
  nb::module_ dynamics = m.def_submodule(
      "dynamics",
      "Dynamics over rows; manyhands.dynamics describes the functions. Arrays are C-contiguous, (columns) or "
      "(n, columns), all of one type. `width`: rows at once, see BatchDynamics.");
  bind_functions<double>(dynamics, "float64");
  bind_functions<float>(dynamics, "float32");
}

}  // namespace manyhands
