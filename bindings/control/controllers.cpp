// manyhands._core.control: controllers of a model over rows of states; float64 and float32 overloads of each.
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <optional>

#include "bindings/control/control.h"
#include "bindings/dynamics/rows.h"
#include "manyhands/control/batch_control.h"
#include "manyhands/control/sliding_control.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

/// Scratch for the controllers of a model.
struct ControlPools {
  explicit ControlPools(const Model& model) : doubles(model), floats(model) {}

  template <Real R>
  [[nodiscard]] ModelPool<BatchControl<R>>& pool() {
    if constexpr (std::same_as<R, double>) {
      return doubles;
    } else {
      return floats;
    }
  }

  ModelPool<BatchControl<double>> doubles;
  ModelPool<BatchControl<float>> floats;
};

namespace {

using bindings::Batch;
using bindings::batch_of;
using bindings::finite_rows;
using bindings::Input;
using bindings::Output;
using bindings::Result;
using bindings::size;

/// Runs `body(control)` without the interpreter's lock.
template <Real R, class Body>
void run(PythonModel& model, Body&& body) {
  if (!model.control) model.control = std::make_shared<ControlPools>(*model.model);
  const std::shared_ptr<ControlPools> pools = model.control;
  const nb::gil_scoped_release release;
  pools->pool<R>().use(0, body);
}

template <Real R>
std::vector<R> gains_of(const char* name, const Input<R>& gains, std::size_t nv) {
  if (gains.ndim() != 1 || gains.shape(0) != nv)
    throw std::invalid_argument(std::string(name) + " has shape " + bindings::shape_of(gains) + "; expected (" +
                                std::to_string(nv) + ",)");
  bindings::require_finite(name, gains);
  return {gains.data(), gains.data() + gains.size()};
}

/// Rows of four numbers, none of which is so short that it leaves its direction open.
template <Real R>
std::span<const R> quaternion_rows(const Input<R>& quaternion, const Batch& batch) {
  const std::span<const R> numbers = finite_rows("quaternion", quaternion, batch, 4);
  for (std::size_t i = 0; i < numbers.size(); i += 4) bindings::require_rotation(numbers.data() + i);
  return numbers;
}

/// The states and desired motions of a call, and room for its result.
template <Real R>
struct Call {
  Call(PythonModel& model, const Input<R>& q, const Input<R>& v, const Input<R>& q_d, const Input<R>& v_d,
       const Input<R>& a_d)
      : nv(size(model.model->nv())), batch(batch_of(q, size(model.model->nq()))), tau(batch, {nv}) {
    rows_of = {finite_rows("q", q, batch, size(model.model->nq())), finite_rows("v", v, batch, nv),
               finite_rows("q_desired", q_d, batch, nv), finite_rows("v_desired", v_d, batch, nv),
               finite_rows("a_desired", a_d, batch, nv)};
  }

