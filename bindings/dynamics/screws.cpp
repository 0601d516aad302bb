// manyhands._core.kinematics: exponential maps over rows, and models seen as screws.
#include "manyhands/kinematics/screws.h"

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include "bindings/arrays.h"
#include "bindings/dynamics/kinematics.h"
#include "bindings/dynamics/rows.h"
#include "bindings/model/python_model.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

using bindings::Array;
using bindings::copied;
using Numbers = std::vector<double>;

void append(Numbers& to, const Vec3<double>& v) { to.insert(to.end(), {v.x, v.y, v.z}); }
void append(Numbers& to, const Quat<double>& r) { to.insert(to.end(), {r.x, r.y, r.z, r.w}); }

Vec3<double> vector_at(const double* x) { return {x[0], x[1], x[2]}; }
Mat3<double> rotation_at(const double* x) { return to_matrix(normalized(Quat<double>{x[0], x[1], x[2], x[3]})); }
Motion<double> motion_at(const double* x) { return {vector_at(x), vector_at(x + 3)}; }

/// (6, 6) by rows: [a 0; b a], of columns a and b.
void append_blocks(Numbers& to, const Mat3<double>& a, const Mat3<double>& b) {
  const auto row = [&](const Mat3<double>& m, int i) {
    const auto pick = [i](const Vec3<double>& v) { return i == 0 ? v.x : i == 1 ? v.y : v.z; };
    to.insert(to.end(), {pick(m.x), pick(m.y), pick(m.z)});
  };
  for (int i = 0; i < 3; ++i) {
    row(a, i);
    to.insert(to.end(), 3, 0.0);
  }
  for (int i = 0; i < 3; ++i) {
    row(b, i);
    row(a, i);
  }
}

nb::object exp3(const Array<double, 2>& rotation) {
  Numbers found;
  for (std::size_t i = 0; i < rotation.shape(0); ++i)
    append(found, quat_from_rotation_vector(vector_at(&rotation(i, 0))));
  return copied(found.data(), {rotation.shape(0), 4});
}

nb::object log3(const Array<double, 2>& quaternion) {
  Numbers found;
  for (std::size_t i = 0; i < quaternion.shape(0); ++i) {
    const double* const r = &quaternion(i, 0);
    append(found, rotation_vector(normalized(Quat<double>{r[0], r[1], r[2], r[3]})));
  }
  return copied(found.data(), {quaternion.shape(0), 3});
}

nb::tuple exp6_rows(const Array<double, 2>& twist) {
  Numbers position, quaternion;
  for (std::size_t i = 0; i < twist.shape(0); ++i) {
    const Motion<double> m = motion_at(&twist(i, 0));
    append(position, exp6(m).p);
    append(quaternion, quat_from_rotation_vector(m.w));
  }
  return nb::make_tuple(copied(position.data(), {twist.shape(0), 3}), copied(quaternion.data(), {twist.shape(0), 4}));
}

nb::object log6_rows(const Array<double, 2>& position, const Array<double, 2>& quaternion) {
  Numbers found;
  for (std::size_t i = 0; i < position.shape(0); ++i) {
    const Motion<double> m = log6(Transform<double>{rotation_at(&quaternion(i, 0)), vector_at(&position(i, 0))});
    append(found, m.w);
    append(found, m.v);
  }
  return copied(found.data(), {position.shape(0), 6});
}

/// Of rotation matrices by rows, (n, 9).
nb::object quaternions(const Array<double, 2>& rows) {
  Numbers found;
  for (std::size_t i = 0; i < rows.shape(0); ++i) {
    const double* const m = &rows(i, 0);
    append(found, to_quat(transpose(Mat3<double>{vector_at(m), vector_at(m + 3), vector_at(m + 6)})));
  }
  return copied(found.data(), {rows.shape(0), 4});
}

