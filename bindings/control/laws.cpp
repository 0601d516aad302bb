// manyhands._core.control: laws that know no model, step responses and margins.
#include <nanobind/nanobind.h>

#include "bindings/arrays.h"
#include "bindings/control/control.h"
#include "bindings/dynamics/rows.h"
#include "manyhands/control/impedance.h"
#include "manyhands/control/kalman.h"
#include "manyhands/control/pid.h"
#include "manyhands/control/response.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

using bindings::Array;
using bindings::as_span;
using bindings::copied;
using Numbers = std::vector<double>;

/// Force (n) and integral (n) after a step, of arrays (n) each.
nb::tuple pid_rows(double h, const Array<double, 1>& error, const Array<double, 1>& rate,
                   const Array<double, 1>& integral, const Array<double, 2>& gains) {
  const std::size_t n = error.size();
  if (rate.size() != n || integral.size() != n || gains.shape(0) != 5 || gains.shape(1) != n)
    throw std::invalid_argument("error, rate, integral and gains (5, n) do not fit");
  Numbers force(n), next(as_span(integral).begin(), as_span(integral).end());
  for (std::size_t i = 0; i < n; ++i) {
    const PidGains<double> of{gains(0, i), gains(1, i), gains(2, i), gains(3, i), gains(4, i)};
    force[i] = pid(of, h, error(i), rate(i), next[i]);
  }
  return nb::make_tuple(copied(force.data(), {n}), copied(next.data(), {n}));
}

Motion<double> motion_at(const Array<double, 2>& rows, std::size_t i) {
  const double* x = &rows(i, 0);
  return {{x[0], x[1], x[2]}, {x[3], x[4], x[5]}};
}

/// Displacement and velocity (n, 6) after a step.
nb::tuple admit_rows(double h, const Array<double, 2>& force, const Array<double, 2>& displacement,
                     const Array<double, 2>& velocity, const Array<double, 1>& law) {
  const std::size_t n = force.shape(0);
  const Admittance admittance{law(0), law(1), law(2), law(3), law(4), law(5)};
  Numbers x, v;
  for (std::size_t i = 0; i < n; ++i) {
    const Motion<double> F = motion_at(force, i);
    Motion<double> at = motion_at(displacement, i), rate = motion_at(velocity, i);
    admit(admittance, h, {F.w, F.v}, at, rate);
    x.insert(x.end(), {at.w.x, at.w.y, at.w.z, at.v.x, at.v.y, at.v.z});
    v.insert(v.end(), {rate.w.x, rate.w.y, rate.w.z, rate.v.x, rate.v.y, rate.v.z});
  }
  return nb::make_tuple(copied(x.data(), {n, 6}), copied(v.data(), {n, 6}));
}

/// P (n, k, k) after a motion F (k, k).
nb::object predict_rows(const Array<double, 2>& F, const Array<double, 2>& Q, const Array<double, 3>& P) {
  const std::size_t n = P.shape(0), k = P.shape(1);
  Numbers next(as_span(P).begin(), as_span(P).end()), scratch(kalman_scratch(k, k));
  for (std::size_t i = 0; i < n; ++i)
    kalman_predict<double>(k, F.data(), Q.data(), next.data() + i * k * k, scratch.data());
  return copied(next.data(), {n, k, k});
}

/// x (n, k) and P (n, k, k) after measurements z (n, m).
nb::tuple update_rows(const Array<double, 2>& H, const Array<double, 2>& R, const Array<double, 2>& z,
                      const Array<double, 2>& x, const Array<double, 3>& P) {
  const std::size_t n = x.shape(0), k = x.shape(1), m = z.shape(1);
  Numbers at(as_span(x).begin(), as_span(x).end()), next(as_span(P).begin(), as_span(P).end()),
      scratch(kalman_scratch(k, m));
  for (std::size_t i = 0; i < n; ++i)
    kalman_update<double>(k, m, H.data(), R.data(), z.data() + i * m, at.data() + i * k, next.data() + i * k * k,
                          scratch.data());
  return nb::make_tuple(copied(at.data(), {n, k}), copied(next.data(), {n, k, k}));
}

nb::tuple response(const Array<double, 1>& time, const Array<double, 1>& values, double set_point, double start,
                   double tolerance) {
  const StepResponse r = step_response(as_span(time), as_span(values), set_point, start, tolerance);
  return nb::make_tuple(r.rise_time, r.settling_time, r.peak, r.peak_time, r.overshoot, r.steady_state_error);
}

nb::tuple margins(const Array<double, 1>& numerator, const Array<double, 1>& denominator, double delay) {
  const StabilityMargins m = stability_margins(as_span(numerator), as_span(denominator), delay);
  return nb::make_tuple(m.gain, m.gain_frequency, m.phase, m.phase_frequency, m.stable, m.lower_gain,
                        m.lower_gain_frequency);
}

}  // namespace

void bindings::bind_control_laws(nb::module_& control) {
  control.def("pid", &pid_rows, "dt"_a, "error"_a, "rate"_a, "integral"_a, "gains"_a);
  control.def("admit", &admit_rows, "dt"_a, "force"_a, "displacement"_a, "velocity"_a, "law"_a);
  control.def("kalman_predict", &predict_rows, "F"_a, "Q"_a, "P"_a);
  control.def("kalman_update", &update_rows, "H"_a, "R"_a, "z"_a, "x"_a, "P"_a);
  control.def("step_response", &response, "time"_a, "response"_a, "set_point"_a, "start"_a, "tolerance"_a);
  control.def("stability_margins", &margins, "numerator"_a, "denominator"_a, "delay"_a);
}

void bindings::bind_control(nb::module_& m) {
  nb::module_ control = m.def_submodule("control", "Controllers; manyhands.control describes the functions.");
  bind_controllers(control);
  bind_control_laws(control);
}

}  // namespace manyhands