  std::size_t nv;
  Batch batch;
  typename BatchControl<R>::Tracked rows_of;
  Result<R> tau;
};

template <Real R>
Output<R> gravity_torque(PythonModel& model, const Input<R>& q) {
  const Batch batch = batch_of(q, size(model.model->nq()));
  Result<R> tau(batch, {size(model.model->nv())});
  const auto states = finite_rows("q", q, batch, size(model.model->nq()));
  run<R>(model, [&](auto& c) { c.gravity_torque(batch.n, states, tau.span()); });
  return tau.array();
}

template <Real R>
Output<R> pd_gravity(PythonModel& model, const Input<R>& q, const Input<R>& v, const Input<R>& q_d, const Input<R>& v_d,
                     const Input<R>& kp, const Input<R>& kd) {
  Call<R> call(model, q, v, q_d, v_d, v_d);
  const typename BatchControl<R>::Gains gains{.kp = gains_of("kp", kp, call.nv), .kd = gains_of("kd", kd, call.nv)};
  run<R>(model, [&](auto& c) { c.pd_gravity(call.batch.n, gains, call.rows_of, call.tau.span()); });
  return call.tau.array();
}

template <Real R>
Output<R> pd_feedforward(PythonModel& model, const Input<R>& q, const Input<R>& v, const Input<R>& q_d,
                         const Input<R>& v_d, const Input<R>& a_d, const Input<R>& kp, const Input<R>& kd) {
  Call<R> call(model, q, v, q_d, v_d, a_d);
  const typename BatchControl<R>::Gains gains{.kp = gains_of("kp", kp, call.nv), .kd = gains_of("kd", kd, call.nv)};
  run<R>(model, [&](auto& c) { c.pd_feedforward(call.batch.n, gains, call.rows_of, call.tau.span()); });
  return call.tau.array();
}

template <Real R>
Output<R> computed_torque(PythonModel& model, const Input<R>& q, const Input<R>& v, const Input<R>& q_d,
                          const Input<R>& v_d, const Input<R>& a_d, const Input<R>& kp, const Input<R>& kd,
                          const Input<R>& ki, const Input<R>& integral) {
  Call<R> call(model, q, v, q_d, v_d, a_d);
  const typename BatchControl<R>::Gains gains{
      .kp = gains_of("kp", kp, call.nv), .ki = gains_of("ki", ki, call.nv), .kd = gains_of("kd", kd, call.nv)};
  const auto integrals = finite_rows("integral", integral, call.batch, call.nv);
  run<R>(model, [&](auto& c) { c.computed_torque(call.batch.n, gains, call.rows_of, integrals, call.tau.span()); });
  return call.tau.array();
}

template <Real R>
Output<R> sliding_mode(PythonModel& model, const Input<R>& q, const Input<R>& v, const Input<R>& q_d,
                       const Input<R>& v_d, const Input<R>& a_d, const Input<R>& slope, const Input<R>& kd,
                       const Input<R>& robust, const Input<R>& boundary) {
  Call<R> call(model, q, v, q_d, v_d, a_d);
  const typename BatchControl<R>::Gains gains{.kd = gains_of("kd", kd, call.nv),
                                              .slope = gains_of("slope", slope, call.nv),
                                              .robust = gains_of("robust", robust, call.nv),
                                              .boundary = gains_of("boundary", boundary, call.nv)};
  for (const R width : gains.boundary) {
    if (!(width > 0)) throw std::invalid_argument("boundary must be above 0");
  }
  run<R>(model, [&](auto& c) { c.sliding_mode(call.batch.n, gains, call.rows_of, call.tau.span()); });
  return call.tau.array();
}

/// tau, and the inertias as they are a step later.
template <Real R>
nb::tuple adaptive(PythonModel& model, const Input<R>& q, const Input<R>& v, const Input<R>& q_d, const Input<R>& v_d,
                   const Input<R>& a_d, const Input<R>& slope, const Input<R>& kd, const Input<R>& rate, double dt,
                   const Input<R>& theta) {
  Call<R> call(model, q, v, q_d, v_d, a_d);
  const typename BatchControl<R>::Gains gains{.kd = gains_of("kd", kd, call.nv),
                                              .slope = gains_of("slope", slope, call.nv)};
  const std::vector<R> rates = gains_of("rate", rate, kBodyParameters);
  const std::size_t numbers = (model.model->bodies().size() - 1) * kBodyParameters;
  const auto given = finite_rows("inertia", theta, call.batch, numbers);
  Result<R> next(call.batch, {numbers});
  std::ranges::copy(given, next.span().begin());
  run<R>(model, [&](auto& c) {
    c.adaptive(call.batch.n, gains, rates, static_cast<R>(dt), call.rows_of, next.span(), call.tau.span());
  });
  return nb::make_tuple(call.tau.array(), next.array());
}

template <Real R>
Output<R> impedance(PythonModel& model, const std::string& frame, const Input<R>& q, const Input<R>& v,
                    const Input<R>& position, const Input<R>& quaternion, double stiffness, double damping,
                    double rotational_stiffness, double rotational_damping) {
  const Impedance spring{stiffness, damping, rotational_stiffness, rotational_damping};
  Call<R> call(model, q, v, v, v, v);
  const FrameId id = model.model->frame_id(frame);
  const auto p = finite_rows("position", position, call.batch, 3), r = quaternion_rows(quaternion, call.batch);
  run<R>(model, [&](auto& c) {
    c.impedance(call.batch.n, id, spring, call.rows_of.q, call.rows_of.v, p, r, call.tau.span());
  });
  return call.tau.array();
}

TaskDirection direction_of(const std::string& name) {
  if (name == "motion") return TaskDirection::kMotion;
  if (name == "force") return TaskDirection::kForce;
  if (name == "free") return TaskDirection::kFree;
  throw std::invalid_argument("a direction is '" + name + "'; expected 'motion', 'force' or 'free'");
}

template <Real R>
Output<R> operational_space(PythonModel& model, const std::string& frame, const Input<R>& q, const Input<R>& v,
                            const Input<R>& position, const Input<R>& quaternion, const Input<R>& velocity,
                            const Input<R>& acceleration, const Input<R>& force, const std::optional<Input<R>>& posture,
                            const std::vector<std::string>& directions, double kp, double kd, double rotational_kp,
                            double rotational_kd, double force_damping, double regularisation) {
  OperationalTask task{.directions = {},
                       .kp = kp,
                       .kd = kd,
                       .rotational_kp = rotational_kp,
                       .rotational_kd = rotational_kd,
                       .force_damping = force_damping,
                       .regularisation = regularisation};
  if (directions.size() != 6)
    throw std::invalid_argument("there are " + std::to_string(directions.size()) + " directions; expected 6");
  std::ranges::transform(directions, task.directions.begin(), direction_of);
  Call<R> call(model, q, v, v, v, v);
  const FrameId id = model.model->frame_id(frame);
  const typename BatchControl<R>::Goal goal{
      finite_rows("position", position, call.batch, 3), quaternion_rows(quaternion, call.batch),
      finite_rows("velocity", velocity, call.batch, 6), finite_rows("acceleration", acceleration, call.batch, 6),
      finite_rows("force", force, call.batch, 6)};
  const std::span<const R> second =
      posture ? finite_rows("posture", *posture, call.batch, call.nv) : std::span<const R>();
  run<R>(model, [&](auto& c) {
    c.operational_space(call.batch.n, id, task, call.rows_of.q, call.rows_of.v, goal, second, call.tau.span());
  });
  return call.tau.array();
}

template <Real R>
void bind_controllers_of(nb::module_& m) {
  const auto x = [](const char* name) { return nb::arg(name).noconvert(); };
  const auto q = x("q"), v = x("v"), q_d = x("q_desired"), v_d = x("v_desired"), a_d = x("a_desired");
  const auto kp = x("kp"), kd = x("kd"), position = x("position"), quaternion = x("quaternion");
  m.def("gravity_torque", &gravity_torque<R>, "model"_a, q);
  m.def("pd_gravity", &pd_gravity<R>, "model"_a, q, v, q_d, v_d, kp, kd);
  m.def("pd_feedforward", &pd_feedforward<R>, "model"_a, q, v, q_d, v_d, a_d, kp, kd);
  m.def("computed_torque", &computed_torque<R>, "model"_a, q, v, q_d, v_d, a_d, kp, kd, x("ki"), x("integral"));
  m.def("sliding_mode", &sliding_mode<R>, "model"_a, q, v, q_d, v_d, a_d, x("slope"), kd, x("robust"), x("boundary"));
  m.def("adaptive", &adaptive<R>, "model"_a, q, v, q_d, v_d, a_d, x("slope"), kd, x("rate"), "dt"_a, x("inertia"));
  m.def("impedance", &impedance<R>, "model"_a, "frame"_a, q, v, position, quaternion, "stiffness"_a, "damping"_a,
        "rotational_stiffness"_a, "rotational_damping"_a);
  m.def("operational_space", &operational_space<R>, "model"_a, "frame"_a, q, v, position, quaternion, x("velocity"),
        x("acceleration"), x("force"), x("posture").none(), "directions"_a, "kp"_a, "kd"_a, "rotational_kp"_a,
        "rotational_kd"_a, "force_damping"_a, "regularisation"_a);
}

}  // namespace

void bindings::bind_controllers(nb::module_& control) {
  bind_controllers_of<double>(control);
  bind_controllers_of<float>(control);
  control.def(
      "body_parameters", [](const PythonModel& model) { return BatchControl<double>(*model.model).body_parameters(); },
      "model"_a);
}

}  // namespace manyhands