/// Columns of the maps m -> X m and m -> twist x m.
nb::object adjoint(const Array<double, 2>& position, const Array<double, 2>& quaternion) {
  Numbers found;
  for (std::size_t i = 0; i < position.shape(0); ++i) {
    const Mat3<double> R = rotation_at(&quaternion(i, 0));
    const Vec3<double> p = vector_at(&position(i, 0));
    append_blocks(found, R, {cross(p, R.x), cross(p, R.y), cross(p, R.z)});
  }
  return copied(found.data(), {position.shape(0), 6, 6});
}

nb::object bracket(const Array<double, 2>& twist) {
  Numbers found;
  const Mat3<double> e = Mat3<double>::identity();
  for (std::size_t i = 0; i < twist.shape(0); ++i) {
    const Motion<double> m = motion_at(&twist(i, 0));
    append_blocks(found, {cross(m.w, e.x), cross(m.w, e.y), cross(m.w, e.z)},
                  {cross(m.v, e.x), cross(m.v, e.y), cross(m.v, e.z)});
  }
  return copied(found.data(), {twist.shape(0), 6, 6});
}

/// Position, quaternion, axes (nv, 6) and joints (nv).
nb::tuple axes_of(PythonModel& model, const std::string& frame, const Array<double, 1>& q0, const std::string& form) {
  const ScrewAxes found =
      screw_axes(*model.model, model.model->frame_id(frame), bindings::as_span(q0), bindings::form_of(form));
  Numbers position, quaternion, axes;
  append(position, found.home.p);
  append(quaternion, to_quat(found.home.R));
  for (const Motion<double>& S : found.axes) {
    append(axes, S.w);
    append(axes, S.v);
  }
  return nb::make_tuple(copied(position.data(), {3}), copied(quaternion.data(), {4}),
                        copied(axes.data(), {found.axes.size(), 6}), copied(found.joint.data(), {found.joint.size()}));
}

nb::object coordinates(PythonModel& model, const Array<double, 2>& q, const Array<double, 1>& q0) {
  Numbers found;
  const std::size_t nq = q.shape(1);
  for (std::size_t i = 0; i < q.shape(0); ++i) {
    const Numbers theta = screw_coordinates(*model.model, bindings::as_span(q0), std::span(q.data() + i * nq, nq));
    found.insert(found.end(), theta.begin(), theta.end());
  }
  return copied(found.data(), {q.shape(0), static_cast<std::size_t>(model.model->nv())});
}

nb::tuple product(const Array<double, 1>& position, const Array<double, 1>& quaternion, const Array<double, 2>& axes,
                  const Array<int, 1>& joint, const std::string& form, const Array<double, 2>& theta) {
  ScrewAxes screws{bindings::form_of(form), {rotation_at(quaternion.data()), vector_at(position.data())}};
  for (std::size_t k = 0; k < axes.shape(0); ++k) screws.axes.push_back(motion_at(&axes(k, 0)));
  screws.joint.assign(joint.data(), joint.data() + joint.size());
  Numbers p, r;
  for (std::size_t i = 0; i < theta.shape(0); ++i) {
    const Transform<double> X =
        product_of_exponentials(screws, std::span(theta.data() + i * theta.shape(1), theta.shape(1)));
    append(p, X.p);
    append(r, to_quat(X.R));
  }
  return nb::make_tuple(copied(p.data(), {theta.shape(0), 3}), copied(r.data(), {theta.shape(0), 4}));
}

ScrewChain chain_of(const Array<double, 2>& T, const Array<double, 2>& axes) {
  if (T.shape(0) != 4 || T.shape(1) != 4 || axes.shape(0) != 6)
    throw std::invalid_argument("expected a home (4, 4) and axes (6, n)");
  const auto row = [&](std::size_t i) { return vector_at(&T(i, 0)); };
  std::vector<Motion<double>> columns;
  for (std::size_t k = 0; k < axes.shape(1); ++k)
    columns.push_back({{axes(0, k), axes(1, k), axes(2, k)}, {axes(3, k), axes(4, k), axes(5, k)}});
  return {{transpose(Mat3<double>{row(0), row(1), row(2)}), {T(0, 3), T(1, 3), T(2, 3)}}, columns};
}

