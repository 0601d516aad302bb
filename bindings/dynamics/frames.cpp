// manyhands._core.kinematics, frames over rows of states: float64 and float32 overloads of each.
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include "bindings/dynamics/kinematics.h"
#include "bindings/dynamics/rows.h"
#include "manyhands/kinematics/manipulability.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

using bindings::Batch;
using bindings::Input;
using bindings::Output;
using bindings::Result;
using bindings::run;
using bindings::size;

VelocityPart part_of(const std::string& name) {
  if (name == "linear") return VelocityPart::kLinear;
  if (name == "angular") return VelocityPart::kAngular;
  if (name == "all") return VelocityPart::kAll;
  throw std::invalid_argument("part is '" + name + "'; expected 'linear', 'angular' or 'all'");
}

/// The rows of q, all finite.
template <class R>
Batch finite_batch(PythonModel& model, const Input<R>& q) {
  const Batch batch = bindings::batch_of(q, size(model.model->nq()));
  bindings::require_finite("q", q);
  return batch;
}

template <Real R>
nb::tuple forward(PythonModel& model, const Input<R>& q, const std::string& frame) {
  const Batch batch = finite_batch(model, q);
  const FrameId id = model.model->frame_id(frame);
  Result<R> position(batch, {3}), quaternion(batch, {4});
  run<R>(model, 0, [&](auto& d) {
    d.frame_pose(batch.n, std::span(q.data(), q.size()), id, position.span(), quaternion.span());
  });
  return nb::make_tuple(position.array(), quaternion.array());
}

template <Real R>
Output<R> jacobian_in_form(PythonModel& model, const Input<R>& q, const std::string& frame, const std::string& form) {
  const Batch batch = finite_batch(model, q);
  const FrameId id = model.model->frame_id(frame);
  const JacobianForm written = bindings::form_of(form);
  Result<R> J(batch, {6, size(model.model->nv())});
  run<R>(model, 0, [&](auto& d) { d.jacobian(batch.n, std::span(q.data(), q.size()), id, J.span(), written); });
  return J.array();
}

template <Real R>
Output<R> jacobian_derivative(PythonModel& model, const Input<R>& q, const Input<R>& v, const std::string& frame,
                              const std::string& form) {
  const Batch batch = finite_batch(model, q);
  const std::size_t nv = size(model.model->nv());
  const auto v_rows = bindings::rows("v", v, batch, nv);
  bindings::require_finite("v", v);
  const FrameId id = model.model->frame_id(frame);
  const JacobianForm written = bindings::form_of(form);
  Result<R> dJ(batch, {6, nv});
  run<R>(model, 0, [&](auto& d) {
    d.jacobian_derivative(batch.n, std::span(q.data(), q.size()), v_rows, id, dJ.span(), written);
  });
  return dJ.array();
}

template <Real R>
nb::tuple manipulability_at(PythonModel& model, const Input<R>& q, const std::string& frame, const std::string& part) {
  const Batch batch = finite_batch(model, q);
  const std::size_t nv = size(model.model->nv());
  const FrameId id = model.model->frame_id(frame);
  const VelocityPart judged = part_of(part);
  const std::size_t m = rows_of(judged);
  Result<R> J(batch, {6, nv}), measure(batch, {}), condition(batch, {}), isotropy(batch, {}), lengths(batch, {m}),
      axes(batch, {m, m});
  run<R>(model, 0, [&](auto& d) {
    d.jacobian(batch.n, std::span(q.data(), q.size()), id, J.span());
    manipulability_of_rows<R>(judged, batch.n, nv, J.span(),
                              {measure.span(), condition.span(), isotropy.span(), lengths.span(), axes.span()});
  });
  return nb::make_tuple(measure.array(), condition.array(), isotropy.array(), lengths.array(), axes.array());
}

/// One overload of every function. `real` is numpy's name of R.
template <Real R>
void bind_frames_of(nb::module_& m, const std::string& real) {
  const std::string array = "numpy.typing.NDArray[numpy." + real + "]";
  const auto signature = [&](const std::string& name, const std::string& more, const std::string& result) {
    return "def " + name + "(model: manyhands._core.Model, q: " + array + ", " + more + ") -> " + result;
  };
  const auto q = nb::arg("q").noconvert(), v = nb::arg("v").noconvert();
  m.def("forward", &forward<R>, "model"_a, q, "frame"_a,
        nb::sig(signature("forward", "frame: str", "tuple[" + array + ", " + array + "]").c_str()));
  m.def("jacobian", &jacobian_in_form<R>, "model"_a, q, "frame"_a, "form"_a,
        nb::sig(signature("jacobian", "frame: str, form: str", array).c_str()));
  m.def("jacobian_derivative", &jacobian_derivative<R>, "model"_a, q, v, "frame"_a, "form"_a,
        nb::sig(signature("jacobian_derivative", "v: " + array + ", frame: str, form: str", array).c_str()));
  m.def("manipulability", &manipulability_at<R>, "model"_a, q, "frame"_a, "part"_a,
        nb::sig(signature("manipulability", "frame: str, part: str", "tuple[" + array + ", ...]").c_str()));
}

}  // namespace

namespace bindings {

JacobianForm form_of(const std::string& name) {
  if (name == "mixed") return JacobianForm::kMixed;
  if (name == "space") return JacobianForm::kSpace;
  if (name == "body") return JacobianForm::kBody;
  throw std::invalid_argument("form is '" + name + "'; expected 'mixed', 'space' or 'body'");
}

void bind_frames(nb::module_& kinematics) {
  bind_frames_of<double>(kinematics, "float64");
  bind_frames_of<float>(kinematics, "float32");
}

}  // namespace bindings

}  // namespace manyhands