/// How many rows theta has, and how long they are.
struct Turns {
  explicit Turns(const bindings::Input<double>& theta)
      : batch{theta.ndim() == 2 ? theta.shape(0) : 1, theta.ndim() == 1}, columns(theta.shape(theta.ndim() - 1)) {
    if (theta.ndim() > 2) throw std::invalid_argument("theta must have the shape (k,) or (n, k)");
    bindings::require_finite("theta", theta);
  }
  bindings::Batch batch;
  std::size_t columns;
};

bindings::Output<double> chain_pose(const ScrewChain& chain, const bindings::Input<double>& theta) {
  const Turns turns(theta);
  bindings::Result<double> found(turns.batch, {4, 4});
  double* to = found.span().data();
  for (std::size_t i = 0; i < turns.batch.n; ++i) {
    const Transform<double> X = chain.pose(std::span(theta.data() + i * turns.columns, turns.columns));
    for (const double x : {X.R.x.x, X.R.y.x, X.R.z.x, X.p.x, X.R.x.y, X.R.y.y, X.R.z.y, X.p.y, X.R.x.z, X.R.y.z,
                           X.R.z.z, X.p.z, 0.0, 0.0, 0.0, 1.0})
      *to++ = x;
  }
  return found.array();
}

bindings::Output<double> chain_jacobian(const ScrewChain& chain, const bindings::Input<double>& theta, bool in_body) {
  const Turns turns(theta);
  const std::size_t n = turns.columns;
  bindings::Result<double> found(turns.batch, {6, n});
  for (std::size_t i = 0; i < turns.batch.n; ++i) {
    const std::vector<Motion<double>> J = chain.jacobian(std::span(theta.data() + i * n, n), in_body);
    double* const to = found.span().data() + 6 * n * i;
    for (std::size_t k = 0; k < n; ++k) {
      const Motion<double>& m = J[k];
      const std::array<double, 6> column{m.w.x, m.w.y, m.w.z, m.v.x, m.v.y, m.v.z};
      for (std::size_t r = 0; r < 6; ++r) to[r * n + k] = column[r];
    }
  }
  return found.array();
}

void bind_chain(nb::module_& m) {
  const std::string array = "numpy.typing.NDArray[numpy.float64]";
  nb::class_<ScrewChain>(m, "ScrewChain", "An arm as screws: home (4, 4), axes (6, n) in the space form.")
      .def(
          "__init__",
          [](ScrewChain* self, const Array<double, 2>& home, const Array<double, 2>& axes) {
            new (self) ScrewChain(chain_of(home, axes));
          },
          "home"_a, "axes"_a)
      .def("pose", &chain_pose, "theta"_a, nb::sig(("def pose(self, theta: " + array + ") -> " + array).c_str()),
           "(..., 4, 4) of theta (..., k): of the first k screws.")
      .def("jacobian", &chain_jacobian, "theta"_a, "in_body"_a = false,
           nb::sig(("def jacobian(self, theta: " + array + ", in_body: bool = False) -> " + array).c_str()),
           "(..., 6, k), in the space form or the body form.");
}

}  // namespace

void bindings::bind_screws(nb::module_& m) {
  bind_chain(m);
  m.def("exp3", &exp3, "rotation"_a);
  m.def("log3", &log3, "quaternion"_a);
  m.def("exp6", &exp6_rows, "twist"_a);
  m.def("log6", &log6_rows, "position"_a, "quaternion"_a);
  m.def("adjoint", &adjoint, "position"_a, "quaternion"_a);
  m.def("quaternions", &quaternions, "rotation"_a);
  m.def("bracket", &bracket, "twist"_a);
  m.def("screw_axes", &axes_of, "model"_a, "frame"_a, "q0"_a, "form"_a);
  m.def("screw_coordinates", &coordinates, "model"_a, "q"_a, "q0"_a);
  m.def("product_of_exponentials", &product, "position"_a, "quaternion"_a, "axes"_a, "joint"_a, "form"_a, "theta"_a);
}

}  // namespace manyhands
